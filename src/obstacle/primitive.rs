//! Signed distances of primitives in closed form.

use nalgebra::{Matrix3, Vector3};

use crate::geometry::bounds::Bounds;
use crate::geometry::direction::perpendicular;
use crate::geometry::segment::share_along;
use crate::obstacle::nearest::Nearest;

/// Within this share of the primitive's size from its surface, a direction `p - c` is rounding noise and the
/// normal of the surface's feature takes its place (dimensionless).
pub(super) const SURFACE_TOLERANCE: f64 = 1e-10;

/// A primitive in its own frame.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Primitive {
    /// Everything behind the plane through `point` (m) with unit `normal`.
    HalfSpace { point: Vector3<f64>, normal: Vector3<f64> },
    /// Ball (m).
    Sphere { center: Vector3<f64>, radius: f64 },
    /// Box around the origin, half its edge lengths (m).
    Cuboid { half_extents: Vector3<f64> },
    /// All points within `radius` (m) of the segment from `a` to `b` (m).
    Capsule { a: Vector3<f64>, b: Vector3<f64>, radius: f64 },
    /// Cylinder around the z axis, `|z| <= half_height` (m).
    Cylinder { half_height: f64, radius: f64 },
}

impl Primitive {
    /// Nearest point of the surface, in the primitive's frame.
    ///
    /// Where several points are nearest (centers, axes, medial planes) one is chosen by a fixed rule: +z at
    /// the center of a sphere, +x on a cylinder's axis, the direction of [`perpendicular`] on a capsule's; of
    /// faces equally near the one along the first axis, on its positive side at 0; a cylinder's side before its caps.
    pub(super) fn nearest(&self, p: &Vector3<f64>) -> Nearest {
        match self {
            Primitive::HalfSpace { point, normal } => {
                let distance = (p - point).dot(normal);
                Nearest { distance, closest: p - normal * distance, normal: *normal }
            }
            Primitive::Sphere { center, radius } => around(p, center, *radius, Vector3::z()),
            Primitive::Cuboid { half_extents } => nearest_on_cuboid(p, half_extents),
            Primitive::Capsule { a, b, radius } => {
                let axis = b - a;
                around(p, &(a + axis * share_along(p, a, b)), *radius, perpendicular(&axis))
            }
            Primitive::Cylinder { half_height, radius } => nearest_on_cylinder(p, *half_height, *radius),
        }
    }

    /// Box around the primitive once `turn` has rotated it; `None` for the half-space.
    pub fn bounding_box(&self, turn: &Matrix3<f64>) -> Option<Bounds> {
        let around = |center: Vector3<f64>, reach: Vector3<f64>| {
            Some(Bounds { low: center - reach, high: center + reach })
        };
        match self {
            Primitive::HalfSpace { .. } => None,
            Primitive::Sphere { center, radius } => around(turn * center, Vector3::repeat(*radius)),
            Primitive::Cuboid { half_extents } => around(Vector3::zeros(), turn.abs() * half_extents),
            Primitive::Capsule { a, b, radius } => Some(Bounds::around(&[turn * a, turn * b]).grown(*radius)),
            Primitive::Cylinder { half_height, radius } => {
                let reach = Vector3::from_fn(|i, _| {
                    let along = turn[(i, 2)];
                    along.abs() * half_height + radius * turn[(i, 0)].hypot(turn[(i, 1)])
                });
                around(Vector3::zeros(), reach)
            }
        }
    }
}

/// Nearest point of the sphere around `center`; `fallback` is the normal seen from the center itself.
fn around(p: &Vector3<f64>, center: &Vector3<f64>, radius: f64, fallback: Vector3<f64>) -> Nearest {
    let out = p - center;
    let length = out.norm();
    let normal = if length > 0.0 { out / length } else { fallback };
    Nearest { distance: length - radius, closest: center + normal * radius, normal }
}

fn nearest_on_cuboid(p: &Vector3<f64>, half_extents: &Vector3<f64>) -> Nearest {
    let side = p.map(|x| if x < 0.0 { -1.0 } else { 1.0 });
    let beyond = p.abs() - half_extents; // > 0: outside the pair of faces across that axis
    let tiny = SURFACE_TOLERANCE * half_extents.norm();

    // Outside, the offset from the closest point; inside, the closest lies across the nearest face.
    let outside = beyond.sup(&Vector3::zeros());
    let nearest_axis = beyond.imax();
    let is_outside = beyond[nearest_axis] > 0.0;
    let distance = if is_outside { outside.norm() } else { beyond[nearest_axis] };
    let mut closest = p.zip_map(half_extents, |x, h| x.clamp(-h, h));
    closest[nearest_axis] = side[nearest_axis] * half_extents[nearest_axis];

    let normal = if distance.abs() <= tiny {
        // On a face, edge or corner up to rounding: the mean of the faces that meet there.
        beyond.zip_map(&side, |beyond, side| if beyond >= -tiny { side } else { 0.0 }).normalize()
    } else if is_outside {
        outside.component_mul(&side) / distance
    } else {
        let mut normal = Vector3::zeros();
        normal[nearest_axis] = side[nearest_axis];
        normal
    };
    Nearest { distance, closest, normal }
}

fn nearest_on_cylinder(p: &Vector3<f64>, half_height: f64, radius: f64) -> Nearest {
    let rho = p.x.hypot(p.y);
    let radial = if rho > 0.0 { Vector3::new(p.x / rho, p.y / rho, 0.0) } else { Vector3::x() };
    let axial = Vector3::z() * if p.z < 0.0 { -1.0 } else { 1.0 };
    let (beyond_side, beyond_cap) = (rho - radius, p.z.abs() - half_height);

    let tiny = SURFACE_TOLERANCE * radius.hypot(half_height);
    let on_rim = radial * radius + axial * half_height;
    if beyond_side > 0.0 && beyond_cap > 0.0 && beyond_side.hypot(beyond_cap) > tiny {
        let distance = beyond_side.hypot(beyond_cap);
        let normal = (radial * beyond_side + axial * beyond_cap) / distance;
        return Nearest { distance, closest: on_rim, normal };
    }
    if beyond_side.abs() <= tiny && beyond_cap.abs() <= tiny {
        // On the rim up to rounding: the mean of side and cap.
        let outside = beyond_side.max(0.0).hypot(beyond_cap.max(0.0));
        let distance = if outside > 0.0 { outside } else { beyond_side.max(beyond_cap) };
        return Nearest { distance, closest: on_rim, normal: (radial + axial).normalize() };
    }
    if beyond_cap > beyond_side {
        let closest = Vector3::new(p.x, p.y, axial.z * half_height);
        Nearest { distance: beyond_cap, closest, normal: axial }
    } else {
        let closest = Vector3::new(radial.x * radius, radial.y * radius, p.z);
        Nearest { distance: beyond_side, closest, normal: radial }
    }
}
