"""The linear complementarity problem ``w = M z + q, w >= 0, z >= 0, w'z = 0``."""

from .error import LcpError as LcpError
from .options import LcpMethod as LcpMethod
from .options import LcpMethodName as LcpMethodName
from .options import LcpOptions as LcpOptions
from .solution import Certificate as Certificate
from .solution import LcpAttempt as LcpAttempt
from .solution import LcpDefiniteness as LcpDefiniteness
from .solution import LcpRay as LcpRay
from .solution import LcpSolution as LcpSolution
from .solution import LcpStatus as LcpStatus
from .solution import RayConclusion as RayConclusion
from .solve import solve_lcp as solve_lcp
