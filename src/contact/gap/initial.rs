//! Initial gaps of a skin, measured on demand, and their planes at displaced vertices.

use std::cell::{Ref, RefCell};
use std::collections::{BTreeMap, HashMap};
use std::rc::Rc;

use nalgebra::Vector3;

use crate::contact::error::ContactError;
use crate::contact::first_touch::touch_rounding;
use crate::contact::gap::averaged::{self, VertexGap};
use crate::contact::gap::deepest::DeepestVertex;
use crate::contact::gap::edge::{Line, SkinPart, triangles_among};
use crate::contact::gap::entry::{Entered, EntryGap, WayIn, measure_entries};
use crate::contact::gap::look::{look_no_farther, reach_farther};
use crate::contact::gap::measured::Measured;
use crate::contact::scene::Scene;
use crate::mesh::distinct::distinct;
use crate::obstacle::posed::Obstacle;
use crate::response::kernel::basis::PressureBasis;
use crate::surface::checked::Surface;

/// Rounding of a distance, in extents of the skin: where an obstacle only touches, some vertices are in it by that.
const ROUNDING: f64 = 16.0 * f64::EPSILON;
/// Default search distance beyond the depth, in mean edge lengths.
const SEARCH_EDGES: f64 = 2.0;
/// How often the search distance is doubled for that.
const MOST_DOUBLINGS: usize = 4;
/// Cosine between the obstacle's normal and the inward normal of the skin below which a side is one that skin is kept off: 75
/// degrees.
const STEEPEST_COSINE: f64 = 0.25;

/// Initial gap g0 (m) and obstacle normal of the skin's vertices, measured anew where somebody asks beyond the search
/// distance. A clone shares what is known of the undeformed skin until one of the two learns more.
#[derive(Clone)]
pub(crate) struct Gaps<'a> {
    pub surface: &'a Surface,
    pub scene: &'a Scene,
    /// Every vertex not measured is at least this far from the obstacle, outside it (m).
    pub search_distance: f64,
    /// How far back along its inward normal each vertex in overlap looks for the way that it came in (n, m).
    reach: Rc<[f64]>,
    /// Vertices whose gap is measured back the way they came.
    pub entry: EntryGap,
    /// Vertices that may touch with g0 < 0, ascending.
    pub penetrating: Vec<usize>,
    /// Of the undeformed skin.
    measured: RefCell<Rc<Measured>>,
    /// Those of vertices that were measured after they were displaced: the problem takes these.
    planes: HashMap<usize, Plane>,
    /// Vertices whose gap is to a line of the obstacle between them.
    on_lines: BTreeMap<usize, Line>,
    /// Share of the force that stood on steep sides; where there is one, vertices keep the plane that they had where they would come
    /// to a steep side from one that is not: linear skin opens like a hole around what goes in deep, and lets it through.
    pub steep_share: Option<f64>,
    /// Where the undeformed skin is pressed in deepest.
    pub deepest_vertex: Option<DeepestVertex>,
    /// g0 (m) averaged against the pressure of a node.
    averaged: RefCell<HashMap<usize, f64>>,
}

/// The gap of a vertex, linearized where a displacement puts it.
#[derive(Clone, Copy)]
struct Plane {
    /// u (m).
    displacement: Vector3<f64>,
    /// g0 (m), as the plane has it at no displacement.
    distance: f64,
    /// Outward unit normal of the obstacle.
    normal: Vector3<f64>,
}

/// How far skin that stands in overlap with an obstacle looks for it (m).
pub(crate) fn search_distance_in_overlap(given: &Surface) -> f64 {
    SEARCH_EDGES * given.mean_edge_length()
}

impl<'a> Gaps<'a> {
    /// Measures every vertex nearer to the obstacle than the search distance and every vertex inside it; back the way it came
    /// where the closest side is not the one that it came in through.
    ///
    /// * `search_distance`: (m); `None`: depth and two mean edge lengths, in overlap more where skin stands deeper
    pub fn measure(
        surface: &'a Surface,
        scene: &'a Scene,
        search_distance: Option<f64>,
    ) -> Result<Self, ContactError> {
        let depth_bound = scene.depth_bound;
        let default = || match (depth_bound, &scene.inherited) {
            (Some(depth), _) => depth + SEARCH_EDGES * surface.mean_edge_length(),
            (None, Some(inherited)) => inherited.search_distance,
            (None, None) => search_distance_in_overlap(surface),
        };
        let nearest = search_distance.unwrap_or_else(default).max(depth_bound.unwrap_or(0.0));
        let mut reach = vec![nearest; surface.vertices().len()];
        let (mut measured, mut entry, mut entered) = Self::within(surface, scene, &reach)?;
        if search_distance.is_none() && scene.press.is_none() {
            for _ in 0..MOST_DOUBLINGS {
                if !reach_farther(surface, &entered, &measured, &mut reach) {
                    break;
                }
                (measured, entry, entered) = Self::within(surface, scene, &reach)?;
            }
        }
        if scene.press.is_none() && look_no_farther(surface, &entered, &mut reach) {
            (measured, entry, _) = Self::within(surface, scene, &reach)?;
        }
        let of_touch = touch_rounding(surface);
        let deepest = |vertex: usize| match &scene.press {
            Some(press) => (press.way_to(&surface.vertices()[vertex]) + of_touch).max(0.0),
            None => reach[vertex],
        };
        let on_lines = take_edges(surface, &scene.obstacle, deepest, &mut measured);
        let rounding = ROUNDING * surface.bounding_box().diagonal();
        let is_inside =
            |&vertex: &usize| surface.skin_mask()[vertex] && measured.distance[vertex] < -rounding;
        let penetrating: Vec<usize> = (0..measured.distance.len()).filter(is_inside).collect();
        Ok(Self {
            surface,
            scene,
            search_distance: farthest(&reach),
            reach: reach.into(),
            entry,
            deepest_vertex: measured.deepest_of(&penetrating).map(|vertex| DeepestVertex {
                vertex,
                overlap: -measured.distance[vertex],
                normal: measured.normal[vertex],
            }),
            penetrating,
            measured: RefCell::new(Rc::new(measured)),
            planes: HashMap::new(),
            on_lines,
            steep_share: None,
            averaged: RefCell::default(),
        })
    }

    /// Gaps of the vertices within their search distances (n, m), and those measured back the way they came.
    fn within(
        surface: &Surface,
        scene: &Scene,
        reach: &[f64],
    ) -> Result<(Measured, EntryGap, Vec<Entered>), ContactError> {
        let farthest = farthest(reach);
        let mut measured = Measured::near(surface.vertices(), &scene.obstacle, farthest, scene.depth_bound)?;
        let may_touch = |vertex: usize| surface.skin_mask()[vertex];
        let way_in = WayIn::new(scene, surface.vertex_normals().iter().copied(), |vertex| reach[vertex]);
        let (entry, entered) =
            measure_entries(surface.vertices(), may_touch, &scene.obstacle, &way_in, &mut measured)?;
        Ok((measured, entry, entered))
    }

    /// Deepest penetration of a vertex of the undeformed skin (m, ≥ 0).
    pub fn deepest(&self) -> f64 {
        self.deepest_vertex.map_or(0.0, |deepest| deepest.overlap)
    }

    /// g0 (n, m) of the undeformed skin as measured so far.
    pub fn undeformed(&self) -> Ref<'_, [f64]> {
        Ref::map(self.measured.borrow(), |measured| &measured.distance[..])
    }

    /// Vertices whose g0 as the problem takes it, measured so far, is less than a limit (m), ascending.
    pub fn nearer_than(&self, limit: f64) -> Vec<usize> {
        let undeformed = self.undeformed();
        let mut near: Vec<usize> =
            (0..undeformed.len()).filter(|&vertex| undeformed[vertex] < limit).collect();
        near.retain(|vertex| !self.planes.contains_key(vertex));
        near.extend(self.planes_below(limit));
        near.sort_unstable();
        near
    }

    fn planes_below(&self, limit: f64) -> impl Iterator<Item = usize> {
        self.planes.iter().filter(move |(_, plane)| plane.distance < limit).map(|(&vertex, _)| vertex)
    }

    /// The line of the obstacle that the gap of a vertex is to, as the undeformed skin met it.
    pub fn line_at(&self, vertex: usize) -> Option<&Line> {
        self.on_lines.get(&vertex)
    }

    /// Direction in which a vertex came to the obstacle: that of the press, or into the skin.
    pub fn way_in(&self, vertex: usize) -> Vector3<f64> {
        let travel = self.scene.press.as_ref();
        travel.map_or_else(|| -self.surface.vertex_normals()[vertex], |travel| travel.direction)
    }

    /// Displacement (m) at which the gap of a vertex was linearized.
    pub fn linearized_at(&self, vertex: usize) -> Vector3<f64> {
        self.planes.get(&vertex).map_or_else(Vector3::zeros, |plane| plane.displacement)
    }

    /// Signed distance (m) and normal at vertices after a displacement (m).
    pub fn measured_at(
        &self,
        vertices: &[usize],
        displacement: &[Vector3<f64>],
    ) -> Result<Measured, ContactError> {
        let moved = vertices.iter().zip(displacement);
        let points: Vec<Vector3<f64>> =
            moved.map(|(&vertex, u)| self.surface.vertices()[vertex] + u).collect();
        let mut measured = Measured::near(&points, &self.scene.obstacle, f64::INFINITY, None)?;
        let normals = vertices.iter().map(|&vertex| self.surface.vertex_normals()[vertex]);
        let way_in = WayIn::new(self.scene, normals, |row| self.reach[vertices[row]]);
        measure_entries(&points, |_| true, &self.scene.obstacle, &way_in, &mut measured)?;
        Ok(measured)
    }

    /// Takes the gaps of vertices from where a displacement (m) puts them.
    ///
    /// * `measured`: [`measured_at`](Self::measured_at)
    pub fn linearize(&mut self, vertices: &[usize], displacement: &[Vector3<f64>], measured: &Measured) {
        let undeformed = self.measured.get_mut();
        for (row, &vertex) in vertices.iter().enumerate() {
            let (normal, displacement) = (measured.normal[row], displacement[row]);
            let known = self.planes.get(&vertex).map_or(undeformed.normal[vertex], |plane| plane.normal);
            let cosine = |normal: &Vector3<f64>| -normal.dot(&self.surface.vertex_normals()[vertex]);
            let would_slip = cosine(&normal) < STEEPEST_COSINE && cosine(&known) >= STEEPEST_COSINE;
            if self.steep_share.is_some() && would_slip {
                continue;
            }
            let distance = measured.distance[row] - normal.dot(&displacement);
            self.planes.insert(vertex, Plane { displacement, distance, normal });
        }
        self.averaged.get_mut().clear();
        // What was inside must stay out, wherever a plane at its displacement lies.
        let distance = &undeformed.distance;
        let was_inside: Vec<usize> = (0..distance.len()).filter(|&vertex| distance[vertex] < 0.0).collect();
        self.penetrating = distinct(was_inside.into_iter().chain(self.planes_below(0.0)));
        self.penetrating.retain(|&vertex| self.surface.skin_mask()[vertex]);
    }

    /// The point of the obstacle (m) that a vertex was measured from; where it was not, the vertex.
    pub fn foot(&self, vertex: usize) -> Vector3<f64> {
        let measured = self.measured.borrow();
        let (distance, normal) = self.known(&measured, vertex);
        let point = self.surface.vertices()[vertex];
        if distance.is_finite() { point - distance * normal } else { point }
    }

    /// g0 (m) and obstacle normal as the problem takes them.
    fn known(&self, measured: &Measured, vertex: usize) -> (f64, Vector3<f64>) {
        let undeformed = || (measured.distance[vertex], measured.normal[vertex]);
        self.planes.get(&vertex).map_or_else(undeformed, |plane| (plane.distance, plane.normal))
    }

    /// g0 (m) and obstacle normal of `vertices`, measured without limit where they have not been yet.
    pub fn at(&self, vertices: &[usize]) -> Result<Measured, ContactError> {
        let mut missing = self.measured.borrow().missing(vertices);
        missing.retain(|vertex| !self.planes.contains_key(vertex));
        if !missing.is_empty() {
            let measured = &mut *self.measured.borrow_mut();
            Rc::make_mut(measured).fill(self.surface.vertices(), &self.scene.obstacle, &missing, None)?;
        }
        let measured = self.measured.borrow();
        let (distance, normal) = vertices.iter().map(|&vertex| self.known(&measured, vertex)).unzip();
        Ok(Measured { distance, normal })
    }

    /// g0 (m) of `nodes`, averaged against their pressures.
    pub fn averaged(&self, basis: PressureBasis, nodes: &[usize]) -> Result<Vec<f64>, ContactError> {
        let mut known = self.averaged.borrow_mut();
        let missing: Vec<usize> = nodes.iter().copied().filter(|node| !known.contains_key(node)).collect();
        if !missing.is_empty() {
            let averages = self.averaged_along(basis, &missing, &self.at(&missing)?.normal)?;
            known.extend(missing.into_iter().zip(averages));
        }
        Ok(nodes.iter().map(|node| known[node]).collect())
    }

    /// The same where the displacement of each node counts along another normal than its own.
    pub fn averaged_along(
        &self,
        basis: PressureBasis,
        nodes: &[usize],
        normals: &[Vector3<f64>],
    ) -> Result<Vec<f64>, ContactError> {
        let at_vertices = |vertices: &[usize]| {
            let measured = self.at(vertices)?;
            let vertex_gap = |(row, &vertex): (usize, &usize)| VertexGap {
                distance: measured.distance[row],
                normal: measured.normal[row],
                shift: self.linearized_at(vertex),
                is_on_line: self.line_at(vertex).is_some(),
            };
            Ok(vertices.iter().enumerate().map(vertex_gap).collect())
        };
        averaged::measure(self.surface, self.scene, basis, nodes, normals, at_vertices)
    }
}

/// The farthest that any vertex looks (m).
fn farthest(reach: &[f64]) -> f64 {
    reach.iter().copied().fold(0.0, f64::max)
}

/// Takes the gaps to sharp edges where vertices were measured.
///
/// * `deepest`: under a vertex (m)
///
/// Returns the vertices that have such a gap, with the line.
fn take_edges(
    surface: &Surface,
    obstacle: &Obstacle,
    deepest: impl Fn(usize) -> f64,
    measured: &mut Measured,
) -> BTreeMap<usize, Line> {
    let near: Vec<usize> =
        (0..measured.distance.len()).filter(|&vertex| measured.distance[vertex].is_finite()).collect();
    let points: Vec<Vector3<f64>> = near.iter().map(|&vertex| surface.vertices()[vertex]).collect();
    let triangles = triangles_among(surface, &near);
    let mut at_near = measured.rows(&near);
    let part = SkinPart { points: &points, triangles: &triangles };
    let deepest: Vec<f64> = near.iter().map(|&vertex| deepest(vertex)).collect();
    let taken = part.take_edges(obstacle, &deepest, &mut at_near);
    for &row in taken.keys() {
        (measured.distance[near[row]], measured.normal[near[row]]) =
            (at_near.distance[row], at_near.normal[row]);
    }
    taken.into_iter().map(|(row, line)| (near[row], line)).collect()
}
