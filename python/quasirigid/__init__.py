"""Quasi-rigid contact of hand skin with products.

Press a posed hand (a triangle mesh) against a product (a triangle mesh or a primitive) and read off the
deformed skin, the pressure map, area, force and moment, and how far each can be trusted. All numbers are SI:
m, N, Pa, rad, s. `io`, `plot`, `reference`, `accuracy` and `stress` are imported when they are first used.
"""

from . import _interrupt as _interrupt  # isort: skip  # first: it hears Ctrl-C while the rest is imported

from importlib import import_module as _import_module
from typing import TYPE_CHECKING as _TYPE_CHECKING

from . import hand, models
from ._core import __version__
from .contact import (
    Accuracy,
    Balance,
    Contact,
    ContactError,
    ContactOptions,
    ContactStatus,
    LeftOut,
    Part,
    Patch,
    Refinement,
    RefinementKind,
    Start,
    Sweep,
    press,
    solve_contact,
    sweep,
)
from .errors import (
    CoarseMeshWarning,
    CutWarning,
    DepthWarning,
    DirectionWarning,
    HandError,
    MaskWarning,
    MeshFileError,
    MissingExtraError,
    ModulusWarning,
    ObstacleError,
    PenetrationWarning,
    QuasirigidError,
    QuasirigidWarning,
    RefinementWarning,
    ResponseError,
    ResponseRangeWarning,
    SizeWarning,
    SurfaceError,
)
from .hand import Grasp, Hand, PosedHand, close_hand, read_hand
from .io.read import read_mesh, read_obstacle, read_surface
from .lcp import (
    Certificate,
    LcpAttempt,
    LcpDefiniteness,
    LcpError,
    LcpMethod,
    LcpOptions,
    LcpRay,
    LcpSolution,
    LcpStatus,
    RayConclusion,
    solve_lcp,
)
from .matrix import Definiteness, NetVolume, definiteness, initial_gaps, net_volume, response_matrix
from .obstacle import Material, Obstacle
from .skin import (
    Body,
    CombinedSkin,
    CutOut,
    Discretization,
    ElasticSkin,
    GaussianCorrected,
    GivenMatrix,
    HalfSpace,
    Layer,
    PreparedSkin,
    PressureBasis,
    Response,
    Skin,
    cut_out,
    load_prepared,
)
from .surface import Repair, Surface, repair, skin_without_caps

if _TYPE_CHECKING:
    from . import io, plot, reference
    from .evaluation import Table, accuracy, stress

__all__ = [
    "Accuracy",
    "Balance",
    "Body",
    "Certificate",
    "CoarseMeshWarning",
    "CombinedSkin",
    "Contact",
    "ContactError",
    "ContactOptions",
    "ContactStatus",
    "CutOut",
    "CutWarning",
    "Definiteness",
    "DepthWarning",
    "DirectionWarning",
    "Discretization",
    "ElasticSkin",
    "GaussianCorrected",
    "GivenMatrix",
    "Grasp",
    "HalfSpace",
    "Hand",
    "HandError",
    "Layer",
    "LcpAttempt",
    "LcpDefiniteness",
    "LcpError",
    "LcpMethod",
    "LcpOptions",
    "LcpRay",
    "LcpSolution",
    "LcpStatus",
    "LeftOut",
    "MaskWarning",
    "Material",
    "MeshFileError",
    "MissingExtraError",
    "ModulusWarning",
    "NetVolume",
    "Obstacle",
    "ObstacleError",
    "Part",
    "Patch",
    "PenetrationWarning",
    "PosedHand",
    "PreparedSkin",
    "PressureBasis",
    "QuasirigidError",
    "QuasirigidWarning",
    "RayConclusion",
    "Refinement",
    "RefinementKind",
    "RefinementWarning",
    "Repair",
    "Response",
    "ResponseError",
    "ResponseRangeWarning",
    "SizeWarning",
    "Skin",
    "Start",
    "Surface",
    "SurfaceError",
    "Sweep",
    "Table",
    "__version__",
    "accuracy",
    "close_hand",
    "cut_out",
    "definiteness",
    "hand",
    "initial_gaps",
    "io",
    "load_prepared",
    "models",
    "net_volume",
    "plot",
    "press",
    "read_hand",
    "read_mesh",
    "read_obstacle",
    "read_surface",
    "reference",
    "repair",
    "response_matrix",
    "skin_without_caps",
    "solve_contact",
    "solve_lcp",
    "stress",
    "sweep",
]


if not _TYPE_CHECKING:

    def __getattr__(name: str) -> object:
        """Import what is used by some alone when it is first asked for."""
        if name in ("io", "plot", "reference"):
            return _import_module(f".{name}", __name__)
        if name in ("Table", "accuracy", "stress"):
            return getattr(_import_module(".evaluation", __name__), name)
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    """Return the names that a user may use."""
    return __all__
