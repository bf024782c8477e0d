"""Local response matrices."""

import numpy as np
import pytest
import quasirigid as qr


@pytest.fixture(scope="module")
def finger() -> qr.Surface:
    return qr.models.fingertip(edge_length=1.2e-3)


@pytest.fixture(scope="module")
def thin() -> qr.Skin:
    return qr.Skin(shear_modulus=60e3, poisson_ratio=0.45, response=qr.Layer(0.5e-3))


def test_products_are_within_the_threshold_of_the_dense_matrix(finger: qr.Surface, thin: qr.Skin) -> None:
    nodes = np.flatnonzero(finger.skin_mask)
    matrix = qr.local_response_matrix(finger, thin, threshold=1e-3)
    dense = qr.response_matrix(finger, thin, nodes)
    norm = np.linalg.norm(dense, 2)
    assert matrix.shape == dense.shape
    np.testing.assert_array_equal(matrix.nodes, nodes)
    assert np.linalg.norm(matrix.to_dense() - dense, 2) <= 1e-3 * norm
    forces = np.sin(np.arange(2.0 * len(nodes))).reshape(-1, 2)
    scale = 1e-12 * norm * np.linalg.norm(forces)
    np.testing.assert_allclose(matrix @ forces, matrix.to_dense() @ forces, atol=scale)
    back = matrix.to_dense().T @ forces[:, 0]
    np.testing.assert_allclose(matrix.apply_transposed(forces[:, 0]), back, atol=scale)
    np.testing.assert_array_equal(matrix.diagonal(), np.diag(matrix.to_dense()))


def test_it_says_what_it_takes(finger: qr.Surface, thin: qr.Skin) -> None:
    matrix = qr.local_response_matrix(finger, thin, threshold=1e-2)
    assert 0.0 < matrix.density < 0.5
    assert matrix.stored_entries == round(matrix.density * matrix.shape[0] ** 2)
    assert matrix.nbytes >= 8 * matrix.stored_entries
    assert matrix.threshold == 1e-2
    assert [len(group) for group in matrix.groups] == [len(matrix.nodes)]
    assert not matrix.nodes.flags.writeable


def test_threads_change_no_bit(finger: qr.Surface, thin: qr.Skin) -> None:
    one = qr.local_response_matrix(finger, thin, num_threads=1).to_dense()
    two = qr.local_response_matrix(finger, thin, num_threads=2).to_dense()
    np.testing.assert_array_equal(one, two)


def test_definiteness_is_told_with_advice(finger: qr.Surface, thin: qr.Skin) -> None:
    found = qr.local_response_matrix(finger, thin, threshold=1e-6).definiteness()
    assert found.positive_definite
    assert found.decided
    assert found.advice is None
    assert found.condition == found.largest / found.smallest
    response = qr.GaussianCorrected(height=0.8e-3, width=5e-3, cutoff=15e-3)
    with pytest.warns(qr.QuasirigidWarning):
        paper = qr.Skin(shear_modulus=60e3, poisson_ratio=0.5, response=response)
    found = qr.local_response_matrix(finger, paper, threshold=1e-4).definiteness()
    assert not found.positive_definite
    assert found.decided
    assert found.advice is not None
    assert "height" in found.advice


def test_malformed_requests_are_refused(finger: qr.Surface, thin: qr.Skin) -> None:
    plain = qr.Skin(shear_modulus=60e3, poisson_ratio=0.5, response=qr.HalfSpace())
    with pytest.raises(qr.ResponseError, match="half-space kernel is felt at any distance"):
        qr.local_response_matrix(finger, plain)
    body = qr.Skin(shear_modulus=60e3, poisson_ratio=0.5, response=qr.Body(fixed=finger.skin_mask))
    with pytest.raises(qr.ResponseError, match=r"Body is no kernel: .* Layer or GaussianCorrected"):
        qr.local_response_matrix(finger, body)
    with pytest.raises(qr.ResponseError, match="threshold is"):
        qr.local_response_matrix(finger, thin, threshold=0.0)
    with pytest.raises(qr.ResponseError, match="memory_limit = 1000"):
        qr.local_response_matrix(finger, thin, memory_limit=1000)
    matrix = qr.local_response_matrix(finger, thin, nodes=[3, 4, 5])
    with pytest.raises(ValueError, match="2 entries, expected 3"):
        matrix.apply([1.0, 2.0])
    with pytest.raises(ValueError, match=r"expected \(k,\) or \(k, m\)"):
        matrix.apply(np.zeros((3, 1, 1)))
    for columns in (0, 1):
        with pytest.raises(ValueError, match="2 entries, expected 3"):
            matrix @ np.ones((2, columns))
    assert (matrix @ np.ones((3, 0))).shape == (3, 0)
    with pytest.raises(TypeError, match="unsupported operand"):
        np.ones(3) @ matrix


@pytest.mark.parametrize("option", ["num_threads", "memory_limit"])
def test_a_negative_or_broken_count_is_refused_by_name(
    option: str, finger: qr.Surface, thin: qr.Skin
) -> None:
    with pytest.raises(qr.ResponseError, match=f"{option} is -5, expected a number above 0"):
        qr.local_response_matrix(finger, thin, **{option: -5})  # type: ignore[arg-type]
    with pytest.raises(TypeError, match=f"{option} is 1.5, expected a whole number"):
        qr.local_response_matrix(finger, thin, **{option: 1.5})  # type: ignore[arg-type]
    with pytest.raises(qr.ResponseError, match="num_threads is -1"):
        qr.response_matrix(finger, thin, [0], num_threads=-1)
