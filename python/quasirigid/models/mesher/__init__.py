"""Even triangle meshes of implicit bodies: the mesher behind the built-in hand."""

from .contour import contour as contour
from .remesh import Body as Body
from .remesh import remeshed as remeshed

__all__ = ["Body", "contour", "remeshed"]
