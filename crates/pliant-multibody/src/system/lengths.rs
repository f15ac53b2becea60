//! What a run does with functions of time: inputs and their rates, the lengths that winches set, and their work.

use super::{Mode, System};
use pliant_dae::problem::{EvaluationError, Point};
use pliant_elements::Motion;

impl System {
    /// Makes inputs, their rates and the lengths of winches those of a time.
    pub(super) fn refresh(&mut self, t: f64) -> Result<(), EvaluationError> {
        self.refresh_inputs(t)?;
        if !self.model.uses_rates {
            return self.wind(t);
        }
        if self.mode == Mode::Dynamic {
            self.rates.resize(self.input_values.len(), 0.0);
            for (k, (rate, value)) in self.rates.iter_mut().zip(&self.input_values).enumerate() {
                *rate = self.memory.pace.rate(k, t, *value);
            }
        }
        self.wind(t)
    }

    /// Sets the lengths that winches give at a time.
    fn wind(&mut self, t: f64) -> Result<(), EvaluationError> {
        for k in 0..self.model.winches.len() {
            let winch = &self.model.winches[k];
            let now = self.moment(t);
            let (factor, rate) = (winch.factor(now), winch.rate(now));
            winch
                .check(factor, t)
                .map_err(|message| EvaluationError { message, recoverable: false })?;
            self.altered.set(&self.model, k, [factor, rate]);
        }
        Ok(())
    }

    /// Forces on the factors of lengths, elastic and of damping, and the power that passes forces, at a point.
    fn given(&mut self, at: Point<'_>) -> (Vec<[f64; 3]>, f64) {
        // Functions of time that fail here have failed in the step itself.
        if self.refresh(at.t).is_err() {
            return (self.memory.winches.clone(), self.memory.transit.unwrap_or(0.0));
        }
        let motion = Motion { q: at.q, v: at.v, a: at.a };
        let forces = self.altered.forces(&self.model, motion);
        let lengths = &self.altered.lengths;
        let winches =
            lengths.iter().zip(forces).map(|(l, [elastic, damping])| [l[0], elastic, damping]);
        let winches = winches.collect();
        let transit = if self.mode == Mode::Dynamic { self.transit(at.t, at.q, at.v) } else { 0.0 };
        (winches, transit)
    }

    /// Notes at the start what the first step compares with.
    pub(super) fn note_given(&mut self, at: Point<'_>) {
        let _ = self.refresh_inputs(at.t);
        if self.model.uses_rates {
            self.memory.pace.note(at.t, self.input_values.clone());
        }
        let (winches, transit) = self.given(at);
        (self.memory.winches, self.memory.transit) = (winches, Some(transit));
    }

    /// Work of winches over the present step, by the mean of their forces over the change of the lengths.
    pub(super) fn work_of_winches(&mut self, after: Point<'_>) -> f64 {
        if self.model.winches.is_empty() {
            return 0.0;
        }
        let (winches, _) = self.given(after);
        let pairs = winches.iter().zip(&self.memory.winches);
        pairs.map(|(new, old)| 0.5 * (new[1] + old[1] + new[2] + old[2]) * (new[0] - old[0])).sum()
    }

    /// The same at an accepted step, for the audit, and the energy that passes forces
    /// from outside into loss, by the trapezoidal rule.
    pub(super) fn accept_given(&mut self, before: Point<'_>, after: Point<'_>) {
        if self.model.winches.is_empty() && !self.model.has_transit {
            if self.model.uses_rates {
                let _ = self.refresh_inputs(after.t);
                self.memory.pace.note(after.t, self.input_values.clone());
            }
            return;
        }
        let known = self.memory.transit.take();
        let transit_before = match known {
            Some(transit) => transit,
            None => {
                let (winches, transit) = self.given(before);
                self.memory.winches = winches;
                transit
            }
        };
        let (winches, transit) = self.given(after);
        let audit = &mut self.memory.audit;
        for (new, old) in winches.iter().zip(&self.memory.winches) {
            let change = new[0] - old[0];
            let mean = |k: usize| 0.5 * (new[k] + old[k]);
            audit.work += (mean(1) + mean(2)) * change;
            audit.dissipated += mean(2) * change;
        }
        if self.mode == Mode::Dynamic {
            let passed = 0.5 * (transit + transit_before) * (after.t - before.t);
            audit.work += passed;
            audit.dissipated += passed;
        }
        (self.memory.winches, self.memory.transit) = (winches, Some(transit));
        if self.model.uses_rates {
            self.memory.pace.note(after.t, self.input_values.clone());
        }
    }
}
