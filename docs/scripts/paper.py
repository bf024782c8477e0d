"""Write docs/paper.md and its pictures: the figures of Xie, Kanai, Date 2011, done again.

Needs the meshes of the folder `QUASIRIGID_DATA` (CC0 files alone). `--no-times` leaves the seconds out, for
a machine that is busy with other things.
"""

from __future__ import annotations

import os
import sys
import time
import warnings
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import paper_pictures as pictures
import quasirigid as qr
from numpy.typing import NDArray
from paper_page import PAGE
from paper_scenes import HAND, MESHES, Scene, finger_scene, fingertip_scene, palm_scene, skin_of

Floats = NDArray[np.float64]
G, NU = 60e3, 0.5
K = (1 - NU) / (2 * np.pi * G)
HEIGHT, WIDTH, CUTOFF = 0.8e-3, 5e-3, 15e-3
FAR = 0.5  # a cutoff that no hand reaches (m)
TIP_EDGES, PALM_EDGES = 2e-3, 6e-3  # of the coarse meshes of the bodies (m)
DEPTH = 1.12e-3
TIP_OVERLAPS, PALM_OVERLAPS = (1.46e-3, 1.98e-3, 2.80e-3), (1.51e-3, 3.20e-3, 4.88e-3)
SWEEP = np.array([0.1, 0.2, 0.3, 0.4, 0.6, 0.8, 1.0, 1.12, 1.4, 1.7, 2.0]) * 1e-3
# As the paper solves: three rings around the penetrating vertices, gaps of the undeformed skin, Lemke.
PAPER = qr.ContactOptions(target_error=None, rings=3, max_linearizations=1, method="lemke")
AS_GIVEN = qr.ContactOptions(target_error=None)
REFINED = qr.ContactOptions()
PRINTED, ENDLESS = "printed, cut off at 15 mm", "printed, no cutoff"
HALF, BODY, BALANCED = "half-space", "body", "Gaussian, balanced"


class Case(NamedTuple):
    """A skin and how it is solved."""

    skin: qr.Skin | qr.PreparedSkin
    options: qr.ContactOptions


def material(response: qr.Response) -> qr.Skin:
    """Return the paper's material with a response."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", qr.QuasirigidWarning)  # the page says what is ill posed
        return qr.Skin(shear_modulus=G, poisson_ratio=NU, response=response)


def printed(cutoff: float) -> qr.Skin:
    """Return the paper's kernel on its one-rings."""
    return material(qr.GaussianCorrected(height=HEIGHT, width=WIDTH, cutoff=cutoff, pressure="one_ring"))


def cases(body: qr.PreparedSkin, options: qr.ContactOptions) -> dict[str, Case]:
    """Return what is tried in each scene."""
    return {
        PRINTED: Case(printed(CUTOFF), PAPER),
        ENDLESS: Case(printed(FAR), PAPER),
        "half-space, one-rings": Case(material(qr.HalfSpace(pressure="one_ring")), PAPER),
        HALF: Case(material(qr.HalfSpace()), options),
        BODY: Case(body, options),
    }


def press(scene: Scene, case: Case, overlap: float) -> qr.Contact:
    """Press to a largest overlap (m), whatever the ending."""
    return qr.press(
        scene.surface,
        scene.product,
        case.skin,
        scene.direction,
        overlap=overlap,
        options=case.options,
        throw=False,
    )


def body_of(scene: Scene, overlap: float, edges: float | None = None) -> qr.PreparedSkin:
    """Return the body under a skin, prepared for what lies within 1 mm of the product at an overlap."""
    there = press(scene, Case(material(qr.HalfSpace()), AS_GIVEN), overlap).obstacle
    near = there.signed_distance(scene.surface.vertices, 0.02)[0] < 1.5e-3
    response = qr.Body(bone=scene.bone, fixed=~scene.surface.skin_mask, coarse_edge_length=edges)
    return material(response).prepared(scene.surface, np.flatnonzero(near & scene.surface.skin_mask))


def row(name: str, contact: qr.Contact, scene: Scene) -> str:
    """Return a line of figures."""
    before = f"| {name} | {contact.max_penetration_before * 1e3:.2f} | {contact.status.value} |"
    if contact.status != "solved":
        return f"{before} - | - | - | {contact.max_penetration_after * 1e3:.2f} | - | - | - |"
    moved = contact.displacement
    towards = float(np.max(-moved @ scene.direction))
    outwards = float((moved * contact.surface.vertex_normals).sum(axis=1).max())
    figures = [
        f"{contact.force @ scene.direction:.2f}",
        f"{contact.contact_area * 1e6:.1f}",
        f"{contact.max_pressure * 1e-3:.0f}",
        f"{contact.max_penetration_after * 1e3:.3f}",
        f"{max(towards, 0.0) * 1e3:.2f}",
        f"{outwards * 1e3:.2f}",
        f"{contact.volume_change * 1e9:+.0f}",
    ]
    return f"{before} " + " | ".join(figures) + " |"


def figures(
    scene: Scene, tried: Mapping[str, Case], overlaps: tuple[float, ...]
) -> tuple[str, dict[Any, Any]]:
    """Return the table of a scene, and its contacts by name and overlap."""
    heads = ["response", "overlap before (mm)", "ending", "force (N)", "area (mm²)", "peak (kPa)"]
    heads += ["overlap after (mm)", "towards product (mm)", "outwards (mm)", "volume (mm³)"]
    lines = ["| " + " | ".join(heads) + " |", "|---" * len(heads) + "|"]
    contacts = {}
    for overlap in overlaps:
        for name, case in tried.items():
            contact = contacts[name, overlap] = press(scene, case, overlap)
            lines.append(row(name, contact, scene))
            print(lines[-1], flush=True)
    return "\n".join(lines), contacts


def ray_reach(surface: qr.Surface, contact: qr.Contact) -> float:
    """Return the largest distance between vertices that carry the ray a contact ended on (m)."""
    ray = contact.lcp_solutions[0].ray
    if ray is None:
        return np.nan
    points = surface.vertices[contact.candidates[ray.z > 0.0]]
    return float(np.linalg.norm(points[:, None] - points, axis=2).max())


def letter(scene: Scene, case: Case) -> str:
    """Return the endings of Lemke's method for the paper's kernel over the rings that are looked at."""
    rings = (0, 1, 2, 3, 6)
    lines = ["| overlap (mm) | " + " | ".join(f"rings: {ring}" for ring in rings) + " | half-space |"]
    lines.append("|---" * (len(rings) + 2) + "|")
    half = Case(material(qr.HalfSpace()), AS_GIVEN)
    for overlap in (0.2e-3, 0.3e-3, 0.35e-3, 0.4e-3, 0.6e-3, DEPTH):
        true = press(scene, half, overlap)
        distance = true.obstacle.signed_distance(scene.surface.vertices)[0]
        inside = np.flatnonzero((distance < 0.0) & scene.surface.skin_mask)
        cells = []
        for ring in rings:
            nodes = scene.surface.k_ring(inside, ring)
            matrix = qr.response_matrix(scene.surface, case.skin, nodes)
            solution = qr.solve_lcp(matrix, distance[nodes], method="lemke", throw=False)
            force = f", {solution.z.sum():.2g} N" if solution.status == "solved" else ""
            cells.append(f"{solution.status.value}{force}")
        lines.append(
            f"| {overlap * 1e3:.2f} | " + " | ".join(cells) + f" | {true.force @ scene.direction:.2g} N |"
        )
    return "\n".join(lines)


def least(work: Callable[[], object], budget: float = 4.0) -> float:
    """Return the least seconds of two to seven runs, no third one past the budget (s)."""
    started, best = time.perf_counter(), np.inf
    for run in range(7):
        begun = time.perf_counter()
        work()
        best = min(best, time.perf_counter() - begun)
        if run > 0 and time.perf_counter() - started > budget:
            break
    return float(best)


def stages(scene: Scene, case: Case, overlap: float) -> dict[str, float]:
    """Return the least seconds of each stage of a press over five runs."""
    runs = [press(scene, case, overlap).timings for _ in range(5)]
    return {stage: min(run[stage] for run in runs) for stage in runs[0]}


def timings(finger: Scene, on_finger: Mapping[str, Case], palm: Scene, on_palm: Mapping[str, Case]) -> str:
    """Return the table of seconds beside the paper's."""
    surface = finger.surface
    every = np.flatnonzero(surface.skin_mask)
    count = f"{len(every):,}"
    rows = []

    def add(what: str, papers: float | None, seconds: float) -> None:
        ratio = "-" if papers is None else f"{papers / seconds:,.0f}"
        shown = [f"{s:.4g} s" if s > 1.0 else f"{s * 1e3:.3g} ms" for s in (papers or np.nan, seconds)]
        rows.append(f"| {what} | {shown[0] if papers else '-'} | {shown[1]} | {ratio} |")
        print(rows[-1], flush=True)

    for name in (PRINTED, "half-space, one-rings", HALF):
        skin = on_finger[name].skin
        seconds = least(lambda skin=skin: qr.response_matrix(surface, skin, every))  # type: ignore[misc]
        add(f"set-up: every pair of {count} vertices, {name}", 340.0, seconds)
    response = qr.Body(bone=finger.bone, fixed=~surface.skin_mask)
    add(
        f"set-up: body with its bone for {count} vertices",
        340.0,
        least(lambda: material(response).prepared(surface, every), 1.0),
    )
    as_given = {name: on_finger[name]._replace(options=AS_GIVEN) for name in (HALF, BODY)}
    tried = {
        "half-space, one-rings, as the paper solves": on_finger["half-space, one-rings"],
        **{f"{name}, mesh as given": case for name, case in as_given.items()},
        **{f"{name}, mesh refined": on_finger[name] for name in (HALF, BODY)},
    }
    for name, case in tried.items():
        found = stages(finger, case, DEPTH)
        add(f"collision at {DEPTH * 1e3:.2f} mm: {name}", 4.835, found["signed_distance"])
        add(f"LCP at {DEPTH * 1e3:.2f} mm: {name}", 0.438, found["lcp"])
    whole = stages(palm, on_palm[HALF], PALM_OVERLAPS[-1])
    vertices = f"{len(palm.surface.vertices):,}"
    add(f"collision: hand of {vertices} vertices, palm, {HALF}", 4.835, whole["signed_distance"])
    add(f"response of that contact, {HALF}", None, whole["response"])
    add(f"LCP of that contact, {HALF}", None, whole["lcp"])
    head = "| stage | paper | here | times faster |\n|---|---|---|---|\n"
    return head + "\n".join(rows)


def exponent(x: Floats, y: Floats) -> float:
    """Return the power of x that y follows where x is above 0.5 mm."""
    good = np.isfinite(y) & (x > 0.5e-3)
    return float(np.polyfit(np.log(x[good]), np.log(y[good]), 1)[0])


def main(with_times: bool) -> None:
    """Measure, print, draw, write."""
    missing = [str(path) for path in MESHES if not path.is_file()]
    if missing:
        sys.exit("missing: " + ", ".join(missing) + "; QUASIRIGID_DATA names the folder of meshes")
    bands = pictures.draw_kernels(K, HEIGHT, WIDTH, CUTOFF)

    finger = finger_scene()
    on_finger = cases(body_of(finger, SWEEP[-1] + 1e-4, TIP_EDGES), REFINED)
    balanced = qr.GaussianCorrected.balanced(width=8e-3, cutoff=CUTOFF)
    on_finger[BALANCED] = Case(material(balanced), AS_GIVEN)
    finger_table, pressed = figures(finger, on_finger, (DEPTH,))
    rings = letter(finger, on_finger[PRINTED])
    shown = {name: pressed[name, DEPTH] for name in (HALF, BALANCED, BODY)}
    shallow = press(finger, on_finger[PRINTED], 0.3e-3)
    pictures.draw_finger(shown, shallow, finger.direction, finger.bone)
    curves = {
        name: qr.sweep(
            finger.surface, finger.product, case.skin, finger.direction, depths=SWEEP, options=case.options
        )
        for name, case in on_finger.items()
        if name != ENDLESS
    }
    pictures.draw_sweep(curves)
    powers = {
        name: (exponent(SWEEP, curves[name].normal_force), exponent(SWEEP, curves[name].contact_area))
        for name in (HALF, BODY)
    }
    last_solved = {
        name: max(d for d, s in zip(SWEEP, curve.status, strict=True) if s == "solved")
        for name, curve in curves.items()
    }

    hand = skin_of(HAND)
    tip = fingertip_scene(hand)
    tip_table, at_tip = figures(tip, cases(body_of(tip, TIP_OVERLAPS[-1], TIP_EDGES), AS_GIVEN), TIP_OVERLAPS)
    steps = [{name: at_tip[name, overlap] for name in (HALF, BODY)} for overlap in TIP_OVERLAPS]
    sight = np.array([-0.85, 0.35, -0.25])
    pictures.draw_depths("fingertip", steps, tip.direction, tip.bone, sight=sight)
    palm = palm_scene(hand)
    started = time.perf_counter()
    palm_body = body_of(palm, PALM_OVERLAPS[-1], PALM_EDGES)
    palm_seconds = time.perf_counter() - started
    on_palm = cases(palm_body, AS_GIVEN)
    palm_table, at_palm = figures(palm, on_palm, PALM_OVERLAPS)
    steps = [{name: at_palm[name, overlap] for name in (HALF, BODY)} for overlap in PALM_OVERLAPS]
    sight = np.array([-0.9, 0.2, 0.15])
    pictures.draw_depths("palm", steps, palm.direction, palm.bone, sight=sight)
    dense = [(at_tip, overlap) for overlap in TIP_OVERLAPS] + [
        (at_palm, overlap) for overlap in PALM_OVERLAPS
    ]
    bodies = [pressed[BODY, DEPTH], *(found[BODY, overlap] for found, overlap in dense)]
    printed_endings = {
        found[name, overlap].status.value for found, overlap in dense for name in (PRINTED, ENDLESS)
    }
    page = PAGE.format(
        balance=K * CUTOFF / (WIDTH**2 * (1 - np.exp(-(CUTOFF**2) / (2 * WIDTH**2)))) * 1e3,
        highest=K * np.exp(0.5) / WIDTH * 1e3,
        endless_band=bands["no cutoff"],
        cut_band=bands["cut off"],
        finger_count=f"{len(finger.surface.vertices):,}",
        hand_count=f"{len(hand.vertices):,}",
        tip_count=f"{len(tip.surface.vertices):,}",
        palm_nodes=f"{len(palm_body.nodes):,}",
        palm_edges=PALM_EDGES * 1e3,
        palm_setup=f" in {palm_seconds:.0f} s" if with_times else "",
        finger_table=finger_table,
        rings=rings,
        half_power=powers[HALF],
        body_power=powers[BODY],
        last=last_solved[PRINTED] * 1e3,
        tip_table=tip_table,
        palm_table=palm_table,
        times=timings(finger, on_finger, palm, on_palm) if with_times else "Not measured in this run.",
        cores=os.cpu_count(),
        body_error=max(contact.accuracy.force_error or 0.0 for contact in bodies),
        depth=DEPTH * 1e3,
        ray_reach=ray_reach(finger.surface, pressed[PRINTED, DEPTH]) * 1e3,
        at_depths="end with " + " or ".join(f'"{ending}"' for ending in sorted(printed_endings)),
        stiffer=max(
            np.linalg.norm(found[BODY, overlap].force) / np.linalg.norm(found[HALF, overlap].force)
            for found, overlap in dense
        ),
        refined=f"{len(pressed[BODY, DEPTH].gap):,}",
    )
    target = Path(__file__).parents[1] / "paper.md"
    target.write_text(page, encoding="utf-8")
    print(f"wrote {target}", file=sys.stderr)


if __name__ == "__main__":
    main("--no-times" not in sys.argv[1:])
