//! Contact in the problem that the solvers see.

use super::{Mode, System};
use crate::contact_coupling::run::At;
pub(super) use crate::contact_coupling::run::Part;
use pliant_dae::problem::{EvaluationError, Point, Weights};

/// Sizes of the model by which nothing moves within a step, and change of slopes.
const WILD: f64 = 10.0;

impl System {
    /// Notes where everything is at the start, or at an equilibrium, and what touches there: slip counts from there,
    /// and sides of surfaces.
    pub(super) fn begin_contact(&mut self, at: Point<'_>) {
        self.memory.contact.q.clear();
        self.accept_contact(at);
    }

    /// Refuses iterates that are far from any sense, before the search looks for what touches there.
    pub(super) fn refuse_wild(&self, q: &[f64]) -> Result<(), EvaluationError> {
        let last = &self.memory.contact.q;
        if last.len() != q.len() {
            return Ok(());
        }
        let most = WILD * f64::max(1.0, self.model.size());
        // Not `>`: what is not a number is wild, too.
        if q.iter().zip(last).all(|(q, last)| (q - last).abs() <= most) {
            return Ok(());
        }
        let message = format!("a step moves something with contact by more than {most:.3e} m");
        Err(EvaluationError { message, recoverable: true })
    }

    fn at_rest(&self) -> bool {
        self.mode == Mode::Static || self.frictionless
    }

    /// Lets bodies in contact slide: small motions about a state at rest do not see friction.
    pub(crate) fn leave_out_friction(&mut self) {
        self.frictionless = true;
    }

    /// Adds what contact adds to the inner forces.
    pub(super) fn add_contact(
        &mut self,
        (t, q, v): (f64, &[f64], &[f64]),
        part: Part,
        force: &mut [f64],
    ) {
        if !self.model.contacts.is_empty() {
            let which = (part, self.at_rest());
            let Self { model, search, memory, .. } = self;
            model.contacts.add_forces(search, &memory.contact, At { t, q, v }, which, force);
        }
    }

    /// Lets the structure follow what touches.
    pub(super) fn follow_contact(&mut self, q: &[f64]) {
        if !self.model.contacts.is_empty() {
            let Self { model, search, memory, coupled, .. } = self;
            coupled.follow(&model.contacts, &model.map, search, &mut memory.contact, q);
        }
    }

    pub(super) fn contact_tangents(&mut self, at: Point<'_>, weights: Weights, values: &mut [f64]) {
        if !self.model.contacts.is_empty() {
            let factors = (weights.stiffness, weights.damping, self.at_rest());
            let Self { model, search, memory, coupled, .. } = self;
            coupled.tangents(&model.contacts, search, &memory.contact, at.into(), factors, values);
        }
    }

    /// How far an increment may go before bodies are pressed through each other.
    pub(super) fn way_of_contact(&mut self, q: &[f64], increment: &[f64]) -> (f64, Option<String>) {
        if self.model.contacts.is_empty() {
            return (1.0, None);
        }
        let Self { model, search, .. } = self;
        let (part, contact) = search.way(&model.contacts, q, increment);
        let what = |name| format!("in contact '{name}' one body would pass through the other");
        (part, contact.map(what))
    }

    /// Appends force on the slave and impulse of each contact.
    pub(super) fn show_contact(&self, out: &mut Vec<f64>) {
        let totals = &self.memory.contact.totals;
        let none = [0.0; 6];
        for k in 0..self.model.contacts.list.len() {
            out.extend(totals.get(k).unwrap_or(&none));
        }
        let totals = &self.memory.contact.probes.totals;
        for k in 0..self.model.contacts.probes.contacts.len() {
            out.extend(totals.get(k).unwrap_or(&none));
        }
    }

    pub(super) fn accept_contact(&mut self, after: Point<'_>) {
        if !self.model.contacts.is_empty() {
            let at_rest = self.at_rest();
            let Self { model, search, memory, .. } = self;
            model.contacts.accept(search, &mut memory.contact, after.into(), at_rest);
        }
    }
}
