//! Where the obstacle stands, and how it comes there: first touch, then a depth.

use nalgebra::Vector3;

use crate::contact::error::ContactError;
use crate::contact::gap::measured::Measured;
use crate::contact::report::cuts::Cuts;
use crate::obstacle::posed::Obstacle;
use crate::surface::checked::Surface;

/// Rounding of a first touch, relative to the size of skin and obstacle: the depth bound is raised by it.
const TOUCH_ROUNDING: f64 = 1e-10;

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

/// The obstacle in place, and what is known from bringing it there.
pub(crate) struct Scene {
    pub obstacle: Obstacle,
    /// Way of the obstacle (m).
    pub travel: f64,
    /// The press that brought it there, where one did.
    pub press: Option<Travel>,
    /// A penetration that no skin vertex exceeds (m), where known.
    pub depth_bound: Option<f64>,
    /// On a refined mesh, the finger of each vertex as the given one told.
    pub finger_of: Option<Vec<Option<usize>>>,
    /// On a refined mesh, where the given one ends or is held.
    pub cuts: Option<Cuts>,
}

/// How the obstacle comes to its place.
#[derive(Clone, Copy)]
pub(crate) struct Placement<'a> {
    /// The obstacle before that.
    pub obstacle: &'a Obstacle,
    /// Unit direction, depth and start of the press; `None`: it stays where it is.
    pub press: Option<Press>,
}

impl Placement<'_> {
    /// The obstacle where it stands against a skin.
    ///
    /// * `is_refined`: whether a press from where the obstacle stands was found to be free before
    pub fn scene(&self, surface: &Surface, is_refined: bool) -> Result<Scene, ContactError> {
        let Some(press) = self.press else {
            let obstacle = self.obstacle.clone();
            return Ok(Scene {
                obstacle,
                travel: 0.0,
                press: None,
                depth_bound: None,
                finger_of: None,
                cuts: None,
            });
        };
        let touch = match press.start {
            Start::Infinity => first_touch(surface, self.obstacle, &press.direction)?,
            Start::Current if is_refined => 0.0,
            Start::Current => free_start(surface, self.obstacle)?,
        };
        let travel = touch + press.depth;
        Ok(Scene {
            obstacle: self.obstacle.translated(&(travel * press.direction)),
            travel,
            press: Some(Travel { direction: press.direction, depth: press.depth }),
            depth_bound: Some(press.depth + TOUCH_ROUNDING * surface.bounding_box().diagonal()),
            finger_of: None,
            cuts: None,
        })
    }
}

/// A press that ends where the obstacle stands, which nothing penetrated at its start.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Travel {
    /// Unit direction of the obstacle.
    pub direction: Vector3<f64>,
    /// Its length (m).
    pub depth: f64,
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
    let allowed = -TOUCH_ROUNDING * surface.bounding_box().diagonal();
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
