"""From the words of a command line to the objects of the package."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, TypeAlias, cast

import numpy as np
from numpy.typing import NDArray

from .._units import UNITS, LengthUnit
from ..errors import SurfaceError
from ..io import read_surface
from ..models import bone_of
from ..skin.response import Body, Discretization, GaussianCorrected, HalfSpace, Layer, PressureBasis
from ..surface import Surface, skin_without_caps
from .quantities import COMPLIANCE, LENGTH, QuantityError, parse_not_negative, parse_numbers, parse_positive

__all__ = [
    "choice",
    "file_unit",
    "mask_file",
    "on_skin",
    "parse_poisson_ratio",
    "parse_response",
    "parse_target_error",
    "rotation",
    "with_skin_mask",
]

_Named: TypeAlias = HalfSpace | Layer | GaussianCorrected | Body

# Each response with the constants that it needs, their units, and what it may be given.
_RESPONSES: dict[str, tuple[type[_Named], dict[str, dict[str, float]], tuple[str, ...]]] = {
    "half-space": (HalfSpace, {}, ("pressure", "discretization")),
    "body": (Body, {}, ("discretization", "coarse_edge_length")),
    "layer": (Layer, {"thickness": LENGTH}, ("pressure", "discretization")),
    "gaussian": (
        GaussianCorrected,
        {"height": COMPLIANCE, "width": LENGTH, "cutoff": LENGTH},
        ("pressure",),
    ),
}
_CHOICES = {"pressure": tuple(PressureBasis), "discretization": tuple(Discretization)}
_LENGTHS = {"coarse_edge_length": LENGTH}
# A Gaussian of no height is the half-space, a body of no coarse edges is solved on the skin's own mesh.
_MAY_BE_ZERO = ("height", "coarse_edge_length")
_EXAMPLES = {"layer": "layer:thickness=5mm", "gaussian": "gaussian:height=0.8mm/N,width=5mm,cutoff=15mm"}


def choice(text: str, choices: Sequence[str], option: str) -> str:
    """Return `text`, where it is one of `choices`."""
    if text not in choices:
        known = " or ".join(filter(None, (", ".join(choices[:-1]), choices[-1])))
        raise QuantityError(f"{option}: '{text}' is not known, expected {known}")
    return text


def file_unit(text: str, option: str) -> LengthUnit:
    """Return the unit of a mesh file."""
    return cast(LengthUnit, choice(text, tuple(UNITS), option))


def parse_response(text: str) -> _Named:
    """Return the response of a name and constants, as in `gaussian:height=0.8mm/N,width=5mm,cutoff=15mm`.

    A body has neither bone nor fixed vertices yet, as these need the skin.
    """
    name, _, rest = text.partition(":")
    values: dict[str, str] = {}
    for part in filter(None, (part.strip() for part in rest.split(","))):
        key, equals, value = part.partition("=")
        if not equals:
            raise QuantityError(f"--response: '{part}' is not of the form name=value")
        if key in values:
            raise QuantityError(f"--response: '{key}' is given twice, {values[key]} and {value}")
        values[key] = value
    choice(name, tuple(_RESPONSES), "--response")
    response, units, choices = _RESPONSES[name]
    if wrong := sorted(values.keys() - units.keys() - set(choices)):
        known = ", ".join([*units, *choices])
        raise QuantityError(f"--response: {name} has no constant '{wrong[0]}', expected {known}")
    if missing := [key for key in units if key not in values]:
        raise QuantityError(f"--response: {name} needs {', '.join(missing)}, as in {_EXAMPLES[name]}")
    arguments: dict[str, Any] = {}
    for key, value in values.items():
        if unit := (units | _LENGTHS).get(key):
            parse = parse_not_negative if key in _MAY_BE_ZERO else parse_positive
            arguments[key] = parse(value, unit, f"--response {key}")
        else:
            arguments[key] = choice(value, _CHOICES[key], f"--response {key}")
    return response(**arguments)


def parse_poisson_ratio(text: str, option: str = "--poisson-ratio") -> float:
    """Return a Poisson's ratio."""
    ratio = parse_numbers(text, 1, option)[0]
    if not 0.0 <= ratio <= 0.5:
        raise QuantityError(f"{option}: {text} is not from 0 to 0.5")
    return ratio


def parse_target_error(text: str) -> float | None:
    """Return the target of `--target-error`; None for the mesh as it is."""
    if text == "none":
        return None
    target = parse_numbers(text, 1, "--target-error")[0]
    if not 0.0 < target < 1.0:
        raise QuantityError(f"--target-error: {text} is not between 0 and 1, expected as 0.02, or none")
    return target


def with_skin_mask(surface: Surface, text: str) -> Surface:
    """Return the surface with the mask that `caps`, `none` or the name of a NumPy file stands for."""
    if text == "none":
        return surface
    mask = skin_without_caps(surface) if text == "caps" else _read_mask(surface, text, "--skin-mask")
    return surface.with_skin_mask(mask)


def on_skin(body: Body, surface: Surface, bone: str, fixed: str, unit: LengthUnit) -> Body:
    """Return the body under a skin with `--bone`, whose file is in `unit`, and `--fixed`."""
    bones = None
    if bone == "auto":
        bones = _drawn_bone(surface)
    elif bone != "none":
        bones = read_surface(bone, unit=unit)
    held: NDArray[np.bool_] | None = None
    if fixed == "caps":
        held = ~skin_without_caps(surface)
        if not held.any():
            # A skin without a cut is held by its bone alone; without either the body itself says so.
            held = None
    elif fixed != "none":
        held = _read_mask(surface, fixed, "--fixed")
    return replace(body, bone=bones, fixed=held)


def _drawn_bone(surface: Surface) -> Surface:
    """Return phalanges in a finger."""
    try:
        return bone_of(surface)
    except SurfaceError as error:
        # Without the remedies, which are arguments of Python.
        found = re.split("[:;] (?:check|give|scale=|min_thickness=)", str(error))[0]
        raise SurfaceError(
            f"--bone auto: {found}; it draws phalanges into one finger with its pad to -z: check --unit, give"
            " --bone FILE or none, or take `quasirigid grasp` for a whole hand"
        ) from None


def mask_file(text: str | None) -> Path | None:
    """Return the NumPy file that a mask is read from; None of a word that stands for one."""
    return Path(text) if text is not None and text.endswith(".npy") else None


def _read_mask(surface: Surface, text: str, option: str) -> NDArray[np.bool_]:
    """Return (n,) bool from a NumPy file."""
    file = mask_file(text)
    if file is None:
        raise QuantityError(
            f"{option}: '{text}' is not known, expected caps, none or a file that ends in .npy"
        )
    try:
        with file.open("rb") as stream:
            mask = np.lib.format.read_array(stream, allow_pickle=False)
    except Exception as error:  # damaged headers raise many kinds
        raise QuantityError(f"{option}: {text} is no NumPy array: {error}") from None
    if mask.dtype != np.bool_ or mask.shape != (len(surface.vertices),):
        raise QuantityError(
            f"{option}: {text} is {mask.dtype} of shape {mask.shape}, expected bool of shape"
            f" ({len(surface.vertices)},)"
        )
    return cast(NDArray[np.bool_], mask)


def rotation(angles: Sequence[float]) -> NDArray[np.float64]:
    """Return turns (rad) about the fixed axes x, then y, then z as one (3, 3) matrix."""
    total = np.eye(3)
    for axis, angle in enumerate(angles):
        turn = np.eye(3)
        first, second = (axis + 1) % 3, (axis + 2) % 3
        turn[first, first] = turn[second, second] = np.cos(angle)
        turn[second, first], turn[first, second] = np.sin(angle), -np.sin(angle)
        total = turn @ total
    return total
