//! Neo-Hookean law, `W = mu/2 (I1 - 3) - mu ln J + lambda/4 (J^2 - 1) - lambda/2 ln J`, per reference volume.
//!
//! Plane stress is linear in C33: with D = det of the surface's metric, `C33 = (2 mu + lambda)/(2 mu + lambda D)`, no
//! local iteration. `S = mu (I - C33 C^-1)`, `dS/dE = 2 mu C33 (beta C^-1 x C^-1 + C^-1 (.) C^-1)`, `beta = lambda
//! D/(2 mu + lambda D)`. Incompressible: C33 = 1/D, beta = 1. Across the thickness three Gauss points see
//! `C(z) = I + 2 (E + z k)`.

use super::{SaintVenantKirchhoff, Stiffness, Voigt};
use pliant_math::Real;
use pliant_math::quadrature::GAUSS_3;

/// Rubber.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NeoHookean {
    /// Shear modulus mu [Pa].
    pub shear_modulus: f64,
    /// Lame's lambda [Pa]; none: incompressible.
    pub lambda_: Option<f64>,
    /// Whether the law is integrated across the thickness; membranes take the middle alone.
    pub bends: bool,
}

/// What the law is made of at one height.
struct Metric<T> {
    c: Voigt<T>,
    inverse: Voigt<T>,
    determinant: T,
    c33: T,
    beta: T,
}

impl NeoHookean {
    /// From Young's modulus and Poisson's ratio; 0.5 is incompressible.
    #[must_use]
    pub fn new(youngs_modulus: f64, poisson_ratio: f64, bends: bool) -> Self {
        let shear_modulus = youngs_modulus / (2.0 * (1.0 + poisson_ratio));
        let lambda_ = (poisson_ratio < 0.5)
            .then(|| 2.0 * shear_modulus * poisson_ratio / (1.0 - 2.0 * poisson_ratio));
        Self { shear_modulus, lambda_, bends }
    }

    pub(super) fn linear(&self) -> SaintVenantKirchhoff {
        let poisson_ratio =
            self.lambda_.map_or(0.5, |lambda_| 0.5 * lambda_ / (lambda_ + self.shear_modulus));
        let youngs_modulus = 2.0 * self.shear_modulus * (1.0 + poisson_ratio);
        SaintVenantKirchhoff { youngs_modulus, poisson_ratio }
    }

    /// Metric at height z. Where it is not positive the law has no value: what comes of it is not a number.
    #[inline(always)]
    fn metric<T: Real>(&self, e: Voigt<T>, k: Voigt<T>, z: f64) -> Metric<T> {
        let one = e[0].constant(1.0);
        let at = |a: T, b: T| b.scale(z) + a;
        let c = [one + at(e[0], k[0]).scale(2.0), one + at(e[1], k[1]).scale(2.0), at(e[2], k[2])];
        let determinant = c[0] * c[1] - c[2] * c[2];
        let determinant = determinant.select_positive(determinant, one.constant(f64::NAN));
        let r = one / determinant;
        let (c33, beta) = match self.lambda_ {
            None => (r, one),
            Some(lambda_) => {
                let stiff = determinant.scale(lambda_);
                let sum = stiff + one.constant(2.0 * self.shear_modulus);
                (one.constant(2.0 * self.shear_modulus + lambda_) / sum, stiff / sum)
            }
        };
        Metric { c, inverse: [c[1] * r, c[0] * r, -(c[2] * r)], determinant, c33, beta }
    }

    /// Heights and weights across the thickness.
    #[inline(always)]
    fn heights(&self, h: f64) -> ([(f64, f64); 3], usize) {
        if !self.bends {
            return ([(0.0, h); 3], 1);
        }
        (std::array::from_fn(|i| (h * (GAUSS_3.xi[i] - 0.5), h * GAUSS_3.weight[i])), 3)
    }

    #[inline(always)]
    pub(super) fn energy<T: Real>(&self, h: f64, e: Voigt<T>, k: Voigt<T>) -> T {
        let mu = self.shear_modulus;
        let (heights, count) = self.heights(h);
        let mut sum = e[0].zero();
        for &(z, w) in &heights[..count] {
            let m = self.metric(e, k, z);
            let trace = m.c[0] + m.c[1] + m.c33 - e[0].constant(3.0);
            let mut density = trace.scale(0.5 * mu);
            if let Some(lambda_) = self.lambda_ {
                let j2 = m.c33 * m.determinant;
                let one = j2.constant(1.0);
                density = density + (j2 - one).scale(0.25 * lambda_);
                density = density - j2.ln().scale(0.5 * mu + 0.25 * lambda_);
            }
            sum = sum + density.scale(w);
        }
        sum
    }

    #[inline(always)]
    pub(super) fn resultants<T: Real>(&self, h: f64, e: Voigt<T>, k: Voigt<T>) -> [Voigt<T>; 2] {
        let mu = self.shear_modulus;
        let (heights, count) = self.heights(h);
        let zero = e[0].zero();
        let (mut n, mut moment) = ([zero; 3], [zero; 3]);
        for &(z, w) in &heights[..count] {
            let m = self.metric(e, k, z);
            let one = zero.constant(1.0);
            let s = [
                (one - m.c33 * m.inverse[0]).scale(mu),
                (one - m.c33 * m.inverse[1]).scale(mu),
                -(m.c33 * m.inverse[2]).scale(mu),
            ];
            for i in 0..3 {
                n[i] = n[i] + s[i].scale(w);
                moment[i] = moment[i] + s[i].scale(w * z);
            }
        }
        [n, moment]
    }

    #[inline(always)]
    pub(super) fn stiffness(&self, h: f64, e: Voigt<f64>, k: Voigt<f64>) -> Stiffness {
        let (heights, count) = self.heights(h);
        let mut out = [[0.0; 6]; 6];
        for &(z, w) in &heights[..count] {
            let m = self.metric(e, k, z);
            let [a, b, c] = m.inverse;
            let f = 2.0 * self.shear_modulus * m.c33 * w;
            // (C^-1 (.) C^-1) in Voigt order, the shear strain counted twice.
            let circle = [
                [a * a, c * c, a * c],
                [c * c, b * b, b * c],
                [a * c, b * c, 0.5 * (a * b + c * c)],
            ];
            for i in 0..3 {
                for j in 0..3 {
                    let t = f * (m.beta * m.inverse[i] * m.inverse[j] + circle[i][j]);
                    out[i][j] += t;
                    out[i][3 + j] += z * t;
                    out[3 + i][j] += z * t;
                    out[3 + i][3 + j] += z * z * t;
                }
            }
        }
        out
    }
}
