"""Files for the commands: the demo's folder, one with a fingertip and a handle, a hand, a bottle."""

from __future__ import annotations

from pathlib import Path

import pytest
import quasirigid as qr
from command_words import DEMO


@pytest.fixture(scope="session")
def demo_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Where the demo has run."""
    from quasirigid.cli import run

    folder = tmp_path_factory.mktemp("demo")
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        assert run(DEMO) == 0
    return folder


@pytest.fixture
def in_demo_folder(demo_folder: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(demo_folder)
    return demo_folder


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with a fingertip and a handle."""
    monkeypatch.chdir(tmp_path)
    tip = qr.models.fingertip(edge_length=2e-3)
    handle = qr.models.cylinder_handle(edge_length=3e-3).triangles()
    assert handle is not None
    qr.io.write_mesh(tip.vertices, tip.faces, "tip.ply", unit="m")
    qr.io.write_mesh(*handle, "handle.stl", unit="mm")
    return tmp_path


@pytest.fixture(scope="session")
def saved(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("hand") / "hand.glb"
    qr.models.hand(edge_length=4e-3).save(path)
    return path


@pytest.fixture(scope="session")
def bottle(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("product") / "bottle.stl"
    triangles = qr.models.bottle(edge_length=2e-3).triangles()
    assert triangles is not None
    qr.io.write_mesh(*triangles, path, unit="mm")
    return path
