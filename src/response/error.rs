//! Why a skin or a response matrix was refused.

use crate::linalg::threads::ThreadsError;
use crate::response::body::error::BodyError;
use crate::response::rows::NodesError;

/// Why a skin or a response matrix was refused.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ResponseError {
    /// A material or kernel constant is outside its range.
    #[error("{name} is {value:?}, but must be {expected}")]
    Constant {
        /// Name of the constant.
        name: &'static str,
        /// The value found (SI).
        value: f64,
        /// The range, in words.
        expected: &'static str,
    },
    /// The response has no Galerkin form.
    #[error("the {response} response takes the gap at the nodes: `discretization=\"collocation\"`")]
    CollocationOnly {
        /// What it is.
        response: &'static str,
    },
    /// The nodes are no rows of a response.
    #[error(transparent)]
    Nodes(#[from] NodesError),
    /// The number of directions differs from the number of nodes.
    #[error("{directions} directions were given for {nodes} nodes")]
    DirectionCount {
        /// Directions given.
        directions: usize,
        /// Nodes given.
        nodes: usize,
    },
    /// A direction is no unit vector.
    #[error("directions[{index}] has length {length}, expected a unit vector")]
    Direction {
        /// Position in the list of directions.
        index: usize,
        /// Its length.
        length: f64,
    },
    /// The number of thicknesses differs from the number of vertices.
    #[error("{thicknesses} thicknesses were given for a surface of {vertex_count} vertices")]
    ThicknessCount {
        /// Thicknesses given.
        thicknesses: usize,
        /// Vertices of the surface.
        vertex_count: usize,
    },
    /// A vertex's layer is so much thinner than the mesh that its unit is likely wrong.
    #[error(
        "the layer is {thickness:.3e} m thick at vertex {vertex}, less than 1/1000 of the mesh's mean edge of \
         {edge_length:.3e} m: give thicknesses in metres, or take a finer mesh"
    )]
    TooThin {
        /// First such vertex.
        vertex: usize,
        /// Thickness there (m).
        thickness: f64,
        /// Mean edge length of the surface (m).
        edge_length: f64,
    },
    /// The matrix would need more memory than allowed.
    #[error(
        "a response matrix over {nodes} nodes needs {bytes} bytes, more than the {limit} of `memory_limit` (what the \
         system has free where none is set); take fewer nodes or a kernel that decays"
    )]
    TooLarge {
        /// Number of nodes.
        nodes: usize,
        /// Bytes needed.
        bytes: usize,
        /// Bytes allowed.
        limit: usize,
    },
    /// The assembly was interrupted.
    #[error("assembly was interrupted after {columns} of {nodes} columns")]
    Interrupted {
        /// Columns finished.
        columns: usize,
        /// Columns in all.
        nodes: usize,
    },
    /// A matrix does not belong to the nodes.
    #[error("the matrix is {rows} x {columns}, expected {nodes} x {nodes} for {nodes} nodes")]
    MatrixShape {
        /// Rows found.
        rows: usize,
        /// Columns found.
        columns: usize,
        /// Number of nodes.
        nodes: usize,
    },
    /// An entry of a matrix is not finite.
    #[error("entry ({row}, {column}) of the matrix is {value}, expected a finite number (m/N)")]
    MatrixEntry {
        /// Row.
        row: usize,
        /// Column.
        column: usize,
        /// The value found.
        value: f64,
    },
    /// A prepared response is asked about a vertex that it was not prepared for.
    #[error(
        "vertex {vertex} may touch, but the response was prepared for {prepared} other vertices ({missing} such \
         vertices): prepare it for these too, or mask them out"
    )]
    NotPrepared {
        /// First such vertex.
        vertex: usize,
        /// How many there are.
        missing: usize,
        /// Vertices that it was prepared for.
        prepared: usize,
    },
    /// A prepared response belongs to another mesh.
    #[error("the response was prepared for another surface: {what}: {found}, expected {expected}")]
    OtherSurface {
        /// What differs.
        what: &'static str,
        /// Found in the surface.
        found: usize,
        /// Expected by the response.
        expected: usize,
    },
    /// A prepared response belongs to the same mesh at another place or in another shape.
    #[error(
        "the response was prepared for other vertex positions: vertex {vertex} is {distance:.3e} m away (allowed \
         {allowed:.1e} m); after a rigid motion move the response too (`moved`), after a deformation prepare it anew"
    )]
    OtherShape {
        /// First such vertex.
        vertex: usize,
        /// How far it is away (m).
        distance: f64,
        /// How far it may be (m).
        allowed: f64,
    },
    /// There is not one force for each vertex.
    #[error("{found} forces for {expected} vertices: expected one for each")]
    ForceCount {
        /// Number found.
        found: usize,
        /// Number of vertices.
        expected: usize,
    },
    /// A part of a combined response does not fit the whole skin.
    #[error("part {part:?} does not fit the whole skin: {what}")]
    PartMismatch {
        /// Its name.
        part: String,
        /// What does not fit.
        what: String,
    },
    /// A combined response was given a kernel or a body that cannot be joined with others.
    #[error(
        "a combined skin takes linear pressure and gaps at the vertices (`discretization=\"collocation\"`) only, of its kernel and of its bodies"
    )]
    PartsNeedLinear,
    /// A patch of candidates lies on both sides of a cut.
    #[error(
        "a patch of {count} vertices straddles the cut of part {part:?} (vertex {inside} on it, vertex {outside} off \
         it), across which nothing is felt: leave that part out, or cut it farther from the contact"
    )]
    StraddlingPatch {
        /// Name of the part.
        part: String,
        /// A vertex of the patch that moves with the part.
        inside: usize,
        /// A vertex of the patch that does not.
        outside: usize,
        /// Vertices of the patch.
        count: usize,
    },
    /// A product cannot have the response.
    #[error("no such response of a product: {what}")]
    Product {
        /// Why not, and what to do.
        what: &'static str,
    },
    /// A product's given matrix is asked about a vertex that it does not know.
    #[error(
        "skin vertex {vertex} may touch the product beside its vertex {product_vertex}, which is none of the {known} nodes \
         of the product's matrix ({missing} such skin vertices): give the matrix for these too, or mask them out"
    )]
    ProductNotKnown {
        /// First such vertex of the skin.
        vertex: usize,
        /// Vertex of the product's mesh.
        product_vertex: usize,
        /// How many vertices of the skin there are.
        missing: usize,
        /// Nodes of the matrix.
        known: usize,
    },
    /// The body could not be solved.
    #[error(transparent)]
    Body(#[from] BodyError),
    /// The worker threads could not be started.
    #[error(transparent)]
    Threads(#[from] ThreadsError),
}

impl ResponseError {
    /// Whether the caller asked to stop.
    pub(crate) fn is_interruption(&self) -> bool {
        matches!(self, Self::Interrupted { .. } | Self::Body(BodyError::Interrupted { .. }))
    }
}
