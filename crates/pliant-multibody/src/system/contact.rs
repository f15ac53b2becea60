//! Contact in the problem that the solvers see.

use super::{Mode, System};
pub(super) use crate::contact_coupling::run::Part;
use crate::contact_coupling::run::{At, Search};
use crate::memory::work;
use pliant_dae::problem::{EvaluationError, Point, Problem, Weights};

/// Part of the kinetic and contact energy at the beginning of a step by which energy may grow in it.
const GAIN: f64 = 0.01;
/// Part of the largest energy in motion that a step may leave out of the balance, where it is too long to resolve the
/// contact: the scheme would damp the rebound away.
const GAP: f64 = 1e-4;
/// The same part of the energy that changes hands within the step.
const EXCHANGED: f64 = 0.003;
/// The same part of the floor of what contact may make.
const REST: f64 = 0.01;
/// Step, in units of a radian of the contact's own motion, that resolves it.
const RESOLVED: f64 = 0.02;
/// Sizes of the model by which nothing moves within a step, and change of slopes.
const WILD: f64 = 10.0;
/// Part of the nominal step below which none is cut any more for what the balance leaves out.
const SMALLEST: f64 = 1.0 / 128.0;

/// What was found out about a step before it was accepted: time of its end, energy, forces there.
#[derive(Default)]
pub(super) struct Judged {
    pub(super) work: Option<(f64, f64, Vec<f64>)>,
    pub(super) loss: Option<(f64, f64, Vec<f64>)>,
}

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
        self.mode == Mode::Static
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

    /// Refuses a step in which lines passed through each other, or contact made energy.
    pub(super) fn judge_contact(
        &mut self,
        before: Point<'_>,
        after: Point<'_>,
        part: f64,
    ) -> Result<(), EvaluationError> {
        if self.model.contacts.is_empty() {
            return Ok(());
        }
        self.judged = Judged::default();
        let refuse = |message: String| Err(EvaluationError { message, recoverable: true });
        let model = self.model.clone();
        let contacts = &model.contacts;
        if self.search.have_passed(contacts, before.q, after.q) {
            return refuse(
                "two bodies have passed through each other within a step: they hit harder than the contact is stiff"
                    .to_owned(),
            );
        }
        if part > SMALLEST && contacts.probes.have_crossed(&mut self.search.probes, after.q) {
            return refuse(
                "a body has been pressed through the middle of a surface within a step: they hit harder than the contact is stiff"
                    .to_owned(),
            );
        }
        if !self.search.any(contacts, after.q) && !self.memory.contact.has_touched() {
            self.noted_energy = None;
            return Ok(());
        }
        let last = match self.noted_energy {
            Some((t, energy)) if t == before.t => energy,
            _ => self.energy_with(&mut Search::default(), before),
        };
        let mut search = std::mem::take(&mut self.search);
        let now = self.energy_with(&mut search, after);
        self.search = search;
        self.noted_energy = Some((after.t, now));
        let mut outside = self.work_of_winches(after);
        if model.has_work() {
            outside += self.work_of_step(before, after);
            outside += self.changing_energy(after.t, after.q, after.v) - self.memory.potential;
        }
        let peak = f64::max(self.memory.contact.peak, now[0]);
        self.memory.contact.peak = peak;
        let gain = now.iter().sum::<f64>() - last.iter().sum::<f64>() - outside;
        let h = after.t - before.t;
        if part > SMALLEST && h * contacts.frequency > RESOLVED && !self.is_driven(after) {
            let lost = self.loss_of_step(before, after) + self.plastic_work(after);
            let gap = gain + lost;
            let changes = [now[0] - last[0], now[1] + now[2] - last[1] - last[2], lost, outside];
            let exchanged: f64 = changes.iter().map(|e| e.abs()).sum();
            let limit = GAP * peak + EXCHANGED * exchanged + REST * contacts.energy_floor;
            if gap.abs() > limit {
                return refuse(format!(
                    "a step leaves {gap:.3e} J of a contact out of the balance, of {peak:.3e} J in motion"
                ));
            }
        }
        let limit = GAIN * (last[0] + last[1].max(0.0) + outside.abs()) + contacts.energy_floor;
        if gain > limit {
            return refuse(format!(
                "contact made {gain:.3e} J within a step, of {:.3e} J in motion",
                last[0]
            ));
        }
        Ok(())
    }

    /// Whether something moves by itself, or stores more or less in time: its work over a step is known roughly.
    fn is_driven(&mut self, at: Point<'_>) -> bool {
        let mut rate = vec![0.0; self.multipliers()];
        self.constraint_rate(at.t, at.q, &mut rate);
        let model = &self.model;
        let changes = model.forces.iter().any(|f| f.force.is_rheonomic())
            || model.chambers.iter().any(|chamber| chamber.flows);
        changes || !model.winches.is_empty() || rate.iter().any(|r| *r != 0.0)
    }

    /// Work of loads over a step, and their forces at its end, kept for [`Problem::accept`].
    fn work_of_step(&mut self, before: Point<'_>, after: Point<'_>) -> f64 {
        let mut noted = self.memory.loads.clone();
        let mut spare = std::mem::take(&mut self.forces);
        let work = work(&mut noted, &mut spare, before, after, |at, force| {
            if self.refresh(at.t).is_ok() {
                self.working_forces(at, force);
            }
        });
        self.forces = spare;
        self.judged.work = Some((after.t, work, noted));
        work
    }

    /// What damping and friction dissipate over a step, likewise.
    fn loss_of_step(&mut self, before: Point<'_>, after: Point<'_>) -> f64 {
        let mut noted = self.memory.damping.clone();
        let mut spare = std::mem::take(&mut self.forces);
        let lost = work(&mut noted, &mut spare, before, after, |at, force| {
            if self.refresh(at.t).is_ok() {
                self.damping_forces(at.t, at.q, at.v, force);
            }
        });
        self.forces = spare;
        self.judged.loss = Some((after.t, lost, noted));
        lost
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

    fn energy_with(&self, search: &mut Search, at: Point<'_>) -> [f64; 3] {
        let mut energy = self.model.energy_of_bodies(&self.altered, at.q, at.v);
        energy[1] += self.model.stored_energy(self.moment(at.t), at.q, at.v);
        energy[1] += self.model.gas_energy(self.moment(at.t), at.q, false);
        energy[1] += self.model.contacts.energy(search, at.q);
        energy
    }

    pub(super) fn accept_contact(&mut self, after: Point<'_>) {
        if !self.model.contacts.is_empty() {
            let at_rest = self.at_rest();
            let Self { model, search, memory, .. } = self;
            model.contacts.accept(search, &mut memory.contact, after.into(), at_rest);
        }
    }
}
