"""Quasi-rigid contact of hand skin with products.

Press a posed hand (a triangle mesh) against a product (a triangle mesh or a primitive) and read off the
deformed skin, the pressure map, area, force and moment, and how far each can be trusted. All numbers are
SI: m, N, Pa, rad, s.
"""

from . import models as models
from ._core import __version__ as __version__
from .contact import Accuracy as Accuracy
from .contact import Contact as Contact
from .contact import ContactOptions as ContactOptions
from .contact import ContactStatus as ContactStatus
from .contact import Patch as Patch
from .contact import press as press
from .contact import solve_contact as solve_contact
from .errors import ContactError as ContactError
from .errors import LcpError as LcpError
from .errors import MeshFileError as MeshFileError
from .errors import MissingExtraError as MissingExtraError
from .errors import ObstacleError as ObstacleError
from .errors import QuasirigidError as QuasirigidError
from .errors import QuasirigidWarning as QuasirigidWarning
from .errors import ResponseError as ResponseError
from .errors import SurfaceError as SurfaceError
from .io import read_mesh as read_mesh
from .io import read_obstacle as read_obstacle
from .io import read_surface as read_surface
from .lcp import LcpOptions as LcpOptions
from .lcp import LcpSolution as LcpSolution
from .lcp import LcpStatus as LcpStatus
from .lcp import solve_lcp as solve_lcp
from .matrix import Definiteness as Definiteness
from .matrix import NetVolume as NetVolume
from .matrix import definiteness as definiteness
from .matrix import initial_gaps as initial_gaps
from .matrix import net_volume as net_volume
from .matrix import response_matrix as response_matrix
from .obstacle import Obstacle as Obstacle
from .skin import Body as Body
from .skin import CombinedSkin as CombinedSkin
from .skin import CutOut as CutOut
from .skin import GaussianCorrected as GaussianCorrected
from .skin import GivenMatrix as GivenMatrix
from .skin import HalfSpace as HalfSpace
from .skin import Layer as Layer
from .skin import PreparedSkin as PreparedSkin
from .skin import Response as Response
from .skin import Skin as Skin
from .skin import cut_out as cut_out
from .skin import load_prepared as load_prepared
from .surface import Repair as Repair
from .surface import Surface as Surface
from .surface import flat_cap_mask as flat_cap_mask
from .surface import repair as repair
