//! What a contact asks of a skin: a kernel computes it, a prepared skin looks it up, a combined one asks its parts.

pub(crate) mod combined;
pub(crate) mod elastic;
pub(crate) mod prepared;
