//! Where the nodes of a beam stand.

use crate::document::Arrays;
use crate::error::ModelError;
use crate::point::Interpolation;
use crate::spec::BeamSpec;
use pliant_math::hermite;
use std::ops::Range;

/// Nodes of one beam: r, r,x r,y and r,z each.
#[derive(Clone, Debug)]
pub struct BeamMap {
    /// Name of the body.
    pub name: String,
    /// First coordinate.
    pub first: usize,
    /// Stress-free length of each element [m].
    pub lengths: Vec<f64>,
}

/// Coordinates of a node.
pub const NODE: usize = 12;

impl BeamMap {
    /// Lays out a beam whose coordinates begin at `first`.
    ///
    /// # Errors
    /// [`ModelError`] naming the array that does not fit.
    pub fn new(spec: &BeamSpec, arrays: Arrays<'_>, first: usize) -> Result<Self, ModelError> {
        let place = |what: &str| format!("beam '{}', {what}", spec.name);
        let lengths = arrays.get(&spec.lengths, &place("lengths"))?;
        if lengths.is_empty() || lengths.iter().any(|&l| l <= 0.0) {
            return Err(ModelError::Value {
                place: place("lengths"),
                value: 0.0,
                allowed: "at least one length, all above zero",
            });
        }
        let size = NODE * (lengths.len() + 1);
        arrays.sized(&spec.reference, &[size], &place("reference"))?;
        Ok(Self { name: spec.name.clone(), first, lengths: lengths.to_vec() })
    }

    /// Number of elements.
    #[must_use]
    pub fn elements(&self) -> usize {
        self.lengths.len()
    }

    /// Number of nodes.
    #[must_use]
    pub fn nodes(&self) -> usize {
        self.lengths.len() + 1
    }

    /// Its coordinates.
    #[must_use]
    pub fn range(&self) -> Range<usize> {
        self.first..self.first + NODE * self.nodes()
    }

    /// First coordinate of a nodal vector: 0 for r, 1 to 3 for its gradients.
    #[must_use]
    pub fn offset(&self, node: usize, vector: usize) -> usize {
        self.first + NODE * node + 3 * vector
    }

    /// Offsets of position and slope of the centre line at both nodes of element `e`, as of a cable.
    #[must_use]
    pub fn offsets(&self, e: usize) -> [usize; 4] {
        [(e, 0), (e, 1), (e + 1, 0), (e + 1, 1)].map(|(node, vector)| self.offset(node, vector))
    }

    /// Position of the centre line at `xi` of element `e`.
    #[must_use]
    pub fn position(&self, e: usize, xi: f64) -> Interpolation {
        let weights = hermite::shape(xi, self.lengths[e]);
        Interpolation::weighted(self.offsets(e).into_iter().zip(weights))
    }

    /// Tangent of the centre line there.
    #[must_use]
    pub fn tangent(&self, e: usize, xi: f64) -> Interpolation {
        let weights = hermite::shape_derivative(xi, self.lengths[e]);
        Interpolation::weighted(self.offsets(e).into_iter().zip(weights))
    }

    /// Gradients r,y and r,z there, which span the section.
    #[must_use]
    pub fn section(&self, e: usize, xi: f64) -> [Interpolation; 2] {
        [2, 3].map(|vector| {
            let ends = [(self.offset(e, vector), 1.0 - xi), (self.offset(e + 1, vector), xi)];
            Interpolation::weighted(ends)
        })
    }

    /// A point of the section there, off the centre line by y and z [m].
    #[must_use]
    pub fn point(&self, e: usize, xi: f64, offset: [f64; 2]) -> Interpolation {
        let mut r = self.position(e, xi);
        for (direction, distance) in self.section(e, xi).into_iter().zip(offset) {
            let terms = direction.terms.into_iter().map(|(o, w)| (o, w * distance));
            r.terms.extend(terms.filter(|&(_, w)| w != 0.0));
        }
        r
    }

    /// Integral of the centre line's position by stress-free length.
    #[must_use]
    pub fn line_weights(&self) -> Interpolation {
        let mut weights = vec![[0.0; 2]; self.nodes()];
        for (e, &l) in self.lengths.iter().enumerate() {
            weights[e][0] += 0.5 * l;
            weights[e][1] += l * l / 12.0;
            weights[e + 1][0] += 0.5 * l;
            weights[e + 1][1] -= l * l / 12.0;
        }
        let terms = weights.iter().enumerate();
        Interpolation::weighted(
            terms.flat_map(|(i, w)| [(self.offset(i, 0), w[0]), (self.offset(i, 1), w[1])]),
        )
    }

    /// Name of a coordinate for messages.
    #[must_use]
    pub fn describe(&self, coordinate: usize) -> String {
        let local = coordinate - self.first;
        let what = ["position", "slope along x", "slope along y", "slope along z"];
        let (node, vector, c) = (local / NODE, local % NODE / 3, ["x", "y", "z"][local % 3]);
        format!("beam '{}', node {node}, {} {c}", self.name, what[vector])
    }
}
