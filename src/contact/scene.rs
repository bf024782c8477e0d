//! Where the obstacle stands, and how it came there.

use std::sync::Arc;

use nalgebra::Vector3;

use crate::contact::candidate::on_refined::KnownFingers;
use crate::contact::cuts::Cuts;
use crate::contact::error::ContactError;
use crate::contact::figures::penetration::at_rest::SkinNear;
use crate::contact::first_touch::{first_touch, never_touches, skin_vertices, touch_rounding};
use crate::contact::gap::touch::touch_between;
use crate::contact::outcome::Contact;
use crate::contact::tilt::axes::{Balance, Turn};
use crate::obstacle::posed::Obstacle;
use crate::surface::checked::Surface;

/// Where a press begins.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Start {
    /// The obstacle comes from infinity along the direction; its first touch is travel zero of the depth.
    Infinity,
    /// The obstacle starts where it stands and moves by the depth.
    Current,
}

/// How far a press goes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Goal {
    /// Depth δ (m, ≥ 0): travel beyond the first touch, or beyond the current position.
    Depth(f64),
    /// Force on the skin along the direction (N, > 0).
    Force(f64),
    /// Deepest penetration of a vertex of the undeformed skin (m, > 0).
    Overlap(f64),
}

/// A press: the obstacle moves along a direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Press {
    /// Direction of travel of the obstacle; normalised here.
    pub direction: Vector3<f64>,
    /// Where it ends.
    pub goal: Goal,
    /// Where it begins.
    pub start: Start,
    /// Whether the obstacle turns as well. The depth is then the travel of the point that it turns about, past the
    /// first touch of the obstacle as it was given.
    pub balance: Balance,
}

/// The way of a press.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Approach {
    /// Unit direction.
    pub direction: Vector3<f64>,
    /// Where it begins.
    pub start: Start,
    /// Of the obstacle, where it has turned.
    pub turn: Option<Turn>,
    /// Travel of the first touch (m), where the skin at hand is a part that need not show it.
    pub known_touch: Option<f64>,
}

/// Slope of an obstacle where it touches, at the steepest: what a turn moves across the press is so much deeper there.
const STEEPEST: f64 = 0.25;

/// Where on its way an obstacle touches.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Touch {
    /// Travel at which the press begins (m).
    pub begin: f64,
    /// Depth at which it touches (m).
    pub depth: f64,
}

impl Touch {
    /// Way of a press past the touch (m).
    pub fn past(&self, pressed: &Contact) -> f64 {
        pressed.pressed_depth() - self.depth
    }
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
    /// What a refined mesh takes over from the given one.
    pub inherited: Option<Arc<Inherited>>,
}

/// What a refined mesh takes over from the given one.
#[derive(Debug, Clone)]
pub(crate) struct Inherited {
    /// The fingers of the given mesh.
    pub fingers: KnownFingers,
    /// Where the skin ends.
    pub cuts: Cuts,
    /// How far skin in overlap looks for the way that it came in (m): no shorter on finer edges.
    pub search_distance: f64,
}

/// How the obstacle comes to its place.
#[derive(Clone, Copy)]
pub(crate) struct Placement<'a> {
    /// The obstacle before that.
    pub obstacle: &'a Obstacle,
    /// The way it comes, and the travel beyond the beginning of that (m, ≥ 0); `None`: it stays where it is.
    pub press: Option<(Approach, f64)>,
}

impl Placement<'_> {
    /// The obstacle where it stands against a skin.
    pub fn scene(&self, surface: &Surface) -> Result<Scene, ContactError> {
        let Some((approach, depth)) = self.press else {
            let obstacle = self.obstacle.clone();
            return Ok(Scene { obstacle, travel: 0.0, press: None, depth_bound: None, inherited: None });
        };
        let touch = match approach.touch(surface, self.obstacle) {
            Err(ContactError::NeverTouches { .. }) if approach.start == Start::Current => {
                Touch { begin: 0.0, depth }
            }
            touch => touch?,
        };
        let turned = approach.turned_touch(touch, surface, self.obstacle)?;
        Ok(approach.scene(depth, surface, self.obstacle, turned.unwrap_or(touch)))
    }
}

impl Approach {
    /// Of an obstacle that does not turn.
    pub fn new(direction: Vector3<f64>, start: Start) -> Self {
        Self { direction, start, turn: None, known_touch: None }
    }

    /// The obstacle at a depth (m).
    pub fn scene(&self, depth: f64, surface: &Surface, obstacle: &Obstacle, touch: Touch) -> Scene {
        let travel = touch.begin + depth;
        let way = travel * self.direction;
        let mut placed = obstacle.translated(&way);
        let past = (depth - touch.depth).max(0.0);
        let mut turned = self.turn.map(|turn| Turn { point: turn.point + way, ..turn });
        if let Some(turn) = &turned {
            placed = turn.of(&placed);
        }
        // From infinity it came as it is turned now: the touch is its own.
        turned = turned.filter(|_| self.start == Start::Current);
        let mut deepest = past;
        if let Some(turn) = &turned {
            let farthest = skin_vertices(surface).map(|(_, position)| (position - turn.point).norm());
            deepest += turn.farthest(farthest.fold(0.0, f64::max));
        }
        Scene {
            obstacle: placed,
            travel,
            press: Some(Travel { direction: self.direction, depth, past, turned, deepest }),
            depth_bound: Some(deepest + touch_rounding(surface)),
            inherited: None,
        }
    }

    /// A touch as the obstacle is turned, where it comes from infinity so; `None` where it never does.
    pub fn turned_touch(
        &self,
        touch: Touch,
        surface: &Surface,
        obstacle: &Obstacle,
    ) -> Result<Option<Touch>, ContactError> {
        let Some(turn) = self.turn.filter(|_| self.start == Start::Infinity) else { return Ok(Some(touch)) };
        match first_touch(surface, &turn.of(obstacle), &self.direction) {
            Err(ContactError::NeverTouches { .. }) => Ok(None),
            travel => Ok(Some(Touch { depth: travel? - touch.begin, ..touch })),
        }
    }

    /// Where on its way the obstacle touches that does not turn.
    pub fn touch(&self, surface: &Surface, obstacle: &Obstacle) -> Result<Touch, ContactError> {
        if self.start == Start::Infinity {
            let begin =
                self.known_touch.map_or_else(|| first_touch(surface, obstacle, &self.direction), Ok)?;
            return Ok(Touch { begin, depth: 0.0 });
        }
        let touching: Vec<Vector3<f64>> = skin_vertices(surface).map(|(_, position)| position).collect();
        let of_vertices = obstacle.first_touch_from_current(&touching, &self.direction)?;
        let of_vertices = of_vertices.map_or(f64::INFINITY, |touch| touch.travel);
        let between =
            touch_between(surface, obstacle, &self.direction, [-touch_rounding(surface), of_vertices]);
        match of_vertices.min(between.max(0.0)) {
            f64::INFINITY => Err(never_touches(surface, obstacle, &self.direction)),
            depth => Ok(Touch { begin: 0.0, depth }),
        }
    }

    /// Checks that nothing penetrates yet where the obstacle starts.
    ///
    /// # Errors
    /// [`ContactError::StartsPenetrating`], [`ContactError::StartsWithin`].
    pub fn check_start(&self, surface: &Surface, obstacle: &Obstacle) -> Result<(), ContactError> {
        if self.start == Start::Infinity {
            return Ok(());
        }
        let near = SkinNear::new(surface, obstacle, None)?;
        // A position reached by an earlier press touches exactly; its rounding is no penetration.
        let allowed = touch_rounding(surface);
        let depths = near.vertices.iter().zip(near.distance.iter().map(|distance| -distance));
        let inside = depths.filter(|(_, depth)| *depth > allowed);
        let count = inside.clone().count();
        if let Some((&vertex, penetration)) = inside.rev().max_by(|(_, a), (_, b)| a.total_cmp(b)) {
            return Err(ContactError::StartsPenetrating { vertex, penetration, count });
        }
        let penetration = near.deepest_edge(obstacle, allowed);
        if penetration > allowed { Err(ContactError::StartsWithin { penetration }) } else { Ok(()) }
    }
}

/// A press that ends where the obstacle stands, which nothing penetrated at its start.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Travel {
    /// Unit direction of the obstacle.
    pub direction: Vector3<f64>,
    /// Its length (m), and how much of that is past the touch.
    pub depth: f64,
    pub past: f64,
    /// How the obstacle turned there, where it did not come from infinity so.
    pub turned: Option<Turn>,
    /// A penetration that none exceeds (m): the way past the touch where the obstacle did not turn.
    pub deepest: f64,
}

impl Travel {
    /// How far the obstacle came along the direction to a place, past the touch (m): with a turn it brings other points there.
    pub fn way_to(&self, place: &Vector3<f64>) -> f64 {
        let turned = self.turned.map_or(Vector3::zeros(), |turn| turn.way_to(place));
        self.past + self.direction.dot(&turned) + STEEPEST * turned.norm()
    }
}
