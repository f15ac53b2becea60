//! Coefficients of the generalized-alpha scheme.

use crate::error::Error;
use crate::problem::Weights;

/// Largest spectral radius that is stable on constrained (index-3) problems with a margin.
pub const LARGEST_CONSTRAINED_RADIUS: f64 = 0.98;

/// Coefficients of generalized-alpha (Chung & Hulbert 1993), optimal for a spectral radius at infinity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coefficients {
    /// Spectral radius at infinite frequency: 1 keeps all high frequencies, 0 annihilates them in one step.
    pub spectral_radius: f64,
    /// Weight of the old algorithmic acceleration.
    pub alpha_m: f64,
    /// Weight of the old true acceleration.
    pub alpha_f: f64,
    /// Newmark coefficient of positions.
    pub beta: f64,
    /// Newmark coefficient of velocities.
    pub gamma: f64,
}

impl Coefficients {
    /// Coefficients for a spectral radius in [0, 1].
    ///
    /// # Errors
    /// [`Error::SpectralRadius`] outside that interval; [`Error::UndampedConstraints`] above
    /// [`LARGEST_CONSTRAINED_RADIUS`] where there are constraints: the multipliers of an index-3 system then
    /// oscillate undamped and pump energy into the motion (Arnold & Bruls 2007).
    pub fn new(spectral_radius: f64, constrained: bool) -> Result<Self, Error> {
        let rho = spectral_radius;
        if !(0.0..=1.0).contains(&rho) {
            return Err(Error::SpectralRadius { spectral_radius });
        }
        if constrained && rho > LARGEST_CONSTRAINED_RADIUS {
            return Err(Error::UndampedConstraints { spectral_radius });
        }
        let alpha_m = (2.0 * rho - 1.0) / (rho + 1.0);
        let alpha_f = rho / (rho + 1.0);
        let gamma = 0.5 - alpha_m + alpha_f;
        let beta = 0.25 * (gamma + 0.5) * (gamma + 0.5);
        Ok(Self { spectral_radius, alpha_m, alpha_f, beta, gamma })
    }

    /// `Delta = alpha_m - alpha_f`: `a_alg` of a step is the acceleration at `t + Delta h`, to second order.
    #[must_use]
    pub fn shift(&self) -> f64 {
        self.alpha_m - self.alpha_f
    }

    /// Coefficient of `h^3 jerk` in the local error of positions, `1/6 - Delta/2 - beta`.
    ///
    /// Positions lie on the constraints, so the discrete velocities carry this error times `h^2` normal to them
    /// (Arnold, Bruls & Cardona 2015).
    #[must_use]
    pub fn error_constant(&self) -> f64 {
        1.0 / 6.0 - 0.5 * self.shift() - self.beta
    }

    /// `da/dq` inside one step of length `h` [1/s^2].
    #[must_use]
    pub fn acceleration_rate(&self, h: f64) -> f64 {
        (1.0 - self.alpha_m) / (h * h * self.beta * (1.0 - self.alpha_f))
    }

    /// `dv/dq` inside one step of length `h` [1/s].
    #[must_use]
    pub fn velocity_rate(&self, h: f64) -> f64 {
        self.gamma / (h * self.beta)
    }

    /// Weights of the iteration matrix with its dynamic rows and its multipliers scaled by `beta h^2`: its
    /// condition then does not depend on the step (Bottasso, Bauchau & Cardona 2007).
    #[must_use]
    pub fn weights(&self, h: f64) -> Weights {
        Weights {
            mass: (1.0 - self.alpha_m) / (1.0 - self.alpha_f),
            damping: self.gamma * h,
            stiffness: self.beta * h * h,
            jacobian: 1.0,
        }
    }
}
