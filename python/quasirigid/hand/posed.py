"""A hand in a pose."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from .. import _core
from .._check import as_integer_or_none, as_nodes, as_path
from .._frozen import Frozen, ReadOnlyDict
from ..errors import HandError, ResponseError
from ..models.loft import joined
from ..skin import Body, Skin
from ..skin.progress import as_progress
from ..surface import Surface
from .bones import fitted
from .crossings import crossing_parts, in_words
from .kept import kept
from .regions import digit_of_vertices
from .rig.frames import unit
from .rig.joints import REFERENCE_LENGTH, index_of

if TYPE_CHECKING:
    from collections.abc import Mapping
    from os import PathLike

    from numpy.typing import ArrayLike, NDArray

    from .._arrays import Floats
    from ..skin import PreparedSkin, Response
    from ..skin.progress import Progress
    from .bones import Bone
    from .hand import Hand

__all__ = ["PalmFrame", "PosedHand"]

_OFF_PALM = ("back", "wrist")
_PALM_JOINTS = (
    "wrist",
    "middle-finger-phalanx-proximal",
    "index-finger-phalanx-proximal",
    "pinky-finger-phalanx-proximal",
)
_BELOW = 5e-3  # m, of a hand of REFERENCE_LENGTH, below the mean of the palm's center: inside the hand
_PALM_MIDDLE = 2.0 / 3.0  # of the way from the wrist to the middle knuckle


class PalmFrame(np.ndarray[Any, np.dtype[np.float64]]):
    """The frame (4, 4) of a palm (m) with its skin.

    Copies and pickles know the skin too; what is computed from a frame and parts of it are plain arrays.

    Attributes
    ----------
    surface : Surface or None
        The hand's, of which the palm alone may touch; None of another view of the frame.
    """

    surface: Surface | None

    def __new__(cls, frame: Floats, surface: Surface | None) -> PalmFrame:
        """Return the frame with its skin."""
        palm = frame.view(cls)
        palm.surface = surface
        return palm

    def __array_finalize__(self, source: Any) -> None:
        """Forget the skin: what is made of a frame may lie elsewhere."""
        self.surface = None

    def __array_wrap__(self, array: Any, context: Any = None, return_scalar: bool = False) -> Any:
        """Return what was computed as a plain array or number; what was changed in place as it is."""
        return self if array is self else np.asarray(array)[()]

    def __getitem__(self, key: Any) -> Any:
        """Return a part as a plain array, which changes the frame where it is changed."""
        return np.asarray(self)[key]

    def copy(self, order: Literal["K", "A", "C", "F"] | None = "C") -> PalmFrame:
        """Return a frame of its own with the same skin."""
        return PalmFrame(np.array(self, order=order), self.surface)

    def __copy__(self) -> PalmFrame:
        """Return a frame of its own with the same skin."""
        return self.copy()

    def __deepcopy__(self, memo: object) -> PalmFrame:
        """Return a frame of its own with the same skin, which nobody changes."""
        return self.copy()

    def __reduce__(self) -> Any:
        """Return what a pickle makes the frame of."""
        return PalmFrame, (np.array(self), self.surface)


@dataclass(frozen=True, kw_only=True, eq=False)
class PosedHand(Frozen):
    """A hand in a pose, ready to press.

    Attributes
    ----------
    hand : Hand
        The hand at rest.
    surface : Surface
        The skin; its faces were checked at rest.
    joints : (J, 4, 4) float64
        Frames of the joints (m), in the order of `Hand.joint_names`.
    motions : (J, 4, 4) float64
        Motion of each joint from rest (m).
    """

    hand: Hand
    surface: Surface = field(repr=False)
    joints: Floats = field(repr=False)
    motions: Floats = field(repr=False)

    @property
    def labels(self) -> NDArray[np.str_]:
        """(n,) str: the region of each vertex."""
        return self.hand.labels

    @cached_property
    def bones(self) -> Surface:
        """Bones of the hand where their joints are, one component each.

        They stay at least 1 mm inside the skin and clear of each other: `bone_shares` says which are slimmer
        for that. Of skin that crosses itself there is no inside: they are as at rest.

        Raises
        ------
        HandError
            The skin leaves no room for any.
        """
        if not self._bones:
            length = f"{self.hand.length:.4g} m long from wrist to middle tip"
            raise HandError(f"no bone fits into this skin, {length}: check the unit")
        return Surface(*joined([(bone.vertices, bone.faces) for bone in self._bones]))

    @property
    def bone_shares(self) -> Mapping[str, float]:
        """What each bone has of its published section in this pose, by its name; 0 where it is left out."""
        shares = dict.fromkeys((bone.name for bone in self.hand.bones), 0.0)
        return ReadOnlyDict(shares | {bone.name: bone.share for bone in self._bones})

    @cached_property
    def _bones(self) -> tuple[Bone, ...]:
        moved = tuple(bone.moved(self.motions[bone.joint]) for bone in self.hand.bones)
        return moved if self.crossings else fitted(moved, self.surface)

    @cached_property
    def crossings(self) -> tuple[tuple[str, str], ...]:
        """Pairs of regions whose faces cross in this pose, those with the most crossings first."""
        return crossing_parts(self.surface.faces[self._crossing_faces], self.labels)

    def without_crossings(self) -> PosedHand:
        """Return the hand in the same pose, of which the skin that crosses itself may not touch."""
        mask = self.surface.skin_mask.copy()
        mask[self.surface.faces[self._crossing_faces]] = False
        return replace(self, surface=self.surface.with_skin_mask(mask))

    @cached_property
    def _crossing_faces(self) -> NDArray[np.int64]:
        """Pairs of faces (k, 2) that cross."""
        return _core.find_crossings(self.surface.vertices, self.surface.faces)

    def skin(
        self,
        *,
        shear_modulus: float,
        poisson_ratio: float,
        response: Response | None = None,
        nodes: ArrayLike | None = None,
        folder: str | PathLike[str] | None = None,
        progress: Progress | bool | None = None,
        num_threads: int | None = None,
    ) -> Skin | PreparedSkin:
        """Return material and response of this skin in this pose.

        Parameters
        ----------
        shear_modulus : float
            G (Pa).
        poisson_ratio : float
            nu, from 0 to 0.5.
        response : Response, optional
            A body when left out; one that has neither bone nor fixed vertices gets the hand's bones and is
            held at the cut at the wrist, where that is flat. It is prepared, which takes seconds, and kept
            in memory by content: the same body is prepared once.
        nodes : (k,) array_like of int, optional
            Vertices where a body is touched and the mesh that it is solved on is finest. When left out the
            palmar side and the sides of the thumb's tip; all skin where the body has a `coarse_edge_length`.
            A whole hand without one answers everywhere, best beside these.
        folder : path, optional
            Keeps prepared bodies in files, as `PreparedSkin.save`, and finds them there.
        progress : callable or bool, optional
            How far the preparation of a body is, as for `Skin.prepared`; one that is kept needs none.
        num_threads : int, optional
            Threads that prepare a body; None for all.

        Raises
        ------
        HandError
            The skin of a body crosses itself in this pose (the regions are named), or leaves no room for
            bones.
        ResponseError
            As `Skin` and `Skin.prepared` say.
        OSError
            If the folder does not exist or cannot be written to.
        TypeError
            If `progress` cannot be called.
        """
        nodes = None if nodes is None else as_nodes("nodes", nodes, len(self.labels), ResponseError)
        folder = None if folder is None else as_path("folder", folder)
        progress = as_progress(progress)
        num_threads = as_integer_or_none("num_threads", num_threads, ResponseError, least=1)
        response = Body() if response is None else response
        if not isinstance(response, Body):
            return Skin(shear_modulus=shear_modulus, poisson_ratio=poisson_ratio, response=response)
        if response.bone is None and response.fixed is None:
            cut = ~self.surface.skin_mask
            response = replace(response, bone=self.bones, fixed=cut if cut.any() else None)
        if self.crossings:
            parts = in_words(self.crossings)
            raise HandError(
                f"the skin crosses itself in this pose, {parts}: it encloses no body; open the pose there, "
                "or take a response that needs none, such as a half-space"
            )
        skin = Skin(shear_modulus=shear_modulus, poisson_ratio=poisson_ratio, response=response)
        nodes = self._touching(response) if nodes is None else nodes
        return kept(skin, self.surface, nodes, folder, progress, num_threads)

    def _touching(self, body: Body) -> NDArray[np.int64]:
        """Return the vertices of the palmar side and the sides of the thumb's tip.

        All that move where the mesh is as fine everywhere.
        """
        regions = self.hand.regions
        palm = np.isin(regions, ("palm-center", "thenar", "hypothenar"))
        digits = np.char.endswith(regions, "-palmar") | np.char.endswith(regions, "-head")
        digits |= np.isin(regions, ("thumb-distal-radial", "thumb-distal-ulnar"))
        held = False if body.fixed is None else np.asarray(body.fixed, dtype=bool)
        free = self.surface.skin_mask & ~held
        if body.coarse_edge_length is not None:
            return np.flatnonzero(free)
        return np.flatnonzero(free & (palm | digits | np.char.startswith(regions, "web-")))

    @property
    def palm(self) -> PalmFrame:
        """(4, 4) float64: frame of the palm (m).

        Origin at the palm's center on the skin, two thirds of the way from the wrist to the middle knuckle
        (beyond, the digits part), +y distal, +z out of the palm, +x = y x z. It knows its skin,
        without digits: `Obstacle.placed` lays a product against that.
        """
        wrist, knuckle, index, little = (self.frame_of(name)[:3, 3] for name in _PALM_JOINTS)
        distal = unit(knuckle - wrist)
        out = np.cross(index - wrist, little - wrist) * (1.0 if self.hand.side == "right" else -1.0)
        out = unit(out - (out @ distal) * distal)
        below = _BELOW * self.hand.length / REFERENCE_LENGTH
        middle = self.surface.vertices[self.hand.regions == "palm-center"].mean(axis=0) - below * out
        middle += ((wrist + _PALM_MIDDLE * (knuckle - wrist) - middle) @ distal) * distal
        frame = np.eye(4)
        frame[:3, :3] = np.column_stack([np.cross(distal, out), distal, out])
        frame[:3, 3] = middle + _core.way_out(self.surface, middle, out) * out
        regions = self.hand.regions
        is_palm = (digit_of_vertices(regions) == "palm") & ~np.isin(regions, _OFF_PALM)
        return PalmFrame(frame, self.surface.with_skin_mask(is_palm & self.surface.skin_mask))

    def frame_of(self, joint: str) -> Floats:
        """Return the frame of a joint in this pose.

        Parameters
        ----------
        joint : str
            One of `Hand.joint_names`.

        Returns
        -------
        (4, 4) float64
            Axes in the first three columns, origin in the last (m).

        Raises
        ------
        HandError
            An unknown name; the nearest known one is offered.
        """
        frame: Floats = self.joints[index_of(joint, self.hand.joint_names, "the joint")]
        return frame
