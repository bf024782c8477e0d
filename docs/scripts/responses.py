"""Write docs/responses.md: each response on a fingertip, its cost and its error.

`--no-times` leaves the seconds out, for a machine that is busy with other things.
"""

from __future__ import annotations

import statistics
import sys
import time
import warnings
from pathlib import Path

import numpy as np
import quasirigid as qr

SHEAR_MODULUS, POISSON_RATIO, EDGE_LENGTH = 60e3, 0.5, 1.2e-3
DEPTHS = (0.3e-3, 0.6e-3, 1.12e-3, 2e-3)
REPEATS = 5
UP = (0.0, 0.0, 1.0)

PAGE = """\
# Each response on a fingertip

The built-in fingertip ({skin_count} vertices, edges of {edge:.2g} mm) with the bone that `models.bone_of`
draws into it ({bone_count} vertices, {tissue:.1f} mm of tissue over the pad), held at its cut, is pressed by
a flat plate; G = 60 kPa, nu = 0.5. Percentages are off the body, which is the linear answer for this finger.
The body is prepared for the {node_count} vertices that may touch; the skin is refined under the plate, as by
default. † The contact reaches the cut, and warns of it: forces lack what lies beyond. Written by
`python docs/scripts/responses.py`; {times}.

| response | set-up (s) | {heads} |
|---|---|{dashes}|
{rows}

- **half-space**: `HalfSpace()`. Too soft once the contact feels the bone. A kernel moves the skin along each
  force: entries of R are multiplied by the cosine between the obstacle's normals.
- **Gaussian, balanced**: `GaussianCorrected.balanced(width={width:g}e-3, cutoff={cutoff:g}e-3)`: keeps volume
  and is well posed, but far too stiff.
- **Gaussian, as printed**: height 0.8 mm/N, width 5 mm, cutoff 15 mm (Xie, Kanai, Date 2011): not well posed
  on a fingertip; where the problem ends without an answer the table says how.
- **layer**: `Layer(thickness={tissue:.1f}e-3)`, the tissue over the pad: for wide flat tissue; too stiff on a
  fingertip, where tissue gives way sideways.
- **body**: `Body(bone=models.bone_of(finger), fixed=cut)`.

What follows was measured once, as each was built; the script does not measure it again.

A whole hand with its bones (`PosedHand.skin`), 13,000 vertices, nu = 0.495: at most some 2,050 coarse
vertices of the skin, 9 to 12 s and 1 GB of the whole process. Against edges of 3.6 mm everywhere, twice as
many vertices (80 s, 4.2 GB), on refined contacts:

- a ball of 15 mm (radius), 1, 2, 3 mm deep: thenar +0.7, +1.0, +1.2 %, hypothenar +0.2, +0.2, +0.3 %, pad of
  the index finger +2.2, +2.2, +2.1 %, middle of the palm +1.5, +2.3, +2.9 %, head of the middle metacarpal
  +2.1, +3.0, +3.6 %;
- the same ball in the palm with only the skin within 15 mm of it prepared: +1.4, +1.9, +2.3 %, within 30 mm
  +0.7, +1.1, +1.3 %, in 4 s. Where few nodes may be loaded their edges are the shorter, down to 0.4 of the
  tissue's thickness; `accuracy.body_error` does not see how fast they grow beyond 15 mm;
- balls of 5 to 20 mm, up to 3 mm deep, at 20 places of the palm and 20 of the digits: 1.1 and 1.2 % in the
  median. The worst are 15 % on the palm side of the thumb's first bone, where the tissue is thin and the
  default's own edges are shorter than 3.6 mm, and 5.2 % on a digit. `accuracy.body_error` covers 35 of the
  40: 3.2 times the difference on the palm and 7.4 times on the digits, in the median; in the middle of the
  palm it says 1.5 % of 2.9.

Definiteness, by eigenvalues of the symmetric part. The half-space's Galerkin matrix is positive definite on
any surface. A layer's collocation matrix on flat meshes was so from 0.1 to 100 mesh sizes of thickness,
borders included, but for meshes of over 1,000 irregular nodes (vertices moved by 0.3 cells) under an
incompressible layer of a tenth of a cell: -3e-5 of the largest eigenvalue, where Galerkin's is definite.
Where the surface bends within the layer's reach neither has to be: 800 nodes around a fingertip under 1 mm,
nu = 0.5, have -0.1 % (collocation) and -0.3 % (Galerkin). Galerkin assembly costs 9 to 12 times
collocation's, 10 to 20 times for a layer, up to 60 times for one thinner than the mesh.

A body in Galerkin form, `Body(discretization="galerkin")`, averages its near kernel; what is left of it is
smooth and stays at the nodes. On the sphere with a core of docs/validation.md, uniform and turned at
random, target error 0.005, four depths, nu = 0.3 and 0.495, the worst force is 1.2 % off under a plate and
1.5 % under a ball of 15 mm with 642 vertices, 2.6 and 2.1 % with 162; by collocation 1.3 and 1.4, 2.6 and
2.2 %. On two real fingers a press takes 3 to 8 times as long.
"""


def responses(tissue: float) -> dict[str, qr.Response]:
    """Return the kernels; `tissue` in m."""
    return {
        "half-space": qr.HalfSpace(),
        "Gaussian, balanced": qr.GaussianCorrected.balanced(width=WIDTH, cutoff=CUTOFF),
        "Gaussian, as printed": qr.GaussianCorrected(height=0.8e-3, width=5e-3, cutoff=15e-3),
        "layer": qr.Layer(thickness=tissue),
    }


WIDTH, CUTOFF = 8e-3, 15e-3


def main(with_times: bool) -> None:
    """Measure, print, write."""
    finger = qr.models.fingertip(edge_length=EDGE_LENGTH)
    finger = finger.with_skin_mask(qr.skin_without_caps(finger))
    bone = qr.models.bone_of(finger)
    lowest = finger.vertices[np.argmin(finger.vertices[:, 2])]
    tissue = round(float(qr.Obstacle.mesh(bone.vertices, bone.faces).signed_distance([lowest])[0][0]), 4)
    plate = qr.Obstacle.half_space([0, 0, -0.05], UP)
    may_touch = finger.skin_mask & (finger.vertices[:, 2] < lowest[2] + 1.5 * DEPTHS[-1] + 2 * EDGE_LENGTH)
    nodes = np.flatnonzero(may_touch)

    started = time.perf_counter()
    body = qr.Skin(
        shear_modulus=SHEAR_MODULUS,
        poisson_ratio=POISSON_RATIO,
        response=qr.Body(bone=bone, fixed=~finger.skin_mask),
    ).prepared(finger, nodes)
    setups = {"body": time.perf_counter() - started}
    skins: dict[str, qr.Skin | qr.PreparedSkin] = {}
    for name, response in responses(tissue).items():
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", qr.QuasirigidWarning)
            skins[name] = qr.Skin(shear_modulus=SHEAR_MODULUS, poisson_ratio=POISSON_RATIO, response=response)
        setups[name] = 0.0
    skins["body"] = body
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", qr.CutWarning)
        truth = [qr.press(finger, plate, body, UP, depth=depth).force[2] for depth in DEPTHS]

    rows = []
    for name, skin in skins.items():
        cells = []
        for depth, true in zip(DEPTHS, truth, strict=True):
            seconds = []
            for _ in range(REPEATS):
                started = time.perf_counter()
                with warnings.catch_warnings():
                    warnings.simplefilter("ignore", qr.QuasirigidWarning)
                    contact = qr.press(finger, plate, skin, UP, depth=depth, throw=False)
                seconds.append(time.perf_counter() - started)
            cost = f", {statistics.median(seconds) * 1e3:.1f} ms" if with_times else ""
            if contact.status != "solved":
                cells.append(f"ends: {contact.status.value}{cost}")
                continue
            force = contact.force[2]
            off = "" if name == "body" else f" ({force / true - 1:+.0%})"
            area = contact.contact_area * 1e6
            at_cut = "†" if any(one.category is qr.CutWarning for one in contact.warnings) else ""
            cells.append(f"{force:.3f} N{at_cut}{off}, {area:.1f} mm²{cost}")
        setup = f"{setups[name]:.1f}" if with_times and name == "body" else "-"
        rows.append(f"| {name} | {setup} | " + " | ".join(cells) + " |")
        print(rows[-1], flush=True)
    page = PAGE.format(
        skin_count=f"{len(finger.vertices):,}",
        edge=EDGE_LENGTH * 1e3,
        bone_count=len(bone.vertices),
        node_count=len(nodes),
        tissue=tissue * 1e3,
        times=f"times are wall times of the machine that ran it, the press a median of {REPEATS}"
        if with_times
        else "without `--no-times` it measures the seconds too",
        heads=" | ".join(f"{depth * 1e3:g} mm deep" for depth in DEPTHS),
        dashes="|".join("---" for _ in DEPTHS),
        rows="\n".join(rows),
        width=WIDTH * 1e3,
        cutoff=CUTOFF * 1e3,
    )
    target = Path(__file__).parents[1] / "responses.md"
    target.write_text(page, encoding="utf-8")
    print(f"wrote {target}", file=sys.stderr)


if __name__ == "__main__":
    main("--no-times" not in sys.argv[1:])
