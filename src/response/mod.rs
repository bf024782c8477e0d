//! Displacement of the skin per unit contact force.
