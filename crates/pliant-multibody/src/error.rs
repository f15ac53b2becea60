//! What can be wrong with a model document.

use pliant_elements::ElementError;

/// A model document that cannot be turned into a system.
#[derive(Debug, thiserror::Error)]
pub enum ModelError {
    /// Not a document of this kind.
    #[error("the model document cannot be read: {0}")]
    Document(#[from] serde_json::Error),
    /// Written by another version.
    #[error("the model document has version {found}; this build reads version {expected}")]
    Version {
        /// Version of the document.
        found: u32,
        /// Version that is read.
        expected: u32,
    },
    /// A reference to an array that did not travel along.
    #[error("{place}: array {index} is missing ({count} arrays were given)")]
    MissingArray {
        /// Where the array is asked for.
        place: String,
        /// Its number.
        index: usize,
        /// How many there are.
        count: usize,
    },
    /// An array of the wrong length.
    #[error("{place}: expected {expected} numbers, got {got}")]
    Length {
        /// Where.
        place: String,
        /// What is allowed.
        expected: String,
        /// What was given.
        got: usize,
    },
    /// A number out of range.
    #[error("{place}: {value} is not allowed ({allowed})")]
    Value {
        /// Where.
        place: String,
        /// The number.
        value: f64,
        /// What is allowed.
        allowed: &'static str,
    },
    /// Points that are too far apart to be joined.
    #[error(
        "{place}: its points are {gap:.6e} m apart where it engages, allowed are {allowed:.3e} m; bring them closer, \
         allow more by gap=, or give a body in the place of one of them: it lends the point found there"
    )]
    Apart {
        /// The joint.
        place: String,
        /// Distance between its points [m].
        gap: f64,
        /// What is allowed [m].
        allowed: f64,
    },
    /// A reference to something that does not exist.
    #[error("{place}: there is no {kind} number {index} (there are {count})")]
    Reference {
        /// Where.
        place: String,
        /// Of which kind.
        kind: &'static str,
        /// Its number.
        index: usize,
        /// How many there are.
        count: usize,
    },
    /// A joint or load that its point cannot carry.
    #[error("{place}: {reason}")]
    Unsupported {
        /// Where.
        place: String,
        /// Why.
        reason: &'static str,
    },
    /// The bytes of a saved run cannot be used.
    #[error("the saved run cannot be read: {reason}")]
    Saved {
        /// Why.
        reason: String,
    },
    /// An element refused its parameters.
    #[error("cable '{cable}': {source}")]
    Element {
        /// Name of the cable.
        cable: String,
        /// Why.
        source: ElementError,
    },
    /// A beam element refused its parameters.
    #[error("beam '{beam}': {source}")]
    Beam {
        /// Name of the beam.
        beam: String,
        /// Why.
        source: ElementError,
    },
    /// A surface element refused its parameters.
    #[error("surface '{surface}': {source}")]
    Surface {
        /// Name of the surface.
        surface: String,
        /// Why.
        source: ElementError,
    },
}
