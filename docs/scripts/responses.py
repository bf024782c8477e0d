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

What no script measures again is in [measured_once.md](measured_once.md): whole hands, definiteness, bodies in
Galerkin form.
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
