"""Results cannot be changed: no attribute is set, no array or mapping written into."""

from __future__ import annotations

import copy
import dataclasses
import pickle
from collections.abc import Callable, Iterator, Mapping
from typing import Any

import numpy as np
import pytest
import quasirigid as qr
from shapes import AS_GIVEN, SKIN, ball, grid, tetrahedron


def contact_results(contact: qr.Contact) -> Iterator[Any]:
    yield from (contact, contact.accuracy, contact.refinements[0], contact.patches[0], contact.surface)
    yield from (contact.part(np.ones(len(contact.gap), dtype=bool)), contact.lcp_solutions[0])
    yield contact.lcp_solutions[0].certificate


def hand_results() -> Iterator[Any]:
    hand = qr.models.hand(edge_length=5e-3)
    product = qr.Obstacle.sphere([0.0, 0.0, 0.0], 0.02).placed(hand.posed("relaxed").palm)
    grasp = qr.close_hand(hand, product, SKIN, force={"index": 1.0}, options=AS_GIVEN)
    yield from (hand, hand.bones[0], grasp, grasp.posed, grasp.palm)


def skin_results() -> Iterator[Any]:
    sheet = qr.Surface(*grid(4, 1e-3))
    yield from (SKIN, SKIN.prepared(sheet), SKIN.combined(sheet, {}), qr.definiteness(np.eye(2)))
    yield qr.Layer(thickness=np.full(25, 5e-3))
    whole = qr.Surface(*ball(8e-3, 2))
    yield qr.cut_out(whole, tip=int(whole.vertices[:, 2].argmax()), point=[0, 0, 0.01], normal=[0, 0, 1])


@pytest.fixture(scope="module")
def results(pressed: qr.Contact) -> list[Any]:
    """One of each class that the package returns."""
    plate = qr.Obstacle.half_space([0, 0, 0], [0, 0, 1])
    made = [qr.repair(*tetrahedron(), weld_tolerance=0.0), AS_GIVEN, qr.Table(name="stress", _rows=())]
    made.append(qr.sweep(qr.Surface(*ball(8e-3, 2)), plate, SKIN, [0, 0, 1], depths=[0.0], options=AS_GIVEN))
    made.append(qr.solve_lcp([[-1.0]], [-1.0], throw=False).ray)
    return [*made, *contact_results(pressed), *hand_results(), *skin_results()]


def again(thing: Any) -> Any:
    return pickle.loads(pickle.dumps(thing))


@pytest.mark.parametrize("copied", [lambda thing: thing, copy.copy, copy.deepcopy, again])
@pytest.mark.filterwarnings("ignore::quasirigid.QuasirigidWarning")  # of coarse meshes
def test_no_result_can_be_changed(results: list[Any], copied: Callable[[Any], Any]) -> None:
    for result in map(copied, results):
        for name in fields_of(result):
            value = entries = getattr(result, name)
            with pytest.raises(AttributeError):
                setattr(result, name, value)
            with pytest.raises(AttributeError):
                delattr(result, name)
            if isinstance(value, np.ndarray):
                assert not value.flags.writeable, f"{type(result).__name__}.{name}"
            if isinstance(value, Mapping):
                for change in ("clear", "popitem", "update"):
                    with pytest.raises(TypeError):
                        getattr(entries, change)()
                with pytest.raises(TypeError):
                    entries["new"] = 0


def test_results_are_taken_apart_as_dataclasses(results: list[Any]) -> None:
    taken_apart = set()
    for result in results:
        if dataclasses.is_dataclass(result):
            known = dataclasses.asdict(result)
            assert set(known) == {field.name for field in dataclasses.fields(result)}
            taken_apart.add(type(result))
    kinds = {qr.Contact, qr.Grasp, qr.Skin, qr.PreparedSkin, qr.CombinedSkin, qr.Sweep, qr.surface.Repair}
    assert kinds <= taken_apart


def test_a_skin_that_was_computed_takes_no_other_part() -> None:
    sheet = qr.Surface(*grid(4, 1e-3))
    other = dataclasses.replace(SKIN, shear_modulus=2.0 * SKIN.shear_modulus)
    made = {
        r"PreparedSkin is made by `Skin\.prepared` or `load_": (SKIN.prepared(sheet), {"skin": other}),
        r"CombinedSkin is made by `Skin\.combined`": (SKIN.combined(sheet, {}), {"background": other}),
    }
    for message, (skin, change) in made.items():
        with pytest.raises(TypeError, match=message):
            dataclasses.replace(skin, **change)
        with pytest.raises(TypeError, match=message):
            type(skin)(**change, _response=None)


def fields_of(result: Any) -> list[str]:
    """Names of what a result holds, of a surface those of its arrays."""
    if isinstance(result, qr.Surface):
        return ["vertices", "faces", "skin_mask", "vertex_normals"]
    return [name for name in vars(result) if not name.startswith("_")]


def test_what_is_computed_late_is_read_only_too(pressed: qr.Contact) -> None:
    hand = qr.models.hand(edge_length=5e-3)
    joint = hand.joint_names[3]
    for array in (hand.regions, hand.labels, hand.pivot_of(joint), hand.frame_of(joint)):
        assert not array.flags.writeable
    for array in (pressed.displacement, pressed.obstacle_displacement):
        assert not array.flags.writeable
