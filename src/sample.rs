//! Small meshes with known properties and seeded random numbers, for unit tests, `tests/` and `benches/`.

use std::collections::HashMap;

use nalgebra::Vector3;

/// Vertices (m) and faces.
pub type Mesh = (Vec<Vector3<f64>>, Vec<[u32; 3]>);

/// Flat open grid of `count`² unit squares, all cut by the diagonal from low to high; one corner at the origin.
pub fn one_diagonal_grid(count: usize) -> Mesh {
    let side = count + 1;
    let vertices =
        (0..side * side).map(|k| Vector3::new((k % side) as f64, (k / side) as f64, 0.0)).collect();
    let corners = (0..side * count).filter(|k| k % side < count);
    let faces = corners.flat_map(|k| [[k, k + 1, k + side + 1], [k, k + side + 1, k + side]]);
    (vertices, faces.map(|face| face.map(|v| v as u32)).collect())
}

/// Flat open grid of `nx` × `ny` cells in the plane z = 0, normals up, one corner at the origin.
///
/// Vertex (i, j) is `i + j (nx + 1)`; the diagonals alternate.
pub fn grid(nx: usize, ny: usize, spacing: f64) -> Mesh {
    let mut vertices = Vec::new();
    for j in 0..=ny {
        for i in 0..=nx {
            vertices.push(Vector3::new(i as f64 * spacing, j as f64 * spacing, 0.0));
        }
    }
    let mut faces = Vec::new();
    for j in 0..ny {
        for i in 0..nx {
            let at = |di: usize, dj: usize| ((i + di) + (j + dj) * (nx + 1)) as u32;
            let (a, b, c, d) = (at(0, 0), at(1, 0), at(1, 1), at(0, 1));
            if (i + j) % 2 == 0 {
                faces.extend([[a, b, c], [a, c, d]]);
            } else {
                faces.extend([[a, b, d], [b, c, d]]);
            }
        }
    }
    (vertices, faces)
}

/// [`grid`] of `count`² cells with its inner vertices moved along x and y by up to `jitter` cells.
pub fn jittered_grid(count: usize, spacing: f64, jitter: f64, random: &mut Random) -> Mesh {
    let (mut vertices, faces) = grid(count, count, spacing);
    let middle = 0.5 * count as f64 * spacing;
    for vertex in &mut vertices {
        if (*vertex - Vector3::new(middle, middle, 0.0)).amax() < 0.999 * middle {
            vertex.x += jitter * spacing * (2.0 * random.next() - 1.0);
            vertex.y += jitter * spacing * (2.0 * random.next() - 1.0);
        }
    }
    (vertices, faces)
}

/// Faces of a grid of (n + 1)² vertices whose diagonals all run one way, normals up; vertex (i, j) is `i (n + 1) + j`.
pub fn one_way_faces(n: usize) -> Vec<[u32; 3]> {
    let at = |i: usize, j: usize| (i * (n + 1) + j) as u32;
    let cell = |i: usize, j: usize| {
        [[at(i, j), at(i + 1, j), at(i + 1, j + 1)], [at(i, j), at(i + 1, j + 1), at(i, j + 1)]]
    };
    (0..n * n).flat_map(|k| cell(k / n, k % n)).collect()
}

/// Sphere about the origin: an icosahedron whose faces are cut in four `subdivisions` times.
pub fn icosphere(radius: f64, subdivisions: usize) -> Mesh {
    let g = (1.0 + 5f64.sqrt()) / 2.0;
    let corners = [
        [-1.0, g, 0.0],
        [1.0, g, 0.0],
        [-1.0, -g, 0.0],
        [1.0, -g, 0.0],
        [0.0, -1.0, g],
        [0.0, 1.0, g],
        [0.0, -1.0, -g],
        [0.0, 1.0, -g],
        [g, 0.0, -1.0],
        [g, 0.0, 1.0],
        [-g, 0.0, -1.0],
        [-g, 0.0, 1.0],
    ];
    let mut vertices: Vec<Vector3<f64>> = corners.map(|corner| Vector3::from(corner).normalize()).to_vec();
    #[rustfmt::skip]
    let mut faces: Vec<[u32; 3]> = vec![
        [0, 11, 5], [0, 5, 1], [0, 1, 7], [0, 7, 10], [0, 10, 11], [1, 5, 9], [5, 11, 4], [11, 10, 2], [10, 7, 6],
        [7, 1, 8], [3, 9, 4], [3, 4, 2], [3, 2, 6], [3, 6, 8], [3, 8, 9], [4, 9, 5], [2, 4, 11], [6, 2, 10],
        [8, 6, 7], [9, 8, 1],
    ];
    for _ in 0..subdivisions {
        let mut middles: HashMap<(u32, u32), u32> = HashMap::new();
        let mut middle = |a: u32, b: u32| {
            *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                vertices.push((vertices[a as usize] + vertices[b as usize]).normalize());
                vertices.len() as u32 - 1
            })
        };
        faces = faces
            .iter()
            .flat_map(|&[a, b, c]| {
                let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
                [[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]
            })
            .collect();
    }
    (vertices.into_iter().map(|point| point * radius).collect(), faces)
}

/// The faces turned over.
pub fn flipped(faces: &[[u32; 3]]) -> Vec<[u32; 3]> {
    faces.iter().map(|&[a, b, c]| [a, c, b]).collect()
}

/// Two meshes as one, as separate components.
pub fn joined(first: &Mesh, second: &Mesh) -> Mesh {
    let offset = first.0.len() as u32;
    let vertices = first.0.iter().chain(&second.0).copied().collect();
    let faces = first.1.iter().copied().chain(second.1.iter().map(|face| face.map(|vertex| vertex + offset)));
    (vertices, faces.collect())
}

/// Repeatable pseudo-random numbers in [0, 1) (SplitMix64, Steele, Lea, Flood 2014).
pub struct Random(pub u64);

impl Random {
    /// The next number.
    pub fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    /// The next number in [-1, 1).
    pub fn signed(&mut self) -> f64 {
        2.0 * self.next() - 1.0
    }

    /// A shuffled list of 0..n.
    pub fn permutation(&mut self, n: usize) -> Vec<usize> {
        let mut order: Vec<usize> = (0..n).collect();
        for i in (1..n).rev() {
            order.swap(i, (self.next() * (i + 1) as f64) as usize);
        }
        order
    }
}

/// Integrals of the hats of a triangle, seen from a point.
pub struct ReferenceIntegrals {
    /// Corners (m).
    pub triangle: [Vector3<f64>; 3],
    /// Point (m).
    pub point: Vector3<f64>,
    /// Width of the Gaussian (m).
    pub width: f64,
    /// Against 1/r (m).
    pub inverse: [f64; 3],
    /// Against the Gaussian (m²).
    pub gaussian: [f64; 3],
}

/// Hat integrals by quadrature at 60 digits: `tests/data/hat_integrals.csv`, made by the script beside it.
///
/// Five triangles (well shaped, random, two slivers, one 2e-6 m high) at 13 points each: vertices, edges, face, 1e-9 m
/// off the plane, near, and up to three edge lengths away.
pub fn reference_integrals() -> Vec<ReferenceIntegrals> {
    let table = include_str!("../tests/data/hat_integrals.csv");
    let row = |line: &str| {
        let numbers: Vec<f64> = line.split(',').map(|cell| cell.parse().expect("a number")).collect();
        let vector = |k: usize| Vector3::from_column_slice(&numbers[k..k + 3]);
        ReferenceIntegrals {
            triangle: [vector(0), vector(3), vector(6)],
            point: vector(9),
            width: numbers[12],
            inverse: vector(13).into(),
            gaussian: vector(16).into(),
        }
    };
    table.lines().skip(1).map(row).collect()
}
