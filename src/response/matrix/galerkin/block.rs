//! The Galerkin discretization: gap and pressure both against the nodes' pressures.

use std::collections::HashMap;
use std::ops::Range;

use faer::Mat;

use crate::response::column::half_space::ColumnScratch;
use crate::response::column::kernel::KernelColumns;
use crate::response::error::ResponseError;
use crate::response::integral::rule_lists::RuleLists;
use crate::response::kernel::basis::PressureBasis;
use crate::response::kernel::skin::{Kernel, KernelSkin};
use crate::response::kernel::thickness::Thickness;
use crate::response::matrix::fill::filled_columns;
use crate::response::matrix::galerkin::hat_pairs::LoadMoments;
use crate::response::matrix::galerkin::near_faces::{NearFaces, NodeFace};
use crate::response::matrix::galerkin::outer_rule::OuterRules;
use crate::response::matrix::options::AssemblyOptions;
use crate::response::rows::{NO_ROW, rows_of_vertices};
use crate::response::simd::points::{POINTS_PER_BLOCK, Targets};
use crate::surface::checked::Surface;

/// What one thread needs for the outer rule.
struct Outer<'a> {
    scratch: ColumnScratch,
    targets: Targets,
    /// Faces used in this column with their rule and the corners that they are used for.
    used: Vec<(u32, &'a RuleLists, Range<usize>)>,
    /// Whether each row is to be found face by face in this column.
    is_due: Vec<bool>,
    /// Faces around these rows, and the last column in which each face was one.
    faces: Vec<u32>,
    seen_in: Vec<usize>,
    /// The last column in which each of these was near its node, and averages over it there (m³).
    near_in: Vec<usize>,
    averages: Vec<[f64; 3]>,
    /// Means of 1/r by the moments of the loads, in the order of the rows (1/m).
    means: Vec<f64>,
}

/// Which triangles a column looks at.
#[derive(Debug, Clone, Copy, PartialEq)]
enum ColumnFaces {
    /// Those far from its node, at which the whole kernel is averaged.
    Far,
    /// Those near it, at which the smooth part of a layer's kernel is.
    NearSmooth,
}

/// The rows of a block in an order that keeps neighbours together.
struct RowOrder {
    /// Row at each place.
    rows: Vec<u32>,
    /// Of equal rows and columns: the place of each. A pair is computed in the column that comes first.
    places: Option<Vec<u32>>,
}

/// What all columns of a Galerkin block share.
struct GalerkinColumns<'a> {
    surface: &'a Surface,
    kernel: KernelColumns<'a>,
    constant: f64,
    pressure: PressureBasis,
    rules: &'a OuterRules,
    faces: &'a [NodeFace],
    near: NearFaces,
    rows: &'a [usize],
    columns: &'a [usize],
    order: RowOrder,
    /// Of the half-space: the loads at the rows, in that order, and at the columns where they are others.
    of_rows: Option<LoadMoments>,
    of_columns: Option<LoadMoments>,
    /// One over the vertex area of each row (1/m²).
    density: Vec<f64>,
}

/// `R_ij = ∫∫ p_i(x) k(|x - y|) p_j(y) dA dA` over row nodes i and column nodes j, for the half-space and the layer.
///
/// Far from each other two nodes of a half-space feel the moments of their pressures. Else the inner integral is exact and
/// the outer one a Gauss rule whose order falls with distance: that of a node's pressure over triangles farther from it,
/// those of hats over near triangles, and over an edge of those that touch. Entries keep tolerances from some 1e-8 on, from
/// 1e-4 with angles below 3 degrees, from 1e-3 where triangles come closer than a fifth of their size and do not touch.
/// For equal rows and columns each pair is computed once and mirrored, so the matrix is symmetric to the bit.
pub(crate) fn galerkin_block(
    surface: &Surface,
    skin: &KernelSkin,
    rows: &[usize],
    columns: &[usize],
    options: &AssemblyOptions,
) -> Result<Mat<f64>, ResponseError> {
    let is_symmetric = rows == columns;
    let row_of = |nodes| rows_of_vertices(surface.vertices().len(), nodes);
    let faces = NodeFace::around(surface, &row_of(rows)?, &row_of(columns)?);
    let rules = OuterRules::new(options.tolerance);
    let order = RowOrder::new(surface, rows, is_symmetric);
    let pressure = skin.basis();
    let is_half_space = matches!(skin.kernel(), Kernel::HalfSpace);
    let moments_of = |nodes: &[usize]| LoadMoments::new(surface, nodes, pressure, options);
    let in_order: Vec<usize> = order.rows.iter().map(|&row| rows[row as usize]).collect();
    let of_rows = is_half_space.then(|| moments_of(&in_order)).transpose()?;
    let of_columns = (is_half_space && !is_symmetric).then(|| moments_of(columns)).transpose()?;
    let shared = GalerkinColumns {
        surface,
        kernel: KernelColumns::new(surface, skin, options.tolerance),
        constant: skin.kernel_constant(),
        pressure,
        rules: &rules,
        near: NearFaces::new(surface, &faces, &rules, options)?,
        faces: &faces,
        rows,
        columns,
        order,
        of_rows,
        of_columns,
        density: rows.iter().map(|&v| 1.0 / surface.vertex_areas()[v]).collect(),
    };
    let outer = || Outer {
        scratch: ColumnScratch::default(),
        targets: Targets::default(),
        used: Vec::new(),
        is_due: vec![false; rows.len()],
        faces: Vec::new(),
        seen_in: vec![usize::MAX; shared.faces.len()],
        near_in: vec![usize::MAX; shared.faces.len()],
        averages: vec![[0.0; 3]; shared.faces.len()],
        means: Vec::new(),
    };
    let size = [rows.len(), columns.len()];
    let mut matrix =
        filled_columns(size, options, outer, |outer: &mut Outer, j, column| shared.fill(outer, j, column))?;
    if is_symmetric {
        for j in 0..columns.len() {
            for i in 0..j {
                // One of the two is zero.
                let value = matrix[(i, j)] + matrix[(j, i)];
                (matrix[(i, j)], matrix[(j, i)]) = (value, value);
            }
        }
    }
    Ok(matrix)
}

impl RowOrder {
    fn new(surface: &Surface, rows: &[usize], is_symmetric: bool) -> Self {
        let in_order = ring_by_ring(surface, rows);
        let places = is_symmetric.then(|| {
            let mut places = vec![0; rows.len()];
            (0..).zip(&in_order).for_each(|(place, &row)| places[row as usize] = place);
            places
        });
        Self { rows: in_order, places }
    }

    /// Rows of which the pairs with a column are computed in it, by their places.
    fn due(&self, column: usize) -> Range<usize> {
        let first = self.places.as_ref().map_or(0, |places| places[column] as usize);
        first..self.rows.len()
    }
}

/// Rows ring by ring around the first, so that neighbours come close to each other however the surface is turned.
fn ring_by_ring(surface: &Surface, rows: &[usize]) -> Vec<u32> {
    let row_of: HashMap<usize, u32> = rows.iter().copied().zip(0..).collect();
    let mut is_listed = vec![false; rows.len()];
    let mut listed: Vec<u32> = Vec::with_capacity(rows.len());
    let mut front = 0;
    for first in 0..rows.len() as u32 {
        let mut next = vec![first];
        loop {
            next.retain(|&row| !std::mem::replace(&mut is_listed[row as usize], true));
            listed.append(&mut next);
            let Some(&row) = listed.get(front) else { break };
            front += 1;
            let beside = surface.neighbours(rows[row as usize]).iter();
            next.extend(beside.filter_map(|&vertex| row_of.get(&(vertex as usize))));
        }
    }
    listed
}

impl<'a> GalerkinColumns<'a> {
    fn fill(&self, outer: &mut Outer<'a>, j: usize, column: &mut [f64]) {
        let vertex = self.columns[j];
        self.fill_far(outer, j, column);
        self.note_near(outer, j);
        self.place_points(outer, j, ColumnFaces::Far);
        self.kernel.fill(&mut outer.scratch, &outer.targets, vertex);
        self.add_up(outer, column);
        if self.kernel.layer.is_some() {
            self.place_points(outer, j, ColumnFaces::NearSmooth);
            self.kernel.fill_smooth(&mut outer.scratch, &outer.targets, vertex);
            self.add_up(outer, column);
        }
        self.add_near(outer, j, column);
    }

    /// Sets the rows that are far from a column's node, and notes the others with the faces around them.
    fn fill_far(&self, outer: &mut Outer, j: usize, column: &mut [f64]) {
        let Outer { is_due, faces, seen_in, means, .. } = outer;
        is_due.fill(false);
        faces.clear();
        let due = self.order.due(j);
        let begin = due.start - due.start % POINTS_PER_BLOCK;
        let loads = self.of_rows.as_ref().map(|rows| match &self.of_columns {
            Some(columns) => (rows, columns, j),
            None => (rows, rows, due.start),
        });
        if let Some((rows, columns, own)) = loads {
            means.resize(due.end.next_multiple_of(POINTS_PER_BLOCK) - begin, 0.0);
            rows.means(columns, own, begin, means);
        }
        for place in due {
            let row = self.order.rows[place] as usize;
            if let Some((rows, columns, own)) = loads
                && rows.are_far(place, columns, own)
            {
                column[row] = self.constant * means[place - begin];
                continue;
            }
            is_due[row] = true;
            for &face in self.near.around(self.rows[row]) {
                if std::mem::replace(&mut seen_in[face as usize], j) != j {
                    faces.push(face);
                }
            }
        }
    }

    /// Notes the near ones of those faces.
    fn note_near(&self, outer: &mut Outer, j: usize) {
        let vertex = self.columns[j];
        for &face in self.near.of(vertex) {
            let index = face as usize;
            if outer.seen_in[index] == j && self.is_within_reach(&self.faces[index], vertex) {
                (outer.near_in[index], outer.averages[index]) = (j, [0.0; 3]);
            }
        }
    }

    /// Whether no part of a face is beyond the reach of a layer's kernel from a vertex.
    fn is_within_reach(&self, face: &NodeFace, vertex: usize) -> bool {
        let Some((layer, thickness)) = &self.kernel.layer else { return true };
        let corners = face.vertices.map(|v| thickness.at(v as usize));
        let thinnest = corners.into_iter().fold(thickness.at(vertex), f64::min);
        (face.center - self.surface.vertices()[vertex]).norm() + face.radius <= layer.reach * thinnest
    }

    /// Sets the targets to the points of the outer rule on the faces of one part whose rows are due in column `j`.
    fn place_points(&self, outer: &mut Outer<'a>, j: usize, part: ColumnFaces) {
        let Outer { targets, used, faces, near_in, .. } = outer;
        let vertex = self.columns[j];
        let center = self.surface.vertices()[vertex];
        let radius = self.surface.longest_edge(vertex);
        let layer = self.kernel.layer.as_ref();
        let own_thickness = layer.map_or(f64::INFINITY, |(_, thickness)| thickness.at(vertex));
        let silent = layer.map_or(f64::INFINITY, |(layer, _)| layer.reach * own_thickness);
        // Where the thickness varies, each pair of nodes has its own.
        let together = if matches!(layer, Some((_, Thickness::PerVertex(_)))) { 1 } else { 3 };
        targets.clear();
        used.clear();
        for &index in &*faces {
            let face = &self.faces[index as usize];
            let is_near = near_in[index as usize] == j;
            let distance = (face.center - center).norm() - radius;
            let is_silent = distance > silent + face.radius;
            if is_near != (part == ColumnFaces::NearSmooth) || is_silent {
                continue;
            }
            for range in (0..3).step_by(together).map(|k| k..k + together) {
                // A layer's smooth part is as good as singular at two thicknesses, of two the thinner one.
                let corner = face.vertices[range.start] as usize;
                let other = layer.map_or(f64::INFINITY, |(_, thickness)| thickness.at(corner));
                let smooth = 2.0 * own_thickness.min(other);
                let rule = match part {
                    ColumnFaces::Far if distance < face.radius => &self.rules.touching,
                    ColumnFaces::Far if distance < smooth => self.rules.apart(face.radius, distance),
                    ColumnFaces::Far | ColumnFaces::NearSmooth => self.rules.smooth(face.radius, smooth),
                };
                targets
                    .push_on_triangle(&face.corners, rule.shares.each_ref().map(|list| &list[..rule.count]));
                if layer.is_some() {
                    targets.inverse_thickness.extend(std::iter::repeat_n(1.0 / other, rule.count));
                }
                used.push((index, rule, range));
            }
        }
        targets.points.pad(POINTS_PER_BLOCK);
        if layer.is_some() {
            let list = &mut targets.inverse_thickness;
            list.resize(targets.points.len(), 1.0 / own_thickness);
            targets.largest_inverse = list.iter().copied().fold(0.0, f64::max);
        }
    }

    /// Adds the averages of the displacements at the points to the rows that are due.
    fn add_up(&self, outer: &Outer, column: &mut [f64]) {
        let mut values = &outer.scratch.values[..];
        for (index, rule, corners) in &outer.used {
            let face = &self.faces[*index as usize];
            let (own, rest) = values.split_at(rule.count);
            values = rest;
            let mut hats = [0.0; 3];
            for (k, shares) in rule.shares.iter().enumerate() {
                let products = own.iter().zip(&rule.weights).zip(shares);
                hats[k] =
                    face.area * products.map(|((value, weight), share)| value * weight * share).sum::<f64>();
            }
            self.add(face, &hats, corners.clone(), &outer.is_due, column);
        }
    }

    /// Adds the averages of 1/r over the near triangles.
    fn add_near(&self, outer: &mut Outer, j: usize, column: &mut [f64]) {
        let vertex = self.columns[j];
        let amplitude = self.constant / self.surface.vertex_areas()[vertex];
        let Outer { near_in, averages, is_due, .. } = outer;
        let is_near = |face: u32| near_in[face as usize] == j;
        self.near.add_averages(self.faces, vertex, self.pressure, is_near, averages);
        for &face in self.near.of(vertex).iter().filter(|&&face| is_near(face)) {
            let hats = averages[face as usize].map(|average| amplitude * average);
            self.add(&self.faces[face as usize], &hats, 0..3, is_due, column);
        }
    }

    /// Adds averages over a face to those of its corners' rows that are due.
    fn add(
        &self,
        face: &NodeFace,
        hats: &[f64; 3],
        corners: Range<usize>,
        is_due: &[bool],
        column: &mut [f64],
    ) {
        let even = hats.iter().sum::<f64>() / 3.0;
        for k in corners {
            let row = face.rows[k];
            if row != NO_ROW && is_due[row] {
                let share = if self.pressure == PressureBasis::Linear { hats[k] } else { even };
                column[row] += self.density[row] * share;
            }
        }
    }
}
