"""Contact of the skin with an obstacle: the solve, its options and its result."""

from .accuracy import Accuracy as Accuracy
from .accuracy import Refinement as Refinement
from .options import ContactOptions as ContactOptions
from .press import Start as Start
from .press import press as press
from .press import solve_contact as solve_contact
from .result import Contact as Contact
from .result import ContactError as ContactError
from .result import ContactStatus as ContactStatus
from .result import LeftOut as LeftOut
from .result import Patch as Patch
from .sweep import Sweep as Sweep
from .sweep import sweep as sweep
