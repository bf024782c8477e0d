//! Thin PyO3 layer: convert, detach, call, convert back. The typed facade in `python/quasirigid` builds on it.

mod accuracy;
mod arrays_out;
mod contact;
mod contact_options;
mod convert;
mod cut_out;
mod described;
mod elastic;
mod errors;
mod forked;
mod gaps;
mod hand;
mod interrupt;
mod lcp;
mod loaded;
mod material;
mod matrix;
mod obstacle;
mod pickle;
mod raw_mesh;
mod reference;
mod resultant;
mod skin;
mod stored_skin;
mod surface;

use pyo3::prelude::*;

/// The compiled core of quasirigid.
#[pymodule]
mod _core {
    #[pymodule_export]
    use super::accuracy::{PyAccuracy, PyRefinement};
    #[pymodule_export]
    use super::contact::{PyContact, PyDrawing, PyWarmStart, press, solve_contact};
    #[pymodule_export]
    use super::contact_options::PyContactOptions;
    #[pymodule_export]
    use super::cut_out::{cut_out, cut_out_marked};
    #[pymodule_export]
    use super::gaps::{initial_gaps, overlaps};
    #[pymodule_export]
    use super::hand::PySkinWeights;
    #[pymodule_export]
    use super::lcp::{PyLcpOptions, PyLcpRay, PyLcpSolution, solve_lcp};
    #[pymodule_export]
    use super::loaded::PyLoadedVertices;
    #[pymodule_export]
    use super::matrix::{PyDefiniteness, definiteness, response_matrix};
    #[pymodule_export]
    use super::obstacle::{PyObstacle, restore_obstacle};
    #[pymodule_export]
    use super::raw_mesh::{find_crossings, repair};
    #[pymodule_export]
    use super::reference::{
        PyCone, PyFlatPunch, PyHertz, ball_on_cored_sphere, contact_modulus, plate_on_cored_sphere,
        point_load_on_layer, sphere_on_layer,
    };
    #[pymodule_export]
    use super::resultant::PyResultant;
    #[pymodule_export]
    use super::skin::PySkin;
    #[pymodule_export]
    use super::stored_skin::{restore_body, skin_parts};
    #[pymodule_export]
    use super::surface::{PySurface, restore_surface, skin_without_caps, way_out};

    use pyo3::prelude::*;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        super::forked::note_process();
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
