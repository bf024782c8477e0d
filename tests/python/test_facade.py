"""What a user meets: names, short texts, keywords, words for choices, frozen results."""

from __future__ import annotations

import importlib
import inspect
import subprocess
import sys
from collections.abc import Iterator
from enum import Enum
from typing import Any

import numpy as np
import pytest
import quasirigid as qr
from shapes import AS_GIVEN, PLATE, SKIN, ball

# Scenes are coarse on purpose, and taken as they are.
pytestmark = pytest.mark.filterwarnings("ignore::quasirigid.CoarseMeshWarning")

SURFACE = qr.Surface(*ball(8e-3, 2))


@pytest.fixture(scope="module")
def contact() -> qr.Contact:
    return qr.press(SURFACE, PLATE, SKIN, [0, 0, 1], depth=0.5e-3)


def test_dir_lists_what_a_user_may_use_and_it_is_there() -> None:
    names = dir(qr)
    assert sorted(qr.__all__) == sorted(names)
    for name in names:
        assert getattr(qr, name) is not None
    for hidden in ("annotations", "skin", "lcp", "matrix", "errors", "surface", "TYPE_CHECKING"):
        assert hidden not in names


def test_types_of_public_signatures_can_be_imported() -> None:
    for module, names in {
        "contact": ("SweepProgress", "Warned"),
        "evaluation": ("TableProgress",),
        "hand": ("Bone", "PalmFrame", "Pose", "Preset", "Side"),
        "skin": ("Progress",),
    }.items():
        known = vars(importlib.import_module(f"quasirigid.{module}"))
        assert not set(names) - known.keys()


def test_pictures_are_imported_when_somebody_asks() -> None:
    code = (
        "import sys, quasirigid as qr\n"
        "assert not {'quasirigid.plot', 'matplotlib', 'quasirigid.cli'} & set(sys.modules)\n"
        "qr.plot, qr.io, qr.reference\n"
        "assert 'quasirigid.plot' in sys.modules\n"
    )
    subprocess.run([sys.executable, "-c", code], check=True)
    with pytest.raises(AttributeError, match="has no attribute 'pictures'"):
        _ = qr.pictures


def test_the_public_members_are_those_that_a_user_may_use(contact: qr.Contact) -> None:
    prepared = SKIN.prepared(SURFACE, [0])
    public = {
        SKIN: {"shear_modulus", "poisson_ratio", "response", "prepared", "combined"},
        prepared: {"skin", "nodes", "bone_pressure", "moved", "save"},
        SKIN.combined(SURFACE, {}): {"background", "parts", "without", "bone_pressure", "moved"},
    }
    for thing, names in public.items():
        assert {name for name in dir(thing) if not name.startswith("_")} == names


@pytest.mark.parametrize(
    "call",
    [
        lambda: qr.HalfSpace("linear"),
        lambda: qr.Layer(1e-3),
        lambda: qr.GaussianCorrected(1e-4, 8e-3, 15e-3),
        lambda: qr.GaussianCorrected.balanced(8e-3, 15e-3),
        lambda: qr.Body(SURFACE),
        lambda: qr.GivenMatrix([0], [[1.0]]),
        lambda: qr.Skin(60e3, 0.5, qr.HalfSpace()),
        lambda: qr.response_matrix(SURFACE, SKIN, [0], [[0, 0, 1]]),
        lambda: qr.press(SURFACE, PLATE, SKIN, [0, 0, 1], 1e-3),
        lambda: qr.solve_lcp([[1.0]], [1.0], "lemke"),
        lambda: SKIN.prepared(SURFACE, [0], True),
        lambda: qr.cut_out(SURFACE, 0, [0, 0, 0], [0, 0, 1]),
    ],
)
def test_what_follows_the_leading_objects_is_given_by_keyword(call: object) -> None:
    with pytest.raises(TypeError, match="positional argument"):
        call()  # type: ignore[operator]


@pytest.mark.parametrize(
    ("call", "error", "message"),
    [
        (lambda: qr.HalfSpace(discretization="node"), qr.ResponseError, "discretization is 'node'"),
        (lambda: qr.Layer(thickness=1.0, discretization=1), qr.ResponseError, "discretization is 1"),
        (lambda: qr.HalfSpace(pressure=None), qr.ResponseError, "pressure is None"),
        (
            lambda: qr.GaussianCorrected.balanced(width=1.0, cutoff=1.0, pressure="hat"),
            qr.ResponseError,
            "pressure is 'hat'",
        ),
        (
            lambda: qr.press(SURFACE, PLATE, SKIN, [0, 0, 1], depth=0, start="here"),
            qr.ContactError,
            "start is .here.",
        ),
        (lambda: qr.solve_lcp([[1.0]], [1.0], method="pgs"), qr.LcpError, "method is .pgs."),
    ],
)
def test_a_wrong_word_is_an_error_that_lists_the_right_ones(
    call: object, error: type[Exception], message: str
) -> None:
    with pytest.raises(error, match=f'{message}, expected one of "[a-z_]+", "[a-z_]+"'):
        call()  # type: ignore[operator]


def test_words_and_members_are_the_same_choice() -> None:
    for word in qr.Discretization:
        by_word, by_member = (qr.HalfSpace(discretization=one) for one in (str(word), word))  # type: ignore[arg-type]
        assert by_word == by_member
        assert by_word.discretization is word
    assert qr.HalfSpace().discretization is None
    assert qr.Layer(thickness=1.0) != qr.Layer(thickness=2.0)
    assert qr.Body(bone=SURFACE) != qr.Body()
    force = [
        qr.press(SURFACE, PLATE, SKIN, [0, 0, 1], depth=0.5e-3, start=start).force
        for start in ("infinity", qr.Start.INFINITY)
    ]
    np.testing.assert_array_equal(*force)
    none, collocation = (
        qr.response_matrix(
            SURFACE,
            qr.Skin(shear_modulus=6e4, poisson_ratio=0.5, response=qr.HalfSpace(discretization=one)),
            np.arange(20),
        )
        for one in (None, qr.Discretization.COLLOCATION)
    )
    np.testing.assert_array_equal(none, collocation)


def test_texts_are_short_and_have_no_arrays(contact: qr.Contact) -> None:
    count = len(SURFACE.vertices)
    held = SURFACE.vertices[:, 2] > 8e-3
    layer = qr.Layer(thickness=np.linspace(4e-3, 6e-3, count))
    per_vertex = qr.Skin(shear_modulus=60e3, poisson_ratio=0.45, response=layer)
    cut = qr.cut_out(
        SURFACE, tip=int(np.argmin(SURFACE.vertices[:, 2])), point=[0, 0, 8e-3], normal=[0, 0, -1]
    )
    body = qr.Skin(shear_modulus=60e3, poisson_ratio=0.5, response=cut.body())
    part = body.prepared(cut.surface, [int(np.argmin(cut.surface.vertices[:, 2]))])
    expected = {
        contact: "Contact(solved: force ",
        contact.patches[0]: f"Patch({len(contact.active)} vertices, force ",
        contact.lcp_solutions[0]: "LcpSolution(solved by lemke: ",
        SKIN: "Skin(shear_modulus=60000.0, poisson_ratio=0.5, response=HalfSpace())",
        per_vertex: f"Skin(shear_modulus=60000.0, poisson_ratio=0.45, response=Layer(thickness=<{count} from",
        SKIN.prepared(SURFACE, [0, 1]): "PreparedSkin(2 nodes, Skin(",
        SKIN.combined(SURFACE, {"tip": (cut, part)}): "CombinedSkin(tip, background Skin(",
        cut: f"CutOut({len(cut.fixed)} vertices, {cut.fixed.sum()} of them fixed, of a skin of {count})",
        qr.Body(bone=SURFACE, fixed=held): f"Body(bone=Surface({count} vertices",
        qr.Body(fixed=held.tolist()): f"Body(fixed=<{held.sum()} of {count}>)",
        qr.GivenMatrix(
            nodes=[3, 5], compliance=np.eye(2)
        ): "GivenMatrix(nodes=<2 from 3 to 5>, compliance=<2",
        qr.HalfSpace(discretization="galerkin"): "HalfSpace(discretization='galerkin')",
        SURFACE: f"Surface({count} vertices, ",
        PLATE: "Obstacle(half_space at ",
    }
    for thing, text in expected.items():
        found = repr(thing)
        assert found.startswith(text)
        assert "\n" not in found
        assert len(found) < 200
        assert "array(" not in found


def test_results_are_frozen_to_the_bottom(contact: qr.Contact) -> None:
    assert isinstance(contact.left_out, tuple)
    what, why = contact.left_out[0]
    assert (what, why) == (contact.left_out[0].what, contact.left_out[0].why)
    assert contact.warnings == ()
    with pytest.raises(TypeError, match="dict is read-only"):
        contact.timings["lcp"] = 0.0  # type: ignore[index]
    solution = contact.lcp_solutions[0]
    assert solution.method is qr.LcpMethod.LEMKE
    # The certificate and the contact read one answer.
    small = qr.press(SURFACE, PLATE, SKIN, [0, 0, 1], depth=0.5e-3, options=AS_GIVEN)
    assert small.surface is SURFACE
    assert small.lcp_solutions[0].certificate.definiteness is qr.LcpDefiniteness.POSITIVE_DEFINITE
    assert small.accuracy.definite is True
    rounds = contact.refinements
    assert rounds[0].kind is qr.RefinementKind.MESH
    assert contact.accuracy.discretization is qr.Discretization.COLLOCATION
    for array in (
        contact.gap,
        contact.active,
        contact.parents,
        contact.patches[0].force,
        rounds[0].force,
        solution.z,
    ):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 0
    assert not hasattr(contact.patches[0], "area")


def test_what_is_warned_of_is_kept() -> None:
    huge = qr.Obstacle.mesh(
        *(part * 1e3 - [0, 0, 17] if i == 0 else part for i, part in enumerate(ball(8e-3, 2)))
    )
    with pytest.warns(qr.QuasirigidWarning, match="unit") as caught:
        contact = qr.solve_contact(SURFACE, huge, SKIN)
    assert contact.warnings == tuple((one.category, str(one.message)) for one in caught)
    assert contact.warnings[0].category is qr.SizeWarning


def documented() -> Iterator[tuple[str, Any]]:
    """Functions of the package, and methods of its classes in Python."""
    for name in qr.__all__:
        thing = getattr(qr, name)
        if inspect.isfunction(thing):
            yield name, thing
        elif inspect.isclass(thing) and not issubclass(thing, (Enum, Exception)):
            for method, found in inspect.getmembers(thing, inspect.isfunction):
                if not method.startswith("_"):
                    yield f"{name}.{method}", found


def test_help_lists_every_parameter() -> None:
    unlisted = {}
    for name, thing in documented():
        heads = [line.partition(" : ")[0] for line in inspect.getdoc(thing).splitlines() if " : " in line]
        listed = {one.strip(" *") for head in heads for one in head.split(",")}
        if missing := inspect.signature(thing).parameters.keys() - listed - {"self"}:
            unlisted[name] = missing
    assert not unlisted


def test_help_lists_every_field_of_a_named_tuple_and_no_file_that_is_not_installed() -> None:
    modules = (qr, qr.hand, qr.io, qr.models, qr.plot, qr.reference)
    things = [getattr(module, name) for module in modules for name in module.__all__]
    for thing in (one for one in things if callable(one)):
        text = inspect.getdoc(thing) or ""
        assert "docs/" not in text, thing
        for field in getattr(thing, "_fields", ()):
            assert f"{field} : " in text, (thing, field)


def test_help_says_what_returns() -> None:
    for name in dir(qr):
        thing = getattr(qr, name)
        if inspect.isfunction(thing):
            assert thing.__doc__
            assert not thing.__doc__.startswith(("Give", "Tell", "Say"))
