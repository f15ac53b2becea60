//! Winches: the stress-free length of a cable over time, and the rates of values over time.
//!
//! A model never changes during a run, so the run has copies of the blocks whose lengths winches change, and sets them
//! to each time that it asks about. What a winch has let out at a recorded time stands in the outputs of that time.

use crate::error::ModelError;
use crate::model::{Blocks, Model, StrandPlace};
use crate::signal::{Moment, Value};
use crate::spec::CableSpec;
use pliant_elements::{Block, CableBlock, Motion};
use std::ops::Range;

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
    strands: Vec<StrandPlace>,
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

/// Blocks as winches make them at a moment, by their numbers; none where no winch is.
#[derive(Clone, Debug, Default)]
pub struct Wound {
    cables: Vec<Option<CableBlock>>,
    /// Factor and rate of each winch.
    pub(crate) lengths: Vec<[f64; OUTPUTS]>,
}

impl Wound {
    /// Copies of the blocks that have winches, at the start.
    #[must_use]
    pub fn new(model: &Model) -> Self {
        if model.winches.is_empty() {
            return Self::default();
        }
        let copy = |block: &CableBlock| block.law().wound.then(|| block.clone());
        let cables = model.blocks.cables.iter().map(|placed| copy(&placed.block)).collect();
        Self { cables, lengths: vec![[1.0, 0.0]; model.winches.len()] }
    }

    /// Sets what the recorded outputs of a time say; the last of them are those of winches.
    pub fn show(&mut self, model: &Model, outputs: &[f64]) {
        let n = OUTPUTS * model.winches.len();
        if let Some(first) = outputs.len().checked_sub(n) {
            for (k, row) in outputs[first..].chunks_exact(OUTPUTS).enumerate() {
                self.set(model, k, [row[0], row[1]]);
            }
        }
    }

    /// Sets factor and rate of a winch.
    pub(crate) fn set(&mut self, model: &Model, winch: usize, length: [f64; OUTPUTS]) {
        if self.lengths[winch] == length {
            return;
        }
        self.lengths[winch] = length;
        for strand in &model.winches[winch].strands {
            if let Some(Some(block)) = self.cables.get_mut(strand.block) {
                block.set_length(strand.cable, length[0], length[1]);
            }
        }
    }

    /// Lets all winches stand still where they are.
    pub(crate) fn stop(&mut self, model: &Model) {
        for winch in 0..self.lengths.len() {
            let [factor, _] = self.lengths[winch];
            self.set(model, winch, [factor, 0.0]);
        }
    }

    /// Forces on the factors of the lengths [J], elastic and of damping, one for each winch.
    pub(crate) fn forces(&self, model: &Model, motion: Motion<'_>) -> Vec<[f64; 2]> {
        let on = |winch: &Winch| {
            let mut sum = [0.0; 2];
            for strand in &winch.strands {
                let block = model.blocks.cable(strand.block, self);
                let forces = block.length_forces(strand.cable, motion);
                sum[0] += forces[0];
                sum[1] += forces[1];
            }
            sum
        };
        model.winches.iter().map(on).collect()
    }
}

impl Blocks {
    /// A block of cables.
    pub fn cable<'a>(&'a self, number: usize, wound: &'a Wound) -> &'a CableBlock {
        match wound.cables.get(number) {
            Some(Some(block)) => block,
            _ => &self.cables[number].block,
        }
    }

    /// Every block as winches make it, and where its matrices lie. The order never changes.
    pub fn iter_as<'a>(
        &'a self,
        wound: &'a Wound,
    ) -> impl Iterator<Item = (&'a dyn Block, &'a Range<usize>)> {
        self.iter().enumerate().map(|(number, (block, values))| match wound.cables.get(number) {
            Some(Some(block)) => (block as &dyn Block, values),
            _ => (block, values),
        })
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
