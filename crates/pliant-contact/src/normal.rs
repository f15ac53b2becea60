//! The normal force per length of a line contact, or at a point.
//!
//! `p = k delta^2/(2 d_0)` for a penetration `delta < d_0`, `k (delta - d_0/2)` beyond: the stiffness grows from zero, so
//! the force has a continuous slope where contact begins and ends. Damping after Hunt & Crossley 1975:
//! `p (1 + c delta')`, never pulling.

/// Coefficients of the normal force.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Normal {
    /// Stiffness k [N/m^2], force per penetration and length.
    pub k: f64,
    /// Penetration at which the full stiffness is reached [m].
    pub d_0: f64,
    /// Damping c [s/m].
    pub c: f64,
}

/// A force and its derivatives by the penetration and its rate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pressure {
    /// Force per length [N/m].
    pub p: f64,
    /// Derivative by the penetration.
    pub by_depth: f64,
    /// Derivative by the rate of the penetration.
    pub by_rate: f64,
}

impl Normal {
    /// Elastic force per length and its slope.
    #[must_use]
    pub fn elastic(&self, depth: f64) -> (f64, f64) {
        let Self { k, d_0, .. } = *self;
        if depth <= 0.0 {
            (0.0, 0.0)
        } else if depth < d_0 {
            (0.5 * k * depth * depth / d_0, k * depth / d_0)
        } else {
            (k * (depth - 0.5 * d_0), k)
        }
    }

    /// Stored energy per length [J/m].
    #[must_use]
    pub fn energy(&self, depth: f64) -> f64 {
        let Self { k, d_0, .. } = *self;
        if depth <= 0.0 {
            0.0
        } else if depth < d_0 {
            k * depth.powi(3) / (6.0 * d_0)
        } else {
            k * (0.5 * depth * (depth - d_0) + d_0 * d_0 / 6.0)
        }
    }

    /// The force at a penetration that grows at a rate.
    #[must_use]
    pub fn pressure(&self, depth: f64, rate: f64) -> Pressure {
        let (p, slope) = self.elastic(depth);
        let factor = 1.0 + self.c * rate;
        if factor > 0.0 {
            Pressure { p: p * factor, by_depth: slope * factor, by_rate: p * self.c }
        } else {
            Pressure { p: 0.0, by_depth: 0.0, by_rate: 0.0 }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn force_is_the_slope_of_energy_and_continuous() {
        let law = Normal { k: 1e6, d_0: 1e-5, c: 2.0 };
        for depth in [1e-6, 5e-6, 9.99e-6, 1.001e-5, 3e-5, 1e-3] {
            let e = 1e-9;
            let slope = (law.energy(depth + e) - law.energy(depth - e)) / (2.0 * e);
            // Central differences of a quadratic are exact but for rounding and the ramp's third order, 1e-18.
            assert!((slope / law.elastic(depth).0 - 1.0).abs() < 1e-4, "{depth}");
            let by_depth =
                (law.pressure(depth + e, 0.3).p - law.pressure(depth - e, 0.3).p) / (2.0 * e);
            assert!((by_depth / law.pressure(depth, 0.3).by_depth - 1.0).abs() < 1e-3, "{depth}");
        }
        assert_eq!(law.pressure(1e-4, -1.0).p, 0.0);
    }

    #[test]
    fn a_blow_comes_back_as_hunt_and_crossley_say() {
        // A unit mass at 1 m/s; ln((1 + c v)/(1 - c v e)) = c v (1 + e) gives the table.
        for (c, e) in [(0.05, 0.967_739), (0.2, 0.882_19), (1.0, 0.593_624), (2.0, 0.410_72)] {
            let law = Normal { k: 1e4, d_0: 1e-7, c };
            let (mut x, mut v, h) = (0.0, 1.0, 2e-6);
            loop {
                let half = v - 0.5 * h * law.pressure(x, v).p;
                x += h * half;
                v = half - 0.5 * h * law.pressure(x, half).p;
                if x <= 0.0 {
                    break;
                }
            }
            // First order in h omega = 2e-4, from the damping.
            assert!((-v - e).abs() < 1e-3, "c = {c}: {v}, expected {e}");
        }
    }
}
