"""What worker processes do: functions that a child can import, which those of test files are not."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import quasirigid as qr
from numpy.typing import NDArray
from quasirigid import _core
from shapes import SKIN

PLATE = qr.Obstacle.half_space([0, 0, -0.05], [0, 0, 1])


def tip() -> qr.Surface:
    return qr.models.fingertip(edge_length=1.6e-3)


def forces(depth: float) -> NDArray[np.float64]:
    """Everything that works on several threads: mesh, product, response, contact, complementarity."""
    surface = tip().moved(np.eye(3), [0.0, 0.0, 1e-3])
    box = qr.models.rounded_box(size=(0.04, 0.04, 0.02)).moved(np.eye(3), [0, 0, -0.05])
    distance = box.signed_distance(surface.vertices)[0]
    contact = qr.press(surface, PLATE, SKIN, [0, 0, 1], depth=depth)
    matrix = qr.response_matrix(surface, SKIN, np.arange(200))
    assert not len(_core.find_crossings(surface.vertices, surface.faces))
    solution = qr.solve_lcp(matrix, -1e-4 * np.ones(200), method="auto")
    return np.concatenate([distance, contact.force, contact.center_of_pressure, solution.z])


def saved_forces(path: Path) -> NDArray[np.float64]:
    return qr.press(tip(), PLATE, qr.load_prepared(path), [0, 0, 1], depth=1e-3).force


def press_in_place(job: tuple[qr.Surface, qr.Obstacle, qr.Skin, qr.ContactOptions]) -> qr.Contact:
    surface, obstacle, skin, options = job
    return qr.solve_contact(surface, obstacle, skin, options=options)
