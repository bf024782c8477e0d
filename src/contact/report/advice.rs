//! What to try where a contact did not end solved.

use crate::lcp::{LcpSolution, LcpStatus};

/// What happened in the complementarity problem that ended so, and what to try; empty if none did.
pub(crate) fn advice(ended: LcpStatus, solutions: &[LcpSolution]) -> String {
    let Some(solution) = solutions.iter().find(|solution| solution.status == ended) else {
        return String::new();
    };
    let remedy = match ended {
        LcpStatus::Solved | LcpStatus::Interrupted => return solution.ending(),
        LcpStatus::Ray => {
            "the response is not well posed on a patch this wide: take a well-posed response (half-space, layer, body; a \
             body with a shorter `coarse_edge_length`), a smaller depth or a coarser mesh, or `method=\"auto\"`"
        }
        LcpStatus::PivotLimit => "take `method=\"auto\"`, or a smaller depth",
        LcpStatus::Breakdown => {
            "merge vertices that lie on one another, take `pressure=\"linear\"` in place of one-ring, or `method=\"auto\"`"
        }
    };
    format!("{}: {remedy}", solution.ending())
}
