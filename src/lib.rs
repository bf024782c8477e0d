//! Quasi-rigid contact of hand skin with products.
//!
//! A posed hand (a triangle mesh, the *skin*) is pressed against a product (the *obstacle*). The skin is
//! rigid but for a small elastic deformation near the contact. At the candidate nodes `i`, the vertices that
//! start inside the obstacle, the unknowns are node forces `f` (k, N) and gaps `g` (k, m):
//!
//! ```text
//! g = g0 + R f,    g >= 0,    f >= 0,    g·f = 0
//! ```
//!
//! `g0` (k, m) is the signed distance of the undeformed skin from the obstacle, positive outside it, and
//! `R` (k × k, m/N) the response matrix: `R[i, j]` is the displacement of node `i` along the obstacle's
//! outward normal per newton at node `j`, so a force that pushes the skin out of the obstacle is positive.
//! Against a product with a material ([`obstacle::Obstacle::with_material`]) it is the sum of both responses.
//! The pressure is `p_i = f_i / S_i` (Pa) with `S_i` (m²) a third of the area of the triangles around `i`.
//!
//! The pipeline, one module a step:
//!
//! 1. [`surface`]: the skin, checked once, with its neighbourhoods, areas and normals;
//! 2. [`obstacle`]: the product, with signed distance, closest point and outward normal;
//! 3. [`contact`]: the gaps and from them the candidate nodes;
//! 4. [`response`]: the response matrix over the candidates;
//! 5. [`lcp`]: the complementarity problem, its ending and its certificate;
//! 6. [`contact`]: deformed skin, pressure map, force, moment, area, and how far each can be trusted.
//!
//! From arrays to figures (the crate reads no mesh files; bring vertices and faces from a reader of yours):
//!
//! ```
//! use nalgebra::Vector3;
//! use quasirigid::contact::{Balance, ContactOptions, Goal, Press, Start, press};
//! use quasirigid::response::{Kernel, KernelSkin};
//! use quasirigid::{obstacle::Obstacle, surface::Surface};
//!
//! // Flat skin in z = 0, outside above: 17 x 17 vertices, 0.5 mm apart.
//! let n = 17;
//! let place = |i: u32| 0.5e-3 * Vector3::new(f64::from(i % n) - 8.0, f64::from(i / n) - 8.0, 0.0);
//! let vertices = (0..n * n).map(place).collect();
//! let corners = (0..n * (n - 1)).filter(|i| i % n < n - 1);
//! let faces = corners.flat_map(|i| [[i, i + 1, i + n + 1], [i, i + n + 1, i + n]]).collect();
//! let skin = Surface::new(vertices, faces)?;
//!
//! let ball = Obstacle::sphere(Vector3::zeros(), 8e-3)?;
//! let tissue = KernelSkin::new(60e3, 0.5, Kernel::HalfSpace)?;
//! let goal = Goal::Depth(0.2e-3);
//! let down = Press { direction: -Vector3::z(), goal, start: Start::Infinity, balance: Balance::None };
//! let contact = press(&skin, &ball, &tissue, &down, &ContactOptions::default())?;
//!
//! println!("{} N on {} m²", contact.resultant.force.norm(), contact.resultant.contact_area);
//! for (vertex, pressure) in contact.surface().vertices().iter().zip(&contact.pressure) {
//!     println!("{vertex}: {pressure} Pa"); // the mesh is refined around the contact
//! }
//! for warning in &contact.warnings {
//!     println!("{}", warning.message);
//! }
//! // Hertz: pi R d
//! assert!((contact.resultant.contact_area / (std::f64::consts::PI * 8e-3 * 0.2e-3) - 1.0).abs() < 0.05);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Units are SI throughout: m, N, Pa, rad, s. Faces are counter-clockwise seen from outside.
//!
//! Sources: Xie, Kanai, Date 2011 ("Simulating Deformable Contact Property of Digital Hand Skin"); Pauly,
//! Pai, Guibas 2004 ("Quasi-rigid objects in contact"); Johnson 1985 ("Contact Mechanics").

pub mod contact;
pub mod geometry;
pub mod hand;
pub mod lcp;
pub(crate) mod linalg;
pub mod mesh;
pub mod obstacle;
pub mod reference;
pub mod response;
#[cfg(test)]
#[allow(dead_code, reason = "tests/ and benches/ use the rest")]
pub(crate) mod sample;
pub mod surface;

#[cfg(feature = "python")]
mod python;

/// The README's Rust code compiles.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
