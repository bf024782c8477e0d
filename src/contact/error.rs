//! Why a contact could not be posed or carried through.

use crate::contact::outcome::Contact;
use crate::contact::report::digits::{Digits, Given};
use crate::geometry::bounds::LARGEST_COORDINATE;
use crate::lcp::problem::LcpError;
use crate::obstacle::error::ObstacleError;
use crate::response::error::ResponseError;

/// Why a contact could not be posed or carried through; an ending of a well-posed solve is a
/// [`ContactStatus`](crate::contact::ContactStatus) instead.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ContactError {
    /// An option is out of range.
    #[error("option `{option}` is {value}, expected {expected}")]
    Option {
        /// Name of the option.
        option: &'static str,
        /// Its value.
        value: f64,
        /// What it may be.
        expected: &'static str,
    },
    /// The direction of a press has no length or is not finite.
    #[error("direction ({0}, {1}, {2}) cannot be normalised: give a finite vector that is not zero", direction[0], direction[1], direction[2])]
    Direction {
        /// The direction given.
        direction: [f64; 3],
    },
    /// The depth of a press is negative, or too large for coordinates.
    #[error("depth is {} m, expected a depth from 0 to {:e} m", Given(*depth), LARGEST_COORDINATE)]
    Depth {
        /// The depth given (m).
        depth: f64,
    },
    /// The force or the overlap that a press is to reach is not positive or not finite.
    #[error("{goal} is {} {unit}, expected a finite {goal} > 0", Given(*value))]
    Goal {
        /// `force` or `overlap`.
        goal: &'static str,
        /// The value given.
        value: f64,
        /// Its unit.
        unit: &'static str,
    },
    /// A press cannot reach the force or the overlap asked for.
    #[error(
        "a{} {goal} of {} {unit} is not reached: the {} {goal} found is {} {unit} at a depth of {} m; {why}",
        if *goal == "overlap" { "n" } else { "" },
        Given(*asked),
        // Where contacts do not settle, the one found last can lie above.
        if found < asked { "largest" } else { "nearest" },
        Digits(*found, 4),
        Digits(*depth, 4)
    )]
    NotReached {
        /// `force` or `overlap`.
        goal: &'static str,
        /// Its unit.
        unit: &'static str,
        /// The value asked for.
        asked: f64,
        /// The largest found below it; where contacts do not settle, the nearest.
        found: f64,
        /// Depth of that (m).
        depth: f64,
        /// What is in the way.
        why: String,
        /// The contact at that depth.
        contact: PressedContact,
    },
    /// The point that an obstacle is to turn about is not finite.
    #[error("tilt_point is ({0}, {1}, {2}) m, expected three finite numbers", point[0], point[1], point[2])]
    TiltPoint {
        /// The point given (m).
        point: [f64; 3],
    },
    /// An axis that an obstacle is to turn about has no length or is not finite.
    #[error(
        "axis {number} of `tilt_axes` is ({0}, {1}, {2}) and cannot be normalised: give a finite vector that is not zero",
        axis[0], axis[1], axis[2]
    )]
    TiltAxis {
        /// Its number.
        number: usize,
        /// The axis given.
        axis: [f64; 3],
    },
    /// Two axes that an obstacle is to turn about are one.
    #[error("the two `tilt_axes` are parallel: leave one of them out, or turn it")]
    ParallelAxes,
    /// An obstacle that turns finds no balance.
    #[error(
        "the obstacle finds no balance about ({x:.4}, {y:.4}, {z:.4}) m: a moment of {} N m is left about \
         the tilt axes under {} N along the direction{}, turned by {angle:.4} rad; {why}: move `tilt_point` between \
         the parts of the skin that are to carry it{}",
        Digits(*moment, 7),
        Digits(*force, 7),
        asked.map_or(String::new(), |asked| format!(", where {} N is asked for", Given(asked))),
        if asked.is_some() { "" } else { ", or press deeper" },
        x = point[0], y = point[1], z = point[2]
    )]
    NotBalanced {
        /// The point that it turns about, where it stands now (m).
        point: [f64; 3],
        /// Moment on the skin about the axes that is left (N m, ≥ 0).
        moment: f64,
        /// Force on the skin along the direction (N).
        force: f64,
        /// The force that is to be reached, if one is (N).
        asked: Option<f64>,
        /// Angle that it has turned by (rad).
        angle: f64,
        /// What is in the way.
        why: String,
        /// The contact there.
        contact: PressedContact,
    },
    /// The area of a mean pressure is not positive or not finite.
    #[error("area is {area} m², expected a finite area > 0")]
    Area {
        /// The area given (m²).
        area: f64,
    },
    /// A mask has the wrong length.
    #[error(
        "the mask has {found} entries, expected {given}, one a vertex of the given mesh, or {whole}, one a vertex of \
         the mesh that was solved"
    )]
    MaskLength {
        /// Its length.
        found: usize,
        /// Vertices of the given mesh.
        given: usize,
        /// Vertices of the mesh that was solved.
        whole: usize,
    },
    /// No vertex may touch.
    #[error("the skin mask leaves no vertex that may touch ({vertex_count} vertices, all masked out)")]
    NoSkin {
        /// Vertices of the surface.
        vertex_count: usize,
    },
    /// Moving along the direction, the obstacle never meets the skin.
    #[error(
        "the obstacle never meets the skin along direction ({:.4}, {:.4}, {:.4}): none of the {skin_vertices} \
         vertices that may touch lies in its way; move it into line with the skin, or turn the direction. The skin is \
         {skin_size:.3e} m large, the obstacle {obstacle_size:.3e} m: check both units",
        direction[0], direction[1], direction[2]
    )]
    NeverTouches {
        /// The unit direction.
        direction: [f64; 3],
        /// Vertices that may touch.
        skin_vertices: usize,
        /// Diagonal of the skin's bounding box (m).
        skin_size: f64,
        /// That of the obstacle's; infinite for a half-space (m).
        obstacle_size: f64,
    },
    /// A press from the current position starts inside the skin.
    #[error(
        "the obstacle already penetrates the skin by {penetration:.6e} m at vertex {vertex} ({count} vertices in all): `start=\"current\"` needs a free start, use `start=\"infinity\"` or move the obstacle"
    )]
    StartsPenetrating {
        /// Deepest vertex.
        vertex: usize,
        /// Its depth (m).
        penetration: f64,
        /// Penetrating vertices.
        count: usize,
    },
    /// The obstacle stands in the skin between its vertices where a press starts.
    #[error(
        "the obstacle already stands in the skin by {penetration:.6e} m between its vertices: `start=\"current\"` needs a free start, use `start=\"infinity\"` or move the obstacle"
    )]
    StartsWithin {
        /// How deep (m).
        penetration: f64,
    },
    /// A vertex inside the obstacle is one that a body holds in place.
    #[error(
        "vertex {vertex} comes to lie inside the obstacle, and the body holds it fixed ({count} such vertices): mask them \
         out (`skin_mask` of the surface), fix fewer (`Body(fixed=)`), cut farther from the contact, or press less deep"
    )]
    Held {
        /// First such vertex.
        vertex: usize,
        /// How many there are.
        count: usize,
    },
    /// Candidates were still being added when the limit was reached.
    #[error(
        "the candidate set still grew after {growths} rounds ({candidates} of {skin_vertices} skin vertices): raise `max_growths`, or take a response without negative entries"
    )]
    Growth {
        /// Rounds done.
        growths: usize,
        /// Candidates then.
        candidates: usize,
        /// Skin vertices of the surface.
        skin_vertices: usize,
    },
    /// The caller asked to stop.
    #[error("interrupted during {stage}")]
    Interrupted {
        /// The stage under way.
        stage: &'static str,
    },
    /// The obstacle could not answer.
    #[error(transparent)]
    Obstacle(#[from] ObstacleError),
    /// The response matrix could not be built.
    #[error(transparent)]
    Response(#[from] ResponseError),
    /// The complementarity problem could not be posed.
    #[error(transparent)]
    Lcp(#[from] LcpError),
}

impl ContactError {
    /// Whether it may be that of a depth alone: deeper than the response knows, the body moves or memory holds.
    pub(crate) fn is_of_deeper(&self) -> bool {
        match self {
            Self::Response(error) => !error.is_interruption(),
            Self::Held { .. } | Self::Growth { .. } => true,
            _ => false,
        }
    }
}

/// The contact that a press came to which could not reach its goal or its balance.
#[derive(Debug, Clone)]
pub struct PressedContact(pub Box<Contact>);

impl PartialEq for PressedContact {
    /// Equal in depth, ending and node forces.
    fn eq(&self, other: &Self) -> bool {
        let of = |contact: &Self| (contact.0.depth, contact.0.status);
        of(self) == of(other) && self.0.node_force == other.0.node_force
    }
}
