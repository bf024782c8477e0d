//! Closed-form and tabulated answers to check against.
