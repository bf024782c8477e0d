"""A contact as a table for people: lengths in mm, forces in N, pressures in kPa."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from .._text import aligned, as_percent
from .._units import KPA, MM
from .record import MEAN_AREAS, NOT_REACHED, mean_pressure

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from ..contact.accuracy import Refinement
    from ..contact.result import Contact
    from ..contact.swept import Sweep

__all__ = [
    "compare_contacts",
    "contact_html",
    "contact_summary",
    "infinite_error",
    "patch_table",
    "refinement_table",
    "sweep_summary",
    "sweep_table",
    "with_error",
]

_LEFT_OUT = "left out: "


def contact_summary(contact: Contact) -> str:
    """Return the figures of a contact as a text table, and what the solve left out.

    Parameters
    ----------
    contact : Contact
        The contact.

    Returns
    -------
    str
        One line a figure, in mm, N and kPa, each with its unit and, where one was made, the estimate of its
        error; then `warnings`, `left_out`, and `advice` where the contact did not end solved.
    """
    return compare_contacts({"": contact})


def compare_contacts(
    contacts: Mapping[str, Contact], *, verbose: bool = True, warnings: bool = True, is_reached: bool = True
) -> str:
    """Return the figures of several contacts side by side as a text table.

    Parameters
    ----------
    contacts : mapping of str to Contact
        The contacts under their names; at least one.
    verbose : bool
        Say why each thing was left out; else name them on one line.
    warnings : bool
        List what the contacts warned of; False where that is told elsewhere.
    is_reached : bool
        Whether the contacts reached what was asked for; `status` is "not_reached" else.

    Returns
    -------
    str
        As `contact_summary`, with a column for each contact; of several, warnings and advice say whose they
        are.

    Raises
    ------
    ContactError
        If there is no contact; a TypeError if a name is no str.
    """
    if not contacts:
        from ..contact.result import ContactError

        raise ContactError("contacts is empty, expected at least one")
    if wrong := [name for name in contacts if not isinstance(name, str)]:
        raise TypeError(f"a contact is named {wrong[0]!r}, expected a str")
    ending = {} if is_reached else {"status": NOT_REACHED}
    columns = [{"": name} | _rows(contact) | ending for name, contact in contacts.items()]
    names = list(dict.fromkeys(name for column in columns for name in column))
    rows = [[column.get(name, "") for name in names] for column in columns]
    owners: dict[str, list[str]] = {}
    for name, contact in contacts.items():
        for note in dict.fromkeys(_notes(contact, verbose, warnings)):
            owners.setdefault(note, []).append(name)
    notes = [_owned(note, of, len(contacts)) for note, of in owners.items()]
    omitted = dict.fromkeys(what for contact in contacts.values() for what, _ in contact.left_out)
    if omitted and not verbose:
        notes.append(_LEFT_OUT + ", ".join(omitted))
    return "\n".join([*filter(None, aligned([names, *rows])), *notes])


def refinement_table(contact: Contact) -> str:
    """Return what each mesh of a contact gave as a text table.

    Parameters
    ----------
    contact : Contact
        The contact.

    Returns
    -------
    str
        A line for each mesh of `Contact.refinements`: nodes, force (N) and area (mm²) with the estimates of
        their errors, peak pressure (kPa), time (ms).
    """
    rounds = _meshes(contact)
    forces = [float(np.linalg.norm(one.force)) for one in rounds]
    columns = [
        ["mesh", "given", *(f"round {number}" for number in range(1, len(rounds)))],
        ["nodes", *(str(one.nodes) for one in rounds)],
        ["force (N)", *(f"{force:.4g}" for force in forces)],
        ["error", *(_percent(one.force_error) for one in rounds)],
        ["area (mm²)", *(_of(one.contact_area, MM**2) for one in rounds)],
        ["error", *(_percent(one.area_error) for one in rounds)],
        ["peak (kPa)", *(_of(one.max_pressure, KPA) for one in rounds)],
        ["time (ms)", *(f"{one.seconds * 1e3:.3g}" for one in rounds)],
    ]
    return "\n".join(aligned(columns))


def sweep_table(sweep: Sweep) -> str:
    """Return the steps of a sweep as a text table.

    Parameters
    ----------
    sweep : Sweep
        The sweep.

    Returns
    -------
    str
        A line for each step: its number from 0, the force that was asked for (N) or nothing of depths, depth
        (mm), force along the direction (N) and area (mm²) and peak pressure (kPa) with the estimates of their
        errors, time (ms), status; a note where a peak is infinite.
    """
    numbers = (
        ("depth (mm)", sweep.depth * MM),
        ("force (N)", sweep.normal_force),
        ("area (mm²)", sweep.contact_area * MM**2),
        ("peak (kPa)", sweep.max_pressure * KPA),
        ("time (ms)", sweep.seconds * 1e3),
    )
    depth, force, area, peak, seconds = (
        [name, *("-" if np.isnan(value) else f"{value:.4g}" for value in values)] for name, values in numbers
    )
    force_error, area_error, peak_error = (
        ["error", *(_percent(None if np.isnan(error) else float(error)) for error in errors)]
        for errors in (sweep.force_error, sweep.area_error, sweep.max_pressure_error)
    )
    status = ["status", *sweep.status]
    step = ["step", *map(str, range(len(sweep)))]
    forces = ["asked (N)", *(f"{value:.4g}" for value in sweep.asked)]
    asked = [forces] if sweep._question.goal == "force" else []
    columns = [step, *asked, depth, force, force_error, area, area_error, peak, peak_error, seconds, status]
    at_edge = np.isinf(sweep.max_pressure_error) & np.isfinite(sweep.force_error)
    note = ["peak with an error of inf %: infinite at an edge or a cut"] if at_edge.any() else []
    return "\n".join([*aligned(columns), *note])


def sweep_summary(sweep: Sweep) -> str:
    """Return the steps of a sweep as a text table, and what each has warned of or left without figures.

    Parameters
    ----------
    sweep : Sweep
        The sweep.

    Returns
    -------
    str
        `sweep_table`, then `warnings` and `messages` of each step, counted from 0.
    """
    notes = []
    for step, (warned, message) in enumerate(zip(sweep.warnings, sweep.messages, strict=True)):
        notes += [f"step {step}: warning: {warning}" for warning in warned]
        notes += [f"step {step}: {sweep.status[step]}: {message}"] if message else []
    return "\n".join([sweep_table(sweep), *notes])


def patch_table(contact: Contact) -> str:
    """Return what each patch of a contact carries as a text table.

    Parameters
    ----------
    contact : Contact
        The contact.

    Returns
    -------
    str
        A line for each of `Contact.patches`: force (N), area (mm²), peak pressure and mean over 1 cm² (kPa),
        center of pressure (mm).
    """
    patches = contact.patches
    columns = [
        ["patch", *(str(number) for number in range(1, len(patches) + 1))],
        ["force (N)", *(f"{float(np.linalg.norm(one.force)):.4g}" for one in patches)],
        ["area (mm²)", *(f"{one.contact_area * MM**2:.4g}" for one in patches)],
        ["peak (kPa)", *(f"{one.max_pressure * KPA:.4g}" for one in patches)],
        ["mean over 1 cm² (kPa)", *(f"{one.mean_pressure * KPA:.4g}" for one in patches)],
        ["center (mm)", *(_vector(one.center_of_pressure, MM) for one in patches)],
    ]
    return "\n".join(aligned(columns))


def contact_html(contact: Contact) -> str:
    """Return the figures of a contact as an HTML table, for notebooks.

    Parameters
    ----------
    contact : Contact
        The contact.

    Returns
    -------
    str
        The lines of `contact_summary`: one `<table>`, and a `<div>` for each note.
    """
    from html import escape

    rows = "".join(
        f'<tr><th style="text-align:left">{escape(name)}</th><td>{escape(value)}</td></tr>'
        for name, value in _rows(contact).items()
    )
    notes = "".join(f"<div>{escape(note)}</div>" for note in _notes(contact))
    return f"<table>{rows}</table>{notes}"


def _meshes(contact: Contact) -> list[Refinement]:
    return [one for one in contact.refinements if one.kind == "mesh"]


def _of(value: float | None, unit: float) -> str:
    return "" if value is None else f"{value * unit:.4g}"


def _rows(contact: Contact) -> dict[str, str]:
    counts = len(contact.pressure), len(contact.candidates), len(contact.active)
    accuracy, rounds = contact.accuracy, _meshes(contact)
    force = float(np.linalg.norm(contact.force))
    infinite = infinite_error(contact)
    return {
        "status": str(contact.status),
        **_way(contact),
        "force": f"{force:.4g} N" + with_error(accuracy.force_error, infinite),
        "force vector": f"{_vector(contact.force, 1.0)} N",
        "moment about the origin": f"{_vector(contact.moment, MM)} N mm",
        "center of pressure": f"{_vector(contact.center_of_pressure, MM)} mm",
        "contact area": f"{contact.contact_area * MM**2:.4g} mm²" + with_error(accuracy.area_error, infinite),
        "peak pressure": f"{contact.max_pressure * KPA:.4g} kPa"
        + with_error(accuracy.max_pressure_error, infinite),
        **{f"mean pressure over {disc}": _mean_pressure(contact, area) for disc, area in MEAN_AREAS.items()},
        "overlap before": f"{contact.max_penetration_before * MM:.4g} mm",
        "overlap after": f"{contact.max_penetration_after * MM:.2g} mm",
        **_share(contact),
        "patches": str(len(contact.patches)),
        "vertices, candidates, active": ", ".join(map(str, counts)),
        "cells per contact radius": f"{accuracy.cells_per_radius:.3g}",
        "rounds of refinement": f"{len(rounds) - 1}, {rounds[-1].reason}",
        "natural residual": f"{contact.natural_residual:.1e}",
    } | {f"time: {stage}": f"{seconds * 1e3:.3g} ms" for stage, seconds in contact.timings.items()}


def _way(contact: Contact) -> dict[str, str]:
    """Return how far a press went; nothing of a contact in place."""
    if contact.depth is None:
        return {}
    ways = {"depth": contact.depth, "travel": contact.travel}
    return {name: f"{way * MM:.4g} mm" for name, way in ways.items()}


def _mean_pressure(contact: Contact, area: float) -> str:
    """Return the largest mean pressure over an area (m²), where the mesh resolves it."""
    found = mean_pressure(contact, area)
    return "not resolved: mesh too coarse" if found is None else f"{found * KPA:.4g} kPa"


def _share(contact: Contact) -> dict[str, str]:
    """Return how much of the overlap a product with a material takes."""
    share = contact.obstacle_share
    if share is None or contact.obstacle.material is None:
        return {}
    return {"share of the product": f"{100.0 * share:.3g} %"}


def infinite_error(contact: Contact) -> str:
    """Return in words what an infinite error of a contact means; at an edge or a cut the peak's alone is."""
    if len(contact.active) == 0:
        return "not known: nothing carries force"
    of_force = contact.accuracy.force_error
    is_known = of_force is not None and np.isfinite(of_force)
    return "infinite at an edge or a cut" if is_known else "not known: mesh too coarse"


def with_error(error: float | None, infinite: str) -> str:
    """Return a relative error as in " ± 1 %", an infinite one in words; nothing where there is none."""
    if error is None:
        return ""
    return f" ± {_percent(error)}" if np.isfinite(error) else f", {infinite}"


def _percent(error: float | None) -> str:
    """Return an estimated error, of one figure."""
    return as_percent(error, figures=1)


def _vector(values: ArrayLike, scale: float) -> str:
    """Return numbers parted by commas; what is nothing beside the largest is 0, and no 0 has a sign."""
    numbers = np.asarray(values, dtype=np.float64) * scale
    small = np.abs(numbers) < 1e-9 * np.abs(numbers).max()
    return ", ".join(f"{number:.4g}" for number in np.where(small, 0.0, numbers) + 0.0)


def _notes(contact: Contact, verbose: bool = True, warnings: bool = True) -> list[str]:
    advice = [f"advice: {contact.advice}"] if contact.advice else []
    warned = [f"warning: {warning}" for warning in contact.warnings] if warnings else []
    omitted = [f"{_LEFT_OUT}{what} ({why})" for what, why in contact.left_out] if verbose else []
    return [*warned, *omitted, *advice]


def _owned(note: str, owners: list[str], count: int) -> str:
    """Return a warning or an advice after the names of its contacts, where it is one of several."""
    return note if count == 1 or note.startswith(_LEFT_OUT) else f"{', '.join(owners)}: {note}"
