"""Built-in hands, fingers and products, so that a press needs no file at all.

Fingers have their pad to -z, their nail to +z and their axis along +y, the origin in the middle of the flat
cut; `quasirigid.skin_without_caps` leaves the cut out. Products have their bounding box centered at the
origin; round ones stand along z. The hand has its wrist joint at the origin, its fingers along +y and its
palm to -z. Every length is in metres, and `edge_length` sets the mesh density.
"""

from .bones import bone_of as bone_of
from .fingers import finger as finger
from .fingers import fingertip as fingertip
from .hands import hand as hand
from .products import bottle as bottle
from .products import cylinder_handle as cylinder_handle
from .products import rounded_box as rounded_box

__all__ = ["bone_of", "bottle", "cylinder_handle", "finger", "fingertip", "hand", "rounded_box"]
