"""Pictures of a contact: the skin with its pressure map, a cut through the contact, the footprint.

Lengths are drawn in mm and pressures in kPa. A function `plot_...` draws into a matplotlib `Axes` and
returns it, a function `..._figure` returns a `Figure`. Matplotlib (the extra `plot`) is imported where it is
used, and no window is opened.
"""

from .curves import sweep_figure as sweep_figure
from .figures import comparison_figure as comparison_figure
from .figures import contact_figure as contact_figure
from .figures import footprint_figure as footprint_figure
from .footprint import plot_footprint as plot_footprint
from .grasps import grasp_figure as grasp_figure
from .hands import hand_figure as hand_figure
from .section import plot_section as plot_section
from .skin import plot_skin as plot_skin
from .view import View as View
from .view import pad_view as pad_view

__all__ = [
    "View",
    "comparison_figure",
    "contact_figure",
    "footprint_figure",
    "grasp_figure",
    "hand_figure",
    "pad_view",
    "plot_footprint",
    "plot_section",
    "plot_skin",
    "sweep_figure",
]
