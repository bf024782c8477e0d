//! Whether triangles cross, decided by the exact signs of orientations.

use std::cmp::Ordering;

use nalgebra::Vector3;
use robust::{Coord, Coord3D, orient2d, orient3d};

use crate::geometry::bounds::Bounds;

type Corners<'a> = [&'a Vector3<f64>; 3];

/// Whether two faces of one mesh have points in common beyond their shared edge or vertex.
pub(crate) fn triangles_cross(vertices: &[Vector3<f64>], [first, second]: [[u32; 3]; 2]) -> bool {
    let point = |v: u32| &vertices[v as usize];
    let in_first: [bool; 3] = second.map(|v| first.contains(&v));
    match in_first.iter().filter(|&&shared| shared).count() {
        0 => triangles_meet(first.map(point), second.map(point)),
        1 => {
            // What they share beyond the vertex reaches the edge opposite to it in one of them.
            let shared = second[in_first.iter().position(|&shared| shared).expect("one is shared")];
            let opposite = |face: [u32; 3]| {
                let at = face.iter().position(|&v| v == shared).expect("the vertex is shared");
                [point(face[(at + 1) % 3]), point(face[(at + 2) % 3])]
            };
            segment_meets_triangle(opposite(first), second.map(point))
                || segment_meets_triangle(opposite(second), first.map(point))
        }
        2 => {
            // In different planes they share the edge alone; in one plane all depends on the sides of the tips.
            let tip = |face: [u32; 3], other: [u32; 3]| face.into_iter().find(|v| !other.contains(v));
            let (Some(a), Some(b)) = (tip(first, second), tip(second, first)) else { return false };
            let at = first.iter().position(|&v| v == a).expect("the tip is a corner");
            let [u, v] = [point(first[(at + 1) % 3]), point(first[(at + 2) % 3])];
            sign_3d(u, v, point(a), point(b)) == Ordering::Equal
                && flattened(first.map(point))
                    .is_some_and(|axis| sign_2d(axis, u, v, point(a)) == sign_2d(axis, u, v, point(b)))
        }
        _ => true,
    }
}

/// Whether two triangles, as closed sets, have a point in common.
pub(crate) fn triangles_meet(first: Corners, second: Corners) -> bool {
    // Their common points form a segment that ends on edges, or a polygon in one plane with corners on edges.
    !separates(first, second)
        && !separates(second, first)
        && (edges(first).into_iter().any(|edge| segment_meets_triangle(edge, second))
            || edges(second).into_iter().any(|edge| segment_meets_triangle(edge, first)))
}

/// Whether an edge of one of two triangles passes through the inside of the other: they cross, and do not only touch.
pub(crate) fn triangles_pierce(first: Corners, second: Corners) -> bool {
    !separates(first, second)
        && !separates(second, first)
        && (edges(first).into_iter().any(|edge| segment_pierces_triangle(edge, second))
            || edges(second).into_iter().any(|edge| segment_pierces_triangle(edge, first)))
}

/// Whether the other triangle lies on one side of the plane of this one, and off it.
fn separates([a, b, c]: Corners, other: Corners) -> bool {
    let [x, y, z] = other.map(|p| sign_3d(a, b, c, p));
    x == y && y == z && x != Ordering::Equal
}

fn segment_pierces_triangle([p, q]: [&Vector3<f64>; 2], triangle: Corners) -> bool {
    let [a, b, c] = triangle;
    let sides = [sign_3d(a, b, c, p), sign_3d(a, b, c, q)];
    if !(sides.contains(&Ordering::Less) && sides.contains(&Ordering::Greater)) {
        return false;
    }
    let around = edges(triangle).map(|[s, e]| sign_3d(p, q, s, e));
    same_side(around) && !around.contains(&Ordering::Equal)
}

fn edges<'a>([a, b, c]: Corners<'a>) -> [[&'a Vector3<f64>; 2]; 3] {
    [[a, b], [b, c], [c, a]]
}

/// Whether a segment meets a triangle, ends and border included.
fn segment_meets_triangle([p, q]: [&Vector3<f64>; 2], triangle: Corners) -> bool {
    let [a, b, c] = triangle;
    match (sign_3d(a, b, c, p), sign_3d(a, b, c, q)) {
        (Ordering::Equal, Ordering::Equal) => {
            flattened(triangle).is_some_and(|axis| segment_meets_in_plane(axis, [p, q], triangle))
        }
        (side_p, side_q) if side_p == side_q => false,
        _ => same_side(edges(triangle).map(|[s, e]| sign_3d(p, q, s, e))),
    }
}

fn segment_meets_in_plane(axis: usize, [p, q]: [&Vector3<f64>; 2], triangle: Corners) -> bool {
    same_side(edges(triangle).map(|[s, e]| sign_2d(axis, s, e, p)))
        || edges(triangle).into_iter().any(|[s, e]| {
            let across = |a, b, c, d| {
                let (side_c, side_d) = (sign_2d(axis, a, b, c), sign_2d(axis, a, b, d));
                side_c != side_d || side_c == Ordering::Equal
            };
            let boxes_meet = || Bounds::around([p, q]).meets(&Bounds::around([s, e]));
            across(p, q, s, e) && across(s, e, p, q) && boxes_meet()
        })
}

/// 1 if the ray from `p` along a coordinate axis meets a triangle from behind, -1 if from the front,
/// 0 if it misses the triangle; `None` if its line meets an edge.
pub(crate) fn crossing_along(axis: usize, p: &Vector3<f64>, corners: Corners) -> Option<i32> {
    let sides = edges(corners).map(|[s, e]| sign_2d(axis, s, e, p));
    if !same_side(sides) {
        return Some(0);
    }
    if sides.contains(&Ordering::Equal) {
        return None;
    }
    let [a, b, c] = corners;
    let is_before = sign_3d(a, b, c, p) == sides[0];
    Some(if !is_before { 0 } else { sides[0] as i32 })
}

/// No two of the signs are opposite.
fn same_side(signs: [Ordering; 3]) -> bool {
    !(signs.contains(&Ordering::Less) && signs.contains(&Ordering::Greater))
}

/// The coordinate that can be dropped such that the triangle keeps an area; `None` if it has none.
fn flattened([a, b, c]: Corners) -> Option<usize> {
    let normal = (b - a).cross(&(c - a)).abs();
    let largest = normal.imax();
    [largest, (largest + 1) % 3, (largest + 2) % 3]
        .into_iter()
        .find(|&axis| sign_2d(axis, a, b, c) != Ordering::Equal)
}

fn sign_2d(axis: usize, a: &Vector3<f64>, b: &Vector3<f64>, c: &Vector3<f64>) -> Ordering {
    let flat = |p: &Vector3<f64>| Coord { x: p[(axis + 1) % 3], y: p[(axis + 2) % 3] };
    sign(orient2d(flat(a), flat(b), flat(c)))
}

fn sign_3d(a: &Vector3<f64>, b: &Vector3<f64>, c: &Vector3<f64>, d: &Vector3<f64>) -> Ordering {
    let coord = |p: &Vector3<f64>| Coord3D { x: p.x, y: p.y, z: p.z };
    sign(orient3d(coord(a), coord(b), coord(c), coord(d)))
}

fn sign(value: f64) -> Ordering {
    value.partial_cmp(&0.0).expect("orientations of finite points are numbers")
}
