//! Integrals that are computed once, when a block is built.

pub(crate) mod beam;
pub(crate) mod cable;
pub(crate) mod invariants;
pub(crate) mod surface;
