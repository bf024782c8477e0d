//! Matrices whose gaps are averages against the pressures of the nodes: near triangles in pairs, far loads by the moments of
//! both, the rest by quadrature over the outer triangles.

pub(crate) mod block;
pub(crate) mod face_pair;
pub(crate) mod hat_pairs;
pub(crate) mod near_faces;
pub(crate) mod node_load;
pub(crate) mod outer_rule;
