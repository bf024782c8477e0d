"""The body response through Python: refusals, volume, units, bone pressure, progress."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import quasirigid as qr
from shapes import AS_GIVEN, PLATE, ball

# Scenes are coarse on purpose, and taken as they are; some are in other units.
pytestmark = [
    pytest.mark.filterwarnings("ignore::quasirigid.CoarseMeshWarning"),
    pytest.mark.filterwarnings("ignore::quasirigid.ModulusWarning"),
    pytest.mark.filterwarnings("ignore::quasirigid.SizeWarning"),
]

SHEAR_MODULUS = 60e3
UP = [0, 0, 1]


def at(mesh: tuple[np.ndarray, np.ndarray], shift: float | list[float]) -> qr.Surface:
    """A ball about the origin, moved by `shift` (m)."""
    vertices, faces = mesh
    low = vertices[:, 2].min()
    high = vertices[:, 2].max()
    return qr.Surface(vertices - [0, 0, (low + high) / 2] + np.broadcast_to(shift, 3), faces)


BALL = at(ball(8e-3, 1), 0.0)
CORE = at(ball(3e-3, 1), 0.0)


def skin_of(poisson_ratio: float = 0.5, shear_modulus: float = SHEAR_MODULUS, **body: object) -> qr.Skin:
    response = qr.Body(**body)  # type: ignore[arg-type]
    return qr.Skin(shear_modulus=shear_modulus, poisson_ratio=poisson_ratio, response=response)


def inside_out() -> qr.Surface:
    # Mirrored in place, a bone keeps its faces and turns its volume.
    mirrored = CORE.vertices * [1, 1, -1]
    return qr.Surface(mirrored, CORE.faces)


def touching() -> qr.Surface:
    """A small ball that all but meets a face of the skin from within."""
    corners = BALL.vertices[BALL.faces[0]]
    centroid = corners.mean(axis=0)
    normal = centroid / np.linalg.norm(centroid)
    small = at(ball(1e-3, 1), 0.0)
    tip = small.vertices[0]
    # Turned so that a vertex points at the face.
    first = tip / np.linalg.norm(tip)
    axis = np.cross(first, normal)
    cross = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    turn = np.eye(3) + cross + cross @ cross / (1 + first @ normal)
    return qr.Surface((small.vertices - tip) @ turn.T + centroid * (1 - 1e-9), small.faces)


REFUSALS: dict[str, tuple[Callable[[], dict[str, object]], str]] = {
    "nothing holds it": (dict, "nothing holds the body"),
    "an open bone": (
        lambda: {"bone": qr.Surface(CORE.vertices, CORE.faces[1:])},
        r"bone 0 is open .*must be closed",
    ),
    "a bone outside": (lambda: {"bone": at(ball(3e-3, 1), [0.02, 0, 0])}, "bone 0 lies outside the skin"),
    "a bone around": (lambda: {"bone": at(ball(9e-3, 1), 0.0)}, "lies outside the skin"),
    "a bone that crosses": (
        lambda: {"bone": at(ball(3e-3, 1), [7e-3, 0, 0])},
        r"crosses or touches the skin in \d+ pairs of faces",
    ),
    "a bone that touches": (lambda: {"bone": touching()}, r"bone face \d+ is only .* from skin face 0"),
    "a short mask": (lambda: {"fixed": [True] * 3}, "3 entries, but the skin has 42"),
    "nothing fixed": (lambda: {"fixed": [False] * 42}, "fixes none of the 42"),
    "everything fixed": (lambda: {"fixed": [True] * 42}, "fixes all 42"),
    "one vertex fixed": (
        lambda: {"fixed": np.arange(42) == 7},
        r"1 fixed vertices \(first: 7\) span no face: .* could turn about them",
    ),
    "numbers for a mask": (lambda: {"fixed": np.zeros(42)}, "booleans"),
}


@pytest.mark.parametrize(("body", "message"), REFUSALS.values(), ids=REFUSALS.keys())
def test_a_body_that_cannot_be_is_refused_with_the_reason(
    body: Callable[[], dict[str, object]], message: str
) -> None:
    with pytest.raises((qr.ResponseError, TypeError), match=message):
        skin_of(**body()).prepared(BALL, [0])


def test_a_bone_or_skin_turned_inside_out_is_refused() -> None:
    with pytest.raises(qr.QuasirigidError, match=r"inside out|encloses -|counter-clockwise"):
        skin_of(bone=inside_out()).prepared(BALL, [0])
    with pytest.raises(qr.QuasirigidError, match=r"inside out|encloses -|counter-clockwise"):
        skin_of(bone=CORE).prepared(qr.Surface(BALL.vertices * [1, 1, -1], BALL.faces), [0])


def test_an_open_skin_and_nodes_that_cannot_be_loaded_are_refused() -> None:
    with pytest.raises(qr.ResponseError, match=r"the skin is open \(1 borders\)"):
        skin_of(bone=CORE).prepared(qr.Surface(BALL.vertices, BALL.faces[1:]), [0])
    with pytest.raises(qr.ResponseError, match="vertex 4 "):
        skin_of(bone=CORE).prepared(BALL, [4, 0, 4])
    with pytest.raises(qr.ResponseError, match=r"nodes\[1\]"):
        skin_of(bone=CORE).prepared(BALL, [0, 42])
    with pytest.raises(qr.ResponseError, match="no node to load"):
        skin_of(bone=CORE).prepared(BALL, np.zeros(0, dtype=int))
    held = BALL.vertices[:, 2] > 0
    with pytest.raises(qr.ResponseError, match="fixed vertices"):
        skin_of(fixed=held).prepared(BALL, np.flatnonzero(held))


def test_the_force_is_the_same_at_one_half_and_just_below() -> None:
    surface = qr.Surface(*ball(8e-3, 2))
    bone = at(ball(5e-3, 2), [0, 0, 8e-3])
    low = np.flatnonzero(surface.vertices[:, 2] < 4e-3)

    def force(poisson_ratio: float) -> float:
        prepared = skin_of(poisson_ratio, bone=bone, coarse_edge_length=0).prepared(surface, low)
        return float(qr.press(surface, PLATE, prepared, UP, depth=0.6e-3, options=AS_GIVEN).force[2])

    assert force(0.499999) == pytest.approx(force(0.5), rel=1e-4)


@pytest.mark.filterwarnings("ignore:the target of .*coarse mesh of the body:quasirigid.RefinementWarning")
@pytest.mark.parametrize(("length", "modulus"), [(1e-3, 1.0), (1e3, 1.0), (1.0, 1e-6), (1.0, 1e6)])
def test_the_unit_system_does_not_matter(length: float, modulus: float) -> None:
    vertices, faces = ball(8e-3, 2)
    bone = at(ball(3e-3, 1), [0, 0, 8e-3])
    held = vertices[:, 2] > 13e-3
    low = np.flatnonzero(vertices[:, 2] < 3e-3)

    def press(length: float, modulus: float) -> tuple[qr.Surface, qr.Contact]:
        surface = qr.Surface(vertices * length, faces)
        core = qr.Surface(bone.vertices * length, bone.faces)
        skin = skin_of(0.5, SHEAR_MODULUS * modulus, bone=core, fixed=held).prepared(surface, low)
        return surface, qr.press(surface, PLATE, skin, UP, depth=0.4e-3 * length)

    (_, here), (_, there) = press(1.0, 1.0), press(length, modulus)
    scale = length**2 * modulus
    assert there.force[2] / scale == pytest.approx(here.force[2], rel=1e-9)
    np.testing.assert_allclose(there.node_force / scale, here.node_force, atol=1e-9 * here.node_force.max())
    largest = np.abs(here.displacement).max()
    np.testing.assert_allclose(there.displacement / length, here.displacement, atol=1e-9 * largest)


def swept(contact: qr.Contact) -> float:
    """Volume (m^3) that the skin gives up where it moves inwards."""
    inward = -np.einsum("ij,ij->i", contact.displacement, contact.surface.vertex_normals)
    return float(np.maximum(inward, 0) @ contact.surface.vertex_areas)


# At 2 mm the contact reaches the cut, 10 % of the force beside it.
@pytest.mark.filterwarnings("ignore:the contact reaches:quasirigid.QuasirigidWarning")
@pytest.mark.parametrize("depth", [0.3e-3, 1.12e-3, 2e-3])
def test_the_deformed_finger_keeps_its_volume_to_first_order_and_its_contact(depth: float) -> None:
    finger = qr.models.fingertip(edge_length=2.2e-3)
    finger = finger.with_skin_mask(qr.skin_without_caps(finger))
    body = {"bone": qr.models.bone_of(finger), "fixed": ~finger.skin_mask}
    pad = np.flatnonzero(finger.skin_mask & (finger.vertices[:, 2] < 0))
    prepared = skin_of(**body).prepared(finger, pad)
    plate = qr.Obstacle.half_space([0, 0, -0.05], UP)
    contact = qr.press(finger, plate, prepared, UP, depth=depth, options=AS_GIVEN)
    pushed = swept(contact)
    assert abs(contact.volume_change) < 5e-3 * pushed
    # Of the mesh's own change the rest is of second order: some depth over the radius of what is pushed in.
    assert abs(contact.deformed.volume - finger.volume) < depth / 8e-3 * pushed
    # Neither opened nor closed: the contact lies on the plate, everything else as far off it as the gap says.
    heights = contact.obstacle.signed_distance(contact.deformed.vertices)[0]
    assert np.abs(heights[contact.active]).max() < 1e-9
    free = np.setdiff1d(contact.candidates, contact.active)
    np.testing.assert_allclose(heights[free], contact.gap[free], rtol=1e-9, atol=1e-15)
    assert contact.gap[free].min() >= 0.0
    assert contact.max_penetration_after < 1e-9
    # What is fixed stays.
    assert not contact.displacement[~finger.skin_mask].any()


def test_a_compressible_body_changes_its_volume_by_the_first_order() -> None:
    surface = qr.Surface(*ball(8e-3, 2))
    bone = at(ball(3e-3, 2), [0, 0, 8e-3])
    low = np.flatnonzero(surface.vertices[:, 2] < 4e-3)
    prepared = skin_of(0.3, bone=bone).prepared(surface, low)
    depths = (0.1e-3, 0.4e-3)
    changes = []
    for depth in depths:
        contact = qr.press(surface, PLATE, prepared, UP, depth=depth)
        changes.append((contact.deformed.volume - contact.surface.volume) / swept(contact))
    # A share of what is pushed in, nearly the same at any depth, and not its second order.
    assert changes[0] < -0.1
    assert changes[1] == pytest.approx(changes[0], rel=0.1)


def test_a_uniform_pressure_reaches_the_bone_unchanged() -> None:
    surface = at(ball(8e-3, 2), 0.0)
    prepared = skin_of(bone=at(ball(3e-3, 2), 0.0), bone_pressure=True).prepared(surface)
    pressure = 1e4
    forces = -pressure * surface.vertex_areas[:, None] * surface.vertex_normals
    found = prepared.bone_pressure(forces)
    # The mesh error of 162 vertices.
    np.testing.assert_allclose(found, pressure, rtol=0.01)


def test_a_coarse_mesh_costs_a_uniform_pressure_no_more_than_the_docstring_says() -> None:
    surface, core = at(ball(8e-3, 3), 0.0), at(ball(3e-3, 2), 0.0)
    forces = -1e3 * surface.vertex_areas[:, None] * surface.vertex_normals

    def error(coarse_edge_length: float | None) -> float:
        skin = skin_of(bone=core, bone_pressure=True, coarse_edge_length=coarse_edge_length)
        return float(np.abs(skin.prepared(surface).bone_pressure(forces) / 1e3 - 1.0).max())

    coarse, own = error(None), error(0.0)
    assert own < coarse < 0.03
    assert own < 0.003


@pytest.mark.filterwarnings("ignore:the target of .*coarse mesh of the body:quasirigid.RefinementWarning")
def test_the_pressure_on_the_bone_under_a_contact_is_saved_and_turned_too(tmp_path: Path) -> None:
    surface = qr.Surface(*ball(8e-3, 2))
    bone = at(ball(3e-3, 2), [0, 0, 8e-3])
    low = np.flatnonzero(surface.vertices[:, 2] < 4e-3)
    held = surface.vertices[:, 2] > 14e-3
    prepared = skin_of(bone=bone, fixed=held, bone_pressure=True).prepared(surface, low)
    contact = qr.press(surface, PLATE, prepared, UP, depth=0.6e-3)
    pressure = prepared.bone_pressure(contact)
    # The forces that it answers are those of the contact.
    np.testing.assert_allclose(contact.force_vectors.sum(axis=0), contact.force, rtol=1e-12, atol=1e-15)
    np.testing.assert_allclose(
        np.linalg.norm(contact.force_vectors, axis=1), contact.node_force, rtol=1e-12, atol=0
    )
    # Pressed from below, the bone feels most at its lowest point.
    assert pressure.max() == pytest.approx(pressure[np.argmin(bone.vertices[:, 2])], rel=0.05)
    assert pressure.max() > 0
    prepared.save(tmp_path / "ball.npz")
    loaded = qr.load_prepared(tmp_path / "ball.npz")
    np.testing.assert_array_equal(loaded.bone_pressure(contact), pressure)
    assert isinstance(loaded.skin.response, qr.Body)
    assert loaded.skin.response.bone is not None
    np.testing.assert_array_equal(loaded.skin.response.bone.vertices, bone.vertices)
    np.testing.assert_array_equal(loaded.skin.response.fixed, held)
    turn = np.array([[0.0, -1, 0], [0.6, 0, -0.8], [0.8, 0, 0.6]])
    moved = loaded.moved(turn, [0.1, 0.2, 0.3])
    there = surface.moved(turn, [0.1, 0.2, 0.3])
    plate = PLATE.moved(turn, [0.1, 0.2, 0.3])
    again = qr.press(there, plate, moved, turn @ UP, depth=0.6e-3)
    np.testing.assert_allclose(moved.bone_pressure(again), pressure, rtol=1e-6)


def test_a_bone_pressure_that_is_not_known_is_refused() -> None:
    forces = np.zeros((42, 3))
    with pytest.raises(qr.ResponseError, match="bone_pressure=True"):
        skin_of(bone=CORE).prepared(BALL, [0]).bone_pressure(forces)
    skin = qr.Skin(shear_modulus=SHEAR_MODULUS, poisson_ratio=0.5, response=qr.HalfSpace())
    with pytest.raises(qr.ResponseError, match="bone_pressure=True"):
        skin.prepared(BALL, [0]).bone_pressure(forces)
    prepared = skin_of(bone=CORE, bone_pressure=True).prepared(BALL, [0])
    with pytest.raises(qr.ResponseError, match="3 forces for 42 vertices"):
        prepared.bone_pressure(np.zeros((3, 3)))
    forces[5] = 1.0
    message = (
        "^vertex 5 carries force, but the response was prepared for 1 other vertices: prepare it for this"
    )
    with pytest.raises(qr.ResponseError, match=message):
        prepared.bone_pressure(forces)


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_a_load_that_is_not_finite_is_refused_by_its_row(value: float) -> None:
    prepared = skin_of(bone=CORE, bone_pressure=True).prepared(BALL)
    forces = np.zeros((42, 3))
    forces[7, 1] = forces[9, 2] = value
    message = rf"^forces\[7\] is \[0\.0, {value}, 0\.0\], expected finite forces \(2 are not\)$"
    for load in (forces, forces.astype(np.float32), forces.tolist()):
        with pytest.raises(qr.ResponseError, match=message):
            prepared.bone_pressure(load)


def test_only_the_nodes_asked_for_get_right_hand_sides(tmp_path: Path) -> None:
    surface = qr.Surface(*ball(8e-3, 2))
    bone = at(ball(3e-3, 1), [0, 0, 8e-3])
    low = np.flatnonzero(surface.vertices[:, 2] < 3e-3)
    few, all_ = (skin_of(bone=bone).prepared(surface, nodes) for nodes in (low, None))
    np.testing.assert_array_equal(few.nodes, low)
    assert len(all_.nodes) == 162
    sizes = []
    for prepared in (few, all_):
        prepared.save(tmp_path / "one.npz")
        sizes.append(np.load(tmp_path / "one.npz")["displacement"].shape)
    assert sizes == [(3 * 162, 3 * len(low)), (3 * 162, 3 * 162)]
    forces = [qr.press(surface, PLATE, skin, UP, depth=0.3e-3).force[2] for skin in (few, all_)]
    assert forces[0] == pytest.approx(forces[1], rel=1e-9)
    with pytest.raises(qr.ResponseError, match="prepare it for these too"):
        qr.press(surface, qr.Obstacle.half_space([0, 0, 0.02], [0, 0, -1]), few, [0, 0, -1], depth=0.3e-3)


def test_progress_announces_the_cost_and_goes_through_the_stages(capsys: pytest.CaptureFixture[str]) -> None:
    calls: list[tuple[str, float]] = []
    skin_of(bone=CORE).prepared(BALL, [0, 1], progress=lambda what, done: calls.append((what, done)))
    words = [what for what, _ in calls]
    assert words[0].startswith("body of 42 skin and 42 bone vertices, 2 of them loaded: ")
    assert "GB" in words[0]
    assert list(dict.fromkeys(words[1:])) == ["assembly", "factorization", "solution"]
    assert calls[-1] == ("solution", 1.0)
    skin_of(bone=CORE).prepared(BALL, [0], progress=True)
    printed = capsys.readouterr()
    assert printed.out == ""
    assert printed.err.startswith("body of 42 skin and 42 bone vertices")
    assert "solution: 100%" in printed.err
    skin_of(bone=CORE).prepared(BALL, [0])
    assert capsys.readouterr().err == ""


@pytest.mark.parametrize("progress", ["yes", 1, 0.5])
def test_a_progress_that_cannot_be_called_is_refused(progress: object) -> None:
    for skin in (skin_of(bone=CORE), qr.Skin(shear_modulus=6e4, poisson_ratio=0.5, response=qr.HalfSpace())):
        with pytest.raises(TypeError, match=f"progress is {progress!r}, expected a function"):
            skin.prepared(BALL, [0], progress=progress)  # type: ignore[arg-type]


@pytest.mark.parametrize("failure", [ZeroDivisionError, KeyboardInterrupt])
@pytest.mark.parametrize("at", ["body of", "assembly", "solution"])
def test_what_progress_raises_ends_the_work_and_reaches_the_caller(
    at: str, failure: type[BaseException]
) -> None:
    calls: list[str] = []

    def progress(what: str, done: float) -> None:
        calls.append(what)
        if what.startswith(at):
            raise failure

    with pytest.raises(failure):
        skin_of(bone=CORE).prepared(BALL, [0, 1], progress=progress)
    # Nothing is called after the failure.
    assert [what.startswith(at) for what in calls] == [False] * (len(calls) - 1) + [True]


def test_a_progress_of_other_arguments_says_so() -> None:
    with pytest.raises(TypeError, match="positional arguments"):
        skin_of(bone=CORE).prepared(BALL, [0], progress=lambda: None)  # type: ignore[arg-type, misc]


def test_fixed_is_looked_at_before_it_is_used() -> None:
    held = BALL.vertices[:, 2] > 0
    for nodes in (None, [0]):
        with pytest.raises(TypeError, match=r"`fixed` has dtype int64, expected booleans.*np\.isin"):
            skin_of(fixed=np.flatnonzero(held)).prepared(BALL, nodes)
        with pytest.raises(qr.ResponseError, match="`fixed` has 41 entries, but the skin has 42 vertices"):
            skin_of(fixed=held[1:]).prepared(BALL, nodes)
    with pytest.raises(qr.ResponseError, match="memory_limit is -5"):
        skin_of(fixed=held, memory_limit=-5).prepared(BALL)


def test_a_vertex_marked_as_fixed_without_a_face_stays_free() -> None:
    held = BALL.vertices[:, 2] > 0
    lowest = int(np.argmin(BALL.vertices[:, 2]))
    held[lowest] = True
    with pytest.warns(qr.CutWarning, match=rf"1 of the fixed vertices \(first: {lowest}\)") as caught:
        skin = skin_of(fixed=held).prepared(BALL)
    assert caught[0].filename == __file__
    assert lowest in skin.nodes
    beside = BALL.faces[(BALL.faces == lowest).any(axis=1)][0]
    held[beside] = True
    with pytest.raises(qr.ResponseError, match="fixed vertices"):
        skin_of(fixed=held).prepared(BALL, [lowest])


def test_a_body_beyond_the_memory_is_refused_with_what_would_fit() -> None:
    with pytest.raises(qr.ResponseError, match=r"42 skin.*42 bone.*\d+ "):
        skin_of(bone=CORE, memory_limit=100_000).prepared(BALL)
