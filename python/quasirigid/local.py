"""Response matrices of kernels that fade, stored in blocks."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, ClassVar, final

import numpy as np

from . import _core
from .checks import count_of
from .errors import ResponseError
from .matrix import kernel_of

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import ArrayLike, NDArray

    from .skin import Skin
    from .surface import Surface

__all__ = ["LocalDefiniteness", "LocalResponseMatrix", "local_response_matrix"]


@dataclass(frozen=True, kw_only=True)
class LocalDefiniteness:
    """What is known of the symmetric part ``(R + R') / 2`` of a local response matrix.

    Attributes
    ----------
    positive_definite : bool
        Whether the smallest eigenvalue found is above `margin`, so that the exact matrix has none below zero
        either.
    decided : bool
        Whether the smallest eigenvalue is farther from 0 than `margin`; if not, a smaller threshold may
        tell.
    smallest, largest : float
        Extreme eigenvalues of the stored matrix (m/N), from 100 Lanczos steps. One found below zero is
        there; that none is smaller is an estimate.
    condition : float
        largest / smallest; inf unless both are positive.
    margin : float
        What `smallest` may be off by (m/N): threshold times `largest`, and the residual of the steps.
    advice : str or None
        What to change where the matrix is not positive definite or that is left open.
    """

    positive_definite: bool
    decided: bool
    smallest: float
    largest: float
    condition: float
    margin: float
    advice: str | None


@final
@dataclass(frozen=True, kw_only=True, eq=False)
class LocalResponseMatrix:
    """Response matrix R (k, k) of a kernel that fades, for products ``R @ f``.

    Made by `local_response_matrix`. Blocks of nodes that are close are stored entry by entry, others as
    sums of a few products of vectors, and nothing where the kernel has faded or where two nodes lie on
    different fingers.

    Attributes
    ----------
    nodes : (k,) int64
        Vertices, in the order of rows and columns; read-only.
    threshold : float
        Largest error of a product: ``|R' f - R f| <= threshold |R| |f|`` in Euclidean norms, R' the stored
        matrix.
    """

    nodes: NDArray[np.int64]
    threshold: float
    _matrix: _core.LocalMatrix = field(repr=False)

    # NumPy leaves an operator with an array on its left to this class, which has none for it.
    __array_ufunc__: ClassVar[None] = None

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns, both the number of nodes."""
        return self._matrix.order, self._matrix.order

    @property
    def nbytes(self) -> int:
        """Memory that the matrix takes (bytes)."""
        return self._matrix.nbytes

    @property
    def stored_entries(self) -> int:
        """Number of stored values."""
        return self._matrix.entries

    @property
    def density(self) -> float:
        """Stored values over those of the dense matrix; nan without nodes."""
        order = self._matrix.order
        return self._matrix.entries / order**2 if order else float("nan")

    @property
    def groups(self) -> list[NDArray[np.int64]]:
        """Positions in `nodes` that are coupled, group by group: separate contact problems."""
        return self._matrix.groups()

    def apply(self, forces: ArrayLike) -> NDArray[np.float64]:
        """Give the displacement ``R @ forces``.

        Parameters
        ----------
        forces : (k,) or (k, m) array_like
            Node forces (N).

        Returns
        -------
        float64 array of the same shape
            Displacements (m), equal to the bit for any number of threads.

        Raises
        ------
        ValueError
            If the number of forces is not that of the nodes.
        """
        return _columns(self._matrix.apply, forces, len(self.nodes))

    def apply_transposed(self, forces: ArrayLike) -> NDArray[np.float64]:
        """Give ``R.T @ forces``, as `apply` does for R."""
        return _columns(self._matrix.apply_transposed, forces, len(self.nodes))

    def __matmul__(self, forces: ArrayLike) -> NDArray[np.float64]:
        return self.apply(forces)

    def to_dense(self) -> NDArray[np.float64]:
        """Give the (k, k) matrix (m/N), with zeros where nothing is stored."""
        return self._matrix.to_dense()

    def diagonal(self) -> NDArray[np.float64]:
        """Give the (k,) diagonal (m/N)."""
        return self._matrix.diagonal()

    def definiteness(self) -> LocalDefiniteness:
        """Examine the symmetric part by 100 Lanczos steps, each with R and its transpose."""
        return LocalDefiniteness(**self._matrix.definiteness())


def _columns(
    product: Callable[[ArrayLike], NDArray[np.float64]], forces: ArrayLike, order: int
) -> NDArray[np.float64]:
    """Multiply one vector, or each column of an array."""
    values = np.asarray(forces)
    if values.ndim < 2:
        return product(values)
    if values.ndim > 2:
        raise ValueError(f"forces has shape {values.shape}, expected (k,) or (k, m)")
    if len(values) != order:
        raise ValueError(f"forces has {len(values)} entries, expected {order}, one per node")
    found = np.empty(values.shape, dtype=np.float64)
    for column in range(values.shape[1]):
        found[:, column] = product(values[:, column])
    return found


def local_response_matrix(
    surface: Surface,
    skin: Skin,
    nodes: ArrayLike | None = None,
    *,
    threshold: float = 1e-3,
    tolerance: float | None = None,
    num_threads: int | None = None,
    memory_limit: int | None = None,
) -> LocalResponseMatrix:
    """Assemble the response matrix of a kernel that fades at a cost almost proportional to the nodes.

    Parameters
    ----------
    surface : Surface
        The skin's mesh.
    skin : Skin
        Material with a `Layer`, or a `GaussianCorrected` response with a finite cutoff.
    nodes : (k,) array_like of int, optional
        Vertices, each at most once; None means the vertices of the skin mask.
    threshold : float
        Largest error of a product relative to ``|R| |f|``, from 1e-10 to 0.1.
    tolerance : float, optional
        Relative tolerance of single entries as in `response_matrix`; None means a tenth of the threshold,
        and half of it for entries that a cutoff cuts.
    num_threads : int, optional
        Threads; None for all. The matrix is equal to the bit for any number.
    memory_limit : int, optional
        Largest size of the matrix (bytes); None for no limit.

    Returns
    -------
    LocalResponseMatrix
        R (m/N) in blocks.

    Raises
    ------
    ResponseError
        If the response is felt at any distance, or a node, threshold, tolerance or the memory needed is out
        of range.

    Notes
    -----
    Nodes on different fingers are not coupled, however close: where the way along the skin is more than
    twice the straight line. `response_matrix` does not look at this.

    The Gaussian jumps at its cutoff, which no few vectors can tell: entries there are stored one by one, so
    on fine meshes it takes more memory than the layer.

    Examples
    --------
    >>> import quasirigid as qr
    >>> finger = qr.models.fingertip(edge_length=1.5e-3)
    >>> skin = qr.Skin(shear_modulus=60e3, poisson_ratio=0.45, response=qr.Layer(1e-3))
    >>> matrix = qr.local_response_matrix(finger, skin, threshold=1e-2)
    >>> matrix.density < 0.5
    True
    """
    kernel = kernel_of(skin, "a local response matrix needs a kernel that fades, Layer or GaussianCorrected")
    chosen = np.flatnonzero(surface.skin_mask) if nodes is None else np.array(nodes)
    matrix = _core.local_response_matrix(
        surface,
        kernel,
        chosen,
        threshold=threshold,
        tolerance=tolerance,
        num_threads=count_of("num_threads", num_threads, ResponseError),
        memory_limit=count_of("memory_limit", memory_limit, ResponseError),
    )
    kept = np.array(chosen, dtype=np.int64)
    kept.flags.writeable = False
    return LocalResponseMatrix(nodes=kept, threshold=threshold, _matrix=matrix)
