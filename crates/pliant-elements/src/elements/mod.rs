//! The registry of element kinds.

pub(crate) mod beam;
mod bicubic;
pub mod cable;
mod cylindrical;
mod membrane;
mod plate;
pub mod surface;
mod triangle;

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
pub const KINDS: &[Kind] = &[
    Kind {
        name: "cable",
        coordinates: 12,
        summary: "Gradient-deficient ANCF cable: stretching and bending, no torsion",
    },
    Kind {
        name: "beam",
        coordinates: 24,
        summary: "Fully parameterised ANCF beam: stretches, shears, bends and twists, sections deform",
    },
    Kind {
        name: "bicubic",
        coordinates: 48,
        summary: "Gradient-deficient ANCF shell on structured meshes, tangent plane continuous",
    },
    Kind {
        name: "cylindrical",
        coordinates: 24,
        summary: "Gradient-deficient ANCF shell for strips and tubes that bend along u",
    },
    Kind {
        name: "plate",
        coordinates: 36,
        summary: "Gradient-deficient ANCF shell on rectangles, no twist at nodes",
    },
    Kind {
        name: "triangle",
        coordinates: 27,
        summary: "Gradient-deficient ANCF shell on triangles, tangent plane continuous",
    },
    Kind { name: "quad_membrane", coordinates: 12, summary: "Bilinear membrane, no bending" },
    Kind { name: "triangle_membrane", coordinates: 9, summary: "Linear membrane, no bending" },
];
