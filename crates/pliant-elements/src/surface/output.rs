//! What is read from a state at the middle of elements.

use super::SurfaceBlock;
use super::point::{Frame, Vectors, membrane_strain};
use super::scalar::local;
use crate::materials::{Regime, Voigt};
use pliant_math::Vec3;

impl SurfaceBlock {
    fn middle(&self, e: usize, q: &[f64]) -> (Vectors<f64>, [f64; 3]) {
        let (rows, reference) = &self.element(e).0.middle;
        let q = local(&self.local(e, q));
        let sum = |s: usize| {
            q.iter().zip(&rows[s]).fold(Vec3::zero(0.0), |sum, (&q, &w)| sum.add_times(w, q))
        };
        (Vectors { a: [sum(0), sum(1)], h: [sum(2), sum(3), sum(4)] }, *reference)
    }

    /// Membrane strain (E11, E22, E12) in the local frame at the middle of element `e`.
    #[must_use]
    pub fn membrane_strain(&self, e: usize, q: &[f64]) -> Voigt<f64> {
        let [a, b, c] = membrane_strain(&self.middle(e, q).0.a);
        [a, b, 0.5 * c]
    }

    /// Change of curvature (k11, k22, k12) there [1/m].
    #[must_use]
    pub fn bending_strain(&self, e: usize, q: &[f64]) -> Voigt<f64> {
        if !self.kind.bends() {
            return [0.0; 3];
        }
        let (x, reference) = self.middle(e, q);
        let [a, b, c] = Frame::new(&x, reference).bending;
        [a, b, 0.5 * c]
    }

    /// Regime of the film there.
    #[must_use]
    pub fn regime(&self, e: usize, q: &[f64]) -> Regime {
        self.law.material.regime(membrane_strain(&self.middle(e, q).0.a))
    }

    /// Elastic energy of element `e` at a strain of one [J], as a measure of rounding.
    #[must_use]
    pub fn stiffness_scale(&self, e: usize) -> f64 {
        let (table, _, h) = self.element(e);
        let area: f64 = table.pressure.iter().map(|point| point.area).sum();
        self.linear.youngs_modulus * h * area
    }
}
