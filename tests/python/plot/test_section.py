"""The cut through a contact: how much of it is shown, and from where."""

from __future__ import annotations

import numpy as np
import pytest
import quasirigid as qr
from quasirigid import plot
from shapes import SKIN

pytest.importorskip("matplotlib")

# Of steep sides.
pytestmark = pytest.mark.filterwarnings("ignore::quasirigid.QuasirigidWarning")

UP = [0.0, 0.0, 1.0]


def test_a_needle_is_seen_from_where_it_comes(fingertip: qr.Surface) -> None:
    needle = qr.Obstacle.capsule([0.0, 0.02, -0.06], [0.0, 0.02, -0.03], 3e-4)
    contact = qr.press(fingertip, needle, SKIN, UP, depth=1e-3)
    # Its tip went between the vertices: what is left stands on its flank and pushes aside.
    assert abs(contact.force[2]) < 0.5 * np.linalg.norm(contact.force)
    assert plot.pad_view(contact).toward == pytest.approx([0.0, 0.0, -1.0])
    # The cut goes through the needle: its outline is that of 0.6 mm.
    ax = plot.plot_section(contact)
    outline = np.concatenate([line.vertices for line in ax.collections[1].get_paths()])
    assert 0.4 < np.ptp(outline[:, 0]) <= 0.61
