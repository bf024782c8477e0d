//! How deep each vertex of a skin stands in an obstacle, without a contact.

use crate::contact::error::ContactError;
use crate::contact::gap::initial::Gaps;
use crate::contact::options::{ContactOptions, with_threads};
use crate::contact::scene::Placement;
use crate::obstacle::posed::Obstacle;
use crate::surface::checked::Surface;

/// Depth (n, m, ≥ 0) of each vertex in an obstacle where it stands; 0 outside and where the mask keeps a vertex from
/// touching.
///
/// Measured as [`solve_contact`](crate::contact::solve_contact) does: through a wall thinner than the depth back along the
/// skin's inward normal to where the wall met the skin.
///
/// * `options`: threads and search distance
///
/// # Errors
/// [`ContactError`] where the obstacle cannot be measured.
pub fn overlaps(
    surface: &Surface,
    obstacle: &Obstacle,
    options: &ContactOptions,
) -> Result<Vec<f64>, ContactError> {
    options.validate()?;
    with_threads(options, || measured(surface, obstacle, options.search_distance))
}

fn measured(
    surface: &Surface,
    obstacle: &Obstacle,
    search_distance: Option<f64>,
) -> Result<Vec<f64>, ContactError> {
    let scene = Placement { obstacle, press: None }.scene(surface)?;
    let gaps = Gaps::measure(surface, &scene, search_distance)?;
    let mut depths = vec![0.0; surface.vertices().len()];
    for &vertex in &gaps.penetrating {
        depths[vertex] = -gaps.undeformed()[vertex];
    }
    Ok(depths)
}
