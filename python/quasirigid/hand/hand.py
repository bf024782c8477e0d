"""A hand that can be posed: skin, joints, and by which joints each vertex is moved."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from .. import _core
from .._check import as_boolean, as_number
from .._frozen import Frozen, read_only
from ..errors import HandError
from ..surface import Surface, skin_without_caps
from .bend import shares_of
from .bones import Bone, bones_of
from .checks import as_frames, as_labels, as_names, as_parents, check_inside, check_movers
from .creases import without_folds
from .pose import turns_of
from .posed import PosedHand
from .regions import regions_of
from .rig.frames import side_of
from .rig.joints import index_of, length_of
from .rig.kinematics import mirrored_frames, motions_of, rigid_motion
from .rig.pivots import pivots_of

if TYPE_CHECKING:
    from collections.abc import Sequence
    from os import PathLike

    from numpy.typing import ArrayLike, NDArray

    from .._arrays import Floats
    from ..contact import Contact
    from .pose import Pose

__all__ = ["Hand", "Side"]

Side = Literal["right", "left"]
"""Which hand it is."""


class Hand(Frozen):
    """A hand: its skin at rest, its joints, and the weights by which the skin follows them.

    Parameters
    ----------
    vertices : (n, 3) array_like
        Skin at rest (m).
    faces : (m, 3) array_like of int
        Corners of each triangle, counter-clockwise seen from outside.
    joint_names : sequence of str
        J names, WebXR's 25 among them (`quasirigid.hand.WEBXR_25`); others are kept as they are.
    parents : (J,) array_like of int
        The joint that each hangs on, -1 for the one root.
    rest : (J, 4, 4) array_like
        Frames of the joints at rest (m): +y along the bone, +x the axis of flexion (which is a negative turn
        about it), +z dorsal.
    joints : (n, k) array_like of int
        The joints that move each vertex.
    weights : (n, k) array_like
        How much each does, >= 0; sums within 1e-3 of 1 are normalised.
    labels : (n,) sequence of str, optional
        Region of each vertex; found from joints and normals when left out.
    side : {"right", "left"}, optional
        Which hand it is; found from the joints when left out.

    Attributes
    ----------
    surface : Surface
        The skin at rest; its flat cut at the wrist may not touch.
    joint_names : tuple of str
    parents : (J,) int64
    rest : (J, 4, 4) float64
    joints : (n, k) int64
    weights : (n, k) float64
    side : str

    Raises
    ------
    HandError
        Naming the joint or vertex at fault: names that are missing or double, parents in a circle or several
        roots, frames that are no rigid motion, a joint outside the skin, weights that do not sum to 1. Or a
        `side` that the joints are not of.
    SurfaceError
        The skin is no surface.
    """

    surface: Surface
    joint_names: tuple[str, ...]
    parents: NDArray[np.int64]
    rest: Floats
    joints: NDArray[np.int64]
    weights: Floats
    side: Side
    _labels: NDArray[np.str_] | None

    def __init__(
        self,
        vertices: ArrayLike,
        faces: ArrayLike,
        *,
        joint_names: Sequence[str],
        parents: ArrayLike,
        rest: ArrayLike,
        joints: ArrayLike,
        weights: ArrayLike,
        labels: ArrayLike | None = None,
        side: Side | None = None,
    ) -> None:
        if side not in ("right", "left", None):
            raise HandError(f'side is {side!r}, expected "right", "left" or None')
        names = as_names(joint_names)
        hangs_on = as_parents(parents, names)
        frames = as_frames(rest, names)
        found = side_of(names, frames)
        if side not in (found, None):
            raise HandError(
                f"side is {side!r}, but the joints are those of a {found} hand: seen from the back, +z "
                "of their frames, its little finger lies on the other side of the index"
            )
        surface = Surface(vertices, faces)
        if not surface.is_closed:
            raise HandError("the skin is open: a hand needs a closed one, its cut at the wrist capped")
        # The flat cut at the wrist is no skin.
        surface = surface.with_skin_mask(skin_without_caps(surface))
        check_movers(joints, len(names))
        _core.SkinWeights(joints, weights, joint_count=len(names))  # checked
        movers = np.array(joints, dtype=np.int64)
        if len(movers) != len(surface.vertices):
            raise HandError(
                f"joints has {len(movers)} rows, but the skin has {len(surface.vertices)} vertices"
            )
        check_inside(surface, frames, names)
        vars(self).update(
            surface=surface,
            joint_names=names,
            parents=hangs_on,
            rest=frames,
            joints=movers,
            weights=np.array(weights, dtype=np.float64),
            side=found,
            _labels=None if labels is None else as_labels(labels, len(surface.vertices)),
        )
        self._freeze()

    @property
    def labels(self) -> NDArray[np.str_]:
        """(n,) str: the region of each vertex, such as ``"index-distal-palmar"``, or what was given.

        ``<digit>-<segment>-<side>``, digits thumb, index, middle, ring, little, segments proximal, middle
        (not the thumb's), distal, sides palmar, dorsal, radial, ulnar; ``<finger>-metacarpal-head``;
        ``web-thumb-index``, ``web-index-middle``, ``web-middle-ring``, ``web-ring-little``; ``palm-center``,
        ``thenar``, ``hypothenar``, ``back``, ``wrist``.
        """
        return self.regions if self._labels is None else self._labels

    @property
    def length(self) -> float:
        """Way along the joints from the wrist to the tip joint of the middle finger (m), less its pulp."""
        return length_of(self.rest, self.joint_names)

    @cached_property
    def regions(self) -> NDArray[np.str_]:
        """(n,) str: the regions found from joints and normals, whatever the labels are."""
        return read_only(regions_of(self))

    @cached_property
    def _shares(self) -> Floats:
        shares = shares_of(self)
        return without_folds(self, pivots_of(self, shares), shares)

    @cached_property
    def _pivots(self) -> Floats:
        return read_only(pivots_of(self, self._shares))

    @cached_property
    def _influence(self) -> _core.SkinWeights:
        most = np.count_nonzero(self._shares, axis=1).max()
        joints = np.argpartition(-self._shares, most - 1, axis=1)[:, :most]
        weights = np.take_along_axis(self._shares, joints, axis=1)
        return _core.SkinWeights(joints, weights, joint_count=len(self.joint_names))

    def posed(
        self,
        pose: Pose,
        *,
        rotation: ArrayLike | None = None,
        translation: ArrayLike | None = None,
        linear: bool = False,
    ) -> PosedHand:
        """Return the hand in a pose.

        Parameters
        ----------
        pose : str, mapping, array_like or Mixed
            A preset ("flat", "open", "opposed", "relaxed", "cylinder", "sphere", "pinch", "point", "fist"),
            its flexion from the straight digit; a mapping of joint names to flexion from rest (rad) or to a
            mapping of "flexion", "abduction" and "twist" (rad), joints not named at rest; or an array in the
            order of `joint_names`, relative to the rest frames: (J, 3) rotation vectors (rad) or (J, 4)
            quaternions x, y, z, w. Flexion is positive towards the palm,
            abduction away from the middle finger (of that itself: towards the thumb), twist where it turns
            the thumb's pad to the fingers.
        rotation : (3, 3) or (4, 4) array_like, optional
            Of the whole hand about the origin, after it was posed; a (4, 4) matrix holds the translation too.
        translation : (3,) array_like, optional
            Of the whole hand (m), after that.
        linear : bool
            Blend the motions of joints as matrices, not as dual quaternions: the skin collapses at bent
            joints.

        Returns
        -------
        PosedHand
            Skin, joints and labels.

        Raises
        ------
        HandError
            Unknown names (the nearest known one is offered), angles that are not finite, an array of another
            shape.
        TypeError
            Both a (4, 4) matrix and a translation.

        Warns
        -----
        QuasirigidWarning
            Angles of a mapping that are beyond the range of a joint, half a turn of the wrist and others that
            are no digit's, are taken at its end, and a joint at the end of a digit turns nothing. Arrays are
            taken as they are.

        Notes
        -----
        Joints of digits turn about points that keep the digit's volume (`pivot_of`), others about their
        origin. Weights that change so fast that a hinge bent by a right angle would turn
        skin over at its crease are smoothed there.
        """
        placed = rigid_motion(rotation, translation)
        motions, frames = motions_of(self.rest, self._pivots, self.parents, turns_of(pose, self), placed)
        surface = self._influence.posed(self.surface, motions, linear=as_boolean("linear", linear))
        return PosedHand(hand=self, surface=surface, joints=frames, motions=motions)

    def moved(self, rotation: ArrayLike | None = None, translation: ArrayLike | None = None) -> Hand:
        """Return the hand after a rigid motion of all of it, at rest there.

        Parameters
        ----------
        rotation : (3, 3) or (4, 4) array_like, optional
            About the origin; a (4, 4) matrix holds the translation too.
        translation : (3,) array_like, optional
            After the rotation (m).

        Raises
        ------
        HandError
            What is no rotation or no translation.
        TypeError
            Both a (4, 4) matrix and a translation.
        """
        frames = rigid_motion(rotation, translation) @ self.rest
        # The motion of every joint is that of the first.
        motion = frames[0] @ np.linalg.inv(self.rest[0])
        return self._with(self.surface.vertices @ motion[:3, :3].T + motion[:3, 3], frames)

    def scaled(self, factor: float) -> Hand:
        """Return the hand with all lengths times a factor, about the origin.

        Parameters
        ----------
        factor : float
            Dimensionless, > 0.
        """
        factor = as_number("factor", factor, HandError)
        frames = self.rest.copy()
        frames[:, :3, 3] *= factor
        return self._with(self.surface.vertices * factor, frames)

    def mirrored(self) -> Hand:
        """Return the other hand: the mirror image in the plane x = 0."""
        vertices = self.surface.vertices * [-1.0, 1.0, 1.0]
        side: Side = "left" if self.side == "right" else "right"
        return self._with(vertices, mirrored_frames(self.rest), faces=self.surface.faces[:, ::-1], side=side)

    def frame_of(self, joint: str) -> Floats:
        """Return the frame of a joint at rest.

        Parameters
        ----------
        joint : str
            One of `joint_names`.

        Returns
        -------
        (4, 4) float64
            Axes in the first three columns, origin in the last (m).

        Raises
        ------
        HandError
            An unknown name; the nearest known one is offered.
        """
        frame: Floats = self.rest[index_of(joint, self.joint_names, "the joint")]
        return frame

    def pivot_of(self, joint: str) -> Floats:
        """Return the point that a joint turns about at rest.

        Parameters
        ----------
        joint : str
            One of `joint_names`.

        Returns
        -------
        (3,) float64
            The point (m).
        """
        pivot: Floats = self._pivots[index_of(joint, self.joint_names, "the joint")]
        return pivot

    @cached_property
    def bones(self) -> tuple[Bone, ...]:
        """Phalanges, metacarpals and carpals at rest; one that the skin leaves no room for is missing."""
        return bones_of(self)

    def save(self, path: str | PathLike[str], contact: Contact | None = None) -> None:
        """Write the hand at rest as GLB with skin and joints.

        Parameters
        ----------
        path : path
            A file that ends in .glb.
        contact : Contact, optional
            One of this hand's skin, posed or not: the mesh that was solved, with pressure as color and as
            the attribute ``_PRESSURE`` (Pa), and the deformed skin as a morph target. Posed again, that finer
            mesh comes to lie some tenths of a mm elsewhere.
        """
        from .files.save import save_glb

        save_glb(self, path, contact)

    def __getstate__(self) -> dict[str, Any]:
        """Return the attributes but for the core's weights, which are made anew of the others."""
        return {name: value for name, value in vars(self).items() if name != "_influence"}

    def __repr__(self) -> str:
        """Return side, counts and length on one line."""
        counts = f"{len(self.surface.vertices)} vertices, {len(self.joint_names)} joints"
        return f"Hand({self.side}, {counts}, {self.length * 1e3:.0f} mm from wrist to tip)"

    def _with(self, vertices: Floats, rest: Floats, **changed: Any) -> Hand:
        """Return the same hand with other places of skin and joints."""
        known: dict[str, Any] = {
            "faces": self.surface.faces,
            "joint_names": self.joint_names,
            "parents": self.parents,
            "joints": self.joints,
            "weights": self.weights,
            "labels": self._labels,
            "side": self.side,
        }
        made = Hand(vertices, rest=rest, **(known | changed))
        # What rigid motions, scales and mirrors leave as it is.
        for name in ("regions", "_shares", "_influence"):
            if name in vars(self):
                vars(made)[name] = vars(self)[name]
        return made
