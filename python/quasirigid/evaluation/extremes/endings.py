"""Questions without an answer: each must end in an error of its kind whose message names what was wrong."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from ... import models
from ...contact import ContactError, press
from ...errors import QuasirigidError, ResponseError, SurfaceError
from ...obstacle import Obstacle
from ...skin import Body, CombinedSkin, GaussianCorrected, HalfSpace, Layer, Skin, cut_out
from ...surface import Surface, skin_without_caps
from ..memo import remembered
from .case import Case, ends_with
from .flat import CELL, flat_skin
from .scaling import AS_GIVEN

__all__ = ["ending_cases"]

_UP, _DOWN = (0.0, 0.0, 1.0), (0.0, 0.0, -1.0)

# A name, the work, the kind of the error, and words of its message.
_Ending = tuple[str, Callable[[], object], type[QuasirigidError], str]


def ending_cases() -> Iterator[Case]:
    """Make the cases of questions that have no answer."""
    for name, work, kind, words in _endings():
        yield Case(group="ending", name=name, judge=partial(ends_with, work, kind, words), quick=True)
    huge = partial(_triangle, (0.0, 1e120), 1e120)
    judge = partial(ends_with, huge, SurfaceError, "coordinate")
    yield Case(group="ending", name="coordinates of 1e120 m", judge=judge)


def _endings() -> Iterator[_Ending]:
    yield "G = 0", partial(_skin, HalfSpace(), modulus=0.0), ResponseError, "shear_modulus is 0"
    yield (
        "nu = 0.5 + 1e-12",
        partial(_skin, HalfSpace(), nu=0.5 + 1e-12),
        ResponseError,
        "poisson_ratio",
    )
    yield "a layer of 1e-4 cells", _layer_too_thin, ResponseError, "1/1000 of the mesh's mean edge"
    yield "no memory for a matrix", _no_memory, ResponseError, "the 1000 of `memory_limit`"
    yield "no memory for a body", _no_memory_for_a_body, ResponseError, "the limit is 1000"
    yield "the paper's Gaussian, 2 mm deep", _ill_posed, ContactError, "ray"
    yield "a product that passes by", _passes_by, ContactError, "never meets the skin"
    yield "a force of 1e12 N", _out_of_reach, ContactError, "is not reached"
    yield "no vertex may touch", _masked, ContactError, "mask"
    yield "across the cut of a part", _across_a_cut, ResponseError, 'the cut of part "tip"'
    yield "a face without height", partial(_triangle, (2.0, 0.0)), SurfaceError, "face 0 is degenerate"
    yield "a coordinate that is no number", partial(_triangle, (0.0, np.nan)), SurfaceError, "vertex 2"


def _skin(response: Any, *, modulus: float = 60e3, nu: float = 0.5) -> Skin:
    return Skin(shear_modulus=modulus, poisson_ratio=nu, response=response)


@remembered
def _finger() -> Surface:
    finger = models.fingertip(edge_length=2e-3)
    return finger.with_skin_mask(skin_without_caps(finger))


def _plate() -> Obstacle:
    return Obstacle.half_space([0.0, 0.0, -0.05], _UP)


def _layer_too_thin() -> object:
    skin, plate = _skin(Layer(thickness=1e-4 * CELL)), Obstacle.half_space([0.0, 0.0, 0.01], _DOWN)
    return press(Surface(*flat_skin(8)), plate, skin, _DOWN, depth=1e-5, options=AS_GIVEN)


def _no_memory() -> object:
    options = replace(AS_GIVEN, memory_limit=1000)
    return press(_finger(), _plate(), _skin(HalfSpace()), _UP, depth=1e-3, options=options)


def _no_memory_for_a_body() -> object:
    body = Body(fixed=~_finger().skin_mask, memory_limit=1000)
    return _skin(body).prepared(_finger())


def _ill_posed() -> object:
    skin = _skin(GaussianCorrected(height=0.8e-3, width=5e-3, cutoff=15e-3))
    return press(_finger(), _plate(), skin, _UP, depth=2e-3, options=AS_GIVEN)


def _passes_by() -> object:
    far = Obstacle.sphere([1.0, 0.0, -1.0], 1e-3)
    return press(_finger(), far, _skin(HalfSpace()), _UP, depth=1e-3, options=AS_GIVEN)


def _out_of_reach() -> object:
    return press(_finger(), _plate(), _skin(HalfSpace()), _UP, force=1e12, options=AS_GIVEN)


def _masked() -> object:
    none = _finger().with_skin_mask(np.zeros(len(_finger().vertices), dtype=bool))
    return press(none, _plate(), _skin(HalfSpace()), _UP, depth=1e-3, options=AS_GIVEN)


def _across_a_cut() -> object:
    finger = models.finger(edge_length=3e-3)
    tip = int(np.argmax(finger.vertices[:, 1]))
    part = cut_out(finger, tip=tip, point=[0, 0.04, 0], normal=[0, 1, 0])
    prepared = _skin(part.body()).prepared(part.surface, np.flatnonzero(~part.fixed))
    skin: CombinedSkin = _skin(HalfSpace()).combined(finger, {"tip": (part, prepared)})
    return press(finger, _plate(), skin, _UP, depth=3e-3, options=AS_GIVEN)


def _triangle(third: tuple[float, float], length: float = 1.0) -> object:
    return Surface(np.array([[0.0, 0.0, 0.0], [length, 0.0, 0.0], [*third, 0.0]]), np.array([[0, 1, 2]]))
