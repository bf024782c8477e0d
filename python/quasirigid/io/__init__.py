"""Files in and out: meshes with their unit, and what a contact is written to."""

from .read import LengthUnit as LengthUnit
from .read import read_mesh as read_mesh
from .read import read_obstacle as read_obstacle
from .read import read_surface as read_surface
from .summary import contact_summary as contact_summary
from .write import write_contact as write_contact
from .write import write_json as write_json
from .write import write_mesh as write_mesh
from .write import write_npz as write_npz
from .write import write_ply as write_ply
from .write import write_vtp as write_vtp
