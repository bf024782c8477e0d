//! Questions that are posed well and are probably not meant: a wrong unit, a depth that no tissue has, an inverted mask.

use std::f64::consts::PI;

use crate::contact::error::{ContactError, PressedContact};
use crate::contact::gap::deepest::DeepestVertex;
use crate::contact::outcome::{Contact, ContactStatus};
use crate::contact::report::given::misfit;
use crate::contact::report::product::{LAYER_SHARE, product_range, product_thickness};
use crate::contact::report::warning::{Warning, WarningKind};
use crate::contact::scene::{Approach, Press, Start};
use crate::contact::tilt::axes::Balance;
use crate::geometry::bounds::Bounds;
use crate::geometry::direction::unit;
use crate::mesh::remesh::green::smallest_angle;
use crate::obstacle::material::Material;
use crate::obstacle::posed::Obstacle;
use crate::response::kernel::skin::Kernel;
use crate::response::skin::elastic::{ElasticSkin, shear_modulus_under};
use crate::surface::checked::Surface;

/// Largest extent that a skin has (m): from a finger's tip to a hand with its arm.
const SKIN_EXTENTS: [f64; 2] = [5e-3, 1.0];
/// Largest extent that a product's mesh has (m).
const PRODUCT_EXTENTS: [f64; 2] = [1e-3, 3.0];
/// Shear moduli that tissue has (Pa).
pub(super) const MODULI: [f64; 2] = [1e3, 10e6];
/// Shear moduli that products have (Pa): from gels to diamond.
const PRODUCT_MODULI: [f64; 2] = [100.0, 1e12];
/// Share of the tissue over a bone that may be pressed in.
const TISSUE_SHARE: f64 = 2.0 / 3.0;
/// Share of a part's breadth that may be, where no bone is known.
const BREADTH_SHARE: f64 = 0.5;
/// Depths below this share of the skin's largest extent are below half the breadth of any part of a hand.
const SHALLOW_DEPTH: f64 = 1.0 / 64.0;
/// Radius of a contact as a share of the width of a Gaussian, from which its force is half too high (docs/responses.md).
const GAUSSIAN_SHARE: f64 = 1.0 / 3.0;
/// Mesh cells in the radius of a contact below which force and area are guesses.
const FEW_CELLS: f64 = 1.5;
/// Angle (rad) below which triangles are slivers: normals at their corners imply a skin that is uneven where it was smooth.
const SLIVER_ANGLE: f64 = 10.0 * PI / 180.0;
/// Share of the vertices that are few to touch: the flat cuts of hands and fingers are less.
const FEW_MAY_TOUCH: f64 = 0.2;

/// A question, with the contact that answers it.
pub(crate) struct Guarded<'a> {
    pub surface: &'a Surface,
    pub obstacle: &'a Obstacle,
    pub skin: &'a dyn ElasticSkin,
    /// The press that brought the obstacle to its place.
    pub press: Option<&'a Press>,
}

impl Guarded<'_> {
    /// Adds what the guards say to a contact, and to one that an error carries.
    pub fn check(&self, mut answer: Result<Contact, ContactError>) -> Result<Contact, ContactError> {
        match &mut answer {
            Ok(contact) => self.warn(contact),
            Err(
                ContactError::NotReached { contact: PressedContact(contact), why, .. }
                | ContactError::NotBalanced { contact: PressedContact(contact), why, .. },
            ) => {
                self.warn(contact);
                let is_of_unit =
                    |warning: &&Warning| matches!(warning.kind, WarningKind::Size | WarningKind::Modulus);
                for doubt in contact.warnings.iter().filter(is_of_unit) {
                    why.push_str("; ");
                    why.push_str(&doubt.message);
                }
            }
            Err(_) => {}
        }
        answer
    }

    fn warn(&self, contact: &mut Contact) {
        let found = [
            skin_size(self.surface),
            product_size(self.obstacle),
            self.modulus(contact),
            product_modulus(self.obstacle),
            self.given_compliance(contact),
            misfit(self.skin.misfit(), "skin"),
            misfit(self.obstacle.material().and_then(Material::misfit), "product"),
            self.mask(),
            self.way(contact),
            self.direction(contact),
            self.depth(contact),
            self.response_range(contact),
            self.response_length(contact),
            product_range(contact),
            product_thickness(contact),
            self.coarse_mesh(contact),
            self.slivers(contact),
        ];
        contact.warnings.splice(0..0, found.into_iter().flatten());
    }

    fn modulus(&self, contact: &Contact) -> Option<Warning> {
        let given =
            contact.candidates.iter().copied().filter(|&vertex| vertex < contact.given_vertex_count());
        let modulus = shear_modulus_under(self.skin, given)?;
        unit_of_modulus("shear modulus", modulus, MODULI, "tissue")
    }

    fn mask(&self) -> Option<Warning> {
        let mask = self.surface.skin_mask();
        let (free, count) = (mask.iter().filter(|&&may_touch| may_touch).count(), mask.len());
        (free < count && (free as f64) < FEW_MAY_TOUCH * count as f64).then(|| Warning {
            kind: WarningKind::Mask,
            message: format!(
                "the skin mask lets {free} of {count} vertices touch ({:.2} %): is it inverted? It is true where the skin may touch",
                100.0 * free as f64 / count as f64
            ),
        })
    }

    /// Of a product that moves past the skin or away from it.
    fn way(&self, contact: &Contact) -> Option<Warning> {
        let press = self.press.filter(|press| press.start == Start::Current)?;
        let approach = Approach::new(unit(&press.direction)?, Start::Current);
        let never_touches = || {
            let touch = approach.touch(self.surface, self.obstacle);
            matches!(touch, Err(ContactError::NeverTouches { .. }))
        };
        (contact.status == ContactStatus::NoContact && never_touches()).then(|| Warning {
            kind: WarningKind::Direction,
            message: "the product meets the skin nowhere on its way from where it stands: the direction is the one that the product travels in; turn it around, or move the product, where that is not meant".into(),
        })
    }

    /// Of a product that stands behind all of the skin, from where it was taken to the other side.
    fn direction(&self, contact: &Contact) -> Option<Warning> {
        let direction = unit(&self.press.filter(|_| contact.travel < 0.0)?.direction)?;
        let Bounds { low, high } = self.obstacle.bounding_box()?;
        let nearest = 0.5 * ((low + high).dot(&direction) - (high - low).dot(&direction.abs()));
        let along = self.surface.vertices().iter().map(|vertex| vertex.dot(&direction));
        let end_of_skin = along.fold(f64::NEG_INFINITY, f64::max);
        (nearest >= end_of_skin).then(|| Warning {
            kind: WarningKind::Direction,
            message: format!(
                "the product stands behind the skin along the direction and was taken back by {:.4e} m to press the other side: the direction is the one that the product travels in; turn it around where that is not meant",
                -contact.travel
            ),
        })
    }

    fn depth(&self, contact: &Contact) -> Option<Warning> {
        let warn = |depth: f64, most: f64, of: String| Warning {
            kind: WarningKind::Depth,
            message: format!(
                "the skin is pressed in by {depth:.4e} m, more than {most:.4e} m, {of}: the linear answer holds no longer; press less deep, and look at the unit and the place of the product"
            ),
        };
        let breadth = middle(&self.surface.bounding_box());
        let is_from_touch = |press: &&Press| press.start == Start::Infinity && press.balance == Balance::None;
        let depth = self.press.filter(is_from_touch).and(contact.depth);
        if let Some(depth) = depth.filter(|&depth| depth > breadth) {
            return Some(warn(depth, breadth, "the breadth of the whole skin".into()));
        }
        let DeepestVertex { vertex, overlap, normal } = contact.clues.deepest.as_ref()?;
        if let Some(tissue) = self.skin.tissue_at(*vertex) {
            // Along the way that the skin is pushed.
            let cosine = -self.surface.vertex_normals()[*vertex].dot(normal);
            let tissue = tissue / cosine.clamp(f64::MIN_POSITIVE, 1.0);
            let most = TISSUE_SHARE * tissue;
            let of = || format!("two thirds of the {tissue:.4e} m of tissue under vertex {vertex}");
            return (*overlap > most).then(|| warn(*overlap, most, of()));
        }
        if *overlap < SHALLOW_DEPTH * largest(&self.surface.bounding_box()) {
            return None;
        }
        // Beside an edge, or in a thin wall, the obstacle's normal runs along the skin.
        let inward = -self.surface.vertex_normals()[*vertex];
        let ways = [Some(*normal), Some(inward), self.press.and_then(|press| unit(&press.direction))];
        let breadths = ways.into_iter().flatten().filter_map(|way| self.surface.breadth_along(*vertex, &way));
        let part = breadths.reduce(f64::max).unwrap_or(breadth);
        let most = BREADTH_SHARE * part;
        let of = || format!("half of the {part:.4e} m that the part is broad at vertex {vertex}");
        (*overlap > most).then(|| warn(*overlap, most, of()))
    }

    fn response_range(&self, contact: &Contact) -> Option<Warning> {
        let vertex = contact.clues.deepest?.vertex;
        let (found, is_beyond) = match self.skin.kernel_at(vertex)?.kernel() {
            Kernel::Layer { thickness } => {
                let (thickness, overlap) = (thickness.at(vertex), contact.max_penetration_before);
                let found = format!(
                    "the skin is pressed in by {overlap:.4e} m, more than half of the {thickness:.4e} m of its layer"
                );
                (found, overlap > LAYER_SHARE * thickness)
            }
            Kernel::GaussianCorrected { width, height, .. } if *height > 0.0 => {
                let areas = contact.patches.iter().map(|patch| patch.resultant.contact_area);
                let radius = (areas.fold(0.0, f64::max) / PI).sqrt();
                let found = format!(
                    "the contact has a radius of {radius:.4e} m, more than a third of the {width:.4e} m of the Gaussian's width"
                );
                (found, radius > GAUSSIAN_SHARE * width)
            }
            _ => return None,
        };
        is_beyond.then(|| Warning {
            kind: WarningKind::ResponseRange,
            message: format!(
                "{found}: there it is too stiff, by half and more on a finger; take a body, or press less deep"
            ),
        })
    }

    fn coarse_mesh(&self, contact: &Contact) -> Option<Warning> {
        let cells = contact.accuracy.cells_per_radius;
        let is_given = contact.gap.len() == contact.given_vertex_count();
        let is_coarse = contact.status == ContactStatus::Solved && is_given && cells < FEW_CELLS;
        let refines = self.skin.traits(self.surface).is_ok_and(|traits| traits.refines);
        let refine = if refines { "refine it (`target_error`), or " } else { "" };
        (is_coarse && !contact.active.is_empty()).then(|| Warning {
            kind: WarningKind::CoarseMesh,
            message: format!(
                "the contact has {cells:.2} mesh cells in its radius, fewer than {FEW_CELLS}, and the mesh was taken as it is: do not trust force and area; {refine}take a finer mesh"
            ),
        })
    }

    /// Of the given mesh, which all finer ones follow.
    fn slivers(&self, contact: &Contact) -> Option<Warning> {
        let given: Vec<usize> =
            contact.active.iter().copied().filter(|&vertex| vertex < contact.given_vertex_count()).collect();
        let faces = self.surface.faces_at(&given);
        let corners =
            |face: u32| self.surface.faces()[face as usize].map(|v| self.surface.vertices()[v as usize]);
        let angle = |&face: &u32| smallest_angle(corners(face));
        let slivers = faces.iter().filter(|face| angle(face) < SLIVER_ANGLE);
        let thinnest = slivers.clone().min_by(|one, other| angle(one).total_cmp(&angle(other)))?;
        Some(Warning {
            kind: WarningKind::CoarseMesh,
            message: format!(
                "{} of the {} triangles of the given mesh under force have angles below {:.0} degrees, down to {:.2} at face {thinnest}: the smooth skin that their normals imply is uneven, and area and peak pressure may be off by more than is told; remesh the skin there",
                slivers.count(),
                faces.len(),
                SLIVER_ANGLE.to_degrees(),
                angle(thinnest).to_degrees(),
            ),
        })
    }

    /// Of a layer thicker, or a Gaussian wider, than the skin is large: both are half-spaces there.
    fn response_length(&self, contact: &Contact) -> Option<Warning> {
        let vertex = contact.clues.deepest?.vertex;
        let (what, length) = match self.skin.kernel_at(vertex)?.kernel() {
            Kernel::Layer { thickness } => ("layer's thickness", thickness.at(vertex)),
            Kernel::GaussianCorrected { width, height, .. } if *height > 0.0 => ("Gaussian's width", *width),
            _ => return None,
        };
        let size = self.surface.bounding_box().diagonal();
        (length > size).then(|| Warning {
            kind: WarningKind::ResponseRange,
            message: format!(
                "the {what} is {length:.4e} m, more than the {size:.4e} m that the skin is large: is it in another unit? So large it answers as a half-space; 8 mm is 8e-3"
            ),
        })
    }
}

fn product_modulus(obstacle: &Obstacle) -> Option<Warning> {
    unit_of_modulus(
        "product's shear modulus",
        obstacle.material()?.shear_modulus(),
        PRODUCT_MODULI,
        "products",
    )
}

fn unit_of_modulus(what: &str, modulus: f64, usual: [f64; 2], of: &str) -> Option<Warning> {
    let [least, most] = usual;
    (!is_within(modulus, usual)).then(|| Warning {
        kind: WarningKind::Modulus,
        message: format!(
            "the {what} is {modulus:.4e} Pa, outside the {least:.0e} to {most:.0e} Pa of {of}: is it in another unit? 60 kPa is 60e3"
        ),
    })
}

fn skin_size(surface: &Surface) -> Option<Warning> {
    size("skin", "read_surface", largest(&surface.bounding_box()), SKIN_EXTENTS)
}

/// Of a mesh: primitives are given in metres by hand, and half-spaces have no end.
fn product_size(obstacle: &Obstacle) -> Option<Warning> {
    let bounds = obstacle.bounding_box().filter(|_| obstacle.kind() == "mesh")?;
    size("product", "read_obstacle", largest(&bounds), PRODUCT_EXTENTS)
}

fn size(of: &str, read: &str, extent: f64, usual: [f64; 2]) -> Option<Warning> {
    let [least, most] = usual;
    (!is_within(extent, usual)).then(|| Warning {
        kind: WarningKind::Size,
        message: format!(
            "the {of} is {extent:.4e} m large, outside {least} to {most} m: is it in another unit? `{read}(unit=\"mm\")` converts a file"
        ),
    })
}

pub(super) fn is_within(value: f64, [least, most]: [f64; 2]) -> bool {
    (least..=most).contains(&value)
}

/// Sides of a box, ascending (m).
fn sides(bounds: &Bounds) -> [f64; 3] {
    let mut sides: [f64; 3] = (bounds.high - bounds.low).into();
    sides.sort_unstable_by(f64::total_cmp);
    sides
}

fn largest(bounds: &Bounds) -> f64 {
    sides(bounds)[2]
}

fn middle(bounds: &Bounds) -> f64 {
    sides(bounds)[1]
}
