//! The product: a closed mesh or a primitive at a rigid pose, answering signed distances.
//!
//! For a point `p` and the obstacle's surface `S` (a closed set of points) the signed distance is
//!
//! ```text
//! d(p) = ± min over s in S of |p - s|        + outside, - inside (m)
//! ```
//!
//! together with a closest point `c` and the outward unit normal `n`, so that `p = c + d n`. Primitives are
//! answered in closed form. A mesh is searched best-first through parry's tree of boxes; the sign comes from
//! the angle-weighted pseudo-normal of the closest feature (Baerentzen and Aanaes 2005,
//! doi:10.1109/TVCG.2005.49) and, where that is nearly perpendicular to `p - c`, from the solid angle of all
//! triangles (van Oosterom and Strackee 1983, doi:10.1109/TBME.1983.325207).
//!
//! That needs a closed mesh whose faces do not cross, which [`Obstacle::mesh`] checks once, in exact
//! arithmetic. [`Obstacle::first_touch`] moves the obstacle along a line until it meets the first of many points.
//! It is rigid unless [`Obstacle::with_material`] says what it is made of.

pub(crate) mod convex_edge;
pub(crate) mod distance;
pub(crate) mod edges;
pub(crate) mod error;
pub(crate) mod faces_near;
pub(crate) mod facets;
pub(crate) mod material;
pub(crate) mod mesh;
pub(crate) mod nearest;
pub(crate) mod placed;
mod pose_matrix;
pub(crate) mod posed;
pub(crate) mod primitive;
pub(crate) mod travel;

pub use distance::SignedDistances;
pub use error::ObstacleError;
pub use material::{Material, ProductResponse};
pub use mesh::MeshObstacleOptions;
pub use posed::{Obstacle, Triangles};
#[cfg(feature = "python")]
pub(crate) use primitive::Primitive;
pub use travel::first_touch::FirstTouch;
