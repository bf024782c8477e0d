//! Bringing the obstacle to the skin: first touch, then a depth.

use std::time::Instant;

use nalgebra::Vector3;

use crate::contact::error::ContactError;
use crate::contact::gap::measured::Measured;
use crate::contact::options::{ContactOptions, with_threads};
use crate::contact::outcome::Contact;
use crate::contact::report::record::Report;
use crate::contact::scene::{Scene, Travel};
use crate::contact::solve::solve_in_place;
use crate::obstacle::posed::Obstacle;
use crate::response::skin::elastic::ElasticSkin;
use crate::surface::checked::Surface;

/// Where a press begins.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Start {
    /// The obstacle comes from infinity against the direction; its first touch is travel zero of the depth.
    Infinity,
    /// The obstacle starts where it stands and moves by the depth.
    Current,
}

/// A press: the obstacle moves along a direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Press {
    /// Direction of travel of the obstacle; normalised here.
    pub direction: Vector3<f64>,
    /// Depth δ (m, ≥ 0): travel beyond the first touch, or beyond the current position.
    pub depth: f64,
    /// Where it begins.
    pub start: Start,
}

/// Rounding of a first touch, relative to the size of skin and obstacle: the depth bound is raised by it.
const TOUCH_ROUNDING: f64 = 1e-10;

/// Moves the obstacle along a direction to a depth, then solves the contact.
///
/// From infinity, the depth counts from the *first touch*: the position along the line of travel at which the
/// obstacle first brings a skin vertex to distance 0. The travel reported may be negative, for a scene that starts
/// in overlap.
///
/// Vertices that came in through another side of the obstacle than their closest one (beside an edge, through the rim
/// of a can) get the way back along the travel for their gap, which `left_out` counts; a warning counts those
/// that went through a wall thinner than their depth. Not so in Galerkin form.
///
/// # Errors
/// [`ContactError`] by variant; among them a direction that cannot be normalised, a negative depth, an obstacle
/// that never meets the skin, and a current position that already penetrates.
pub fn press(
    surface: &Surface,
    obstacle: &Obstacle,
    skin: &dyn ElasticSkin,
    press: &Press,
    options: &ContactOptions,
) -> Result<Contact, ContactError> {
    options.validate()?;
    let direction = unit(&press.direction)?;
    if !(press.depth >= 0.0 && press.depth.is_finite()) {
        return Err(ContactError::Depth { depth: press.depth });
    }
    with_threads(options, || {
        let started = Instant::now();
        let touch = match press.start {
            Start::Infinity => first_touch(surface, obstacle, &direction)?,
            Start::Current => free_start(surface, obstacle)?,
        };
        let travel = touch + press.depth;
        let scene = Scene {
            obstacle: obstacle.translated(&(travel * direction)),
            travel,
            press: Some(Travel { direction, depth: press.depth }),
            depth_bound: Some(press.depth + TOUCH_ROUNDING * size(surface)),
        };
        let mut report = Report::default();
        report.clock("first_touch", started);
        solve_in_place(surface, &scene, skin, options, report)
    })
}

fn unit(direction: &Vector3<f64>) -> Result<Vector3<f64>, ContactError> {
    // Scaling first keeps tiny and huge directions from under- and overflowing.
    let scaled = direction / direction.amax();
    let length = scaled.norm();
    if !(length > 0.0 && length.is_finite()) {
        return Err(ContactError::Direction { direction: (*direction).into() });
    }
    Ok(scaled / length)
}

/// Travel (m) at which the obstacle, coming from infinity, first touches a vertex that may touch.
fn first_touch(
    surface: &Surface,
    obstacle: &Obstacle,
    direction: &Vector3<f64>,
) -> Result<f64, ContactError> {
    let touching: Vec<Vector3<f64>> = skin_vertices(surface).map(|(_, position)| position).collect();
    if touching.is_empty() {
        return Err(ContactError::NoSkin { vertex_count: surface.vertices().len() });
    }
    match obstacle.first_touch(&touching, direction)? {
        Some(touch) => Ok(touch.travel),
        None => {
            Err(ContactError::NeverTouches { direction: (*direction).into(), skin_vertices: touching.len() })
        }
    }
}

/// Travel 0, after a check that nothing penetrates yet.
fn free_start(surface: &Surface, obstacle: &Obstacle) -> Result<f64, ContactError> {
    let (vertices, positions): (Vec<usize>, Vec<Vector3<f64>>) = skin_vertices(surface).unzip();
    let distance = Measured::near(&positions, obstacle, 0.0, None)?.distance;
    // A position reached by an earlier press touches exactly; its rounding is no penetration.
    let allowed = -TOUCH_ROUNDING * size(surface);
    let inside = distance.iter().filter(|&&d| d < allowed).count();
    let deepest = (0..distance.len()).min_by(|&a, &b| distance[a].total_cmp(&distance[b]));
    match deepest {
        Some(row) if inside > 0 => Err(ContactError::StartsPenetrating {
            vertex: vertices[row],
            penetration: -distance[row],
            count: inside,
        }),
        _ => Ok(0.0),
    }
}

fn skin_vertices(surface: &Surface) -> impl Iterator<Item = (usize, Vector3<f64>)> + '_ {
    let may_touch = |&(vertex, _): &(usize, Vector3<f64>)| surface.skin_mask()[vertex];
    surface.vertices().iter().copied().enumerate().filter(may_touch)
}

/// Diagonal of the surface's bounding box (m).
fn size(surface: &Surface) -> f64 {
    surface.bounding_box().diagonal()
}
