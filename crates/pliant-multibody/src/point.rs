//! Material points: positions and tangents as weighted sums of coordinates.

/// A point (or a tangent) `constant + sum_i w_i q[offset_i..offset_i + 3]`: its Jacobian is constant.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Interpolation {
    /// Offsets into the coordinates, and weights.
    pub terms: Vec<(usize, f64)>,
    /// What does not move [m].
    pub constant: [f64; 3],
}

impl Interpolation {
    /// A point fixed in the world.
    #[must_use]
    pub fn fixed(constant: [f64; 3]) -> Self {
        Self { terms: Vec::new(), constant }
    }

    /// Sum of the given terms without the vanishing ones.
    #[must_use]
    pub fn weighted(terms: impl IntoIterator<Item = (usize, f64)>) -> Self {
        let terms = terms.into_iter().filter(|&(_, w)| w != 0.0).collect();
        Self { terms, constant: [0.0; 3] }
    }

    /// The vector from `other` to here.
    #[must_use]
    pub fn minus(&self, other: &Self) -> Self {
        let minus = other.terms.iter().map(|&(o, w)| (o, -w));
        let mut value = Self::weighted(self.terms.iter().copied().chain(minus));
        for k in 0..3 {
            value.constant[k] = self.constant[k] - other.constant[k];
        }
        value
    }

    /// Its value at coordinates `q`.
    #[must_use]
    pub fn at(&self, q: &[f64]) -> [f64; 3] {
        let mut r = self.rate(q);
        for k in 0..3 {
            r[k] += self.constant[k];
        }
        r
    }

    /// Its value without the constant part: velocities from velocities.
    #[must_use]
    pub fn rate(&self, v: &[f64]) -> [f64; 3] {
        let mut r = [0.0; 3];
        for &(offset, w) in &self.terms {
            for k in 0..3 {
                r[k] += w * v[offset + k];
            }
        }
        r
    }

    /// Adds the generalized force of `f` acting here: `force += (dr/dq)^T f`.
    pub fn add_force(&self, f: [f64; 3], force: &mut [f64]) {
        for &(offset, w) in &self.terms {
            for k in 0..3 {
                force[offset + k] += w * f[k];
            }
        }
    }
}

/// The coordinates a joint or load acts on, whole groups of unknowns, and where they stand in its element matrix.
#[derive(Clone, Debug, Default)]
pub struct Support {
    /// Groups, in the order of the element matrix.
    pub groups: Vec<usize>,
    /// Coordinates of these groups, one after the other.
    pub unknowns: Vec<usize>,
}

impl Support {
    /// Local number of coordinate `offset`, which is one of `unknowns`.
    #[must_use]
    pub fn local(&self, offset: usize) -> usize {
        self.unknowns.iter().position(|&u| u == offset).unwrap_or(usize::MAX)
    }

    /// Local numbers in place of offsets.
    #[must_use]
    pub fn localize(&self, point: &Interpolation) -> Interpolation {
        Interpolation {
            terms: point.terms.iter().map(|&(offset, w)| (self.local(offset), w)).collect(),
            constant: point.constant,
        }
    }
}
