"""The drawn skin: computed when somebody asks, once, and then alone."""

from __future__ import annotations

import _thread
import copy
import pickle
import sys
import threading
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
import quasirigid as qr
from quasirigid import _core
from shapes import PLATE, SKIN, ball, grid


@pytest.fixture
def contact() -> qr.Contact:
    return qr.press(qr.Surface(*ball(8e-3, 3)), PLATE, SKIN, [0, 0, 1], depth=0.5e-3)


def is_drawn(contact: qr.Contact) -> bool:
    return not isinstance(contact._drawing._source, _core.Drawing)


def test_nothing_is_drawn_before_somebody_asks(contact: qr.Contact) -> None:
    assert contact.force[2] > 0
    assert contact.max_pressure == contact.pressure.max()
    assert repr(contact).startswith("Contact(solved: force ")
    assert not is_drawn(contact)
    assert "drawn" not in contact.timings
    assert contact.deformed is contact.deformed
    assert is_drawn(contact)


@pytest.mark.parametrize("name", ["displacement", "fade_distance", "volume_change", "deformed"])
def test_each_of_the_four_draws(name: str, contact: qr.Contact) -> None:
    assert not is_drawn(contact)
    getattr(contact, name)
    assert is_drawn(contact)


def test_the_deformed_skin_is_the_surface_moved_by_the_displacement(contact: qr.Contact) -> None:
    moved = contact.surface.vertices + contact.displacement
    np.testing.assert_array_equal(contact.deformed.vertices, moved)
    assert contact.volume_change < 0
    assert 0 < contact.fade_distance < np.inf


@pytest.mark.parametrize("again", [lambda thing: pickle.loads(pickle.dumps(thing)), copy.deepcopy])
def test_a_copy_is_drawn_and_as_frozen_as_the_original(again: object, contact: qr.Contact) -> None:
    copied = again(contact)  # type: ignore[operator]
    assert is_drawn(copied)
    np.testing.assert_array_equal(copied.displacement, contact.displacement)
    assert copied.volume_change == contact.volume_change
    for one in (contact, copied):
        for array in (one.pressure, one.force, one.displacement, one.patches[0].vertices):
            with pytest.raises(ValueError, match="read-only"):
                array[0] = 1
        with pytest.raises(TypeError, match="read-only"):
            one.timings["lcp"] = 0.0


def test_threads_that_ask_at_once_get_the_same_skin(contact: qr.Contact) -> None:
    start = threading.Barrier(4)

    def ask(_: int) -> qr.Surface:
        start.wait()
        return contact.deformed

    with ThreadPoolExecutor(4) as pool:
        first, *others = pool.map(ask, range(4))
    assert all(other is first for other in others)


@pytest.mark.parametrize("threads", [None, 1])
def test_ctrl_c_ends_the_drawing_and_it_can_be_asked_for_again(threads: int | None) -> None:
    surface = qr.Surface(*grid(160, 0.3e-3))
    sphere = qr.Obstacle.sphere([0, 0, 21e-3], 20e-3)
    options = qr.ContactOptions(num_threads=threads)
    contact = qr.press(surface, sphere, SKIN, [0, 0, -1], depth=1e-3, options=options)
    # Drawing takes ten times as long.
    timer = threading.Timer(0.03, _thread.interrupt_main)
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        _ = contact.deformed
    timer.join()
    assert not is_drawn(contact)
    assert contact.deformed.vertices.shape == contact.surface.vertices.shape


def test_the_picture_is_equal_to_the_bit_for_any_number_of_threads() -> None:
    surface = qr.Surface(*ball(8e-3, 3))
    one, two = (
        qr.press(surface, PLATE, SKIN, [0, 0, 1], depth=0.5e-3, options=qr.ContactOptions(num_threads=count))
        for count in (1, 2)
    )
    np.testing.assert_array_equal(one.displacement, two.displacement)


def test_no_matrix_is_kept_beyond_what_drawing_needs() -> None:
    surface = qr.Surface(*ball(8e-3, 2))
    core = qr.Surface(*(part if i else 0.3 * part + [0, 0, 5.6e-3] for i, part in enumerate(ball(8e-3, 1))))
    body = qr.Skin(shear_modulus=60e3, poisson_ratio=0.5, response=qr.Body(bone=core))
    for skin, kept in ((SKIN, 0), (body, 1)):
        prepared = skin.prepared(surface)
        counts = [sys.getrefcount(prepared._response)]
        contact = qr.press(surface, PLATE, prepared, [0, 0, 1], depth=0.4e-3)
        # A kernel draws without the matrix over all nodes; a body's compliance is let go once it is drawn.
        counts.append(sys.getrefcount(prepared._response))
        assert contact.deformed.is_closed
        counts.append(sys.getrefcount(prepared._response))
        assert np.diff(counts).tolist() == [kept, -kept]


def test_a_contact_without_forces_moves_nothing(unsolved: qr.Contact, apart: qr.Contact) -> None:
    for contact in (unsolved, apart):
        assert not contact.displacement.any()
        assert contact.volume_change == contact.fade_distance == 0.0
        np.testing.assert_array_equal(contact.deformed.vertices, contact.surface.vertices)
