//! The gas of a chamber: `p = p_0 (rho/rho_0)^gamma` with rho = m/V. An exponent of one is the isothermal ideal gas, the
//! ratio of its heat capacities the adiabatic one; gas that flows in comes on the same curve.
//!
//! Its energy is the work against gas and surroundings from the state in which both have the same pressure,
//! `A = integral of (p_a - p) dV` at a fixed mass, from the state of the document where there are no surroundings.

use crate::error::ModelError;
use crate::spec::GasSpec;

/// Pressures below this part of the reference are none that a gas can have: the curve goes on straight.
const LEAST: f64 = 1e-6;

/// Law of a gas in its surroundings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gas {
    /// Reference pressure p_0, absolute [Pa].
    pub pressure: f64,
    /// Density rho_0 at this pressure [kg/m^3].
    pub density: f64,
    /// Exponent gamma.
    pub exponent: f64,
    /// Pressure of the surroundings p_a, absolute [Pa].
    pub ambient: f64,
}

impl Gas {
    /// The gas of a document.
    ///
    /// # Errors
    /// [`ModelError`] naming `place` for numbers out of range.
    pub fn of_spec(gas: &GasSpec, ambient: f64, place: &str) -> Result<Self, ModelError> {
        let &GasSpec { pressure, temperature, exponent, gas_constant } = gas;
        for value in [pressure, temperature, exponent, gas_constant] {
            if !(value > 0.0 && value.is_finite()) {
                let allowed = "pressure, temperature, exponent and gas constant above zero";
                return Err(ModelError::Value { place: place.to_owned(), value, allowed });
            }
        }
        if !(ambient >= 0.0 && ambient.is_finite()) {
            let allowed = "pressures of the surroundings from zero on";
            return Err(ModelError::Value { place: place.to_owned(), value: ambient, allowed });
        }
        Ok(Self { pressure, density: pressure / (gas_constant * temperature), exponent, ambient })
    }

    /// Volume of a mass at a pressure [m^3].
    #[must_use]
    pub fn volume(&self, mass: f64, pressure: f64) -> f64 {
        let least = LEAST * self.pressure;
        let at = |p: f64| mass / self.density * (self.pressure / p).powf(1.0 / self.exponent);
        if pressure >= least {
            return at(pressure);
        }
        at(least) * (1.0 + (1.0 - pressure / least) / self.exponent)
    }

    /// `-V dp/dV` over the volume, gamma p: what stands against compression [Pa].
    #[must_use]
    pub fn stiffness(&self, pressure: f64) -> f64 {
        self.exponent * pressure.max(LEAST * self.pressure)
    }

    /// Pressure of a mass in a volume [Pa]; the reference where there is no volume yet.
    #[must_use]
    pub fn pressure_in(&self, mass: f64, volume: f64) -> f64 {
        if volume > 0.0 && mass > 0.0 {
            self.pressure * (mass / (self.density * volume)).powf(self.exponent)
        } else {
            self.pressure
        }
    }

    /// Energy A of a mass in a volume [J].
    #[must_use]
    pub fn energy(&self, mass: f64, volume: f64) -> f64 {
        if mass <= 0.0 || volume <= 0.0 {
            return self.ambient * volume;
        }
        let from = if self.ambient > 0.0 { self.ambient } else { self.pressure };
        let (v_0, v) = (self.volume(mass, from), volume);
        // p V^gamma = k: the integral of p is k (v^(1 - gamma) - v_0^(1 - gamma))/(1 - gamma).
        let rest = 1.0 - self.exponent;
        let log = (v / v_0).ln();
        let growth = if rest == 0.0 { log } else { (rest * log).exp_m1() / rest };
        self.ambient * (v - v_0) - from * v_0 * growth
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn gases() -> Vec<Gas> {
        let gas = |pressure, exponent, ambient| Gas { pressure, density: 1.2, exponent, ambient };
        vec![gas(1e5, 1.0, 1e5), gas(1.3e5, 1.4, 1e5), gas(2e4, 1.0, 0.0), gas(2e4, 1.67, 0.0)]
    }

    #[test]
    fn pressure_is_minus_the_derivative_of_the_energy() {
        for gas in gases() {
            let (mass, h) = (0.6, 1e-6);
            for volume in [0.3, 0.5, 0.9] {
                let energy = |v| gas.energy(mass, v);
                let slope = (energy(volume + h) - energy(volume - h)) / (2.0 * h);
                let p = gas.pressure_in(mass, volume);
                // Difference of second order: 1e-12, and rounding of the energy over h.
                assert!((slope - (gas.ambient - p)).abs() < 1e-7 * p, "{gas:?}");
                assert!((gas.volume(mass, p) - volume).abs() < 1e-14, "{gas:?}");
                let slope = (gas.pressure_in(mass, volume + h) - gas.pressure_in(mass, volume - h))
                    / (2.0 * h);
                assert!((slope * volume / gas.stiffness(p) + 1.0).abs() < 1e-8, "{gas:?}");
            }
            let least = if gas.ambient > 0.0 { gas.ambient } else { gas.pressure };
            assert!(gas.energy(mass, gas.volume(mass, least)).abs() < 1e-9, "{gas:?}");
        }
    }

    #[test]
    fn the_curve_goes_on_below_the_least_pressure() {
        for gas in gases() {
            let least = LEAST * gas.pressure;
            let (left, right) =
                (gas.volume(1.0, least * (1.0 - 1e-9)), gas.volume(1.0, least * (1.0 + 1e-9)));
            assert!((left / right - 1.0).abs() < 1e-8 && left > right);
            assert!(gas.volume(1.0, -1.0) > left);
        }
    }
}
