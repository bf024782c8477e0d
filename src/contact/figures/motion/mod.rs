//! How candidates, drawn skin and product move under the forces.

pub(crate) mod candidates;
pub(crate) mod displacement;
pub(crate) mod drawn;
pub(crate) mod fade;
pub(crate) mod product;
