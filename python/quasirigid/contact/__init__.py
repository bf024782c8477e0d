"""Contact of the skin with an obstacle: the solve, its options and its result."""

from .accuracy import Accuracy as Accuracy
from .accuracy import Refinement as Refinement
from .accuracy import RefinementKind as RefinementKind
from .ending import ContactStatus as ContactStatus
from .ending import LeftOut as LeftOut
from .options import ContactOptions as ContactOptions
from .parts import Part as Part
from .parts import Patch as Patch
from .press import Balance as Balance
from .press import Start as Start
from .press import press as press
from .press import solve_contact as solve_contact
from .result import Contact as Contact
from .result import ContactError as ContactError
from .sweep import SweepProgress as SweepProgress
from .sweep import sweep as sweep
from .swept import Sweep as Sweep
from .warned import Warned as Warned
