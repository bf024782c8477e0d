"""Scenes given in the wrong order or form, and motions in any form."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import quasirigid as qr
from shapes import PLATE, SKIN, TURN, ball

SURFACE = qr.Surface(*ball(8e-3, 2))
SHIFT = np.array([0.1, 0.2, 0.3])
MESH = SimpleNamespace(vertices=SURFACE.vertices, faces=SURFACE.faces)
HAND = qr.models.hand(edge_length=5e-3)
BALL = qr.Obstacle.sphere([9.0, 0, 0], 0.03)
FAR = PLATE.moved(translation=[0, 0, -1])
CLOUD = SimpleNamespace(points=SURFACE.vertices, cells=[])

CALLS = {
    "press": lambda surface, obstacle: qr.press(surface, obstacle, SKIN, [0, 0, 1], depth=1e-3),
    "solve_contact": lambda surface, obstacle: qr.solve_contact(surface, obstacle, SKIN),
    "sweep": lambda surface, obstacle: qr.sweep(surface, obstacle, SKIN, [0, 0, 1], depths=[1e-3]),
}


@pytest.mark.parametrize("call", CALLS.values(), ids=CALLS.keys())
@pytest.mark.parametrize(
    ("surface", "obstacle", "message"),
    [
        (PLATE, SURFACE, "swap them, the skin comes first"),
        (PLATE, PLATE, "surface is an Obstacle, expected a Surface"),
        (SURFACE, SURFACE, r"obstacle is a Surface, expected an Obstacle: qr\.Obstacle\.mesh\("),
        ("finger.ply", PLATE, r"surface is the path 'finger\.ply'.*qr\.read_surface\(path, unit=\.\.\.\)"),
        (SURFACE, Path("can.stl"), r"obstacle is the path 'can\.stl'.*qr\.read_obstacle"),
        (MESH, PLATE, r"surface is a SimpleNamespace.*qr\.Surface\.from_mesh\(mesh, unit=\.\.\.\)"),
        (SURFACE, CLOUD, r"obstacle is a SimpleNamespace.*qr\.Obstacle\.from_mesh"),
        (ball(8e-3, 1), PLATE, r"surface is a tuple.*qr\.Surface\(vertices, faces\)"),
        (SURFACE, None, r"obstacle is a NoneType.*qr\.Obstacle\.mesh\(vertices, faces\)"),
    ],
)
def test_what_is_no_scene_says_how_to_make_one(
    call: object, surface: object, obstacle: object, message: str
) -> None:
    with pytest.raises(TypeError, match=message):
        call(surface, obstacle)  # type: ignore[operator]


def test_other_takers_of_a_surface_say_so_too() -> None:
    takers = (
        lambda surface: SKIN.prepared(surface),
        lambda surface: qr.cut_out(surface, keep=[True]),
        lambda surface: qr.models.bone_of(surface),
        lambda surface: qr.response_matrix(surface, SKIN, [0]),
        lambda surface: qr.initial_gaps(surface, SKIN, [0], PLATE),
        lambda surface: qr.net_volume(surface, SKIN, 0),
        lambda surface: qr.skin_without_caps(surface),
        lambda surface: SKIN.combined(surface, {}),
    )
    posed = SimpleNamespace(surface=SURFACE, labels=[])
    for take in takers:
        with pytest.raises(TypeError, match="is an Obstacle, expected a Surface: a product goes"):
            take(PLATE)
        with pytest.raises(TypeError, match=r"is the path 'a\.ply', expected a Surface: `qr\.read_surface"):
            take("a.ply")
        with pytest.raises(TypeError, match=r"is a SimpleNamespace, .*: pass its `\.surface`"):
            take(posed)


@pytest.mark.parametrize("distance", ["a.ply", SURFACE, MESH])
def test_gaps_to_what_is_no_obstacle_say_how_to_make_one(distance: Any) -> None:
    with pytest.raises(TypeError, match=r"distance is .*, expected an Obstacle"):
        qr.initial_gaps(SURFACE, SKIN, [0], distance)


@pytest.mark.parametrize("thing", [SURFACE, PLATE, SKIN.prepared(SURFACE), SKIN.combined(SURFACE, {})])
def test_a_motion_is_a_rotation_a_shift_both_or_a_matrix(thing: object) -> None:
    def pressed(moved: object, rotation: object, translation: object) -> np.ndarray:
        surface, plate, skin = SURFACE, PLATE, SKIN
        turn = np.eye(3) if rotation is None else np.asarray(rotation)
        if isinstance(thing, qr.Surface):
            surface = moved
            plate = PLATE.moved(rotation, translation)
        elif isinstance(thing, qr.Obstacle):
            surface = SURFACE.moved(rotation, translation)
            plate = moved
        else:
            surface, plate = (one.moved(rotation, translation) for one in (SURFACE, PLATE))
            skin = moved
        return turn.T @ qr.press(surface, plate, skin, turn @ [0, 0, 1], depth=1e-3).force

    still = qr.press(SURFACE, PLATE, SKIN, [0, 0, 1], depth=1e-3).force
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = TURN, SHIFT
    move = thing.moved  # type: ignore[attr-defined]
    for moved, rotation, translation in (
        (move(TURN), TURN, None),
        (move(translation=SHIFT), None, SHIFT),
        (move(TURN, SHIFT), TURN, SHIFT),
        (move(matrix), TURN, SHIFT),
        (move(), None, None),
    ):
        np.testing.assert_allclose(pressed(moved, rotation, translation), still, rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize(
    ("arguments", "error", "message"),
    [
        ((np.eye(4), [0, 0, 1]), TypeError, "leave out `translation`"),
        ((2 * np.eye(4),), ValueError, r"last row \[0\.0, 0\.0, 0\.0, 2\.0\], expected \[0, 0, 0, 1\]"),
        ((np.eye(2),), ValueError, r"\(3, 3\), or \(4, 4\) with the translation"),
        (("turn",), TypeError, "`rotation`"),
    ],
)
def test_a_motion_that_is_none_is_refused(
    arguments: tuple[object, ...], error: type[Exception], message: str
) -> None:
    for thing in (SURFACE, PLATE, SKIN.prepared(SURFACE)):
        with pytest.raises(error, match=message):
            thing.moved(*arguments)  # type: ignore[arg-type]


HERTZ = qr.reference.Hertz(radius=1e-2, contact_modulus=1e4)


def _answering(response: Any) -> qr.Skin:
    return qr.Skin(shear_modulus=6e4, poisson_ratio=0.3, response=response)


def _pressed(**given: Any) -> qr.Contact:
    return qr.press(SURFACE, PLATE, SKIN, [0, 0, -1], **given)


NUMBERS = {
    "shear_modulus": lambda value: qr.Skin(shear_modulus=value, poisson_ratio=0.4, response=qr.HalfSpace()),
    "poisson_ratio": lambda value: qr.Skin(shear_modulus=1e4, poisson_ratio=value, response=qr.HalfSpace()),
    "radius": lambda value: qr.Obstacle.sphere([0, 0, 0], value),
    "half_height": lambda value: qr.Obstacle.cylinder(value, 0.02),
    "depth": lambda value: _pressed(depth=value),
    "force": lambda value: _pressed(force=value),
    "overlap": lambda value: _pressed(overlap=value),
    "target_error": lambda value: _pressed(depth=1e-4, options=qr.ContactOptions(target_error=value)),
    "pivot_tol": lambda value: qr.solve_lcp([[1]], [-1], options=qr.LcpOptions(pivot_tol=value)),
    "coarse_edge_length": lambda value: qr.Skin(
        shear_modulus=1e4, poisson_ratio=0.4, response=qr.Body(coarse_edge_length=value)
    ).prepared(SURFACE),
    "height": lambda value: _answering(qr.GaussianCorrected(height=value, width=8e-3, cutoff=15e-3)),
    "width": lambda value: _answering(qr.GaussianCorrected(height=None, width=value, cutoff=15e-3)),
    "cutoff": lambda value: _answering(qr.GaussianCorrected(height=1e-4, width=8e-3, cutoff=value)),
    "contact_modulus": lambda value: qr.reference.Hertz(radius=1e-2, contact_modulus=value),
    "semi_angle": lambda value: qr.reference.Cone(semi_angle=value, contact_modulus=1e4),
    "approach": HERTZ.energy,
    "distance": lambda value: HERTZ.pressure(1e-3, value),
    "weld_tolerance": lambda value: qr.repair(SURFACE.vertices, SURFACE.faces, weld_tolerance=value),
}


@pytest.mark.parametrize(
    "value",
    ["1mm", [1.0, 2.0], 1j, 10**400, True, np.False_],
    ids=["word", "list", "complex", "huge", "boolean", "boolean of NumPy"],
)
@pytest.mark.parametrize("name", NUMBERS)
def test_what_is_no_number_is_named(name: str, value: Any) -> None:
    with pytest.raises(TypeError, match=rf"(?m)^{name} is .*, expected a number$"):
        NUMBERS[name](value)


@pytest.mark.parametrize("number", [1, np.int64(1), np.float32(1.0), np.array(1.0)])
def test_a_number_of_any_kind_is_one(number: Any) -> None:
    distance, _, _ = qr.Obstacle.sphere([0, 0, 0], number).signed_distance([[3.0, 0.0, 0.0]])
    assert distance[0] == 2.0


@pytest.mark.parametrize("name", ["start", "balance"])
@pytest.mark.parametrize("value", [None, 3, "nowhere"])
def test_a_choice_of_a_press_that_is_none_is_named(name: str, value: Any) -> None:
    with pytest.raises(qr.ContactError, match=rf"^{name} is {value!r}, expected one of "):
        _pressed(depth=1e-4, **{name: value})
    if name == "start":
        with pytest.raises(qr.ContactError, match=rf"^start is {value!r}, expected one of "):
            qr.sweep(SURFACE, PLATE, SKIN, [0, 0, -1], depths=[1e-4], start=value)


@pytest.mark.parametrize("depths", [[True], [1e-4, True], np.array([True])])
def test_a_depth_of_a_sweep_is_no_boolean(depths: Any) -> None:
    with pytest.raises(qr.ContactError, match=r"^depths is .*, expected a row of numbers >= 0"):
        qr.sweep(SURFACE, PLATE, SKIN, [0, 0, -1], depths=depths)


@pytest.mark.parametrize(
    ("response", "message"),
    [
        (
            "half-space",
            "response is 'half-space', expected one of HalfSpace, GaussianCorrected, Layer",
        ),
        (qr.HalfSpace, r"response is the class HalfSpace, call it: `HalfSpace\(\)`"),
        (np.eye(3), "response is .*, as in `qr.HalfSpace"),
    ],
)
def test_what_is_no_response_says_how_to_make_one(response: Any, message: str) -> None:
    with pytest.raises(TypeError, match=message):
        qr.Skin(shear_modulus=60e3, poisson_ratio=0.5, response=response)


@pytest.mark.parametrize("value", [1e200, 1e61, 1e-61, 0.0, -1.0, np.inf])
@pytest.mark.parametrize(
    "response", [qr.HalfSpace(), qr.Body(fixed=SURFACE.vertices[:, 2] > 8e-3)], ids=["kernel", "body"]
)
def test_a_shear_modulus_out_of_range_is_named(value: float, response: qr.HalfSpace | qr.Body) -> None:
    with pytest.raises(
        qr.ResponseError, match=r"^shear_modulus is .*finite and positive, from 1e-60 to 1e60"
    ):
        qr.Skin(shear_modulus=value, poisson_ratio=0.4, response=response).prepared(SURFACE)


BOOLEANS = {
    "condition": lambda value: _pressed(depth=1e-4, options=qr.ContactOptions(condition=value)),
    "couple_fingers": lambda value: _pressed(depth=1e-4, options=qr.ContactOptions(couple_fingers=value)),
    "crash": lambda value: qr.solve_lcp([[1]], [-1], options=qr.LcpOptions(crash=value)),
    "known_p_matrix": lambda value: qr.solve_lcp([[1]], [-1], options=qr.LcpOptions(known_p_matrix=value)),
    "bone_pressure": lambda value: qr.Skin(
        shear_modulus=1e4,
        poisson_ratio=0.4,
        response=qr.Body(fixed=SURFACE.vertices[:, 2] > 8e-3, bone_pressure=value),
    ).prepared(SURFACE),
    "check_crossings": lambda value: qr.Obstacle.mesh(SURFACE.vertices, SURFACE.faces, check_crossings=value),
    "linear": lambda value: HAND.posed("flat", linear=value),
    "throw": lambda value: _pressed(depth=1e-4, throw=value),
    "throw of a contact in place": lambda value: qr.solve_contact(SURFACE, PLATE, SKIN, throw=value),
    "throw of a problem": lambda value: qr.solve_lcp([[1]], [-1], throw=value),
    "throw of a grasp": lambda value: qr.close_hand(HAND, BALL, SKIN, force=2.0, throw=value),
    "pictures": lambda value: qr.solve_contact(SURFACE, FAR, SKIN).save("unwritten", pictures=value),
}


@pytest.mark.parametrize("value", ["no", None, 1, [True]], ids=["word", "none", "one", "list"])
@pytest.mark.parametrize("name", BOOLEANS)
def test_what_is_no_boolean_is_named(name: str, value: Any) -> None:
    with pytest.raises(TypeError, match=rf"(?m)^{name.split()[0]} is .*, expected True or False$"):
        BOOLEANS[name](value)


def test_a_boolean_of_numpy_is_one() -> None:
    words: dict[str, Any] = {"crash": np.False_, "known_p_matrix": np.True_}
    options = qr.LcpOptions(**words)
    assert qr.solve_lcp([[1]], [-1], options=options).certificate.definiteness is qr.LcpDefiniteness.P_MATRIX


def test_a_mask_in_place_of_vertices_says_how_to_find_them() -> None:
    mask = SURFACE.vertices[:, 2] < 0
    for call in (SKIN.prepared, lambda surface, nodes: qr.response_matrix(surface, SKIN, nodes)):
        with pytest.raises(TypeError, match=r"dtype bool, expected integers: of a mask take np\.flatnonzero"):
            call(SURFACE, mask)
    with pytest.raises(TypeError, match=r"dtype int64, expected booleans; .* np\.isin"):
        SURFACE.with_skin_mask(np.flatnonzero(mask))


def _hiding(values: Any) -> Any:
    """Values of which the last is hidden."""
    hidden = np.zeros(np.shape(values), dtype=bool)
    hidden.flat[-1] = True
    return np.ma.MaskedArray(values, hidden)


ROW = np.full(len(SURFACE.vertices), 5e-3)
ARRAYS = {
    "vertices": lambda: qr.Surface(_hiding(SURFACE.vertices), SURFACE.faces),
    "faces": lambda: qr.Surface(SURFACE.vertices, _hiding(SURFACE.faces)),
    "faces of a mesh object": lambda: qr.Surface.from_mesh(
        SimpleNamespace(vertices=SURFACE.vertices, faces=_hiding(SURFACE.faces))
    ),
    "skin_mask": lambda: SURFACE.with_skin_mask(_hiding(ROW > 0)),
    "direction": lambda: qr.press(SURFACE, PLATE, SKIN, _hiding([0.0, 0, 1]), depth=1e-3),
    "direction of a sweep": lambda: qr.sweep(SURFACE, PLATE, SKIN, _hiding([0.0, 0, 1]), depths=[1e-3]),
    "depths": lambda: qr.sweep(SURFACE, PLATE, SKIN, [0, 0, 1], depths=_hiding([1e-3, 2e-3])),
    "thickness": lambda: qr.Layer(thickness=_hiding(ROW)),
    "M": lambda: qr.solve_lcp(_hiding([[2.0, 1], [1, 2]]), [-1, -1]),
    "q": lambda: qr.solve_lcp([[2.0, 1], [1, 2]], _hiding([-1.0, -1])),
    "nodes": lambda: SKIN.prepared(SURFACE, _hiding([1, 2])),
    "forces": lambda: SKIN.prepared(SURFACE).bone_pressure(_hiding(SURFACE.vertices)),
    "mask": lambda: qr.solve_contact(SURFACE, FAR, SKIN).part(_hiding(ROW > 0)),
    "translation": lambda: HAND.posed("flat", translation=_hiding([0.0, 0, 1])),
    "rotation": lambda: HAND.posed("flat", rotation=_hiding(np.eye(3))),
}


@pytest.mark.parametrize("name", ARRAYS)
def test_an_array_that_hides_an_entry_is_refused_by_name(name: str) -> None:
    with pytest.raises((TypeError, qr.QuasirigidError), match=rf"^`?{name.split()[0]}`? is "):
        ARRAYS[name]()


def test_a_masked_array_that_hides_none_is_an_array() -> None:
    matrix = np.ma.MaskedArray([[2.0, 1], [1, 2]], mask=False)
    assert qr.solve_lcp(matrix, [-3, -3]).z.tolist() == [1.0, 1.0]


ROWS = {
    "direction": lambda row: qr.sweep(SURFACE, PLATE, SKIN, row, depths=[1e-4]),
    "depths": lambda row: qr.sweep(SURFACE, PLATE, SKIN, [0, 0, 1], depths=row),
    "translation": lambda row: HAND.posed("flat", translation=row),
    "rotation": lambda row: HAND.posed("flat", rotation=[row] * 3),
    "pose": lambda row: HAND.posed([row] * len(HAND.joint_names)),
    "gravity": lambda row: qr.close_hand(HAND, BALL, SKIN, force=2.0, gravity=row),
    "center_of_mass": lambda row: qr.close_hand(HAND, BALL, SKIN, force=2.0, center_of_mass=row),
}


@pytest.mark.parametrize("row", [["0", "0", "1"], [False, False, True], [0, 0, True], [0, 0, 1 + 0j]])
@pytest.mark.parametrize("name", ROWS)
def test_words_booleans_and_complex_numbers_are_no_vector(name: str, row: Any) -> None:
    with pytest.raises(qr.QuasirigidError, match=rf"^{name} is .*, expected "):
        ROWS[name](row)


PLACES = {
    "node": lambda value: qr.net_volume(SURFACE, SKIN, value),
    "step": lambda value: qr.sweep(SURFACE, FAR, SKIN, [0, 0, 1], depths=[1e-4], start="current")[value],
    "num_threads": lambda value: HAND.posed("flat").skin(**ON_HALF_SPACE, num_threads=value),
}
ON_HALF_SPACE: dict[str, Any] = {"shear_modulus": 6e4, "poisson_ratio": 0.3, "response": qr.HalfSpace()}


@pytest.mark.parametrize("value", [True, np.True_, "x", 1.0])
@pytest.mark.parametrize("name", PLACES)
def test_what_is_no_integer_is_named(name: str, value: Any) -> None:
    with pytest.raises(TypeError, match=rf"^{name} is .*, expected (an integer|the number of a vertex)$"):
        PLACES[name](value)


@pytest.mark.parametrize("thickness", [True, np.True_, "1mm", None])
def test_a_thickness_is_a_number_or_a_row_of_them(thickness: Any) -> None:
    with pytest.raises(TypeError, match=r"^`?thickness`? "):
        _answering(qr.Layer(thickness=thickness))


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: PLATE.placed([0, 0, 1, 0]), r"^`frame` has shape \(4,\), expected \(4, 4\)$"),
        (lambda: _answering(_given("")).prepared(SURFACE), "^`compliance` has dtype <U"),
        (lambda: PLATE.with_material(**_material(_given([[1j]]))), "^`compliance` has dtype complex"),
        (lambda: _given([[1, 2], [3]]), "^`compliance` cannot be read as an array"),
        (lambda: HAND.posed("flat").skin(**ON_HALF_SPACE, nodes=np.nan), "^`nodes` has dtype float64"),
        (lambda: HAND.posed("flat").skin(**ON_HALF_SPACE, folder=3), "^folder is 3, expected a path$"),
        (lambda: _hand_of(joint_names=None), "^joint_names is None, expected a sequence of names$"),
    ],
)
def test_what_is_of_another_kind_is_named(call: Any, message: str) -> None:
    with pytest.raises((TypeError, ValueError), match=message):
        call()


def _given(compliance: Any) -> qr.GivenMatrix:
    return qr.GivenMatrix(nodes=[0], compliance=compliance)


def _material(response: Any) -> dict[str, Any]:
    return {"shear_modulus": 6e4, "poisson_ratio": 0.3, "response": response}


def _hand_of(**changed: Any) -> qr.Hand:
    names = ("joint_names", "parents", "rest", "joints", "weights")
    known = {name: getattr(HAND, name) for name in names}
    return qr.Hand(HAND.surface.vertices, HAND.surface.faces, **(known | changed))


def test_a_number_beyond_64_bits_is_shown_as_given() -> None:
    large = np.array([2**63 + 1], dtype=np.uint64)
    with pytest.raises(qr.ResponseError, match=r"^`nodes\[0\]` is 9223372036854775809, but there are"):
        SKIN.prepared(SURFACE, large)
    with pytest.raises(qr.SurfaceError, match="refers to vertex 9223372036854775809, which cannot exist"):
        qr.Surface(SURFACE.vertices, np.full((1, 3), large))


@pytest.mark.parametrize(
    "read",
    [
        qr.load_prepared,
        qr.hand.read_pose,
        lambda path: qr.read_mesh(path, unit="m"),
        qr.read_hand,
    ],
    ids=["load_prepared", "read_pose", "read_mesh", "read_hand"],
)
def test_the_number_of_an_open_file_is_no_path(read: Any) -> None:
    with open(__file__, "rb") as file:
        with pytest.raises(TypeError, match=r"^path is \d+, expected a path$"):
            read(file.fileno())
        assert file.read(1)


@pytest.mark.parametrize(
    ("name", "save"),
    [
        (
            "folder",
            qr.press(SURFACE, BALL.moved(translation=[-9.0, 0, -0.1]), SKIN, [0, 0, 1], depth=0.0).save,
        ),
        ("folder", qr.sweep(SURFACE, PLATE, SKIN, [0, 0, 1], depths=[0.0]).save),
        ("path", SKIN.prepared(SURFACE, [0]).save),
        ("path", HAND.save),
        ("path", lambda path: qr.io.write_mesh(MESH.vertices, MESH.faces, path, unit="m")),
    ],
    ids=["contact", "sweep", "prepared", "hand", "mesh"],
)
def test_a_number_is_no_place_to_write_to(name: str, save: Any) -> None:
    with pytest.raises(TypeError, match=f"^{name} is 3, expected a path$"):
        save(3)
