"""A hand that holds a product."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ..._frozen import Frozen

if TYPE_CHECKING:
    from os import PathLike
    from pathlib import Path

    from matplotlib.figure import Figure

    from ..._arrays import Floats
    from ...contact import Contact, Part
    from ..posed import PosedHand

__all__ = ["Grasp"]


@dataclass(frozen=True, kw_only=True, eq=False)
class Grasp(Frozen):
    """A hand that holds a product.

    Attributes
    ----------
    pose : (J, 4) float64
        Turn of each joint against its rest frame, quaternions x, y, z, w: a pose for `Hand.posed`.
    posed : PosedHand
        The hand in it, where it stands; `PosedHand.crossings` names the regions that cross each other there.
    contact : Contact
        The contact of the whole hand, everything coupled.
    shares : dict of str to float
        How far each digit went: 0 the start, 1 the end, down to -1 the pose "open" where the product stood in
        it at the start.
    digits : dict of str to Part
        What the phalanges of each digit carry.
    palm : Part
        What all other skin carries.
    regions : dict of str to Part
        What each region of the skin carries, by the names of `Hand.labels`; those under force alone.
    net_force : (3,) float64
        Force of the hand on the product (N).
    net_moment : (3,) float64
        Moment of the hand on the product about its center of mass (N m).
    unbalanced_force, unbalanced_moment : (3,) float64 or None
        The same with the product's weight (N, N m): what something else must bear. None without
        `product_mass`.
    missed : dict of str to str
        Digits that do not hold what was asked of them, and why.
    rounds : int
        Contacts of the whole hand that were solved.
    timings : dict of str to float
        Seconds: "approach", "search" on the given mesh, "rounds" with all options.
    """

    pose: Floats
    posed: PosedHand
    contact: Contact
    shares: Mapping[str, float]
    digits: Mapping[str, Part]
    palm: Part
    regions: Mapping[str, Part]
    net_force: Floats
    net_moment: Floats
    unbalanced_force: Floats | None
    unbalanced_moment: Floats | None
    missed: Mapping[str, str]
    rounds: int
    timings: Mapping[str, float]

    def summary(self) -> str:
        """Return what each digit holds and the figures of the contact as text tables in mm, N and kPa."""
        from ...io.grasps import digit_table

        return f"{digit_table(self)}\n{self.contact.summary()}"

    def save(
        self,
        folder: str | PathLike[str],
        *,
        inputs: Mapping[str, Any] | None = None,
        pictures: bool = False,
    ) -> tuple[Path, ...]:
        """Write everything into a folder.

        Parameters
        ----------
        folder : path
            The folder; made where it is missing. Files are replaced and removed as by `Contact.save`.
        inputs : mapping, optional
            What the grasp was computed from, to be written too.
        pictures : bool
            Draw pictures too (extra `plot`).

        Returns
        -------
        tuple of Path
            What `Contact.save` writes, grasp.json (pose, digits, regions, balance), hand.glb (`Hand.save`)
            and grasp.png.

        Raises
        ------
        MissingExtraError
            If pictures are asked for and matplotlib is not installed.
        OSError
            If the folder cannot be written to.
        """
        from ...io.grasps import save_grasp

        return save_grasp(self, folder, inputs=inputs, pictures=pictures)

    def to_dataframe(self) -> Any:
        """Return a pandas DataFrame with one row for each digit and the palm, columns as in grasp.json."""
        from ...io.frame import grasp_dataframe

        return grasp_dataframe(self)

    def plot(self) -> Figure:
        """Return a matplotlib figure: hand and product from two sides, and the pressure (extra `plot`)."""
        from ...plot.grasps import grasp_figure

        return grasp_figure(self)

    def __repr__(self) -> str:
        """Return the force of each digit and the net force on one line."""
        forces = ", ".join(f"{name} {np.linalg.norm(part.force):.3g}" for name, part in self.digits.items())
        missed = f", missed: {', '.join(self.missed)}" if self.missed else ""
        return f"Grasp({forces} N, net {np.linalg.norm(self.net_force):.3g} N{missed})"
