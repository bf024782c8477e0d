"""Write docs/hand.md and its pictures: the built-in hand, regions of a skin, what bent digits keep.

Needs the hands of the folder `QUASIRIGID_DATA`.
"""

from __future__ import annotations

import math
import os
import sys
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path

import matplotlib
import numpy as np
import quasirigid as qr
from numpy.typing import NDArray
from quasirigid.hand.pose import bend_at_rest
from quasirigid.hand.regions import digit_of_vertices
from quasirigid.hand.rig.joints import DIGITS, JOINTS_OF
from quasirigid.plot.shading import lit_skin
from quasirigid.plot.view import View

matplotlib.use("Agg")
import matplotlib.pyplot as plt

DATA = Path(os.environ.get("QUASIRIGID_DATA", Path(__file__).parents[2] / "../shared/data"))
RIGS = ("libhand", "makehuman_male", "webxr")
SIZES = ("13k", "53k")
HEIGHT = 420  # pixels of each picture
MARGIN = 4e-3  # around each hand (m)
REPEATS = 10

PAGE = """# Hands

Written by `python docs/scripts/hand.py`, which needs the test meshes (`QUASIRIGID_DATA`). A hand is a closed
skin, joints with WebXR's names, and by which joints each vertex is moved: built in, from arrays, from GLB, or
from a mesh with its rig.

## The built-in hand

![The built-in hand: palm, back, aslant, posed as on a cylinder and as a fist](hand.png)

`qr.models.hand(edge_length=1.4e-3)`.

## Regions

![Regions of the MakeHuman hand from the palm, the back and aslant](hand_regions.png)

`hand.labels` of a scanned hand (MakeHuman, CC0; 53,000 vertices), one color each, and its joints as dots.
Phalanges end in the plane through a joint that halves its bend. `qr.plot.hand_figure(posed, regions=True)`
draws this for any hand.

- `<digit>-<segment>-<side>`: digits thumb, index, middle, ring, little; segments proximal, middle (not the
  thumb's), distal; sides palmar, dorsal, radial, ulnar.
- `<finger>-metacarpal-head`: the pad under the knuckle of index, middle, ring, little.
- `web-thumb-index`, `web-index-middle`, `web-middle-ring`, `web-ring-little`: the skin between two digits.
- `palm-center`, `thenar`, `hypothenar`, `back`, `wrist`.

## Bent digits

{bent}

Change of volume where joints are bent to 90 degrees from straight and all others are at rest: as dual
quaternions (the default), then as blended matrices (`linear=True`), under which bent joints collapse. The
volume is that below the triangles of the digit's regions, closed by a fan; "all" are the knuckle and the
hinges.

- Rigs have the joints of digits at any depth below the back, where a bend gains or loses volume. Here they
  turn at the depth at which a right angle keeps it (`hand.pivot_of`).
- Weights that change over a short way turn skin over in the crease of a joint. There, and nowhere else, they
  change as slowly as they must: at a distance y from the axis the angle grows along the digit by less than
  1/y. `hand.weights` are the file's.
- Pivots hang on the mesh a little: with each triangle split into four, the same skin comes to lie up to
  0.04 to 1.4 mm elsewhere in "relaxed" and 0.5 to 4.4 mm in "fist", by the rig (13,000 vertices at most 0.5
  and 1.0 mm); that of a saved contact by up to 0.2 mm.

## Times

{times}

Least of {repeats} runs on {cores} cores, but for the first pose of a hand, which finds regions, pivots and
creases once.
"""


def draw_built_in(target: Path) -> None:
    """Build, pose, draw."""
    hand = qr.models.hand(edge_length=1.4e-3)
    up = np.array([0.0, 1.0, 0.0])
    shown = [
        ("palm", hand.surface, (0.0, 0.0, 1.0)),
        ("back", hand.surface, (0.0, 0.0, -1.0)),
        ("aslant", hand.surface, (0.55, -0.25, 1.0)),
        ('posed("cylinder")', hand.posed("cylinder").surface, (0.75, -0.2, 0.8)),
        ('posed("fist")', hand.posed("fist").surface, (0.5, -0.3, 1.0)),
    ]
    views = [View.along(np.array(sight), up) for _, _, sight in shown]
    places = [view.project(skin.vertices) for view, (_, skin, _) in zip(views, shown, strict=True)]
    low = min(place[:, 1].min() for place in places) - MARGIN
    high = max(place[:, 1].max() for place in places) + MARGIN
    windows = [(place[:, 0].min() - MARGIN, place[:, 0].max() + MARGIN, low, high) for place in places]
    widths = [window[1] - window[0] for window in windows]
    inches = 4.2 / (high - low)
    figure, axes = plt.subplots(
        1, len(shown), figsize=(inches * sum(widths), 4.4), width_ratios=widths, layout="constrained"
    )
    for ax, (title, skin, _), view, window in zip(axes, shown, views, windows, strict=True):
        nothing = np.zeros(len(skin.vertices))
        picture = lit_skin(skin.vertices, skin.faces, view, nothing, nothing, plt.cm.viridis, window, HEIGHT)
        ax.imshow(picture)
        ax.set_title(title, fontsize=9)
        ax.axis("off")
    figure.savefig(target, dpi=100)


def bends_of(digit: str) -> dict[str, tuple[str, ...]]:
    """Return the joints of a digit that bend together, by what they are called."""
    knuckle, *hinges = JOINTS_OF[digit][1:-1]
    titles = ("last hinge",) if digit == "thumb" else ("first hinge", "last hinge")
    single = {title: (joint,) for title, joint in zip(titles, hinges, strict=True)}
    return {"knuckle": (knuckle,)} | single | {"all": (knuckle, *hinges)}


def volume_of(skin: qr.Surface, faces: NDArray[np.int64]) -> float:
    """Return the volume (m³) between some faces and the fan that closes their border."""
    sides = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]).tolist()
    known = {(a, b) for a, b in sides}
    border = np.unique([b for a, b in sides if (b, a) not in known])
    # The fan's own cones have no height above its middle.
    return float(np.linalg.det(skin.vertices[faces] - skin.vertices[border].mean(axis=0)).sum() / 6.0)


def bent_digits(hands: dict[str, qr.Hand]) -> str:
    """Return the table of volumes of bent digits, of each rig."""
    titles = ("knuckle", "first hinge", "last hinge", "all")
    lines = ["| hand | digit | " + " | ".join(titles) + " |", "|---|---|" + "---|" * len(titles)]
    for name, hand in hands.items():
        for digit in DIGITS:
            own = digit_of_vertices(hand.labels) == digit
            faces = hand.surface.faces[own[hand.surface.faces].all(axis=1)]
            at_rest = volume_of(hand.surface, faces)
            cells = dict.fromkeys(titles, "")
            for bend, joints in bends_of(digit).items():
                at = [hand.joint_names.index(joint) for joint in joints]
                vectors = np.zeros((len(hand.joint_names), 3))
                vectors[at, 0] = bend_at_rest(hand)[at] - math.pi / 2
                dual, linear = (
                    volume_of(hand.posed(vectors, linear=linear).surface, faces) / at_rest - 1.0
                    for linear in (False, True)
                )
                cells[bend] = f"{dual:+.1%} / {linear:+.1%}"
            lines.append(f"| {name} | {digit} | " + " | ".join(cells.values()) + " |")
    return "\n".join(lines)


def least(run: Callable[[], object]) -> float:
    """Return the least seconds of some runs, after one."""
    run()
    seconds = []
    for _ in range(REPEATS):
        start = time.perf_counter()
        run()
        seconds.append(time.perf_counter() - start)
    return min(seconds)


def fist(hand: qr.Hand) -> qr.Surface:
    """Return the skin of a hand that makes a fist."""
    return hand.posed("fist").surface


def times(size: str) -> list[str]:
    """Return rows of the table of times, of the rigs of a size."""
    rows = []
    for rig in RIGS:
        hand = qr.read_hand(DATA / f"hands/{rig}_right_{size}.ply")
        start = time.perf_counter()
        hand.posed("fist")
        first = time.perf_counter() - start
        pose = least(partial(fist, hand))
        rows.append(f"| {rig} | {len(hand.surface.vertices)} | {first:.2f} s | {pose * 1e3:.1f} ms |")
    return rows


def main() -> None:
    """Draw, measure, write."""
    paths = {rig: DATA / f"hands/{rig}_right_13k.ply" for rig in RIGS}
    missing = [str(path) for path in paths.values() if not path.is_file()]
    if missing:
        sys.exit("missing: " + ", ".join(missing) + "; QUASIRIGID_DATA names the folder of meshes")
    docs = Path(__file__).parents[1]
    draw_built_in(docs / "hand.png")
    scanned = qr.read_hand(DATA / "hands/makehuman_male_right_53k.ply")
    qr.plot.hand_figure(scanned.posed({}), regions=True).savefig(docs / "hand_regions.png", dpi=100)
    hands = {"built in": qr.models.hand()} | {rig: qr.read_hand(path) for rig, path in paths.items()}
    rows = [row for size in SIZES for row in times(size)]
    page = PAGE.format(
        bent=bent_digits(hands),
        times="\n".join(["| hand | vertices | first | pose |", "|---|---|---|---|", *rows]),
        repeats=REPEATS,
        cores=os.cpu_count(),
    )
    target = docs / "hand.md"
    target.write_text(page, encoding="utf-8")
    print(f"wrote {target}", file=sys.stderr)


if __name__ == "__main__":
    main()
