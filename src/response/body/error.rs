//! Why a body response was refused.

use crate::geometry::rigid_motion::RigidMotionError;
use crate::linalg::threads::ThreadsError;
use crate::response::rows::NodesError;

/// Why a body response was refused.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum BodyError {
    /// The shear modulus is not a positive number, or is out of range.
    #[error("shear modulus {value:?} Pa: it must be positive and finite, from 1e-60 to 1e60")]
    ShearModulus {
        /// What was given (Pa).
        value: f64,
    },
    /// The Poisson ratio is out of range.
    #[error("Poisson ratio {value}: the body response takes 0 to 0.5")]
    PoissonRatio {
        /// What was given.
        value: f64,
    },
    /// The integration tolerance is out of range.
    #[error("integration tolerance {value}: it must lie between 1e-9 and 1e-2")]
    Tolerance {
        /// What was given (relative).
        value: f64,
    },
    /// The wanted length of the coarse edges is out of range.
    #[error(
        "coarse edge length {value} m: it must be 0 (the skin itself) or up to the size of the body, {size:.3e} m"
    )]
    CoarseEdgeLength {
        /// What was given (m).
        value: f64,
        /// Diagonal of the box around the skin (m).
        size: f64,
    },
    /// The skin cannot be coarsened as far as wanted.
    #[error(
        "the coarse skin of the body is no body: {reason}; take a smaller coarse edge length, or 0 for the skin itself"
    )]
    CoarseMesh {
        /// What is wrong with it.
        reason: String,
    },
    /// The skin crosses itself, so it bounds no body there.
    #[error(
        "the skin crosses itself in {count} pairs of faces (first: {first} and {second}): it encloses no body there; part \
         what crosses, or cut it off"
    )]
    SkinCrosses {
        /// A face of the skin that crosses another.
        first: usize,
        /// The other.
        second: usize,
        /// Number of such pairs.
        count: usize,
    },
    /// The skin has a border, so it bounds no body.
    #[error(
        "the skin is open ({border_count} borders): the body response needs a closed surface, cut faces included"
    )]
    SkinOpen {
        /// Number of border loops.
        border_count: usize,
    },
    /// The skin is more than one body, or a body with a cavity.
    #[error("the skin has {count} separate pieces: prepare one body each")]
    SkinPieces {
        /// Number of connected components.
        count: usize,
    },
    /// The skin is turned inside out.
    #[error("the skin encloses {volume:.3e} m³: its faces must be counter-clockwise seen from outside")]
    SkinInverted {
        /// Signed volume (m³).
        volume: f64,
    },
    /// Neither bone nor fixed vertices hold the body.
    #[error(
        "nothing holds the body, so a force moves it without end: give a bone, or fix the vertices of a cut face"
    )]
    Unsupported,
    /// The mask of fixed vertices has the wrong length.
    #[error("the mask of fixed vertices has {found} entries, but the skin has {expected} vertices")]
    FixedLength {
        /// Length of the mask.
        found: usize,
        /// Number of skin vertices.
        expected: usize,
    },
    /// The mask fixes no vertex.
    #[error(
        "the mask fixes none of the {vertex_count} skin vertices: leave it out, or fix the vertices of a cut face"
    )]
    FixedNothing {
        /// Number of skin vertices.
        vertex_count: usize,
    },
    /// The mask fixes every vertex.
    #[error("the mask fixes all {vertex_count} skin vertices, so nothing can move")]
    FixedEverything {
        /// Number of skin vertices.
        vertex_count: usize,
    },
    /// The fixed vertices span no face, so they cannot carry a moment or even a finite traction.
    #[error(
        "the {count} fixed vertices (first: {first}) span no face: the body could turn about them; fix all three \
         vertices of some faces, as those of a cut face"
    )]
    FixedWithoutFace {
        /// Number of fixed vertices.
        count: usize,
        /// The first of them.
        first: usize,
    },
    /// A bone has a border.
    #[error("bone {component} is open (one border edge: {edge:?}): bones must be closed surfaces")]
    BoneOpen {
        /// Connected component of the bone surface.
        component: usize,
        /// Vertices of a border edge.
        edge: (u32, u32),
    },
    /// A bone is turned inside out, or is a cavity of another.
    #[error(
        "bone {component} encloses {volume:.3e} m³: its faces must be counter-clockwise seen from the tissue, and \
         bones are solid"
    )]
    BoneInverted {
        /// Connected component of the bone surface.
        component: usize,
        /// Signed volume (m³).
        volume: f64,
    },
    /// A bone lies outside the skin.
    #[error("bone {component} lies outside the skin (vertex {vertex} and {count} in all)")]
    BoneOutside {
        /// Connected component of the bone surface.
        component: usize,
        /// A bone vertex outside.
        vertex: usize,
        /// Number of vertices of that bone, all of them outside.
        count: usize,
    },
    /// Bone and skin cross or touch.
    #[error(
        "the bone crosses or touches the skin in {count} pairs of faces (first: bone face {bone_face}, skin face \
         {skin_face}): shrink or move it"
    )]
    BoneCrossesSkin {
        /// The first bone face that meets the skin.
        bone_face: usize,
        /// The first skin face that it meets.
        skin_face: usize,
        /// Number of pairs that meet.
        count: usize,
    },
    /// Bone and skin all but touch.
    #[error(
        "bone face {bone_face} is only {distance:.3e} m from skin face {skin_face}, less than {limit:.1e} m: no \
         tissue is left between"
    )]
    BoneTouchesSkin {
        /// The bone face.
        bone_face: usize,
        /// The skin face.
        skin_face: usize,
        /// Their distance (m).
        distance: f64,
        /// Smallest distance accepted (m).
        limit: f64,
    },
    /// Two bones touch or cross.
    #[error(
        "bones {first} and {second} touch or cross (faces {first_face} and {second_face}): join or part them"
    )]
    BonesMeet {
        /// Component of the first.
        first: usize,
        /// Component of the second.
        second: usize,
        /// A face of the first.
        first_face: usize,
        /// A face of the second.
        second_face: usize,
    },
    /// No node was asked for.
    #[error("no node to load: the compliance of no node is empty")]
    NoNodes,
    /// The nodes are no rows of a response.
    #[error(transparent)]
    Nodes(#[from] NodesError),
    /// A node is fixed, so a force there moves nothing.
    #[error("{count} of the nodes are fixed vertices (first: vertex {vertex}): a force there moves nothing")]
    NodeFixed {
        /// The first such vertex.
        vertex: usize,
        /// Number of such nodes.
        count: usize,
    },
    /// The solve would need more memory than allowed.
    #[error(
        "the body response needs {needed} bytes ({skin_count} skin and {bone_count} bone vertices, {node_count} \
         nodes), the limit is {limit}; within it about {affordable} vertices are possible: coarsen bone and skin away \
         from the contact, cut the finger off the hand, or load fewer nodes"
    )]
    MemoryLimit {
        /// Peak memory (bytes).
        needed: usize,
        /// The limit (bytes).
        limit: usize,
        /// Skin vertices.
        skin_count: usize,
        /// Bone vertices.
        bone_count: usize,
        /// Loaded nodes.
        node_count: usize,
        /// Skin and bone vertices that would fit with as many nodes.
        affordable: usize,
    },
    /// The caller's interrupt ended the work.
    #[error("interrupted after {seconds:.1} s, during the {stage}")]
    Interrupted {
        /// What was going on.
        stage: &'static str,
        /// Time since the start (s).
        seconds: f64,
    },
    /// The equations are singular to working precision.
    #[error(
        "the equations are singular (smallest over largest pivot {pivot_ratio:.1e}): look for slivers and folds"
    )]
    Singular {
        /// Smallest over largest pivot.
        pivot_ratio: f64,
    },
    /// Directions or forces do not fit the nodes.
    #[error("{found} {what} for {expected} nodes")]
    Length {
        /// "directions" or "forces".
        what: &'static str,
        /// Number found.
        found: usize,
        /// Number of nodes.
        expected: usize,
    },
    /// A direction is no unit vector.
    #[error("directions[{index}] has length {length}, expected a unit vector")]
    DirectionLength {
        /// Position in the list.
        index: usize,
        /// Its length.
        length: f64,
    },
    /// A matrix is no rotation.
    #[error(transparent)]
    Rotation(#[from] RigidMotionError),
    /// Stored parts do not belong together.
    #[error("stored {what} has {found} entries, expected {expected}")]
    Parts {
        /// Which part.
        what: &'static str,
        /// Number found.
        found: usize,
        /// Number expected.
        expected: usize,
    },
    /// A number of a stored part is out of its range.
    #[error("row {row} of the stored {what} holds {value}, expected {expected}")]
    PartNumber {
        /// Which part.
        what: &'static str,
        /// The first row at fault.
        row: usize,
        /// The value found.
        value: f64,
        /// The range, in words.
        expected: &'static str,
    },
    /// A stored node is not where it belongs.
    #[error("stored node {position} is vertex {vertex}, expected vertex {expected} there")]
    NodeMisplaced {
        /// Position in the list of nodes.
        position: usize,
        /// The vertex found there.
        vertex: usize,
        /// The vertex that belongs there.
        expected: usize,
    },
    /// A stored remainder does not answer a force at a node.
    #[error(
        "vertex {vertex} may be loaded, but the stored remainder has no column for vertex {coarse_vertex} of the coarse \
         skin beside it"
    )]
    NoColumn {
        /// The vertex of the skin.
        vertex: usize,
        /// The vertex of the coarse skin.
        coarse_vertex: usize,
    },
    /// The worker threads could not be started.
    #[error(transparent)]
    Threads(#[from] ThreadsError),
}
