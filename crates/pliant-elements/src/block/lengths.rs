//! Stress-free lengths that winches change: a factor and its rate for each cable of a block with the law `wound`.

use pliant_math::{Lanes, Real};
use pulp::Simd;

use super::scalar::vectors;
use super::{CableBlock, LANES};
use crate::element::Motion;
use crate::elements::cable::{Scale, length_forces};

/// Factors of the lengths of all elements, with room for the last lanes; empty where no law asks for them.
#[derive(Clone, Debug, Default)]
pub(crate) struct Lengths {
    factor: Vec<f64>,
    inverse: Vec<f64>,
    rate: Vec<f64>,
}

impl Lengths {
    /// Factors of one for so many elements.
    pub fn new(elements: usize) -> Self {
        let n = elements.next_multiple_of(LANES);
        Self { factor: vec![1.0; n], inverse: vec![1.0; n], rate: vec![0.0; n] }
    }

    #[inline(always)]
    pub fn lanes<S: Simd>(&self, simd: S, e: usize) -> Scale<Lanes<S>> {
        let load = |x: &[f64]| Lanes::load(simd, &x[e..]);
        Scale { length: load(&self.factor), inverse: load(&self.inverse), rate: load(&self.rate) }
    }
}

impl CableBlock {
    /// Sets the stress-free length of a cable to `factor` times that it was built with, above zero, and the rate of
    /// the factor [1/s]. The law of the block is `wound`; for another law this does nothing.
    pub fn set_length(&mut self, cable: usize, factor: f64, rate: f64) {
        if !self.law.wound {
            return;
        }
        for e in self.elements_of(cable) {
            let Some(slot) = self.lengths.factor.get_mut(e) else { return };
            *slot = factor;
            self.lengths.inverse[e] = 1.0 / factor;
            self.lengths.rate[e] = rate / factor;
        }
    }

    /// Forces on the factor of the length of a cable [J], elastic and of damping: times its rate they are the power of
    /// the winch.
    #[must_use]
    pub fn length_forces(&self, cable: usize, motion: Motion<'_>) -> [f64; 2] {
        let mut sum = [0.0; 2];
        for e in self.elements_of(cable) {
            let x = vectors(&self.local(e, motion.q));
            let rates = self.law.damped.then(|| vectors(&self.local(e, motion.v)));
            let axial = self.axial_column(e);
            let scale = self.scale(e, 1.0);
            let forces = length_forces(self.law, self.column(e), axial, &x, rates.as_ref(), scale);
            sum[0] += forces[0];
            sum[1] += forces[1];
        }
        sum
    }

    /// What winches spend on damping [W].
    pub(super) fn length_dissipation(&self, motion: Motion<'_>) -> f64 {
        if !self.law.wound {
            return 0.0;
        }
        let power = |cable: usize| {
            let e = self.elements_of(cable).start;
            let rate = self.lengths.rate[e] * self.lengths.factor[e];
            self.length_forces(cable, motion)[1] * rate
        };
        (0..self.cable_count()).map(power).sum()
    }

    /// Scale of one element, as numbers of the kind of `like`.
    pub(super) fn scale<T: Real>(&self, e: usize, like: T) -> Scale<T> {
        let number = |x: &[f64], none: f64| like.constant(x.get(e).copied().unwrap_or(none));
        Scale {
            length: number(&self.lengths.factor, 1.0),
            inverse: number(&self.lengths.inverse, 1.0),
            rate: number(&self.lengths.rate, 0.0),
        }
    }
}
