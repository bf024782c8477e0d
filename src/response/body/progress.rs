//! How far the solution of a body is.

use crate::response::body::cost::BodyCost;

/// How far [`Body::prepare`](crate::response::body::Body::prepare) is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BodyProgress {
    /// "assembly", "factorization" or "solution", in this order.
    pub stage: &'static str,
    /// Part of that stage that is done, 0 to 1.
    pub done: f64,
    /// What the whole work costs.
    pub cost: BodyCost,
}
