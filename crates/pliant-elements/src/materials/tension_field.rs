//! Tension field: the relaxed energy of a film too thin to carry compression.
//!
//! With principal strains E1 >= E2, `W = E h/2 (<E1>^2 + <E2 + nu E1>^2/(1 - nu^2))`, <x> = max(x, 0): taut, wrinkled
//! (uniaxial tension) and slack. It is the quasiconvex envelope of the Saint Venant-Kirchhoff law (Pipkin 1986), equal
//! to it where the film is taut, and its gradient is continuous. A small part of the elastic law is mixed in, so that
//! a slack film is not singular. Bending stays elastic.

use super::{Regime, SaintVenantKirchhoff, Stiffness, Voigt};
use pliant_math::Real;

/// A film that wrinkles instead of carrying compression.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TensionField {
    /// The law of the taut film.
    pub elastic: SaintVenantKirchhoff,
    /// Part of the elastic law that is kept where the film is not taut.
    pub residual_stiffness: f64,
}

/// Below this the square of the radius of Mohr's circle is nothing.
const TINY: f64 = 1e-60;

/// Principal strains and the double angle of the first direction.
struct Principal<T> {
    first: T,
    second: T,
    cosine: T,
    sine: T,
}

#[inline(always)]
fn principal<T: Real>(e: Voigt<T>) -> Principal<T> {
    let mean = (e[0] + e[1]).scale(0.5);
    let (x, y) = ((e[0] - e[1]).scale(0.5), e[2].scale(0.5));
    let radius = (x * x + y * y + mean.constant(TINY)).sqrt();
    Principal { first: mean + radius, second: mean - radius, cosine: x / radius, sine: y / radius }
}

impl TensionField {
    /// `<E1>` and `<E2 + nu E1>`.
    #[inline(always)]
    fn brackets<T: Real>(&self, p: &Principal<T>) -> (T, T) {
        let zero = p.first.zero();
        (p.first.max(zero), self.transverse(p).max(zero))
    }

    #[inline(always)]
    fn transverse<T: Real>(&self, p: &Principal<T>) -> T {
        p.first.scale(self.elastic.poisson_ratio) + p.second
    }

    pub(super) fn regime(&self, e: Voigt<f64>) -> Regime {
        let p = principal(e);
        if self.transverse(&p) > 0.0 {
            Regime::Taut
        } else if p.first > 0.0 {
            Regime::Wrinkled
        } else {
            Regime::Slack
        }
    }

    #[inline(always)]
    pub(super) fn energy<T: Real>(&self, h: f64, e: Voigt<T>, k: Voigt<T>) -> T {
        let SaintVenantKirchhoff { youngs_modulus, poisson_ratio: nu } = self.elastic;
        let (first, transverse) = self.brackets(&principal(e));
        let relaxed = first * first + (transverse * transverse).scale(1.0 / (1.0 - nu * nu));
        let zero = [e[0].zero(); 3];
        let rho = self.residual_stiffness;
        relaxed.scale(0.5 * youngs_modulus * h * (1.0 - rho))
            + self.elastic.energy(h, e, zero).scale(rho)
            + self.elastic.energy(h, zero, k)
    }

    #[inline(always)]
    pub(super) fn resultants<T: Real>(&self, h: f64, e: Voigt<T>, k: Voigt<T>) -> [Voigt<T>; 2] {
        let SaintVenantKirchhoff { youngs_modulus, poisson_ratio: nu } = self.elastic;
        let p = principal(e);
        let (first, transverse) = self.brackets(&p);
        let rho = self.residual_stiffness;
        let factor = youngs_modulus * h * (1.0 - rho);
        let second = transverse.scale(1.0 / (1.0 - nu * nu));
        let s1 = (first + second.scale(nu)).scale(factor);
        let s2 = second.scale(factor);
        let (mean, half) = ((s1 + s2).scale(0.5), (s1 - s2).scale(0.5));
        let [elastic, m] = self.elastic.resultants(h, e, k);
        let n = [
            mean + half * p.cosine + elastic[0].scale(rho),
            mean - half * p.cosine + elastic[1].scale(rho),
            half * p.sine + elastic[2].scale(rho),
        ];
        [n, m]
    }

    #[inline(always)]
    pub(super) fn stiffness(&self, h: f64, e: Voigt<f64>, k: Voigt<f64>) -> Stiffness {
        let SaintVenantKirchhoff { youngs_modulus, poisson_ratio: nu } = self.elastic;
        let p = principal(e);
        let (first, transverse) = self.brackets(&p);
        // An unstrained film counts as taut.
        let (pulled, taut) =
            (f64::from(p.first >= 0.0), f64::from(self.transverse(&p) >= 0.0) / (1.0 - nu * nu));
        let second = transverse / (1.0 - nu * nu);
        let d = [[pulled + nu * nu * taut, nu * taut], [nu * taut, taut]];
        let gap = p.first - p.second;
        let size = p.first.abs() + p.second.abs();
        // The limit of (s1 - s2)/(2 (E1 - E2)) where both strains are one.
        let turning = if gap > 1e-9 * size && gap > 1e-25 {
            (first + nu * second - second) / (2.0 * gap)
        } else {
            0.25 * (d[0][0] - 2.0 * d[0][1] + d[1][1])
        };
        let (c, s) = (p.cosine, p.sine);
        let n = [
            [0.5 * (1.0 + c), 0.5 * (1.0 - c), 0.5 * s],
            [0.5 * (1.0 - c), 0.5 * (1.0 + c), -0.5 * s],
        ];
        let q = [-s, s, c];
        let rho = self.residual_stiffness;
        let factor = youngs_modulus * h * (1.0 - rho);
        let mut out = self.elastic.stiffness(h, e, k);
        for i in 0..3 {
            for j in 0..3 {
                let mut sum = turning * q[i] * q[j];
                for a in 0..2 {
                    for b in 0..2 {
                        sum += d[a][b] * n[a][i] * n[b][j];
                    }
                }
                out[i][j] = rho * out[i][j] + factor * sum;
            }
        }
        out
    }
}
