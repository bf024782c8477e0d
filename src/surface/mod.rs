//! The skin: a validated triangle mesh with neighbourhoods, areas, normals and patches.
//!
//! [`Surface::new`] checks the mesh once (see [`mesh::check`](crate::mesh::check)) and keeps what the later
//! stages ask for: one-rings, face and vertex normals, face areas and the vertex areas `S_i` (m²), a third of
//! the area of the faces around `i`, so that `Σ S_i` is the area of the skin. Open surfaces are welcome.
//!
//! Searches on it: [`Surface::k_ring`], [`Surface::patches`], [`Surface::skin_distances`],
//! [`Surface::nearest_along_skin`] and [`Surface::skin_without_caps`]. [`shared_tissue`]: how far two
//! points are coupled through the tissue or belong to different fingers. [`cut_out`] takes one finger out of a whole hand.

mod breadth;
pub(crate) mod cap;
pub(crate) mod checked;
pub(crate) mod coarse;
pub(crate) mod cut_out;
mod edges;
pub(crate) mod measures;
pub(crate) mod refined;
mod rim;
pub(crate) mod rings;
pub(crate) mod sharp;
pub(crate) mod shortest_paths;

pub use checked::{Surface, SurfaceError};
pub use coarse::{CoarsePlace, CoarseSkin};
pub use cut_out::{CutOut, CutOutError, cut_out, cut_out_marked};
pub use refined::RefinedSurface;
pub use shortest_paths::{LONGEST_DETOUR, NearestAlongSkin, SHORT_DETOUR, shared_tissue};
