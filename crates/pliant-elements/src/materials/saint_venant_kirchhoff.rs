//! Saint Venant-Kirchhoff: `N = h C e`, `M = h^3/12 C k`, `C = E/(1 - nu^2) [[1, nu, 0], [nu, 1, 0], [0, 0, (1 -
//! nu)/2]]`. Softens in compression and collapses at a stretch of 1/sqrt(3): for small strains.

use super::{Stiffness, Voigt};
use pliant_math::Real;

/// Stress linear in the Green-Lagrange strain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SaintVenantKirchhoff {
    /// E [Pa].
    pub youngs_modulus: f64,
    /// nu.
    pub poisson_ratio: f64,
}

impl SaintVenantKirchhoff {
    /// `C s`.
    #[inline(always)]
    pub fn stress<T: Real>(&self, s: Voigt<T>) -> Voigt<T> {
        let nu = self.poisson_ratio;
        let c = self.youngs_modulus / (1.0 - nu * nu);
        [
            (s[0] + s[1].scale(nu)).scale(c),
            (s[1] + s[0].scale(nu)).scale(c),
            s[2].scale(0.5 * (1.0 - nu) * c),
        ]
    }

    /// C.
    #[must_use]
    pub fn matrix(&self) -> [[f64; 3]; 3] {
        let nu = self.poisson_ratio;
        let c = self.youngs_modulus / (1.0 - nu * nu);
        [[c, nu * c, 0.0], [nu * c, c, 0.0], [0.0, 0.0, 0.5 * (1.0 - nu) * c]]
    }

    #[inline(always)]
    pub(super) fn energy<T: Real>(&self, h: f64, e: Voigt<T>, k: Voigt<T>) -> T {
        let [n, m] = self.resultants(h, e, k);
        let product = |a: Voigt<T>, b: Voigt<T>| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        (product(n, e) + product(m, k)).scale(0.5)
    }

    #[inline(always)]
    pub(super) fn resultants<T: Real>(&self, h: f64, e: Voigt<T>, k: Voigt<T>) -> [Voigt<T>; 2] {
        let (n, m) = (self.stress(e), self.stress(k));
        let i = h * h * h / 12.0;
        [
            [n[0].scale(h), n[1].scale(h), n[2].scale(h)],
            [m[0].scale(i), m[1].scale(i), m[2].scale(i)],
        ]
    }

    #[inline(always)]
    pub(super) fn stiffness(&self, h: f64, _e: Voigt<f64>, _k: Voigt<f64>) -> Stiffness {
        let c = self.matrix();
        let i = h * h * h / 12.0;
        let mut out = [[0.0; 6]; 6];
        for a in 0..3 {
            for b in 0..3 {
                out[a][b] = h * c[a][b];
                out[3 + a][3 + b] = i * c[a][b];
            }
        }
        out
    }
}
