"""Grasps: a table by digit, a record for JSON, files."""

from __future__ import annotations

from collections.abc import Mapping
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from .._check import as_boolean, as_path
from .._core import __version__
from .._extras import need_matplotlib
from .._text import aligned
from .._units import KPA, MM
from ..hand.crossings import in_words
from ..hand.rig.joints import DIGITS
from .atomic import json_bytes, png_bytes, write_files
from .record import as_plain, figure, figures, inputs_record, patch_figures
from .write import CONTACT_FILES, GRASP_OWN_FILES, save_contact, save_pictures

if TYPE_CHECKING:
    from ..hand import Grasp

__all__ = ["GRASP_FILES", "digit_table", "grasp_record", "save_grasp"]

# All that `save_grasp` may write.
GRASP_FILES = (*CONTACT_FILES, *GRASP_OWN_FILES)

_ONE_WAY = 0.5  # of all forces: beyond, most of them are against nothing
_BALANCE = {"net_force": "N", "net_moment": "N m", "unbalanced_force": "N", "unbalanced_moment": "N m"}


def digit_table(grasp: Grasp) -> str:
    """Return what each digit holds as a text table.

    Parameters
    ----------
    grasp : Grasp
        The grasp.

    Returns
    -------
    str
        A line for each digit, the palm and all: how far it closed (%, `Grasp.shares`; below 0 where it opened
        for a product that stood in it at the start), force (N; of all the sum of these,
        whatever their directions), area (mm²), peak pressure and mean over 1 cm² (kPa); then what missed,
        the resultant force, and what is out of balance.
    """
    parts = dict(grasp.digits) | {"palm": grasp.palm}
    forces = [_length(part.force) for part in parts.values()]
    columns = [
        ["digit", *parts, "all"],
        [
            "closed (%)",
            *(f"{100.0 * grasp.shares[name]:.1f}" if name in grasp.shares else "" for name in parts),
            "",
        ],
        ["force (N)", *(f"{force:.4g}" for force in forces)],
        ["area (mm²)", *(f"{part.contact_area * MM**2:.4g}" for part in parts.values())],
        ["peak (kPa)", *(f"{part.max_pressure * KPA:.4g}" for part in parts.values())],
        ["mean over 1 cm² (kPa)", *(f"{part.mean_pressure * KPA:.4g}" for part in parts.values())],
    ]
    contact = grasp.contact
    whole = (sum(forces), contact.contact_area * MM**2, contact.max_pressure * KPA)
    for column, value in zip(columns[2:], (*whole, contact.mean_pressure() * KPA), strict=True):
        column.append(f"{value:.4g}")
    lines = aligned(columns)
    lines += [f"{digit} {reason}" for digit, reason in grasp.missed.items()]
    if grasp.posed.crossings:
        lines.append(f"the hand crosses itself: {in_words(grasp.posed.crossings)}")
    net, moment = _length(grasp.net_force), _length(grasp.net_moment)
    line = f"hand on product: {net:.4g} N, {moment:.4g} N m about its center of mass"
    thumb, *fingers = (_length(grasp.digits[name].force) if name in grasp.digits else 0.0 for name in DIGITS)
    # Digits that do not touch, or are alone, cannot push against each other.
    if net > _ONE_WAY * sum(forces) and thumb > 0.0 and any(fingers):
        line += (
            ": the digits push it away more than against each other; turn the hand so that the thumb comes"
            " from the other side"
        )
    lines.append(line)
    if (digits := sum(forces[:-1])) < forces[-1]:
        lines.append(
            f"the palm carries {forces[-1]:.4g} N beside the {digits:.4g} N of the digits, which alone were"
            " asked for: move the product away from it"
        )
    if grasp.unbalanced_force is not None and grasp.unbalanced_moment is not None:
        force, moment = _length(grasp.unbalanced_force), _length(grasp.unbalanced_moment)
        lines.append(f"out of balance with its weight: {force:.4g} N, {moment:.4g} N m")
    return "\n".join(lines)


def grasp_record(grasp: Grasp) -> dict[str, Any]:
    """Return everything about a grasp but its contact, ready for JSON, in SI.

    Parameters
    ----------
    grasp : Grasp
        The grasp.
    """
    return {
        "quasirigid": __version__,
        "pose": {"joints": list(grasp.posed.hand.joint_names), "turns": as_plain(grasp.pose)},
        "shares": as_plain(grasp.shares),
        "digits": {name: patch_figures(part) for name, part in grasp.digits.items()},
        "palm": patch_figures(grasp.palm),
        "regions": {name: patch_figures(part) for name, part in grasp.regions.items()},
        **figures(grasp, _BALANCE),
        "missed": dict(grasp.missed),
        "crossings": grasp.posed.crossings,
        "rounds": grasp.rounds,
        "timings": {name: figure(seconds, "s") for name, seconds in grasp.timings.items()},
    }


def save_grasp(
    grasp: Grasp,
    folder: str | PathLike[str],
    *,
    inputs: Mapping[str, Any] | None = None,
    pictures: bool = False,
) -> tuple[Path, ...]:
    """Write a grasp into a folder, as `Grasp.save` describes."""
    folder = as_path("folder", folder)
    if as_boolean("pictures", pictures):
        need_matplotlib()
    files = save_contact(grasp.contact, folder, inputs=inputs)
    record = grasp_record(grasp) | {"inputs": inputs_record(inputs)}
    grasp.posed.hand.save(folder / "hand.glb", grasp.contact)
    files += (folder / "hand.glb", *write_files(folder, {"grasp.json": json_bytes(record)}))
    if pictures:
        from ..plot.grasps import grasp_figure

        files += save_pictures(grasp.contact, folder)
        files += write_files(folder, {"grasp.png": png_bytes(grasp_figure(grasp))})
    return files


def _length(vector: Any) -> float:
    return float(np.linalg.norm(vector))
