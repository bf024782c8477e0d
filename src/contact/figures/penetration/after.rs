//! What penetration a contact leaves, measured anew at the deformed skin: at its vertices, in its triangles, and of the
//! obstacle's edges, and walls that it went through, in them.

use nalgebra::Vector3;

use crate::contact::discretization::gap_of;
use crate::contact::equilibrium::compliance::Compliance;
use crate::contact::equilibrium::forces::NodeForces;
use crate::contact::error::ContactError;
use crate::contact::figures::area::beside::Beside;
use crate::contact::figures::motion::candidates::CandidateMotion;
use crate::contact::figures::motion::fade::Fade;
use crate::contact::figures::penetration::between::{Between, PointsBetween};
use crate::contact::figures::penetration::receding::{DeformedCorners, Receding};
use crate::contact::gap::edge::{SkinPart, triangles_among};
use crate::contact::gap::entry::OTHER_SIDE;
use crate::contact::gap::initial::Gaps;
use crate::contact::gap::measured::Measured;
use crate::response::kernel::basis::Discretization;
use crate::response::skin::elastic::{ElasticSkin, shear_modulus_under};

/// Penetration left that is next to none, as a share of that before.
pub(crate) const SMALL_PENETRATION: f64 = 0.02;

/// Share of that from which a closer look may find more.
const NEARLY_SMALL: f64 = 0.75;

/// How deep in a triangle, over its shortest edge, something blunt stands: what is deeper has sides that vertices slid past.
const BLUNT_DEPTH: f64 = 0.25;

/// What penetration is left.
#[derive(Debug, Clone)]
pub(crate) struct Penetration {
    /// The deepest (m, ≥ 0).
    pub depth: f64,
    /// The mean over all skin under force (m).
    pub mean: f64,
    /// How far off the obstacle the force acts in the mean (m), beyond the gaps that were solved: where these did not settle.
    pub apart: f64,
    /// Whether a vertex of the skin is that deep, not only a point between vertices.
    pub is_at_vertex: bool,
    /// Where the obstacle recedes between vertices under force.
    pub receding: Receding,
    /// Vertices that penetrate by more than a little away from all force, as averages over their triangles feel nothing of it.
    pub unfelt: Vec<usize>,
    /// Corners of triangles away from all force that something blunt stands in between their vertices.
    pub unmet: Vec<[usize; 3]>,
}

/// Deepest penetration of skin and obstacle into one another, where the forces put the skin.
pub(crate) fn penetration_after(
    gaps: &Gaps,
    forces: &NodeForces,
    response: &Compliance,
    motion: &CandidateMotion,
    beside: &Beside,
) -> Result<Penetration, ContactError> {
    if forces.active.is_empty() {
        // Nothing has moved, and an obstacle that stands between the vertices alone is in none of them.
        let depth = gaps.deepest();
        return Ok(Penetration {
            depth,
            mean: depth,
            apart: 0.0,
            is_at_vertex: true,
            receding: Receding::default(),
            unfelt: gaps.penetrating.clone(),
            unmet: Vec::new(),
        });
    }
    let Compliance { skin, traits, .. } = *response;
    let moved = MovedSkin::new(gaps, forces, skin, motion, beside)?;
    let Between { deepest, middles, of_faces } = moved.between()?;
    let depth = moved.looked_at_closely(deepest);
    // E* of tissue that keeps its volume.
    let modulus = 4.0 * shear_modulus_under(skin, forces.candidates.iter().copied()).unwrap_or(0.0);
    Ok(Penetration {
        depth,
        mean: moved.mean_depth(&of_faces).unwrap_or(depth),
        apart: moved.apart(traits.discretization)?,
        is_at_vertex: moved.deepest_vertex() >= depth,
        receding: moved.receding(&middles, modulus),
        unfelt: moved.unfelt(),
        unmet: moved.unmet(&of_faces),
    })
}

/// The skin around a contact where the forces put it.
struct MovedSkin<'a> {
    gaps: &'a Gaps<'a>,
    forces: &'a NodeForces,
    /// Candidates, and those beside them.
    vertices: Vec<usize>,
    /// Their places (m).
    points: Vec<Vector3<f64>>,
    triangles: Vec<[u32; 3]>,
    /// Distance (m) and normal of the obstacle there, no farther than the deepest penetration before.
    measured: Measured,
    /// How deep each vertex stands in the obstacle at the most (m, negative outside).
    depths: Vec<f64>,
}

impl<'a> MovedSkin<'a> {
    fn new(
        gaps: &'a Gaps,
        forces: &'a NodeForces,
        skin: &dyn ElasticSkin,
        motion: &CandidateMotion,
        beside: &Beside,
    ) -> Result<Self, ContactError> {
        let at_rest = gaps.surface.vertices();
        let mut vertices = forces.candidates.clone();
        let candidates = vertices.iter().zip(&motion.displacement);
        let mut points: Vec<Vector3<f64>> = candidates.map(|(&vertex, u)| at_rest[vertex] + u).collect();
        let (others, found) = beside.near();
        if !others.is_empty() {
            let fade = Fade::new(gaps.surface, &forces.fingers, &forces.candidates, &motion.scalar);
            for (&vertex, moved) in others.iter().zip(found) {
                let share = if skin.is_scalar(vertex) { fade.share(vertex) } else { 1.0 };
                vertices.push(vertex);
                points.push(at_rest[vertex] + share * moved);
            }
        }
        let triangles = triangles_among(gaps.surface, &vertices);
        let reach = gaps.deepest();
        let measured = Measured::near(&points, &gaps.scene.obstacle, reach, None)?;
        let depths = measured.distance.iter().map(|distance| -distance.min(reach)).collect();
        Ok(Self { gaps, forces, vertices, points, triangles, measured, depths })
    }

    /// Deepest penetration of a vertex (m, ≥ 0).
    fn deepest_vertex(&self) -> f64 {
        self.depths.iter().copied().fold(0.0, f64::max)
    }

    fn part(&self) -> SkinPart<'_> {
        SkinPart { points: &self.points, triangles: &self.triangles }
    }

    /// The deepest of all, and what is between the vertices.
    fn between(&self) -> Result<Between, ContactError> {
        let (obstacle, least) = (&self.gaps.scene.obstacle, self.deepest_vertex());
        let of_edges =
            self.part().deepest_between(obstacle, self.gaps.deepest(), least, &self.measured.distance);
        PointsBetween::new(&self.points, &self.depths, &self.triangles).look(obstacle, of_edges)
    }

    /// The deepest penetration (m), with corners, edges and walls of the obstacle in the skin where a warning may tell the figure.
    fn looked_at_closely(&self, deepest: f64) -> f64 {
        let reach = self.gaps.deepest();
        if deepest <= NEARLY_SMALL * SMALL_PENETRATION * reach {
            return deepest;
        }
        let at_rest = self.gaps.surface.vertices();
        let at_rest: Vec<Vector3<f64>> = self.vertices.iter().map(|&vertex| at_rest[vertex]).collect();
        let went_through = self.gaps.entry.through_walls > 0;
        self.part().deepest_inside(&at_rest, &self.gaps.scene.obstacle, reach, deepest, went_through)
    }

    /// How deep all triangles stand in the obstacle, in the mean over those under force (m); `None` without such.
    ///
    /// * `of_faces`: of each at the most, between its corners (m); none where the obstacle is flat
    fn mean_depth(&self, of_faces: &[f64]) -> Option<f64> {
        let (mut volume, mut loaded) = (0.0, 0.0);
        for (face, triangle) in self.triangles.iter().enumerate() {
            let corners = triangle.map(|corner| corner as usize);
            let area = self.area(corners);
            let between = of_faces.get(face).copied().unwrap_or_default();
            volume += area * corners.iter().map(|&corner| self.depths[corner]).fold(between, f64::max);
            if !corners.iter().all(|&corner| self.is_free(self.vertices[corner])) {
                loaded += area;
            }
        }
        (loaded > 0.0).then(|| volume / loaded)
    }

    /// Area of a triangle where the forces put it (m²).
    fn area(&self, corners: [usize; 3]) -> f64 {
        let [a, b, c] = corners.map(|corner| self.points[corner]);
        0.5 * (b - a).cross(&(c - a)).norm()
    }

    /// Force (N) on a vertex by its own gap: the skin that drapes over an edge stands off it.
    fn own_force(&self, vertex: usize) -> f64 {
        if self.gaps.line_at(vertex).is_some() { 0.0 } else { self.forces.force[vertex] }
    }

    /// How far off the obstacle the force acts in the mean (m).
    fn apart(&self, discretization: Discretization) -> Result<f64, ContactError> {
        let reach = self.gaps.deepest();
        let mut off: Vec<f64> = self.measured.distance.iter().map(|distance| distance.min(reach)).collect();
        if discretization == Discretization::Galerkin {
            // What averages leave open at vertices the planes have too: the rest did not settle.
            let at_rest = self.gaps.surface.vertices();
            let moved = self.vertices.iter().zip(&self.points);
            let moved: Vec<Vector3<f64>> = moved.map(|(&vertex, point)| point - at_rest[vertex]).collect();
            let solved = gap_of(self.gaps, &self.vertices, &moved)?;
            off.iter_mut().zip(solved).for_each(|(off, solved)| *off -= solved.min(reach));
            off = self.averages(&off);
        }
        let work = self.vertices.iter().zip(off).map(|(&vertex, off)| self.own_force(vertex) * off.max(0.0));
        Ok(work.sum::<f64>() / self.forces.force.iter().sum::<f64>().max(f64::MIN_POSITIVE))
    }

    /// Averages of distances (m) against the hats of vertices, each taken as the problem does: on another side of the obstacle a
    /// vertex's own stands for them. 0 where some triangles around one drape over an edge or are not among those here.
    fn averages(&self, distance: &[f64]) -> Vec<f64> {
        let count = distance.len();
        let (mut sums, mut areas, mut faces) = (vec![0.0; count], vec![0.0; count], vec![0; count]);
        let normal = &self.measured.normal;
        let drapes = |corner: usize| self.gaps.line_at(self.vertices[corner]).is_some();
        let corners = self.triangles.iter().map(|triangle| triangle.map(|corner| corner as usize));
        for corners in corners.filter(|corners| !corners.iter().any(|&corner| drapes(corner))) {
            let area = self.area(corners);
            for own in corners {
                let is_other = |other: usize| normal[other].dot(&normal[own]) < OTHER_SIDE;
                let taken = corners.map(|other| distance[if is_other(other) { own } else { other }]);
                sums[own] += 0.25 * area * (taken.iter().sum::<f64>() + distance[own]);
                areas[own] += area;
                faces[own] += 1;
            }
        }
        let average = |(row, &vertex): (usize, &usize)| {
            let is_whole = faces[row] == self.gaps.surface.faces_around(vertex).len();
            if is_whole { sums[row] / areas[row] } else { 0.0 }
        };
        self.vertices.iter().enumerate().map(average).collect()
    }

    /// * `middles`: how far the middle of each triangle is from the obstacle at the least (m)
    /// * `modulus`: E* of the skin (Pa)
    fn receding(&self, middles: &[f64], modulus: f64) -> Receding {
        let areas = self.gaps.surface.vertex_areas();
        let pressure: Vec<f64> =
            self.vertices.iter().map(|&vertex| self.own_force(vertex) / areas[vertex]).collect();
        let Measured { distance, normal } = &self.measured;
        let corners = DeformedCorners { points: &self.points, distance, normal, pressure: &pressure };
        Receding::new(&self.triangles, middles, &corners, modulus)
    }

    fn is_free(&self, vertex: usize) -> bool {
        self.forces.force[vertex] == 0.0
    }

    /// Whether that deep (m) is more than a little.
    fn is_deep(&self, depth: f64) -> bool {
        depth > SMALL_PENETRATION * self.gaps.deepest()
    }

    /// Vertices that penetrate away from all force.
    fn unfelt(&self) -> Vec<usize> {
        let is_unfelt = |vertex: usize| {
            let mut beside = self.gaps.surface.neighbours(vertex).iter().map(|&other| other as usize);
            self.is_free(vertex) && beside.all(|other| self.is_free(other))
        };
        let deep = self.vertices.iter().zip(&self.depths).filter(|(_, depth)| self.is_deep(**depth));
        deep.map(|(&vertex, _)| vertex).filter(|&vertex| is_unfelt(vertex)).collect()
    }

    /// Corners of triangles away from all force that something blunt stands in between their vertices.
    ///
    /// * `depths`: in each triangle (m)
    fn unmet(&self, depths: &[f64]) -> Vec<[usize; 3]> {
        let is_blunt = |triangle: &[u32; 3], depth: f64| {
            let [a, b, c] = triangle.map(|corner| self.points[corner as usize]);
            depth < BLUNT_DEPTH * (b - a).norm().min((c - b).norm()).min((a - c).norm())
        };
        let is_stood_in =
            |(triangle, depth): &(&[u32; 3], &f64)| self.is_deep(**depth) && is_blunt(triangle, **depth);
        let may_touch = |vertex: &usize| self.is_free(*vertex) && self.gaps.surface.skin_mask()[*vertex];
        let stood_in = self.triangles.iter().zip(depths).filter(is_stood_in);
        let corners = stood_in.map(|(triangle, _)| triangle.map(|corner| self.vertices[corner as usize]));
        corners.filter(|corners| corners.iter().all(may_touch)).collect()
    }
}
