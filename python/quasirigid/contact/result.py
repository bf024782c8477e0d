"""What a contact returns."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from .._check import as_number
from .._frozen import Frozen
from ..errors import QuasirigidError
from .accuracy import Accuracy, Refinement
from .drawn import Drawing
from .ending import ContactStatus, LeftOut
from .parts import Part, Patch, figures_text, part_of, parts_by_label
from .warned import Warned

if TYPE_CHECKING:
    from collections.abc import Mapping
    from os import PathLike
    from pathlib import Path

    import numpy as np
    from matplotlib.figure import Figure
    from numpy.typing import ArrayLike, NDArray

    from .. import _core
    from ..lcp import LcpSolution
    from ..obstacle import Obstacle
    from ..surface import Surface

__all__ = ["Contact", "ContactError"]


@dataclass(frozen=True, kw_only=True, eq=False)
class Contact(Frozen):
    """The skin pressed against the obstacle. Arrays have one entry per vertex of the surface (n of them).

    `displacement`, `fade_distance`, `volume_change` and `deformed`, and `obstacle_displacement` and
    `deformed_obstacle`, are computed when one of them is first asked for, or the contact is pickled.

    Attributes
    ----------
    status : ContactStatus
        "solved", "no_contact" (no error: force, moment, area and pressure are 0) or the ending of the
        complementarity problem. For any other ending force, moment, area and peak are nan, `pressure`,
        `node_force`, `force_vectors` and `gap` are nan at the nodes of a problem that did not end solved, the
        displacement is 0, and `advice` says what to try.
    surface : Surface
        The undeformed skin on the mesh that was solved: the given object itself, or that refined around the
        contact, whose first vertices are the given ones.
    given_vertex_count : int
        Number of vertices that belong to the given mesh; they come first.
    parents : (n - given_vertex_count, 2) int64
        The two vertices that each added one lies between.
    refinements : tuple of Refinement
        Each mesh and linearization in order; for a step of a sweep, the previous step's mesh first.
    obstacle : Obstacle
        The obstacle where it stands now.
    travel : float
        Way of the obstacle along the direction of a press (m).
    depth : float or None
        Depth of a press (m): travel past first touch, or past where it began with ``start="current"``. None
        for a contact solved in place.
    force : (3,) float64
        Force on the skin (N).
    moment : (3,) float64
        Moment on the skin about the origin, at deformed positions (N m).
    center_of_pressure : (3,) float64
        Mean of the deformed positions weighted by node force (m); nan without force.
    contact_area : float
        Area that carries force (m²): in collocation on the mesh as given the sum of the vertex areas with
        f > 0; on a refined mesh, and in Galerkin form on any, the area within the rim, which the gaps beside
        it and sharp edges of the product place between the vertices.
    max_pressure : float
        Largest pressure at a vertex (Pa), ``pressure.max()``. In Galerkin form the largest between vertices
        too; there and with ``pressure="one_ring"`` never below the mean over a patch's contact area.
    max_penetration_before, max_penetration_after : float
        Deepest penetration (m): before, of a skin vertex, to the plane through a product's edge or bump
        where that stands in a triangle of it; after, measured anew at the deformed skin against the deformed
        product, in the skin's triangles and of the product's sharp edges and thin walls too.
    obstacle_share : float or None
        The product's share of what skin and product give way together, ``-f'u_P / f'(u_H - u_P)`` with
        the displacements of skin and product: 0 of a rigid product, None without contact.
    pressure : (n,) float64
        Pressure (Pa): `node_force` over vertex area. In Galerkin form that ratio is right in the mean only,
        and this is the smooth pressure recovered from it, which sums to the force up to the mesh error.
    node_force : (n,) float64
        Force along the obstacle's outward normal (N).
    force_vectors : (n, 3) float64
        Force on the skin at each vertex (N): `node_force` along that normal.
    gap : (n,) float64
        Gap (m): ``g0 + R f`` on the candidates, g0 within the search distance, inf beyond.
    candidates : (k,) int64
        Vertices in the complementarity problem, ascending.
    active : (a,) int64
        Vertices with f > 0, ascending.
    patches : tuple of Patch
        Connected parts of the active set.
    lcp_solutions : tuple of LcpSolution
        One per complementarity problem.
    natural_residual : float
        Worst natural residual of these (dimensionless).
    accuracy : Accuracy
        How far the figures can be trusted.
    timings : mapping of str to float
        Seconds per stage of the solve, on all meshes and for all depths that were tried: "first_touch",
        "signed_distance", "response", "lcp" and "outcome"; "refinement" is what its rounds take beside these.
        The drawn skin is none of them.
    left_out : tuple of LeftOut
        What the solve left out, and why.
    warnings : tuple of (category, message)
        What was warned of, also where Python's filter hides it: each a `QuasirigidWarning`, such as
        `DepthWarning`, and its words.
    advice : str
        What happened and what to try, where the contact did not solve; else empty.
    """

    status: ContactStatus
    given_vertex_count: int
    parents: NDArray[np.int64]
    refinements: tuple[Refinement, ...]
    obstacle: Obstacle
    travel: float
    depth: float | None
    force: NDArray[np.float64]
    moment: NDArray[np.float64]
    center_of_pressure: NDArray[np.float64]
    contact_area: float
    max_pressure: float
    max_penetration_before: float
    max_penetration_after: float
    obstacle_share: float | None
    pressure: NDArray[np.float64]
    node_force: NDArray[np.float64]
    force_vectors: NDArray[np.float64]
    gap: NDArray[np.float64]
    candidates: NDArray[np.int64]
    active: NDArray[np.int64]
    patches: tuple[Patch, ...]
    lcp_solutions: tuple[LcpSolution, ...]
    natural_residual: float
    accuracy: Accuracy
    timings: Mapping[str, float]
    left_out: tuple[LeftOut, ...]
    warnings: tuple[Warned, ...]
    advice: str
    _loaded: _core.LoadedVertices
    _drawing: Drawing

    @property
    def surface(self) -> Surface:
        """The undeformed skin on the mesh that was solved, built when it is first asked for."""
        return self._drawing.surface()

    @property
    def displacement(self) -> NDArray[np.float64]:
        """(n, 3) float64: displacement (m), faded to 0 at `fade_distance`; no other figure fades."""
        return self._drawing.skin().displacement

    @property
    def fade_distance(self) -> float:
        """Distance from the candidates, along the skin, at which the displacement has faded to zero (m)."""
        return self._drawing.skin().fade_distance

    @property
    def volume_change(self) -> float:
        """Change of the volume in the skin to first order (m³), ``sum S_i N_i . u_i`` without fade."""
        return self._drawing.skin().volume_change

    @property
    def deformed(self) -> Surface:
        """The surface moved by `displacement`."""
        return self._drawing.skin().deformed

    @property
    def obstacle_displacement(self) -> NDArray[np.float64]:
        """(n, 3) float64: displacement of the product opposite each vertex (m); 0 off the candidates."""
        return self._drawing.obstacle(self.obstacle, len(self.gap)).displacement

    @property
    def deformed_obstacle(self) -> Surface | None:
        """The product's mesh, moved; None of a primitive.

        Under a kernel the edges under the contact are halved until they are no longer than the skin's: the
        product's vertices keep their numbers, those added follow. They move as the kernel says of the
        contact's pressure, faded as the skin is. A given matrix moves those that it knows, against their
        normals.
        """
        return self._drawing.obstacle(self.obstacle, len(self.gap)).deformed

    def mean_pressure(self, area: float = 1e-4) -> float:
        """Return the largest mean pressure over a disc of a given area.

        Parameters
        ----------
        area : float
            Of the disc (m²), > 0; by custom 1 cm².

        Returns
        -------
        float
            Node forces within ``sqrt(area / pi)`` of a vertex under force, in a straight line on the
            undeformed skin, over `area`: the largest (Pa). Of a node whose cell the disc cuts the share of
            the cell inside counts. 0 without contact, nan where the contact did not solve. Within a single
            cell nothing is known but its pressure: the summary says of an `area` smaller than the mesh's
            cells that it is not resolved.

        Raises
        ------
        ContactError
            If the area is not finite and above 0.

        Examples
        --------
        >>> import quasirigid as qr
        >>> tip = qr.models.fingertip()
        >>> skin = qr.Skin(shear_modulus=60e3, poisson_ratio=0.5, response=qr.HalfSpace())
        >>> plate = qr.Obstacle.half_space([0, 0, 0], [0, 0, 1])
        >>> contact = qr.press(tip, plate, skin, [0, 0, 1], depth=1e-3)
        >>> contact.mean_pressure(1e-5) < contact.max_pressure
        True
        """
        return self._loaded.mean_pressure(as_number("area", area, ContactError))

    def part(self, mask: ArrayLike) -> Part:
        """Return what some vertices carry.

        Parameters
        ----------
        mask : (n,) array_like of bool
            Which vertices: one entry a vertex of the given mesh or of `surface`. With the former, an added
            vertex takes the entry of the nearer end of the edge that it lies on (`parents`), of two equally
            near ones that of the lower number.

        Returns
        -------
        Part
            Parts that cover the mesh without sharing a vertex sum to `force`, `moment` and `contact_area`.

        Raises
        ------
        ContactError
            If the mask has another length; a TypeError if it holds no booleans.
        """
        return part_of(self._loaded, mask, self._vertex_counts, ContactError)

    def by_label(self, labels: ArrayLike) -> dict[int | str, Part]:
        """Return what the vertices of each label carry, such as the segments of a hand.

        Parameters
        ----------
        labels : (n,) array_like of int or str
            One entry a vertex, as the mask of `part`.

        Returns
        -------
        dict of label to Part
            Ascending, with labels that carry nothing.

        Raises
        ------
        ContactError
            If there are more or fewer labels, or some are nan; a TypeError if they are neither int nor str.

        Examples
        --------
        >>> import numpy as np
        >>> import quasirigid as qr
        >>> tip = qr.models.fingertip()
        >>> skin = qr.Skin(shear_modulus=60e3, poisson_ratio=0.5, response=qr.HalfSpace())
        >>> plate = qr.Obstacle.half_space([0, 0, 0], [0, 0, 1])
        >>> contact = qr.press(tip, plate, skin, [0, 0, 1], depth=1e-3)
        >>> parts = contact.by_label(np.where(tip.vertices[:, 2] < 0, "pad", "nail"))
        >>> list(parts), bool(parts["nail"].force.any())
        (['nail', 'pad'], False)
        """
        return parts_by_label(self._loaded, labels, self._vertex_counts, ContactError)

    @property
    def _vertex_counts(self) -> tuple[int, int]:
        """Vertices of the given mesh, and of the one that was solved."""
        return self.given_vertex_count, len(self.gap)

    def summary(self) -> str:
        """Return the figures as a text table in mm, N and kPa."""
        from ..io.summary import contact_summary

        return contact_summary(self)

    def save(
        self,
        folder: str | PathLike[str],
        *,
        inputs: Mapping[str, Any] | None = None,
        pictures: bool = False,
        bone: Surface | None = None,
    ) -> tuple[Path, ...]:
        """Write everything into a folder: meshes, arrays, figures, pictures.

        deformed.ply and deformed.vtp (ParaView) hold the deformed skin, contact.npz the arrays, contact.json
        the figures with their units, product.ply the triangles of the product where it stands, and
        deformed_product.ply those of one with a material; skin.png and footprint.png are the pictures.
        Details: `quasirigid.io.save_contact`.

        Parameters
        ----------
        folder : path
            The folder; made where it is missing. Files of these names are replaced, those of an earlier
            contact or grasp removed; others stay.
        inputs : mapping, optional
            What the contact was computed from, for contact.json.
        pictures : bool
            Draw pictures too (extra `plot`).
        bone : Surface, optional
            Bones to draw in the cut.

        Returns
        -------
        tuple of Path
            The files.

        Raises
        ------
        MissingExtraError
            If pictures are asked for and matplotlib is not installed.
        OSError
            If the folder cannot be written to.
        """
        from ..io.write import save_contact

        return save_contact(self, folder, inputs=inputs, pictures=pictures, bone=bone)

    def plot(self, *, bone: Surface | None = None) -> Figure:
        """Return a matplotlib figure: the skin with its pressure, and a cut (extra `plot`).

        Parameters
        ----------
        bone : Surface, optional
            Bones to draw in the cut.
        """
        from ..plot.figures import contact_figure

        return contact_figure(self, bone=bone)

    def to_dataframe(self) -> Any:
        """Return a pandas DataFrame with one row a vertex."""
        from ..io.frame import contact_dataframe

        return contact_dataframe(self)

    def to_pyvista(self) -> Any:
        """Return the deformed skin as PolyData of pyvista, with the arrays at its points."""
        from ..io.frame import contact_pyvista

        return contact_pyvista(self)

    def to_trimesh(self) -> Any:
        """Return the deformed skin as a Trimesh of trimesh, with the arrays as vertex attributes."""
        from ..io.frame import contact_trimesh

        return contact_trimesh(self)

    def _repr_html_(self) -> str:
        from ..io.summary import contact_html

        return contact_html(self)

    def __repr__(self) -> str:
        """Return status, force, area, peak and counts on one line."""
        vertices = f"{len(self.active)} of {len(self.gap)} vertices"
        match self.status:
            case ContactStatus.SOLVED:
                patches = f"{len(self.patches)} patch{'es' * (len(self.patches) != 1)}"
                return f"Contact(solved: {figures_text(self)}, {patches}, {vertices})"
            case ContactStatus.NO_CONTACT:
                return f"Contact(no_contact: {vertices})"
            case _:
                return (
                    f"Contact({self.status}: {len(self.candidates)} candidates of {len(self.gap)} vertices)"
                )


class ContactError(QuasirigidError, ValueError, RuntimeError):
    """A contact was malformed, or did not end solved.

    Attributes
    ----------
    contact : Contact or None
        What was found, where the question was well posed: the contact whose ending was not "solved", the
        largest contact of a press that cannot reach its force or overlap, or that left without balance.
    """

    contact: Contact | None = None
