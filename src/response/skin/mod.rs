//! What a contact asks of a skin, and who answers.
//!
//! [`elastic`] is the question. A [`kernel`] computes the answer; a [`prepared_kernel`], a [`prepared_body`], a
//! [`given_matrix`] and [`given_blocks`] look it up at their [`nodes`], a body in its [`levels`]; a [`combined`] skin asks its parts (`body_part`)
//! and puts their answers together (`combination`); a [`kept`] one remembers what another answered. What is given may be
//! a `misfit`.

mod body_part;
mod combination;
pub(crate) mod combined;
pub(crate) mod elastic;
pub(crate) mod given_blocks;
pub(crate) mod given_matrix;
pub(crate) mod kept;
pub(crate) mod kernel;
pub(crate) mod levels;
mod misfit;
pub(crate) mod nodes;
pub(crate) mod prepared_body;
pub(crate) mod prepared_kernel;
