"""The skin as Python sees it."""

from __future__ import annotations

import pickle

import numpy as np
import pytest
import quasirigid as qr
from quasirigid import _core
from shapes import grid, tetrahedron


def test_a_tetrahedron_has_its_textbook_figures() -> None:
    surface = qr.Surface(*tetrahedron())
    assert surface.is_closed
    assert surface.volume == pytest.approx(1 / 6, rel=1e-14)
    assert surface.area == pytest.approx(1.5 + 3**0.5 / 2, rel=1e-14)
    assert surface.vertex_areas.sum() == pytest.approx(surface.area, rel=1e-14)
    assert surface.mean_edge_length == pytest.approx((3 + 3 * 2**0.5) / 6, rel=1e-14)
    np.testing.assert_allclose(np.linalg.norm(surface.vertex_normals, axis=1), 1, rtol=1e-14)


def test_an_open_surface_has_no_volume() -> None:
    surface = qr.Surface(*grid(3, 1e-3))
    assert not surface.is_closed
    assert np.isnan(surface.volume)


def test_arrays_are_shared_and_read_only() -> None:
    surface = qr.Surface(*tetrahedron())
    assert surface.vertices is surface.vertices
    with pytest.raises(ValueError, match="read-only"):
        surface.vertices[0, 0] = 1.0


@pytest.mark.parametrize("dtype", [np.float32, np.float64, np.int32])
@pytest.mark.parametrize("index_type", [np.int32, np.uint32, np.int64])
def test_any_number_type_and_any_memory_order_will_do(dtype: type, index_type: type) -> None:
    vertices, faces = tetrahedron()
    surface = qr.Surface(np.asfortranarray(vertices.astype(dtype)), faces.astype(index_type))
    np.testing.assert_array_equal(surface.vertices, vertices)
    np.testing.assert_array_equal(surface.faces, faces)


def test_malformed_arrays_are_named() -> None:
    vertices, faces = tetrahedron()
    with pytest.raises(ValueError, match=r"`vertices` has shape \(4, 2\), expected \(n, 3\)"):
        qr.Surface(vertices[:, :2], faces)
    with pytest.raises(TypeError, match="`faces` has dtype float64, expected integers"):
        qr.Surface(vertices, faces.astype(float))
    with pytest.raises(TypeError, match="`vertices` has dtype"):
        qr.Surface(vertices.astype(complex), faces)
    with pytest.raises(qr.SurfaceError, match=r"face 1 refers to vertex -1"):
        qr.Surface(vertices, [[0, 2, 1], [0, -1, 3]])
    with pytest.raises(qr.SurfaceError, match="skin mask has 3 entries"):
        qr.Surface(vertices, faces, [True, True, False])
    with pytest.raises(TypeError, match="booleans"):
        qr.Surface(vertices, faces, [1, 1, 0, 1])


def test_an_error_is_both_ours_and_a_value_error() -> None:
    vertices, faces = tetrahedron()
    vertices[2, 1] = np.nan
    with pytest.raises(ValueError, match="vertex 2") as caught:
        qr.Surface(vertices, faces)
    assert isinstance(caught.value, qr.QuasirigidError)


def test_neighbourhoods_and_patches() -> None:
    surface = qr.Surface(*grid(10, 1e-3))
    middle = 60
    ring = surface.k_ring([middle], 1)
    assert middle in ring
    assert set(ring) <= {middle + i + 11 * j for i in (-1, 0, 1) for j in (-1, 0, 1)}
    patches = surface.patches([0, 1, 119, 120])
    assert [patch.tolist() for patch in patches] == [[0, 1], [119, 120]]
    with pytest.raises(qr.SurfaceError, match=r"`nodes\[1\]` is 121"):
        surface.k_ring([0, 121], 1)
    with pytest.raises(qr.SurfaceError, match=r"`nodes\[0\]` is -1"):
        surface.patches([-1])
    with pytest.raises(qr.SurfaceError, match=r"`nodes` has shape \(1, 1\)"):
        surface.patches([[0]])
    for rings, range_of in ((-1, "at least 0"), (2**70, "at most")):
        with pytest.raises(qr.SurfaceError, match=f"rings is {rings}, expected an integer of {range_of}"):
            surface.k_ring([middle], rings)
    with pytest.raises(TypeError, match=r"rings is 0\.5, expected an integer"):
        surface.k_ring([middle], 0.5)  # type: ignore[arg-type]


def test_a_rigid_motion_keeps_volume_and_mask() -> None:
    surface = qr.Surface(*tetrahedron(), [True, False, True, True])
    moved = surface.moved([[0, -1, 0], [1, 0, 0], [0, 0, 1]], [1, 2, 3])
    np.testing.assert_allclose(moved.vertices[1], [1, 3, 3], atol=1e-15)
    assert moved.volume == pytest.approx(surface.volume, rel=1e-12)
    assert moved.skin_mask.tolist() == [True, False, True, True]
    with pytest.raises(qr.SurfaceError, match="reflection"):
        surface.moved(np.diag([1.0, 1.0, -1.0]), [0, 0, 0])


def test_a_surface_survives_pickling() -> None:
    surface = qr.Surface(*tetrahedron(), [True, False, True, True])
    again = pickle.loads(pickle.dumps(surface))
    np.testing.assert_array_equal(again.vertices, surface.vertices)
    np.testing.assert_array_equal(again.skin_mask, surface.skin_mask)


def test_repair_welds_and_says_so() -> None:
    vertices, faces = tetrahedron()
    loose = vertices[faces.ravel()]
    fixed = qr.repair(loose, np.arange(12).reshape(4, 3), weld_tolerance=1e-9)
    assert qr.Surface(fixed.vertices, fixed.faces).is_closed
    assert fixed.report["welded_vertices"] == 8
    np.testing.assert_array_equal(fixed.vertices[fixed.vertex_map], loose)


def test_a_flat_cut_is_no_skin() -> None:
    tip = qr.models.fingertip()
    mask = qr.skin_without_caps(tip)
    at_cut = np.isclose(tip.vertices[:, 1], tip.vertices[:, 1].min(), atol=1e-9)
    assert not mask[at_cut].any()
    assert mask[~at_cut].all()


def test_crossings_of_what_is_no_place_are_refused() -> None:
    vertices, faces = tetrahedron()
    for value in (1e61, 1e200, np.inf, np.nan):
        vertices[2, 1] = value
        with pytest.raises(qr.SurfaceError, match=r"vertex 2 is at .* expected finite coordinates"):
            _core.find_crossings(vertices, faces)
