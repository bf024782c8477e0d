"""Poses from files."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..._check import as_path, short
from ...errors import HandError
from ..pose import ANGLES
from ..rig.joints import index_of

if TYPE_CHECKING:
    from os import PathLike

__all__ = ["read_pose"]

_UNITS = {"deg": math.pi / 180.0, "rad": 1.0}
_TOO_LARGE = 1e300  # in either unit: beyond, whole numbers are no floats


def read_pose(path: str | PathLike[str]) -> dict[str, dict[str, float]]:
    """Read a pose from a JSON file: a mapping as `Hand.posed` takes it, with the unit of its angles.

    Parameters
    ----------
    path : path
        An object with ``"unit"`` ("deg" or "rad"), and each joint to turn by its name, with a flexion from
        rest or with an object of "flexion", "abduction" and "twist".

    Returns
    -------
    dict of str to dict of str to float
        Angles (rad) of the joints named.

    Raises
    ------
    HandError
        The file cannot be read or is no such object, or an angle is no number, by file and joint.

    Examples
    --------
    >>> import quasirigid as qr, tempfile, pathlib
    >>> path = pathlib.Path(tempfile.mkdtemp()) / "pose.json"
    >>> _ = path.write_text('{"unit": "deg", "index-finger-phalanx-distal": 90}')
    >>> pose = qr.hand.read_pose(path)
    >>> round(pose["index-finger-phalanx-distal"]["flexion"], 4)
    1.5708
    """
    file = as_path("path", path)
    try:
        known = json.loads(file.read_text(encoding="utf-8"))
    except OSError as error:
        raise HandError(f"{file}: {error.strerror or error}") from None
    except (ValueError, RecursionError) as error:
        raise HandError(f"{file}: no JSON: {error}") from None
    if not isinstance(known, dict):
        raise HandError(f"{file}: it holds {short(known)}, expected an object of joints")
    unit = known.pop("unit", None)
    if not isinstance(unit, str) or unit not in _UNITS:
        raise HandError(f'{file}: its "unit" is {short(unit)}, expected "deg" or "rad"')
    return {joint: _angles(file, joint, value, _UNITS[unit]) for joint, value in known.items()}


def _angles(file: Path, joint: str, value: Any, unit: float) -> dict[str, float]:
    given = value if isinstance(value, Mapping) else {"flexion": value}
    for name, angle in given.items():
        index_of(name, ANGLES, f"{file}: the angle of {joint}")
        is_number = isinstance(angle, (int, float)) and not isinstance(angle, bool)
        if not is_number or not abs(angle) < _TOO_LARGE:
            raise HandError(f"{file}: {name} of {joint} is {short(angle)}, expected a finite number")
    return {name: float(angle) * unit for name, angle in given.items()}
