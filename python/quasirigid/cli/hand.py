"""`quasirigid hand`: what a hand file holds, and the hand in a pose."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer

import quasirigid as qr

from .._extras import need_matplotlib
from ..hand import read_pose
from ..hand.pose import PRESETS, turned_joint
from ..io import write_mesh
from ..io.atomic import png_bytes, write_files
from ..io.record import figure
from .arguments import file_unit
from .console import Talk, progress
from .folder import OutFolder, check_folder, check_inputs
from .meshes import record_table
from .quantities import QuantityError
from .scene import UNIT_NAMES

__all__ = [
    "HAND_EXAMPLE",
    "HandFile",
    "HandUnit",
    "PoseWord",
    "Rig",
    "check_joints",
    "hand",
    "hand_inputs",
    "pose_file",
    "read_pose_word",
    "read_rigged",
]

HAND_EXAMPLE = "quasirigid hand built-in --pose cylinder --out hand-output"
_BUILT_IN = "built-in"
_GLTF = (".glb", ".gltf")
_FILES = ("posed.ply", "hand.glb", "hand.png")

HandFile = Annotated[
    str,
    typer.Argument(metavar="HAND", help=f".glb or .gltf with a skin, a mesh with its rig, or {_BUILT_IN!r}."),
]
Rig = Annotated[Path | None, typer.Option(help="Rig (.npz) of a mesh. [default: the one beside it]")]
HandUnit = Annotated[str, typer.Option(help=f"Unit of a mesh: {UNIT_NAMES}.")]
POSE_HELP = (
    f"A preset ({', '.join(PRESETS)}), or a JSON file of angles from rest:"
    ' {"unit": "deg", "index-finger-phalanx-proximal": 30}.'
)
PoseWord = Annotated[str, typer.Option(help=POSE_HELP)]


def hand(
    file: HandFile,
    talk: Talk,
    rig: Rig = None,
    unit: HandUnit = "m",
    pose: Annotated[str | None, typer.Option(help=POSE_HELP)] = None,
    pictures: Annotated[bool, typer.Option(help="Draw hand.png.")] = True,
    out: OutFolder = None,
) -> int:
    """Show a hand's joints, regions and size; write it in a pose.

    --json has the names of joints and regions too.
    Writes posed.ply (m), hand.glb (at rest, with skin and joints) and hand.png.
    Exit status 0: done; 2: bad input.
    """
    inputs = hand_inputs(file, rig) | {"--pose": pose_file(pose)}
    check_inputs(inputs)
    check_folder(out, _FILES, inputs)
    if file_unit(unit, "--unit") != "m" and (file == _BUILT_IN or Path(file).suffix.lower() in _GLTF):
        raise QuantityError(f"--unit: '{unit}' is of a mesh, but {file} is in m: leave it out")
    wanted = {} if pose is None else read_pose_word(pose)
    with progress(f"reading {file}"):
        known = read_rigged(file, rig, unit)
        check_joints(pose or "", wanted, known)
        posed = known.posed(wanted)
    files: list[Path] = []
    if out is not None:
        with progress(f"writing {out}"):
            files = _write(known, posed, out, pictures=pictures)
    record = _record(known, pose)
    text = record_table(file, record)
    record |= {"joint_names": list(known.joint_names), "region_names": np.unique(known.labels).tolist()}
    talk.tell(text + "\nwrote " + ", ".join(map(str, files)) if files else text, record)
    return 0


def pose_file(word: str | None) -> Path | None:
    """Return the JSON file of a pose; None of a preset."""
    return Path(word) if word is not None and word.lower().endswith(".json") else None


def read_pose_word(word: str) -> Any:
    """Return a preset's name as it is, a JSON file as the pose that it holds."""
    file = pose_file(word)
    return word if file is None else read_pose(file)


def check_joints(word: str, pose: Any, known: qr.Hand) -> None:
    """Refuse joints of a pose file that the hand has not."""
    if file := pose_file(word):
        for joint in pose:
            turned_joint(joint, known, f"{file}: the joint")


def hand_inputs(file: str, rig: Path | None) -> dict[str, Path | None]:
    """Return the files that a hand is read from, by the names of their arguments."""
    if file == _BUILT_IN:
        return {}
    if not Path(file).suffix and not Path(file).exists():
        raise QuantityError(
            f"there is no hand '{file}', expected {_BUILT_IN}, a .glb file, or a mesh with its rig"
        )
    return {"HAND": Path(file), "--rig": rig}


def read_rigged(file: str, rig: Path | None, unit: str) -> qr.Hand:
    """Return the hand of a file, or the built-in one."""
    length = file_unit(unit, "--unit")
    if file != _BUILT_IN:
        return qr.read_hand(file, rig=rig, unit=length)
    if rig is not None:
        raise QuantityError(f"--rig: '{rig}' belongs to a mesh, the {_BUILT_IN} hand has its own")
    return qr.models.hand()


def _record(known: qr.Hand, pose: str | None) -> dict[str, Any]:
    return {
        "side": known.side,
        "vertices": len(known.surface.vertices),
        "joints": len(known.joint_names),
        "wrist_to_middle_tip_joint": figure(known.length, "m"),
        "volume": figure(known.surface.volume, "m^3"),
        "mean_edge_length": figure(known.surface.mean_edge_length, "m"),
        "regions": len(np.unique(known.labels)),
        "bones": len(known.bones),
        "pose": pose,
    }


def _write(known: qr.Hand, posed: qr.PosedHand, out: Path, *, pictures: bool) -> list[Path]:
    if pictures:
        need_matplotlib()
    out.mkdir(parents=True, exist_ok=True)
    mesh, glb = (out / name for name in _FILES[:2])
    write_mesh(posed.surface.vertices, posed.surface.faces, mesh, unit="m")
    known.save(glb)
    if not pictures:
        return [mesh, glb]
    from ..plot.hands import hand_figure

    return [mesh, glb, *write_files(out, {_FILES[2]: png_bytes(hand_figure(posed))})]
