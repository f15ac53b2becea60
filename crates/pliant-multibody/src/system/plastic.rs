//! Cables that yield: what a step spends on it, and what they remember of it.

use super::System;
use pliant_dae::problem::Point;

impl System {
    /// Work on plastic flow in a step to `after`, before that is accepted [J]. On a winch that moves by the mean of its
    /// lengths, which makes it second order in the step; else exact for strains that grow or fall all along it.
    pub(super) fn plastic_work(&mut self, after: Point<'_>) -> f64 {
        // Inputs that fail here have failed in the step itself.
        if self.model.plastic.is_empty() || self.refresh(after.t).is_err() {
            return 0.0;
        }
        let work = self.altered.plastic_work(&self.model, after.q);
        let of_cables = self.model.plastic.iter().zip(work).map(|(plastic, work)| {
            let before = plastic.winch.and_then(|k| self.memory.winches.get(k));
            match (before, plastic.winch) {
                (Some([before, ..]), Some(k)) => {
                    0.5 * work * (1.0 + before / self.altered.lengths[k][0])
                }
                _ => work,
            }
        });
        of_cables.sum()
    }

    /// Lets cables flow to accepted coordinates.
    pub(super) fn flow_to(&mut self, t: f64, q: &[f64]) {
        if self.model.plastic.is_empty() || self.refresh(t).is_err() {
            return;
        }
        self.memory.past = self.altered.flowed(&self.model, q);
        self.altered.set_past(&self.model, &self.memory.past);
    }

    /// Takes the plastic strains at the start, with what the line yields on its way there.
    pub(super) fn begin_past(&mut self, t: f64, q: &[f64]) {
        self.memory.past.clone_from(&self.model.initial_past);
        self.altered.set_past(&self.model, &self.memory.past);
        self.flow_to(t, q);
    }

    /// Tangents of small motions about the present state: whatever has yielded moves elastically.
    pub(crate) fn keep_elastic(&mut self) {
        self.altered.set_lead(f64::NEG_INFINITY);
    }
}
