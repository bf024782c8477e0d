//! Where an obstacle that comes from infinity first touches skin, at its vertices and between them.

use nalgebra::Vector3;

use crate::contact::error::ContactError;
use crate::contact::gap::touch::touch_between;
use crate::obstacle::posed::Obstacle;
use crate::surface::checked::Surface;

/// Rounding of a first touch, relative to the size of skin and obstacle: the depth bound is raised by it.
const TOUCH_ROUNDING: f64 = 1e-10;

/// A copy of an obstacle where it first touches skin that may touch, coming from infinity along a unit direction.
///
/// # Errors
/// [`ContactError`] by variant: it never touches, or no vertex may.
pub fn touching(
    surface: &Surface,
    obstacle: &Obstacle,
    direction: &Vector3<f64>,
) -> Result<Obstacle, ContactError> {
    Ok(obstacle.translated(&(first_touch(surface, obstacle, direction)? * direction)))
}

/// Travel (m) at which the obstacle, coming from infinity, first touches skin that may touch.
pub(crate) fn first_touch(
    surface: &Surface,
    obstacle: &Obstacle,
    direction: &Vector3<f64>,
) -> Result<f64, ContactError> {
    let touching: Vec<Vector3<f64>> = skin_vertices(surface).map(|(_, position)| position).collect();
    if touching.is_empty() {
        return Err(ContactError::NoSkin { vertex_count: surface.vertices().len() });
    }
    let of_vertices = obstacle.first_touch(&touching, direction)?.map_or(f64::INFINITY, |touch| touch.travel);
    let travel =
        of_vertices.min(touch_between(surface, obstacle, direction, [f64::NEG_INFINITY, of_vertices]));
    if travel.is_infinite() {
        return Err(never_touches(surface, obstacle, direction));
    }
    Ok(travel)
}

pub(crate) fn never_touches(
    surface: &Surface,
    obstacle: &Obstacle,
    direction: &Vector3<f64>,
) -> ContactError {
    ContactError::NeverTouches {
        direction: (*direction).into(),
        skin_vertices: skin_vertices(surface).count(),
        skin_size: surface.bounding_box().diagonal(),
        obstacle_size: obstacle.bounding_box().map_or(f64::INFINITY, |bounds| bounds.diagonal()),
    }
}

/// Rounding of a touch (m).
pub(crate) fn touch_rounding(surface: &Surface) -> f64 {
    TOUCH_ROUNDING * surface.bounding_box().diagonal()
}

pub(crate) fn skin_vertices(surface: &Surface) -> impl Iterator<Item = (usize, Vector3<f64>)> + '_ {
    let may_touch = |&(vertex, _): &(usize, Vector3<f64>)| surface.skin_mask()[vertex];
    surface.vertices().iter().copied().enumerate().filter(may_touch)
}
