//! Why a mesh was rejected.

/// Why a mesh was rejected: the first element at fault, its value and how many there are (`count`).
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MeshError {
    /// There is nothing to work on.
    #[error("the mesh is empty: {vertex_count} vertices and {face_count} faces; at least one face is needed")]
    Empty {
        /// Number of vertices.
        vertex_count: usize,
        /// Number of faces.
        face_count: usize,
    },
    /// A coordinate is NaN or infinite.
    #[error(
        "vertex {vertex} has the coordinate {axis} = {value} ({count} vertices have one that is not finite); \
         remove the vertices and their faces, or read the file again"
    )]
    NonFinite {
        /// First vertex at fault.
        vertex: usize,
        /// Its first coordinate at fault: 'x', 'y' or 'z'.
        axis: char,
        /// The value found there.
        value: f64,
        /// Number of vertices at fault.
        count: usize,
    },
    /// A coordinate is too large to compute with.
    #[error(
        "vertex {vertex} has the coordinate {axis} = {value:?} m ({count} vertices have one beyond 1e60 m, of which \
         areas and volumes overflow); check the unit, or remove the vertices and their faces"
    )]
    OutOfRange {
        /// First vertex at fault.
        vertex: usize,
        /// Its first coordinate at fault: 'x', 'y' or 'z'.
        axis: char,
        /// The value found there (m).
        value: f64,
        /// Number of vertices at fault.
        count: usize,
    },
    /// A face names a vertex that does not exist.
    #[error(
        "face {face} refers to vertex {vertex}, but the mesh has {vertex_count} vertices ({count} such faces); \
         remove the faces, or read the file again (indices count from 0)"
    )]
    VertexOutOfRange {
        /// First face at fault.
        face: usize,
        /// The vertex it names.
        vertex: usize,
        /// Number of vertices in the mesh.
        vertex_count: usize,
        /// Number of faces at fault.
        count: usize,
    },
    /// A face names the same vertex twice.
    #[error("face {face} names vertex {vertex} twice ({count} such faces); `repair` drops them")]
    RepeatedVertex {
        /// First face at fault.
        face: usize,
        /// The vertex that it repeats.
        vertex: usize,
        /// Number of faces at fault.
        count: usize,
    },
    /// A face has no area to speak of: its corners lie on a line.
    #[error(
        "face {face} is degenerate: height {height:.3e} m over its longest edge of {longest_edge:.3e} m \
         (below 1e-12 of it; {count} such faces); `repair` drops them"
    )]
    DegenerateFace {
        /// First face at fault.
        face: usize,
        /// Height over the longest edge (m).
        height: f64,
        /// Longest edge (m).
        longest_edge: f64,
        /// Number of faces at fault.
        count: usize,
    },
    /// A face has the same three vertices as an earlier one, in whatever order.
    #[error(
        "face {face} has the same three vertices as face {earlier} ({count} surplus faces); `repair` drops them"
    )]
    DuplicateFace {
        /// First face at fault.
        face: usize,
        /// The earlier face with the same vertices.
        earlier: usize,
        /// Number of surplus faces.
        count: usize,
    },
    /// An edge belongs to more than two faces.
    #[error(
        "the edge between vertices {} and {} belongs to {faces} faces, at most 2 can be ({count} such edges); \
         separate the sheets or bodies that meet there, or join them to one (boolean union)",
        vertices[0], vertices[1]
    )]
    NonManifoldEdge {
        /// Ends of the first edge at fault.
        vertices: [usize; 2],
        /// Number of faces on it.
        faces: usize,
        /// Number of edges at fault.
        count: usize,
    },
    /// Neighbouring faces are wound in opposite ways.
    #[error(
        "faces {} and {} run along the edge between vertices {} and {} in the same direction, so one of them is \
         inside out ({count} such edges); `repair` mends it by flipping {flips} faces",
        faces[0], faces[1], vertices[0], vertices[1]
    )]
    InconsistentOrientation {
        /// Ends of the first edge at fault.
        vertices: [usize; 2],
        /// The two faces on it.
        faces: [usize; 2],
        /// Number of edges at fault.
        count: usize,
        /// Least number of faces to flip so that all agree.
        flips: usize,
    },
    /// The surface has one side only, as a Moebius strip.
    #[error(
        "the mesh cannot be oriented (it is one-sided, as a Moebius strip): going round from face {} to its \
         neighbour {} turns it over at the edge between vertices {} and {}, and no flip mends that ({count} such \
         edges after the best flips); cut the surface open",
        faces[0], faces[1], vertices[0], vertices[1]
    )]
    NotOrientable {
        /// Ends of the first edge at which the turn shows.
        vertices: [usize; 2],
        /// The two faces on it.
        faces: [usize; 2],
        /// Number of edges at which it shows.
        count: usize,
    },
    /// A border runs along another one without being joined to it.
    #[error(
        "vertex {vertex} on a border lies {distance:.3e} m from vertex {other} on a border, but they are not \
         joined ({count} such vertices): the mesh is not welded; call `repair` with `weld_tolerance={weld_tolerance:e}` m"
    )]
    Unwelded {
        /// First border vertex at fault.
        vertex: usize,
        /// The border vertex nearest to it that is not its neighbour.
        other: usize,
        /// Their distance (m), at most 1e-3 of the mean edge length.
        distance: f64,
        /// Number of border vertices with such a twin.
        count: usize,
        /// The tolerance to weld with (m).
        weld_tolerance: f64,
    },
    /// The end of an edge lies in the middle of a border edge.
    #[error(
        "vertex {vertex} on a border lies {distance:.3e} m from the middle of the border edge between vertices {} \
         and {} ({count} such vertices): the mesh is not joined there; split that edge at the vertex",
        edge[0], edge[1]
    )]
    UnjoinedBorder {
        /// First border vertex at fault.
        vertex: usize,
        /// Ends of the border edge that passes it.
        edge: [usize; 2],
        /// Distance from the edge (m).
        distance: f64,
        /// Number of border vertices at fault.
        count: usize,
    },
    /// The faces around a vertex do not form one fan.
    #[error(
        "vertex {vertex} is pinched: the faces around it form {fans} separate fans ({count} such vertices); \
         give each fan a vertex of its own"
    )]
    PinchedVertex {
        /// First vertex at fault.
        vertex: usize,
        /// Number of fans around it.
        fans: usize,
        /// Number of vertices at fault.
        count: usize,
    },
    /// A vertex belongs to no face.
    #[error("vertex {vertex} belongs to no face ({count} such vertices); `repair` drops them")]
    UnusedVertex {
        /// First vertex at fault.
        vertex: usize,
        /// Number of vertices at fault.
        count: usize,
    },
    /// A face has no neighbour.
    #[error(
        "face {face} shares no edge with any other ({count} of {face_count} faces are loose triangles); join them \
         (`repair` with a `weld_tolerance` if their corners are meant to be the same) or remove them"
    )]
    LooseFace {
        /// First face at fault.
        face: usize,
        /// Number of loose faces.
        count: usize,
        /// Number of faces in the mesh.
        face_count: usize,
    },
    /// A closed component encloses nothing.
    #[error(
        "closed component {component} (from face {face} on) is flat: it encloses {volume:.3e} m³, which is rounding next \
         to its length of {length:.3e} m ({count} of {component_count} components); give it a thickness, or remove it"
    )]
    Flat {
        /// First component at fault, numbered from 0 in the order of their first faces.
        component: usize,
        /// Its first face.
        face: usize,
        /// Volume by the divergence theorem (m³).
        volume: f64,
        /// Diagonal of its bounding box (m).
        length: f64,
        /// Number of components at fault.
        count: usize,
        /// Number of components in the mesh.
        component_count: usize,
    },
    /// A closed component is inside out.
    #[error(
        "closed component {component} (from face {face} on) is inside out: it encloses {volume:.3e} m³ where the \
         sign should be {expected} ({count} of {component_count} components); `repair` turns its faces"
    )]
    InsideOut {
        /// First component at fault, numbered from 0 in the order of their first faces.
        component: usize,
        /// Its first face.
        face: usize,
        /// Volume by the divergence theorem (m³).
        volume: f64,
        /// The sign that it should have: '+', or '-' for a cavity.
        expected: char,
        /// Number of components at fault.
        count: usize,
        /// Number of components in the mesh.
        component_count: usize,
    },
    /// A closed component lies in another one that is turned the same way.
    #[error(
        "closed component {component} (from face {face} on, {volume:.3e} m³) lies inside component {outer} and is \
         turned outward as well ({count} such components); remove it, or call `repair` if it is a cavity"
    )]
    NestedShell {
        /// First component at fault, numbered from 0 in the order of their first faces.
        component: usize,
        /// Its first face.
        face: usize,
        /// Volume by the divergence theorem (m³).
        volume: f64,
        /// The component around it.
        outer: usize,
        /// Number of components at fault.
        count: usize,
    },
    /// A closed component lies on another one: the same surface twice.
    #[error(
        "closed component {component} (from face {face} on) lies on component {other} (from face {other_face} on), \
         at most {distance:.3e} m away: the same surface twice ({count} such components); remove one, or `repair`"
    )]
    CoincidentShell {
        /// First component at fault, numbered from 0 in the order of their first faces.
        component: usize,
        /// Its first face.
        face: usize,
        /// The earlier component that it lies on.
        other: usize,
        /// First face of the other.
        other_face: usize,
        /// Largest distance found between the two (m).
        distance: f64,
        /// Number of components at fault.
        count: usize,
    },
    /// `repair` was asked to weld with a tolerance that is no length.
    #[error("weld_tolerance is {value} m, expected a finite length >= 0")]
    WeldTolerance {
        /// The value given (m).
        value: f64,
    },
    /// `repair` would leave no face.
    #[error(
        "repair leaves no face: of {face_count} faces {collapsed} collapsed in welding, {degenerate} have no area \
         and {duplicates} cover one another; `weld_tolerance={weld_tolerance:e}` m may be larger than the mesh"
    )]
    NothingLeft {
        /// Number of faces given.
        face_count: usize,
        /// Faces of which corners were welded together.
        collapsed: usize,
        /// Faces without area.
        degenerate: usize,
        /// Faces dropped because another has the same vertices.
        duplicates: usize,
        /// The tolerance used (m).
        weld_tolerance: f64,
    },
}
