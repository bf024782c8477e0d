"""Error against run time, and extreme cases: tables that are computed here and now.

`accuracy` measures contacts on the reference problems, `stress` the cases that break solvers; both return a
`Table`. They run on the machine at hand, so that its times and its build are what is judged.
"""

from .extremes.run import stress as stress
from .ladder.run import accuracy as accuracy
from .table import Table as Table
from .table import TableProgress as TableProgress

__all__ = ["Table", "TableProgress", "accuracy", "stress"]
