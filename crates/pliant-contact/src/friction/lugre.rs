//! LuGre friction: `F = sigma_0 z + sigma_1 z' + sigma_2 v`, `z' = v - f(v) z`, `f = sigma_0 |v| / G(v)`,
//! `G = f_n (mu_d + (mu_s - mu_d) exp(-|v/v_s|^alpha))` (Canudas de Wit, Olsson, Astrom & Lischinsky 1995).
//!
//! For a velocity that does not change within the step the equation of z is solved exactly, `a = f h`, `E = exp(-a)`:
//! `z+ = E z + h phi_1(a) v`, `z'+ = E (v - f z)`, with `phi_1(a) = (1 - E)/a`. Nothing is divided by f, and no step is
//! too long. Where v = 0 the bristles do not relax: when the normal force drops they would keep more than the contact
//! can carry for ever, so `|z+| <= mu_s f_n / sigma_0` is enforced.

use super::{Response, Slip};
use nalgebra::{Matrix3, Vector3};

/// Coefficients of the law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LuGre {
    /// Coefficient of static friction `mu_s`.
    pub mu_s: f64,
    /// Coefficient of dynamic friction `mu_d`, at most `mu_s`.
    pub mu_d: f64,
    /// Stribeck velocity `v_s` [m/s].
    pub v_s: f64,
    /// Exponent alpha.
    pub alpha: f64,
    /// Bristle stiffness: per normal force [1/m] where `scaled`, else in the unit of the normal force by metres.
    pub sigma_0: f64,
    /// Bristle damping, likewise by metres a second.
    pub sigma_1: f64,
    /// Viscous friction, likewise.
    pub sigma_2: f64,
    /// Whether the sigmas are per normal force: the deflection does not depend on it then.
    pub scaled: bool,
    /// Velocity beyond which the bristles' damping fades as `exp(-(v/v_d)^2)` [m/s]: a first touch at speed would
    /// otherwise meet `sigma_1 v` at once. Infinite: it does not.
    pub v_d: f64,
}

/// `phi_1(a) = (1 - exp(-a))/a` and its derivative.
fn phi_1(a: f64) -> (f64, f64) {
    let value = if a < 1e-8 { 1.0 - 0.5 * a } else { -(-a).exp_m1() / a };
    let slope = if a < 1e-3 {
        -0.5 + a * (1.0 / 3.0 + a * (-1.0 / 8.0 + a / 30.0))
    } else {
        ((-a).exp() * (1.0 + a) - 1.0) / (a * a)
    };
    (value, slope)
}

impl LuGre {
    /// `mu(s) = mu_d + (mu_s - mu_d) exp(-(s/v_s)^alpha)` and its derivative.
    fn stribeck(&self, s: f64) -> (f64, f64) {
        let x = (s / self.v_s).powf(self.alpha);
        let part = (self.mu_s - self.mu_d) * (-x).exp();
        let slope = if s > 0.0 { -part * self.alpha * x / s } else { 0.0 };
        (self.mu_d + part, slope)
    }

    /// The answer to a slip.
    #[must_use]
    pub fn respond(&self, slip: &Slip) -> Response {
        let &Slip { z, mean: v, end, normal, h } = slip;
        if normal.is_nan() || normal <= 0.0 {
            // Bristles that carry nothing keep their place where they are free of the load.
            let kept =
                if self.scaled && normal == 0.0 { self.respond_to(z, v, end, h).0 } else { z };
            let z = if self.scaled { kept } else { Vector3::zeros() };
            return Response { z, ..Response::none() };
        }
        if self.scaled {
            let (z, force, by_mean) = self.respond_to(z, v, end, h);
            return Response {
                z,
                force: force * normal,
                by_mean: by_mean * normal,
                by_end: Matrix3::from_diagonal_element(self.sigma_2 * normal),
                by_normal: force,
            };
        }
        self.respond_loaded(z, v, end, normal, h)
    }

    /// Deflection, force per normal force and its derivative by the mean velocity, in the scaled form.
    fn respond_to(
        &self,
        z: Vector3<f64>,
        v: Vector3<f64>,
        end: Vector3<f64>,
        h: f64,
    ) -> (Vector3<f64>, Vector3<f64>, Matrix3<f64>) {
        let answer = self.respond_loaded(z, v, end, 1.0, h);
        (answer.z, answer.force, answer.by_mean)
    }

    fn respond_loaded(
        &self,
        z: Vector3<f64>,
        v: Vector3<f64>,
        end: Vector3<f64>,
        normal: f64,
        h: f64,
    ) -> Response {
        let (sigma_0, sigma_2) = (self.sigma_0, self.sigma_2);
        let s = v.norm();
        let (mu, mu_slope) = self.stribeck(s);
        let f = sigma_0 * s / (normal * mu);
        let f_s = sigma_0 / (normal * mu) * (1.0 - s * mu_slope / mu);
        let f_v = if s > 0.0 { v * (f_s / s) } else { Vector3::zeros() };
        let f_normal = -f / normal;
        let a = f * h;
        let e = (-a).exp();
        let (phi, phi_slope) = phi_1(a);
        let rest = v - z * f;
        let mut bent = z * e + v * (h * phi);
        let rate = rest * e;
        let bent_f = (v * (h * phi_slope) - z * e) * h;
        let rate_f = -(z + rest * h) * e;
        let mut bent_v = Matrix3::from_diagonal_element(h * phi) + bent_f * f_v.transpose();
        let rate_v = Matrix3::from_diagonal_element(e) + rate_f * f_v.transpose();
        let mut bent_normal = bent_f * f_normal;
        let limit = self.mu_s * normal / sigma_0;
        let size = bent.norm();
        if size > limit {
            let along = bent / size;
            let across = (Matrix3::identity() - along * along.transpose()) * (limit / size);
            bent = along * limit;
            bent_v = across * bent_v;
            bent_normal = across * bent_normal + along * (limit / normal);
        }
        let fading = (-(s / self.v_d).powi(2)).exp();
        let sigma_1 = self.sigma_1 * fading;
        let sigma_1_v = v * (-2.0 * sigma_1 / (self.v_d * self.v_d));
        Response {
            z: bent,
            force: bent * sigma_0 + rate * sigma_1 + end * sigma_2,
            by_mean: bent_v * sigma_0 + rate_v * sigma_1 + rate * sigma_1_v.transpose(),
            by_end: Matrix3::from_diagonal_element(sigma_2),
            by_normal: bent_normal * sigma_0 + rate_f * (sigma_1 * f_normal),
        }
    }
}

/// Friction force and deflection over a given history, (n, 3) each, from bristles at rest.
///
/// `time` [s], `velocity` (n, 3) [m/s] and `normal` [N] are those at n instants; the bristles move with the mean of the
/// velocities at the ends of each step, or with the one at its end where `end_rule`.
#[must_use]
pub fn history(
    law: &LuGre,
    time: &[f64],
    velocity: &[[f64; 3]],
    normal: &[f64],
    end_rule: bool,
) -> (Vec<[f64; 3]>, Vec<[f64; 3]>) {
    let (mut forces, mut bristles) = (Vec::new(), Vec::new());
    let mut z = Vector3::zeros();
    for (k, (v, &normal)) in velocity.iter().zip(normal).enumerate() {
        let end = Vector3::from(*v);
        let before = k.checked_sub(1);
        let h = before.map_or(0.0, |b| time[k] - time[b]);
        let mean = match before {
            Some(b) if !end_rule => (Vector3::from(velocity[b]) + end) * 0.5,
            _ => end,
        };
        let answer = law.respond(&Slip { z, mean, end, normal, h });
        z = answer.z;
        forces.push(answer.force.into());
        bristles.push(z.into());
    }
    (forces, bristles)
}
