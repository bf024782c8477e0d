//! A shape on its way along a line, in the shape's own frame.
//!
//! While the shape travels by `t` along the unit `direction` u, a point at `p` is seen from the shape at
//! `p - t u`. So the shape meets it at the `t` for which `p - t u` lies on the surface.

use nalgebra::{Matrix3, Vector3};

use crate::obstacle::error::ObstacleError;
use crate::obstacle::posed::Shape;
use crate::obstacle::primitive::Primitive;
use crate::obstacle::travel::shadow::Shadow;

/// Cosine to its normal above which a half-space arrives from infinity.
const ARRIVAL_COSINE: f64 = 1e-12;

/// Points and a shape that travels past them.
pub(super) struct SweptShape<'a> {
    points: Vec<Vector3<f64>>,
    direction: Vector3<f64>,
    outline: Outline<'a>,
}

/// What meets the points.
enum Outline<'a> {
    Mesh(Shadow<'a>),
    Primitive(&'a Primitive),
}

impl<'a> SweptShape<'a> {
    /// `points` (m) and the unit `direction` are in the shape's frame.
    pub fn new(shape: &'a Shape, points: Vec<Vector3<f64>>, direction: Vector3<f64>) -> SweptShape<'a> {
        let outline = match shape {
            Shape::Mesh(mesh) => Outline::Mesh(Shadow::new(mesh, &direction)),
            Shape::Primitive(primitive) => Outline::Primitive(primitive),
        };
        SweptShape { points, direction, outline }
    }

    /// A length that stands for the shape (m).
    pub fn size(&self) -> f64 {
        match &self.outline {
            Outline::Mesh(shadow) => shadow.mesh().size(),
            Outline::Primitive(primitive) => {
                primitive.bounding_box(&Matrix3::identity()).map_or(1.0, |bounds| bounds.diagonal())
            }
        }
    }

    /// Whether the shape is away from every point at `t = -inf`.
    pub fn check_arrival(&self) -> Result<(), ObstacleError> {
        if let Outline::Primitive(Primitive::HalfSpace { normal, .. }) = self.outline {
            let cosine = normal.dot(&self.direction);
            if cosine <= ARRIVAL_COSINE {
                return Err(ObstacleError::HalfSpaceDirection { cosine, tolerance: ARRIVAL_COSINE });
            }
        }
        Ok(())
    }

    /// The smallest travel `>= start` at which the point is on the surface. `None` if there is none, or none up
    /// to `latest`.
    pub fn meeting(&self, point: usize, start: f64, latest: f64) -> Option<f64> {
        let p = &self.points[point];
        match &self.outline {
            Outline::Mesh(shadow) => shadow.meeting(p, start, latest),
            Outline::Primitive(primitive) => {
                let [enter, leave] = stay(primitive, p, &self.direction)?;
                [enter, leave].into_iter().find(|t| *t >= start && t.is_finite())
            }
        }
    }
}

/// First and last `t` at which `p - t u` lies in the primitive; `None` if it never does.
fn stay(primitive: &Primitive, p: &Vector3<f64>, u: &Vector3<f64>) -> Option<[f64; 2]> {
    match primitive {
        Primitive::HalfSpace { point, normal } => {
            let (height, speed) = ((p - point).dot(normal), u.dot(normal));
            if speed == 0.0 {
                return (height <= 0.0).then_some([f64::NEG_INFINITY, f64::INFINITY]);
            }
            let t = height / speed;
            Some(if speed > 0.0 { [t, f64::INFINITY] } else { [f64::NEG_INFINITY, t] })
        }
        Primitive::Sphere { center, radius } => stay_in_ball(&(p - center), u, *radius),
        Primitive::Cuboid { half_extents } => (0..3).try_fold(WHOLE_LINE, |stay, axis| {
            both(stay, stay_in_slab(p[axis], u[axis], half_extents[axis])?)
        }),
        Primitive::Capsule { a, b, radius } => {
            // A cylinder without caps between two balls that cover its ends.
            let axis = (b - a).normalize();
            let half_length = (b - a).norm() * 0.5;
            let q = p - (a + b) * 0.5;
            let (along, speed) = (q.dot(&axis), u.dot(&axis));
            let tube = stay_in_ball(&(q - axis * along), &(u - axis * speed), *radius)
                .and_then(|tube| both(tube, stay_in_slab(along, speed, half_length)?));
            let ends = [stay_in_ball(&(p - a), u, *radius), stay_in_ball(&(p - b), u, *radius)];
            ends.into_iter()
                .chain([tube])
                .flatten()
                .reduce(|one, other| [one[0].min(other[0]), one[1].max(other[1])])
        }
        Primitive::Cylinder { half_height, radius } => {
            let across = |v: &Vector3<f64>| Vector3::new(v.x, v.y, 0.0);
            let tube = stay_in_ball(&across(p), &across(u), *radius)?;
            both(tube, stay_in_slab(p.z, u.z, *half_height)?)
        }
    }
}

const WHOLE_LINE: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];

fn both(one: [f64; 2], other: [f64; 2]) -> Option<[f64; 2]> {
    let stay = [one[0].max(other[0]), one[1].min(other[1])];
    (stay[0] <= stay[1]).then_some(stay)
}

/// `|x - t speed| <= half_width`.
fn stay_in_slab(x: f64, speed: f64, half_width: f64) -> Option<[f64; 2]> {
    if speed == 0.0 {
        return (x.abs() <= half_width).then_some(WHOLE_LINE);
    }
    let (one, other) = ((x - half_width) / speed, (x + half_width) / speed);
    Some([one.min(other), one.max(other)])
}

/// `|v - t u| <= radius`; `u` need not be a unit vector, and the ball may be a disc or a tube seen end on.
fn stay_in_ball(v: &Vector3<f64>, u: &Vector3<f64>, radius: f64) -> Option<[f64; 2]> {
    let speed_squared = u.norm_squared();
    if speed_squared == 0.0 {
        return (v.norm() <= radius).then_some(WHOLE_LINE);
    }
    let nearest = v.dot(u) / speed_squared;
    let miss = (v - u * nearest).norm();
    // (r - m)(r + m) instead of r^2 - m^2: exact where the line grazes.
    let half_chord_squared = (radius - miss) * (radius + miss);
    (half_chord_squared >= 0.0).then(|| {
        let half = (half_chord_squared / speed_squared).sqrt();
        [nearest - half, nearest + half]
    })
}
