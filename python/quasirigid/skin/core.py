"""Material and response as the core's skins."""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING, Any, get_args

import numpy as np

from .. import _core
from .._check import (
    as_array,
    as_boolean,
    as_float,
    as_float_or_none,
    as_integer_or_none,
    as_mask,
    as_nodes,
    as_reals,
    short,
)
from ..errors import CutWarning, ResponseError
from ..scene import as_surface
from .progress import Progress, stage_reporter
from .response import Body, GaussianCorrected, GivenMatrix, HalfSpace, Layer, Response

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import ArrayLike, NDArray

    from ..surface import Surface

__all__ = ["ElasticConstants", "build_kernel", "build_prepared", "restore_prepared"]

ElasticConstants = tuple[float, float]  # Shear modulus (Pa) and Poisson's ratio.


def build_kernel(constants: ElasticConstants, response: Response) -> _core.Skin | None:
    """Return the kernel; None where the response depends on the surface."""
    match response:
        case HalfSpace():
            return _core.Skin.half_space(*constants, response.pressure, response.discretization)
        case GaussianCorrected():
            height = as_float_or_none("height", response.height)
            width, cutoff = as_float("width", response.width), as_float("cutoff", response.cutoff)
            if height is None:
                height = _core.Skin.balanced_height(*constants, width, cutoff)
            return _core.Skin.gaussian_corrected(*constants, height, width, cutoff, response.pressure)
        case Layer():
            words = (response.pressure, response.discretization)
            return _core.Skin.layer(*constants, response.thickness, *words)
        case Body() | GivenMatrix():
            _core.Skin.half_space(*constants, "linear", None)  # checks the material
            return None
    kinds = get_args(Response)
    if isinstance(response, type) and response in kinds:
        raise TypeError(f"response is the class {response.__name__}, call it: `{response.__name__}()`")
    names = ", ".join(kind.__name__ for kind in kinds)
    raise TypeError(f"response is {short(response)}, expected one of {names}, as in `qr.HalfSpace()`")


def build_prepared(
    constants: ElasticConstants,
    response: Response,
    surface: Surface,
    *,
    nodes: ArrayLike | None = None,
    progress: Progress | None = None,
    num_threads: int | None = None,
) -> _core.Skin:
    """Return the response computed once at nodes; None: the skin mask, less what a body holds."""
    chosen = None if nodes is None else as_array("nodes", nodes)
    if isinstance(response, GivenMatrix):
        return _build_given(constants, response, surface, chosen)
    if isinstance(response, Body):
        return _build_body(constants, response, surface, chosen, progress, num_threads)
    kernel = build_kernel(constants, response)
    assert kernel is not None
    chosen = np.flatnonzero(surface.skin_mask) if chosen is None else chosen
    return kernel.prepare(surface, chosen, num_threads=num_threads)


def _build_body(
    constants: ElasticConstants,
    body: Body,
    surface: Surface,
    nodes: NDArray[np.int64] | None,
    progress: Progress | None,
    num_threads: int | None,
) -> _core.Skin:
    if body.bone is not None:
        as_surface("bone", body.bone)
    fixed = body.fixed
    if fixed is not None:
        fixed = as_mask("fixed", fixed, len(surface.vertices), ResponseError)
    held = np.zeros(len(surface.vertices), dtype=bool) if fixed is None else _held(fixed, surface)
    if nodes is None:
        nodes = np.flatnonzero(surface.skin_mask & ~held)
    return _core.Skin.body(
        surface,
        *constants,
        body.bone,
        fixed,
        nodes,
        coarse_edge_length=as_float_or_none("coarse_edge_length", body.coarse_edge_length),
        discretization=body.discretization,
        bone_pressure=as_boolean("bone_pressure", body.bone_pressure),
        num_threads=num_threads,
        memory_limit=as_integer_or_none("memory_limit", body.memory_limit, ResponseError),
        progress=stage_reporter(progress),
    )


def _held(fixed: NDArray[np.bool_], surface: Surface) -> NDArray[np.bool_]:
    """Return which vertices a body holds, those of fixed faces, and warn of others that are marked."""
    held = np.zeros_like(fixed)
    held[surface.faces[fixed[surface.faces].all(axis=1)]] = True
    loose = np.flatnonzero(fixed & ~held)
    if held.any() and len(loose) > 0:
        why = (
            f"{len(loose)} of the fixed vertices (first: {loose[0]}) belong to no face that is fixed at all "
            "three corners: they stay free; mark the faces around them whole"
        )
        warnings.warn(why, CutWarning, stacklevel=5)
    return held


def _build_given(
    constants: ElasticConstants, given: GivenMatrix, surface: Surface, asked: NDArray[np.int64] | None
) -> _core.Skin:
    nodes = as_nodes("nodes", given.nodes, len(surface.vertices), ResponseError)
    compliance = as_reals("compliance", given.compliance)
    if asked is not None and not np.array_equal(np.unique(asked), np.unique(nodes)):
        raise ResponseError(f"a GivenMatrix has its own {len(nodes)} nodes: leave out `nodes`")
    if compliance.ndim == 2:
        return _core.Skin.given(surface, nodes, compliance)
    count = len(nodes)
    if compliance.shape != (count, 3, count, 3):
        raise ResponseError(
            f"compliance has shape {compliance.shape}, expected ({count}, {count}) or "
            f"({count}, 3, {count}, 3) for {count} nodes"
        )
    wrong = np.argwhere(~np.isfinite(compliance))
    if len(wrong) > 0:
        value = compliance[tuple(wrong[0])]
        raise ResponseError(f"compliance{wrong[0].tolist()} is {value}, expected a finite number (m/N)")
    blocks = compliance.reshape(3 * count, 3 * count)
    return _core.Skin.given_blocks(surface, *constants, nodes, blocks, np.eye(3))


def restore_prepared(
    constants: ElasticConstants, response: Response, stored: Mapping[str, NDArray[Any]]
) -> _core.Skin:
    """Return the prepared skin whose numbers `_core.skin_parts` returned."""
    surface = _core.Surface(stored["vertices"], stored["faces"])
    nodes = stored["nodes"]
    kernel = build_kernel(constants, response)
    if kernel is not None:
        return kernel.restore(surface, nodes, stored["matrix"])
    if "matrix" in stored:
        return _core.Skin.given(surface, nodes, stored["matrix"])
    if not isinstance(response, Body):
        blocks, rotation = stored["displacement"], stored["rotation"]
        return _core.Skin.given_blocks(surface, *constants, nodes, blocks, rotation)
    bone = response.bone
    _check_bone_pressure(bone, stored.get("bone_pressure"))
    levels = None
    if "coarse_nodes" in stored:
        names = "coarse_nodes", "coarse_corners", "coarse_weights", "coarse_edges", "held"
        levels = tuple(stored[name] for name in names)
    return _core.restore_body(
        surface,
        *constants,
        nodes,
        stored["displacement"],
        stored["rotation"],
        discretization=response.discretization,
        bone_pressure=stored.get("bone_pressure"),
        tissue_thickness=stored.get("tissue_thickness") if bone is None else stored["tissue_thickness"],
        levels=levels,
    )


def _check_bone_pressure(bone: Surface | None, stored: NDArray[np.float64] | None) -> None:
    expected = 0 if bone is None else len(bone.vertices)
    rows = None if stored is None else len(np.atleast_1d(stored))
    if rows not in (None, expected):
        raise ResponseError(f"stored bone pressure has {rows} rows, expected {expected} for the bone")
