//! The registry of element kinds.

pub mod cable;

/// One kind of element.
#[derive(Clone, Copy, Debug)]
pub struct Kind {
    /// Name, as in model files.
    pub name: &'static str,
    /// Coordinates of one element.
    pub coordinates: usize,
    /// What it is for.
    pub summary: &'static str,
}

/// Every kind of element. The laws of `tests/laws.rs` run on each; a kind missing there fails the tests.
pub const KINDS: &[Kind] = &[Kind {
    name: "cable",
    coordinates: 12,
    summary: "Gradient-deficient ANCF cable: stretching and bending, no torsion",
}];
