"""What the skin is made of: material and response."""

from __future__ import annotations

import warnings
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from .. import _core
from .._check import count_of, mask_of
from ..errors import QuasirigidWarning, ResponseError
from .parts import CombinedSkin, CutOut, combine
from .prepared import PreparedSkin
from .progress import Progress, announced, stage_reporter
from .response import Body, GaussianCorrected, GivenMatrix, HalfSpace, Layer, Response

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import ArrayLike, NDArray

    from ..surface import Surface

__all__ = ["Skin"]


CORE_NAMES = {"node": "collocation", "weighted": "galerkin"}


@dataclass(frozen=True, kw_only=True)
class Skin:
    """Material and response of the skin.

    Parameters
    ----------
    shear_modulus : float
        G (Pa), > 0. About 60 kPa for a fingertip (Xie, Kanai, Date 2011).
    poisson_ratio : float
        nu, in [0, 0.5]; 0.5 is incompressible.
    response : HalfSpace, GaussianCorrected, Layer, Body or GivenMatrix
        Displacement of the surface per unit force.

    Raises
    ------
    ResponseError
        If a constant is out of range.

    Warns
    -----
    QuasirigidWarning
        If the response is not well posed, with the bound on its constants.

    Examples
    --------
    >>> import quasirigid as qr
    >>> skin = qr.Skin(shear_modulus=60e3, poisson_ratio=0.5, response=qr.HalfSpace())
    """

    shear_modulus: float
    poisson_ratio: float
    response: Response
    # The core's skin; None where the response depends on the surface.
    kernel: _core.Skin | None = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        kernel = self._build()
        object.__setattr__(self, "kernel", kernel)
        caution = kernel.caution() if kernel is not None else None
        if caution is not None:
            warnings.warn(caution, QuasirigidWarning, stacklevel=3)

    def __getstate__(self) -> dict[str, Any]:
        """All but the core's skin, which is made anew."""
        return {name: value for name, value in vars(self).items() if name != "kernel"}

    def __setstate__(self, state: dict[str, Any]) -> None:
        """Build the core's skin again, without its caution: whoever made the skin has seen it."""
        vars(self).update(state)
        object.__setattr__(self, "kernel", self._build())

    def _build(self) -> _core.Skin | None:
        """The core's skin; None where the response depends on the surface."""
        material = (self.shear_modulus, self.poisson_ratio)
        match self.response:
            case HalfSpace(pressure, gap):
                return _core.Skin.half_space(*material, pressure, CORE_NAMES[gap])
            case GaussianCorrected(height, width, cutoff, pressure):
                if height is None:
                    height = _core.Skin.balanced_height(*material, width, cutoff)
                return _core.Skin.gaussian_corrected(*material, height, width, cutoff, pressure)
            case Layer(thickness, pressure, gap):
                return _core.Skin.layer(*material, thickness, pressure, CORE_NAMES[gap])
            case Body() | GivenMatrix():
                _core.Skin.half_space(*material, "linear", "collocation")  # checks the material
                return None
        raise TypeError(f"response is {self.response!r}, expected one of {Response}")

    def prepared(
        self,
        surface: Surface,
        nodes: ArrayLike | None = None,
        *,
        progress: Progress | bool | None = None,
    ) -> PreparedSkin:
        """Compute the response for a surface once, to use it for every product.

        Parameters
        ----------
        surface : Surface
            The skin's mesh.
        nodes : (k,) array_like of int, optional
            Vertices that may touch; None for all of the skin mask (less the fixed ones of a body). A body
            takes time and memory for each of these.
        progress : callable or bool, optional
            How far a body is: True prints to stderr; a function is called with words and the part that is
            done, first with memory and operations and 0, then with "assembly", "factorization" and
            "solution". Ctrl-C ends the work at any time, and so does what the function raises, which is
            raised here.

        Returns
        -------
        PreparedSkin
            Goes wherever a `Skin` goes; can be saved, loaded, and moved with the surface.

        Raises
        ------
        ResponseError
            If a part does not fit, or the preparation needs too much memory.
        TypeError
            If `progress` cannot be called or the fixed vertices of a body are no booleans.
        """
        return PreparedSkin(skin=self, core=self._prepare(surface, nodes, announced(progress)))

    def combined(self, surface: Surface, parts: Mapping[str, tuple[CutOut, PreparedSkin]]) -> CombinedSkin:
        """Join bodies of parts of a skin with this kernel for the rest.

        Parameters
        ----------
        surface : Surface
            The whole skin, such as a hand.
        parts : mapping of str to (CutOut, PreparedSkin)
            For each part, by any name, how it was cut out of `surface` and its prepared body.

        Returns
        -------
        CombinedSkin
            Goes wherever a `Skin` goes.

        Raises
        ------
        ResponseError
            If a part does not fit, two overlap, or this skin is no kernel of linear pressure. A contact
            raises it where a patch of candidates straddles a cut, naming the part; `CombinedSkin.without`
            leaves that part to the kernel.
        TypeError
            If `parts` is no mapping of names to a cut and its prepared skin.

        Notes
        -----
        A force on a part moves that part alone, a force elsewhere the rest alone: patches on different sides
        of a cut do not couple, since each body is held there. Patches off the parts couple with one another.
        """
        return combine(self, surface, parts)

    def _prepare(
        self, surface: Surface, nodes: ArrayLike | None, progress: Progress | None = None
    ) -> _core.Skin:
        chosen = np.flatnonzero(surface.skin_mask) if nodes is None else np.asarray(nodes)
        match self.response:
            case GivenMatrix(known, compliance):
                return _given(surface, self, np.asarray(known), np.asarray(compliance, dtype=np.float64))
            case Body(bone=bone, fixed=fixed, memory_limit=memory_limit, bone_pressure=bone_pressure):
                if fixed is not None:
                    fixed = mask_of("fixed", fixed, len(surface.vertices), ResponseError)
                    if nodes is None:
                        chosen = chosen[~fixed[chosen]]
                return _core.Skin.body(
                    surface,
                    self.shear_modulus,
                    self.poisson_ratio,
                    bone,
                    fixed,
                    chosen,
                    bone_pressure=bone_pressure,
                    num_threads=None,
                    memory_limit=count_of("memory_limit", memory_limit, ResponseError),
                    progress=stage_reporter(
                        progress,
                        len(surface.vertices),
                        0 if bone is None else len(bone.vertices),
                        len(chosen),
                    ),
                )
        assert self.kernel is not None
        return self.kernel.prepare(surface, chosen)

    def core_on(self, surface: Surface) -> _core.Skin:
        """The core's skin for a surface, prepared where it must be."""
        return self._prepare(surface, None) if self.kernel is None else self.kernel


def _given(
    surface: Surface, skin: Skin, nodes: NDArray[np.int64], compliance: NDArray[np.float64]
) -> _core.Skin:
    """The core's skin for a given matrix, scalar or in 3 x 3 blocks."""
    if compliance.ndim == 2:
        return _core.Skin.given(surface, nodes, compliance)
    count = len(nodes)
    if compliance.shape != (count, 3, count, 3):
        raise ResponseError(
            f"compliance has shape {compliance.shape}, expected ({count}, {count}) or "
            f"({count}, 3, {count}, 3) for {count} nodes"
        )
    displacement = np.zeros((len(surface.vertices), 3, 3 * count))
    displacement[nodes] = compliance.reshape(count, 3, 3 * count)
    area_vectors = surface.vertex_areas[:, None] * surface.vertex_normals
    return _core.Skin.restore_body(
        surface,
        skin.shear_modulus,
        skin.poisson_ratio,
        nodes,
        displacement.reshape(-1, 3 * count),
        area_vectors,
        np.eye(3),
        bone_pressure=None,
        solved=False,
    )
