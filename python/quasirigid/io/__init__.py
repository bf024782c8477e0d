"""Files and objects of other libraries, in and out.

Mesh files carry no unit, so reading and writing one asks for it. What a contact is saved to is in SI; the
tables for people are in mm, N and kPa.
"""

from .._units import UNITS as UNITS
from .._units import LengthUnit as LengthUnit
from .frame import contact_dataframe as contact_dataframe
from .frame import contact_pyvista as contact_pyvista
from .frame import contact_trimesh as contact_trimesh
from .frame import sweep_columns as sweep_columns
from .frame import sweep_dataframe as sweep_dataframe
from .frame import vertex_data as vertex_data
from .grasps import digit_table as digit_table
from .grasps import grasp_record as grasp_record
from .mesh import mesh_arrays as mesh_arrays
from .read import read_mesh as read_mesh
from .read import read_obstacle as read_obstacle
from .read import read_surface as read_surface
from .record import as_plain as as_plain
from .record import contact_record as contact_record
from .summary import compare_contacts as compare_contacts
from .summary import contact_html as contact_html
from .summary import contact_summary as contact_summary
from .summary import patch_table as patch_table
from .summary import refinement_table as refinement_table
from .summary import sweep_summary as sweep_summary
from .summary import sweep_table as sweep_table
from .sweeps import save_sweep as save_sweep
from .sweeps import sweep_record as sweep_record
from .write import save_contact as save_contact
from .write import write_mesh as write_mesh

__all__ = [
    "UNITS",
    "LengthUnit",
    "as_plain",
    "compare_contacts",
    "contact_dataframe",
    "contact_html",
    "contact_pyvista",
    "contact_record",
    "contact_summary",
    "contact_trimesh",
    "digit_table",
    "grasp_record",
    "mesh_arrays",
    "patch_table",
    "read_mesh",
    "read_obstacle",
    "read_surface",
    "refinement_table",
    "save_contact",
    "save_sweep",
    "sweep_columns",
    "sweep_dataframe",
    "sweep_record",
    "sweep_summary",
    "sweep_table",
    "vertex_data",
    "write_mesh",
]
