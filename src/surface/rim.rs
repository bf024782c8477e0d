//! A cap over the rim of a part that is cut out.

use nalgebra::Vector3;

/// Closes a rim by rings around its centroid, with fewer and fewer vertices towards it.
pub(super) fn add_cap(rim: &[u32], vertices: &mut Vec<Vector3<f64>>, faces: &mut Vec<[u32; 3]>) {
    let points: Vec<Vector3<f64>> = rim.iter().map(|&v| vertices[v as usize]).collect();
    let count = points.len();
    let center = points.iter().sum::<Vector3<f64>>() / count as f64;
    let lengths: Vec<f64> = (0..count).map(|i| (points[(i + 1) % count] - points[i]).norm()).collect();
    let perimeter: f64 = lengths.iter().sum();
    let radius = points.iter().map(|p| (p - center).norm()).sum::<f64>() / count as f64;
    let rings = ((radius * count as f64 / perimeter).round() as usize).max(1);

    // position along the rim, 0 to 1, of its vertices
    let mut along = vec![0.0];
    lengths.iter().for_each(|length| along.push(along[along.len() - 1] + length / perimeter));
    let at = |t: f64| {
        let i = along.partition_point(|&a| a <= t).clamp(1, count) - 1;
        let part = (t - along[i]) / (along[i + 1] - along[i]);
        points[i] * (1.0 - part) + points[(i + 1) % count] * part
    };
    let mut outer: Vec<(f64, u32)> = along.iter().copied().zip(rim.iter().copied()).collect();
    for ring in 1..rings {
        let scale = 1.0 - ring as f64 / rings as f64;
        let number = ((count as f64 * scale).round() as usize).max(3);
        let first = vertices.len() as u32;
        let inner: Vec<(f64, u32)> =
            (0..number).map(|j| (j as f64 / number as f64, first + j as u32)).collect();
        vertices.extend(inner.iter().map(|&(t, _)| center + (at(t) - center) * scale));
        join_rings(&outer, &inner, faces);
        outer = inner;
    }
    let middle = vertices.len() as u32;
    vertices.push(center);
    for i in 0..outer.len() {
        faces.push([outer[i].1, outer[(i + 1) % outer.len()].1, middle]);
    }
}

/// Triangles between two rings around the same center, each with its position along the rim and its vertex.
fn join_rings(outer: &[(f64, u32)], inner: &[(f64, u32)], faces: &mut Vec<[u32; 3]>) {
    let position = |ring: &[(f64, u32)], i: usize| ring[i % ring.len()].0 + (i / ring.len()) as f64;
    let vertex = |ring: &[(f64, u32)], i: usize| ring[i % ring.len()].1;
    let (mut i, mut j) = (0, 0);
    while i < outer.len() || j < inner.len() {
        let outer_is_next = position(outer, i + 1) <= position(inner, j + 1);
        if j == inner.len() || (i < outer.len() && outer_is_next) {
            faces.push([vertex(outer, i), vertex(outer, i + 1), vertex(inner, j)]);
            i += 1;
        } else {
            faces.push([vertex(outer, i), vertex(inner, j + 1), vertex(inner, j)]);
            j += 1;
        }
    }
}
