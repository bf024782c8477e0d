"""Write docs/validation.md: responses against known answers, measured here and now."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Literal

import numpy as np
import quasirigid as qr
from numpy.typing import NDArray
from quasirigid.evaluation.meshes import ball, lattice

G = 60e3
UP = np.array([0.0, 0.0, 1.0])
PLATE = qr.Obstacle.half_space([0, 0, -0.2], UP)
# What the mesh itself costs is measured here.
AS_GIVEN = qr.ContactOptions(target_error=None)

CONTACT_MODULUS = qr.reference.contact_modulus(shear_modulus=G, poisson_ratio=0.5)
FORMS: tuple[Literal["collocation", "galerkin"], ...] = ("collocation", "galerkin")
# h u / K of a flat incompressible layer at r / h.
LAYER = {r: u for r, u in qr.reference.point_load_on_layer().items() if r >= 1.0}


def body(
    skin: qr.Surface,
    nu: float,
    nodes: NDArray[np.int64] | None = None,
    *,
    bone: qr.Surface | None = None,
    fixed: NDArray[np.bool_] | None = None,
    bone_pressure: bool = False,
    coarse_edge_length: float | None = 0.0,
) -> qr.PreparedSkin:
    """Return the prepared body of a skin, on its own mesh unless told otherwise."""
    response = qr.Body(
        bone=bone, fixed=fixed, bone_pressure=bone_pressure, coarse_edge_length=coarse_edge_length
    )
    return qr.Skin(shear_modulus=G, poisson_ratio=nu, response=response).prepared(skin, nodes)


def near_pole(skin: qr.Surface, height: float) -> NDArray[np.int64]:
    """Return the vertices less than `height` (m) above the lowest point."""
    return np.flatnonzero(skin.vertices[:, 2] < skin.vertices[:, 2].min() + height)


def against_hertz() -> list[str]:
    """Measure force, peak and area of a sphere on flat skin in both forms of the half-space."""
    radius, depth = 200.0, 0.5e-3
    known = qr.reference.Hertz(radius=radius, contact_modulus=CONTACT_MODULUS)
    touching = known.contact_radius(depth)
    hertz = [known.force(depth), known.max_pressure(depth), np.pi * touching**2]
    sphere = qr.Obstacle.sphere([0, 0, radius - depth], radius)
    skins = [
        qr.Skin(shear_modulus=G, poisson_ratio=0.5, response=qr.HalfSpace(discretization=discretization))
        for discretization in FORMS
    ]
    names = [f"{figure}, {form}" for figure in ("force", "peak", "area") for form in FORMS]
    lines = ["| mesh | cells | " + " | ".join(names) + " |", "|---|---|" + "---|" * len(names)]
    meshes = {"equilateral": (120.0, 0.0), "square": (90.0, 0.0), "jittered": (90.0, 0.25)}
    for mesh, (degrees, jitter) in meshes.items():
        second = [np.cos(np.radians(degrees)), np.sin(np.radians(degrees))]
        for cells, places in ((4, 50), (8, 50), (16, 12)):
            random = np.random.default_rng(cells)
            errors = np.empty((places, 3, 2))
            for place in range(places):
                h = touching / (cells * random.uniform(0.94, 1.06))
                edges = h * np.array([[1.0, 0.0], second])
                plane, faces = lattice(4 * cells, 4 * cells, edges)
                moved = random.uniform(-jitter * h, jitter * h, plane.shape)
                plane = plane + random.uniform(-0.5, 0.5, 2) @ edges + moved
                surface = qr.Surface(np.column_stack([plane, np.zeros(len(plane))]), faces)
                for form, skin in enumerate(skins):
                    contact = qr.solve_contact(surface, sphere, skin, options=AS_GIVEN)
                    found = [-contact.force[2], contact.max_pressure, contact.contact_area]
                    errors[place, :, form] = np.divide(found, hertz) - 1
            mean, rms = errors.mean(axis=0).ravel(), np.sqrt((errors**2).mean(axis=0)).ravel()
            figures = [f"{m:+.2%}, {r:.2%}" for m, r in zip(mean, rms, strict=True)]
            lines.append(f"| {mesh} | {cells} | " + " | ".join(figures) + " |")
    return lines


def sphere_with_core() -> list[str]:
    """Measure forces against finite elements, and how the error falls under refinement."""
    skin, bone = ball(8e-3, 3, 4.0), ball(3e-3, 2, 2.0)
    known = qr.reference.plate_on_cored_sphere()
    depths = known[0].indentations
    lines = ["| nu | " + " | ".join(f"{depth * 1e3:g} mm" for depth in depths) + " |"]
    lines.append("|---|" + "---|" * len(depths))
    for sphere in known:
        nu = sphere.poisson_ratio
        prepared = body(skin, nu, near_pole(skin, 1.5e-3), bone=bone)
        cells = []
        for depth, true in sphere.indentations.items():
            force = qr.press(skin, PLATE, prepared, UP, depth=depth, options=AS_GIVEN).force[2]
            cells.append(f"{force:.4f} of {true:.4f} N ({force / true - 1:+.1%})")
        lines.append(f"| {nu} | " + " | ".join(cells) + " |")
    lines += ["", "Under refinement at nu = 0.5, 1.12 mm deep (skin and core refined together):", ""]
    lines += ["| skin vertices | force (N) | error | rate in the edge length |", "|---|---|---|---|"]
    last = 0.0
    for subdivisions in (1, 2, 3):
        skin, bone = ball(8e-3, subdivisions, 3.0), ball(3e-3, subdivisions, 1.0)
        prepared = body(skin, 0.5, near_pole(skin, 1.8e-3), bone=bone)
        force = qr.press(skin, PLATE, prepared, UP, depth=1.12e-3, options=AS_GIVEN).force[2]
        error = force / known[0].indentations[1.12e-3] - 1
        rate = f"{np.log2(abs(last / error)):.1f}" if last else "-"
        lines.append(f"| {len(skin.vertices)} | {force:.4f} | {error:+.2%} | {rate} |")
        last = error
    return lines


def on_two_levels() -> list[str]:
    """Measure forces against finite elements for coarse skins of three densities."""
    skin, bone = ball(8e-3, 4, 4.0), ball(3e-3, 3, 1.0)
    known = qr.reference.plate_on_cored_sphere()
    depths = known[0].indentations
    lines = ["| nu | coarse edges | " + " | ".join(f"{depth * 1e3:g} mm" for depth in depths) + " |"]
    lines.append("|---|---|" + "---|" * len(depths))
    for sphere in known:
        for length in (4e-3, 3e-3, None):
            nu = sphere.poisson_ratio
            prepared = body(skin, nu, near_pole(skin, 1.3e-3), bone=bone, coarse_edge_length=length)
            cells = []
            for depth, true in sphere.indentations.items():
                force = qr.press(skin, PLATE, prepared, UP, depth=depth, options=AS_GIVEN).force[2]
                cells.append(f"{force / true - 1:+.1%}")
            edges = "by the tissue" if length is None else f"{length * 1e3:g} mm"
            lines.append(f"| {nu} | {edges} | " + " | ".join(cells) + " |")
    return lines


def under_balls() -> list[str]:
    """Measure forces against finite elements as a press finds them by default."""
    bone = ball(3e-3, 3, 1.0)
    known = qr.reference.ball_on_cored_sphere()
    depths = known[0].indentations
    lines = ["| nu | skin vertices | " + " | ".join(f"{depth * 1e3:g} mm" for depth in depths) + " |"]
    lines.append("|---|---|" + "---|" * len(depths))
    for sphere in known:
        for subdivisions in (2, 3):
            skin = ball(8e-3, subdivisions, 1.0)
            loaded = near_pole(skin, 4e-3)
            prepared = body(skin, sphere.poisson_ratio, loaded, bone=bone, coarse_edge_length=None)
            indenter = qr.Obstacle.sphere([0, 0, -0.05], sphere.indenter_radius)
            cells = []
            for depth, true in sphere.indentations.items():
                contact = qr.press(skin, indenter, prepared, UP, depth=depth)
                told = contact.accuracy.force_error
                cells.append(f"{contact.force[2] / true - 1:+.1%} (told {told:.1%})")
            lines.append(f"| {sphere.poisson_ratio} | {len(skin.vertices)} | " + " | ".join(cells) + " |")
    return lines


def thin_shell() -> list[str]:
    """Measure the radial response of a thin shell on a large core against the flat layer."""
    radius, h = 40e-3, 2e-3
    lines = ["| edges per h at the pole | " + " | ".join(f"r/h = {r:g}" for r in LAYER) + " |"]
    lines.append("|---|" + "---|" * len(LAYER))
    for draw in (8.0, 14.0):
        skin, bone = ball(radius, 3, draw), ball(radius - h, 3, draw)
        nodes = near_pole(skin, 0.8e-3)
        pole = int(np.argmin(skin.vertices[:, 2]))
        order = np.concatenate([[pole], nodes[nodes != pole]])
        prepared = body(skin, 0.5, order, bone=bone)
        inward = -skin.vertices[order] / np.linalg.norm(skin.vertices[order], axis=1)[:, None]
        directions = inward.copy()
        directions[0] = UP
        column = qr.response_matrix(skin, prepared, order, directions=directions)[:, 0] * 4 * np.pi * G * h
        distance = np.linalg.norm(skin.vertices[order] - skin.vertices[pole], axis=1) / h
        ranked = np.argsort(distance[1:]) + 1
        cells = []
        for r, true in LAYER.items():
            found = float(np.interp(r, distance[ranked], column[ranked]))
            cells.append(f"{found:.4f} of {true:.4f}")
        edge = float(np.sort(distance)[1])
        lines.append(f"| {1 / edge:.1f} | " + " | ".join(cells) + " |")
    return lines


def near_field() -> list[str]:
    """Measure a solid sphere held far away: Boussinesq near the force, Hertz for small contacts."""
    skin = ball(8e-3, 3, 8.0)
    fixed = skin.vertices[:, 2] > -3e-3
    pole = int(np.argmin(skin.vertices[:, 2]))
    nodes = near_pole(skin, 0.5e-3)
    order = np.concatenate([[pole], nodes[nodes != pole]])
    distance = np.linalg.norm(skin.vertices[order] - skin.vertices[pole], axis=1)
    lines = ["| nu | " + " | ".join(f"r = {r:g} mm" for r in (1.6, 0.8, 0.4)) + " |", "|---|---|---|---|"]
    for nu in (0.5, 0.3):
        prepared, up = body(skin, nu, order, fixed=fixed), np.tile(UP, (len(order), 1))
        column = qr.response_matrix(skin, prepared, order, directions=up)[:, 0]
        cells = []
        for r in (1.6e-3, 0.8e-3, 0.4e-3):
            row = int(np.argmin(np.abs(distance - r)))
            boussinesq = (1 - nu) / (2 * np.pi * G) / distance[row]
            cells.append(f"{column[row] / boussinesq - 1:+.1%}")
        lines.append(f"| {nu} | " + " | ".join(cells) + " |")
    lines += ["", "Plate on the same sphere against Hertz, F = 4/3 E* R^0.5 d^1.5, at nu = 0.5:", ""]
    lines += ["| contact radius / R | force off Hertz |", "|---|---|"]
    skin = ball(8e-3, 3, 16.0)
    prepared = body(skin, 0.5, near_pole(skin, 0.3e-3), fixed=skin.vertices[:, 2] > -3e-3)
    hertz = qr.reference.Hertz(radius=8e-3, contact_modulus=CONTACT_MODULUS)
    for depth in (160e-6, 80e-6, 40e-6):
        force = qr.press(skin, PLATE, prepared, UP, depth=depth, options=AS_GIVEN).force[2]
        lines.append(f"| {hertz.contact_radius(depth) / 8e-3:.2f} | {force / hertz.force(depth) - 1:+.1%} |")
    return lines


def reciprocity() -> list[str]:
    """Measure how far two smooth loads differ in their work on each other's displacements."""
    lines = ["| vertices | works differ by | rate in the edge length |", "|---|---|---|"]
    last = 0.0
    for subdivisions in (1, 2, 3):
        skin = ball(8e-3, subdivisions, 1.0)
        everything = np.arange(len(skin.vertices))
        prepared = body(skin, 0.45, everything, bone=ball(4e-3, subdivisions, 1.0))
        inward = -skin.vertices / np.linalg.norm(skin.vertices, axis=1)[:, None]
        matrix = qr.response_matrix(skin, prepared, everything, directions=inward)
        low, side = np.array([0, 0, -1.0]), np.array([0.8, 0, 0.6])
        one, other = (np.maximum(-inward @ towards, 0.0) ** 2 * skin.vertex_areas for towards in (low, side))
        difference = abs((one @ matrix @ other) / (other @ matrix @ one) - 1)
        rate = f"{np.log2(last / difference):.1f}" if last else "-"
        lines.append(f"| {len(skin.vertices)} | {difference:.1e} | {rate} |")
        last = difference
    return lines


def identities() -> list[str]:
    """Measure what must hold to rounding, or to the tolerance of the integrals."""
    skin, bone = ball(8e-3, 2, 3.0), ball(3e-3, 2, 1.0)
    nodes = near_pole(skin, 2e-3)

    def force(nu: float = 0.5, length: float = 1.0, modulus: float = 1.0) -> float:
        small = qr.Surface(length * skin.vertices, skin.faces)
        core = qr.Surface(length * bone.vertices, bone.faces)
        stuff = qr.Skin(shear_modulus=modulus * G, poisson_ratio=nu, response=qr.Body(bone=core))
        plate = qr.Obstacle.half_space([0, 0, -0.2 * length], UP)
        pressed = qr.press(
            small, plate, stuff.prepared(small, nodes), UP, depth=0.6e-3 * length, options=AS_GIVEN
        )
        return float(pressed.force[2]) / length**2 / modulus

    there = force()
    units = [(1e-3, 1.0), (1e3, 1.0), (1.0, 1e-6), (1.0, 1e6)]
    worst = max(abs(force(0.5, *unit) / there - 1) for unit in units)
    turn = np.array([[0.0, -1, 0], [0.6, 0, -0.8], [0.8, 0, 0.6]])
    shift = [0.1, -0.2, 0.3]
    prepared = body(skin, 0.5, nodes, bone=bone)
    anew = body(skin.moved(turn, shift), 0.5, nodes, bone=bone.moved(turn, shift))
    pair = [
        qr.press(
            skin.moved(turn, shift),
            PLATE.moved(turn, shift),
            stuff,
            turn @ UP,
            depth=0.6e-3,
            options=AS_GIVEN,
        ).force
        for stuff in (prepared.moved(turn, shift), anew)
    ]
    whole = ball(8e-3, 2, 1.0)
    on_bone = body(whole, 0.5, bone=ball(3e-3, 2, 1.0), bone_pressure=True)
    uniform = on_bone.bone_pressure(-1e4 * whole.vertex_areas[:, None] * whole.vertex_normals)
    lines = ["| identity | deviation |", "|---|---|"]
    lines += [f"| force at nu = 0.499999 against nu = 0.5 | {abs(force(0.499999) / there - 1):.1e} |"]
    lines += [f"| force in other units (lengths x 1e-3, 1e3; G x 1e-6, 1e6) | {worst:.1e} |"]
    motion = np.linalg.norm(pair[0] - pair[1]) / np.linalg.norm(pair[1])
    lines += [f"| force after a rigid motion, moved against prepared anew | {motion:.1e} |"]
    off = np.abs(uniform / 1e4 - 1).max()
    lines += [
        f"| bone pressure under a uniform pressure, nu = 0.5, {len(whole.vertices)} vertices | {off:.1e} |"
    ]
    return lines


def volume() -> list[str]:
    """Measure the fingertip's change of volume against what the press displaces."""
    finger = qr.models.fingertip(edge_length=1.6e-3)
    finger = finger.with_skin_mask(qr.skin_without_caps(finger))
    pad = np.flatnonzero(finger.skin_mask & (finger.vertices[:, 2] < -2e-3))
    prepared = body(finger, 0.5, pad, bone=qr.models.bone_of(finger), fixed=~finger.skin_mask)
    lines = ["| depth | volume change, first order / displaced | of the drawn mesh / displaced |"]
    lines.append("|---|---|---|")
    for depth in (0.3e-3, 1.12e-3, 2e-3):
        contact = qr.press(finger, PLATE, prepared, UP, depth=depth, options=AS_GIVEN)
        inward = -np.einsum("ij,ij->i", contact.displacement, finger.vertex_normals)
        displaced = np.maximum(inward, 0) @ finger.vertex_areas
        first = contact.volume_change / displaced
        drawn = (contact.deformed.volume - finger.volume) / displaced
        lines.append(f"| {depth * 1e3:g} mm | {first:+.1%} | {drawn:+.1%} |")
    return lines


SECTIONS = {
    "Half-space against Hertz, by collocation and by Galerkin": (
        "A sphere pressed into flat skin so little (R = 200 m, 0.5 mm) that it is Hertz's parabola: error of "
        "force, peak pressure and contact area by collocation (`HalfSpace()`) and by Galerkin "
        '(`HalfSpace(discretization="galerkin")`), mean and root mean square over 50 places (12 at 16 cells) '
        "of the sphere on meshes of equilateral triangles, of squares cut by one diagonal, and of these with "
        "vertices moved by up to a quarter of a cell; cells per contact radius. R is large because a sphere "
        "pressed in by d falls short of the parabola's force by 0.3 d / R: 0.1 d / R as a sphere does "
        "(Sneddon 1965), the rest as forces act along its normals.",
        against_hertz,
    ),
    "Sphere with a rigid core against finite elements": (
        "A flat frictionless plate on a sphere of 8 mm radius with a fixed core of 3 mm, G = 60 kPa; 642 "
        "skin and 162 bone vertices drawn towards the contact. Truth: axisymmetric finite elements and the "
        "exact series of the shell, which agree to 0.2 %.",
        sphere_with_core,
    ),
    "The same sphere on two levels": (
        "The body solved on a coarse skin, a near kernel on the skin's own mesh of 2,562 vertices drawn "
        "towards the contact; core of 642 vertices. By the tissue: `Body(coarse_edge_length=None)`.",
        on_two_levels,
    ),
    "A ball on the same sphere": (
        "A rigid ball of 15 mm radius, the skin an even mesh, options and coarse edges as by default, so "
        "that the skin is refined under the ball. Truth: axisymmetric finite elements. In brackets what "
        "`accuracy.force_error` tells.",
        under_balls,
    ),
    "Thin shell on a large core against the flat layer": (
        "Inward displacement h u / (K f) beside a force on a shell of h = 2 mm over a core of 38 mm, nu = "
        "0.5, against the Hankel transform of the flat bonded layer (Johnson 1985, section 5.8); 642 "
        "vertices on each surface. What is left is curvature (h / R = 1/20) and mesh.",
        thin_shell,
    ),
    "Near the force, and small contacts": (
        "A solid sphere of 8 mm without a bone, its upper part fixed: displacement near a force against "
        "Boussinesq's u = K / r. The nearer, the less the body's shape matters; against Hertz's half-space "
        "and parabola the excess falls in proportion to contact radius / R.",
        near_field,
    ),
    "Reciprocity": (
        "Betti: the work of one load on the displacement of another does not depend on their order. "
        "Collocation keeps it up to the mesh error. Sphere of 8 mm, core of 4 mm, nu = 0.45, two smooth "
        "loads along the normals.",
        reciprocity,
    ),
    "Identities": ("Sphere of 8 mm with a core of 3 mm, plate 0.6 mm deep.", identities),
    "Volume of the deformed skin": (
        "The built-in fingertip with its bone, nu = 0.5, under a plate. The linear displacement keeps the "
        "volume to first order (`volume_change`) up to the mesh error; the second order, which linear "
        "elasticity leaves open, shows in the volume of the drawn mesh.",
        volume,
    ),
}


def main() -> None:
    """Measure, print, write."""
    parts = [
        "# Validation",
        "The half-space against Hertz, then the body response against what is known of bodies. Measured by "
        "`python docs/scripts/validation.py`, which writes this page; tests hold most of it to bounds.",
    ]
    for title, (words, measure) in SECTIONS.items():
        lines = measure()
        print(title, *lines, sep="\n", flush=True)
        parts += [f"## {title}", words, "\n".join(lines)]
    target = Path(__file__).parents[1] / "validation.md"
    target.write_text("\n\n".join(parts) + "\n", encoding="utf-8")
    print(f"wrote {target}", file=sys.stderr)


if __name__ == "__main__":
    main()
