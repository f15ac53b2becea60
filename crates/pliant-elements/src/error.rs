//! What can be wrong with the data of an element.

/// Data that no element can be made of.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ElementError {
    /// A cable needs two nodes or more.
    #[error("cable {cable} has {nodes} node(s); it needs at least 2")]
    TooFewNodes {
        /// Number of the cable in the block.
        cable: usize,
        /// Its number of nodes.
        nodes: usize,
    },
    /// Neither one set of parameters for all elements nor one set for each.
    #[error(
        "cable {cable} has {found} sets of element parameters; it needs 1 (for all) or {elements} (one per element)"
    )]
    ParameterCount {
        /// Number of the cable in the block.
        cable: usize,
        /// Number of elements.
        elements: usize,
        /// Number of sets given.
        found: usize,
    },
    /// A number is outside its range.
    #[error("cable {cable}, element {element}: {name} is {value}; it must be {range}")]
    OutOfRange {
        /// Number of the cable in the block.
        cable: usize,
        /// Number of the element in the cable.
        element: usize,
        /// What the number is.
        name: &'static str,
        /// The number.
        value: f64,
        /// What is allowed.
        range: &'static str,
    },
    /// The law is for curved reference lines, but none is given.
    #[error(
        "cable {cable}, element {element}: the law has a planar reference line, but the element gives none"
    )]
    MissingReference {
        /// Number of the cable in the block.
        cable: usize,
        /// Number of the element in the cable.
        element: usize,
    },
    /// A reference line is given to a law for straight ones.
    #[error(
        "cable {cable}, element {element}: a reference line is given, but the law is for straight cables"
    )]
    UnusedReference {
        /// Number of the cable in the block.
        cable: usize,
        /// Number of the element in the cable.
        element: usize,
    },
    /// The reference line leaves the plane of its normal.
    #[error(
        "cable {cable}, element {element}: the reference line leaves its plane by {distance} (relative to its length)"
    )]
    NotPlanar {
        /// Number of the cable in the block.
        cable: usize,
        /// Number of the element in the cable.
        element: usize,
        /// Component along the normal over the length.
        distance: f64,
    },
    /// A law that cannot damp is given a retardation time, or one that damps a negative one.
    #[error(
        "cable {cable}, element {element}: retardation time {value} s given to a law without damping"
    )]
    UnusedDamping {
        /// Number of the cable in the block.
        cable: usize,
        /// Number of the element in the cable.
        element: usize,
        /// The retardation time [s].
        value: f64,
    },
    /// A number of a surface element is outside its range.
    #[error("face {face}: {name} is {value}; it must be {range}")]
    FaceOutOfRange {
        /// Number of the face.
        face: usize,
        /// What the number is.
        name: &'static str,
        /// The number.
        value: f64,
        /// What is allowed.
        range: &'static str,
    },
    /// A number of a law is outside its range.
    #[error("{name} is {value}; it must be {range}")]
    LawOutOfRange {
        /// What the number is.
        name: &'static str,
        /// The number.
        value: f64,
        /// What is allowed.
        range: &'static str,
    },
    /// A number of a beam element is outside its range.
    #[error("beam element {element}: {name} is {value}; it must be {range}")]
    BeamOutOfRange {
        /// Number of the element.
        element: usize,
        /// What the number is.
        name: &'static str,
        /// The number.
        value: f64,
        /// What is allowed.
        range: &'static str,
    },
    /// Integrals that are not computed in advance.
    #[error(
        "{kind} elements have precomputed integrals of the Saint Venant-Kirchhoff law only, bicubic ones and triangles \
         none"
    )]
    NotPrecomputed {
        /// Name of the kind.
        kind: &'static str,
    },
    /// Simplified bending of rubber, or with damping.
    #[error("simplified bending of {kind} elements is for small strains without damping")]
    NotSimplified {
        /// Name of the kind.
        kind: &'static str,
    },
    /// Simplified bending of an element that is curved at rest.
    #[error("face {face} is curved at rest; simplified bending is for flat surfaces")]
    Curved {
        /// Number of the face.
        face: usize,
    },
    /// A surface element without area.
    #[error("face {face} has no area: its corners or slopes coincide")]
    Degenerate {
        /// Number of the face.
        face: usize,
    },
}
