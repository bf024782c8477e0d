"""Pictures of a contact: the skin with its pressure map, a cut through the contact, the footprint.

Lengths are drawn in mm and pressures in kPa. Every function takes and returns a matplotlib `Axes`, or returns
a `Figure`; matplotlib (the extra `plot`) is imported where it is used, and no window is opened.
"""

from .figures import before_and_after as before_and_after
from .figures import footprint as footprint
from .figures import plot_footprint as plot_footprint
from .figures import plot_skin as plot_skin
from .figures import side_by_side as side_by_side
from .section import plot_section as plot_section
from .view import View as View
from .view import pad_view as pad_view
