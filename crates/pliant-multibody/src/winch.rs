//! Winches: the stress-free length of a cable over time, and the rates of values over time.

use crate::error::ModelError;
use crate::model::StrandPlace;
use crate::signal::{Moment, Value};
use crate::spec::CableSpec;

/// Numbers that a winch shows: the factor of the length and its rate [1/s].
pub(crate) const OUTPUTS: usize = 2;

/// A cable on a winch.
pub(crate) struct Winch {
    /// Name of the cable.
    pub name: String,
    /// Stress-free length over time [m].
    length: Value,
    /// That at the start [m], which the cable was built with.
    start: f64,
    pub(crate) strands: Vec<StrandPlace>,
}

impl Winch {
    /// The winch of a cable, if it has one.
    ///
    /// # Errors
    /// [`ModelError`] for a bad signal.
    pub fn of_cable(
        cable: &CableSpec,
        lengths: &[f64],
        strands: &[StrandPlace],
    ) -> Result<Option<Self>, ModelError> {
        let Some(signal) = &cable.rest_length else { return Ok(None) };
        let length = Value::new(signal, &format!("cable '{}', rest_length", cable.name))?;
        let start = lengths.iter().sum();
        Ok(Some(Self { name: cable.name.clone(), length, start, strands: strands.to_vec() }))
    }

    /// Factor of the length. A length is none of the loads that grow with the load factor of statics.
    pub fn factor(&self, now: Moment<'_>) -> f64 {
        self.length.at(Moment { constants: 1.0, ..now })[0] / self.start
    }

    /// Its rate [1/s].
    pub fn rate(&self, now: Moment<'_>) -> f64 {
        now.rate(&self.length) / self.start
    }

    /// The first time after `t` at which the length has a kink.
    pub fn next_break(&self, t: f64) -> Option<f64> {
        self.length.next_break(t)
    }

    /// What is wrong with a factor, if anything.
    pub fn check(&self, factor: f64, t: f64) -> Result<(), String> {
        if factor > 0.0 && factor.is_finite() {
            return Ok(());
        }
        Err(format!(
            "cable '{}': rest_length is {:.6e} m at t = {t:.6e}; it must stay above zero",
            self.name,
            factor * self.start
        ))
    }
}

/// Rates of values that are known at the ends of steps: differences of second order backwards.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub(crate) struct Pace {
    /// Times of the last two accepted points, the later one first.
    times: Vec<f64>,
    /// Values there.
    values: Vec<Vec<f64>>,
}

impl Pace {
    /// Notes the values at an accepted point.
    pub fn note(&mut self, t: f64, values: Vec<f64>) {
        if self.times.first() == Some(&t) {
            self.values[0] = values;
            return;
        }
        self.times.insert(0, t);
        self.values.insert(0, values);
        self.times.truncate(3);
        self.values.truncate(3);
    }

    /// Rate at `t` of value number `k`, which is `value` there.
    pub fn rate(&self, k: usize, t: f64, value: f64) -> f64 {
        let before = self.times.iter().zip(&self.values).filter(|(time, _)| **time < t);
        let mut before = before.map(|(time, values)| (*time, values[k]));
        let Some((t_1, x_1)) = before.next() else { return 0.0 };
        let slope = (value - x_1) / (t - t_1);
        let Some((t_0, x_0)) = before.next() else { return slope };
        // The parabola through three points.
        let bend = (slope - (x_1 - x_0) / (t_1 - t_0)) / (t - t_0);
        slope + bend * (t - t_1)
    }
}

#[cfg(test)]
mod tests {
    use super::Pace;

    #[test]
    fn rates_of_a_parabola_are_exact() {
        let f = |t: f64| 3.0 - 2.0 * t + 0.7 * t * t;
        let mut pace = Pace::default();
        assert_eq!(pace.rate(0, 0.0, f(0.0)), 0.0);
        for t in [0.0, 0.1, 0.25, 0.3] {
            pace.note(t, vec![f(t)]);
        }
        for t in [0.3, 0.35, 0.5] {
            assert!((pace.rate(0, t, f(t)) - (1.4 * t - 2.0)).abs() < 1e-12, "{t}");
        }
    }
}
