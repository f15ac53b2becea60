//! What a converged step must not have done: carried bodies through each other, or made energy.
//!
//! Newton's iteration converges well in steps that are long beside a blow, or beside the whip of a stiff line, and finds
//! motions that have many times the energy of the one before. Tried again in halves, such steps go right.

use super::System;
use crate::contact_coupling::run::Search;
use crate::memory::work;
use pliant_dae::problem::{EvaluationError, Point, Problem};
use serde::{Deserialize, Serialize};

/// Part of the energy in play by which energy may grow within a step.
const GAIN: f64 = 0.01;
/// The same part of the work of loads, drives and winches in a step without contact: by a mean of their forces it is
/// known roughly.
const OUTSIDE: f64 = 0.1;
/// Square of the part of the velocities by which they change in a step that may have made energy, ...
const TURNED: f64 = 0.25;
/// ... and of the largest so far.
const NOTABLE: f64 = 0.01;
/// Factor of the squared velocities after which the energy of motion is looked at again.
const FASTER: f64 = 2.0;
/// Part of the largest energy in motion that a step may leave out of the balance, where it is too long to resolve the
/// contact: the scheme would damp the rebound away.
const GAP: f64 = 1e-4;
/// The same part of the energy that changes hands within the step.
const EXCHANGED: f64 = 0.003;
/// The same part of the floor of what contact may make.
const REST: f64 = 0.01;
/// Step, in units of a radian of the contact's own motion, that resolves it.
const RESOLVED: f64 = 0.02;
/// Part of the nominal step below which none is cut any more for what the balance leaves out, ...
const SMALLEST: f64 = 1.0 / 128.0;
/// ... or for what motion without contact makes.
const SMALLEST_IN_MOTION: f64 = 1.0 / 1024.0;

/// What was found out about a step before it was accepted.
#[derive(Default)]
pub(super) struct Judged {
    pub(super) work: Option<Exchange>,
    pub(super) loss: Option<Exchange>,
}

/// Time of a step's end, energy that was exchanged in it, forces at its end.
pub(super) type Exchange = (f64, f64, Vec<f64>);

/// The liveliest motion so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Liveliest {
    /// Sum of squares of the velocities when energy was looked at.
    speed: f64,
    /// Largest kinetic energy that was seen [J].
    energy: f64,
}

fn refuse(message: String) -> Result<(), EvaluationError> {
    Err(EvaluationError { message, recoverable: true })
}

/// Sums of squares of changes of velocities and of velocities, in lanes that the compiler keeps in registers.
fn turned_and_speed(before: &[f64], after: &[f64]) -> (f64, f64) {
    const LANES: usize = 8;
    let (mut turned, mut speed) = ([0.0; LANES], [0.0; LANES]);
    let mut add = |k: usize, b: f64, a: f64| {
        turned[k] += (a - b) * (a - b);
        speed[k] += b * b;
    };
    let ((before, last_before), (after, last_after)) =
        (before.as_chunks::<LANES>(), after.as_chunks::<LANES>());
    for (b, a) in before.iter().zip(after) {
        for k in 0..LANES {
            add(k, b[k], a[k]);
        }
    }
    for (k, (b, a)) in last_before.iter().zip(last_after).enumerate() {
        add(k, *b, *a);
    }
    (turned.iter().sum(), speed.iter().sum())
}

impl System {
    /// Refuses a step in which bodies passed through each other, or that made energy.
    pub(super) fn judge_step(
        &mut self,
        before: Point<'_>,
        after: Point<'_>,
        part: f64,
    ) -> Result<(), EvaluationError> {
        self.judged = Judged::default();
        let model = self.model.clone();
        let contacts = &model.contacts;
        if !contacts.is_empty() {
            self.judge_passage(before, after, part)?;
            let memory = &self.memory.contact;
            let (lasts, lasted) = (memory.has_touched(), memory.had_touched);
            if lasts || self.search.any(contacts, after.q) {
                return self.judge_contact(before, after, part, true);
            }
            // The algorithmic accelerations hold a force for one step more than it acts: velocities gain by it still.
            if lasted {
                return self.judge_contact(before, after, part, false);
            }
        }
        self.judge_motion(before, after, part)
    }

    fn judge_passage(
        &mut self,
        before: Point<'_>,
        after: Point<'_>,
        part: f64,
    ) -> Result<(), EvaluationError> {
        let contacts = &self.model.contacts;
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
        Ok(())
    }

    /// Energy at both ends of a step, and what came from outside.
    fn change(&mut self, before: Point<'_>, after: Point<'_>) -> ([f64; 3], [f64; 3], f64) {
        let last = match self.noted_energy {
            Some((t, energy)) if t == before.t => energy,
            _ => self.energy_with(&mut Search::default(), before),
        };
        let mut search = std::mem::take(&mut self.search);
        let now = self.energy_with(&mut search, after);
        self.search = search;
        self.noted_energy = Some((after.t, now));
        let mut outside = self.work_of_winches(after);
        if self.model.has_work() {
            let work = self.work_of_step(self.memory.loads.clone(), before, after);
            outside += work.1;
            self.judged.work = Some(work);
            outside += self.changing_energy(after.t, after.q, after.v) - self.memory.potential;
        }
        (last, now, outside)
    }

    /// Where the contact `lasts`, neither may a step lose what the balance does not tell.
    fn judge_contact(
        &mut self,
        before: Point<'_>,
        after: Point<'_>,
        part: f64,
        lasts: bool,
    ) -> Result<(), EvaluationError> {
        let (last, now, outside) = self.change(before, after);
        let liveliest = &mut self.memory.liveliest;
        liveliest.energy = liveliest.energy.max(last[0]);
        let peak = liveliest.energy.max(now[0]);
        let gain = now.iter().sum::<f64>() - last.iter().sum::<f64>() - outside;
        let h = after.t - before.t;
        let model = self.model.clone();
        let contacts = &model.contacts;
        if part > SMALLEST && h * contacts.frequency > RESOLVED && !self.is_driven(after) {
            let loss = self.loss_of_step(self.memory.damping.clone(), before, after);
            let lost = loss.1 + self.plastic_work(after);
            self.judged.loss = Some(loss);
            let gap = gain + lost;
            let changes = [now[0] - last[0], now[1] + now[2] - last[1] - last[2], lost, outside];
            let exchanged: f64 = changes.iter().map(|e| e.abs()).sum();
            let limit = GAP * peak + EXCHANGED * exchanged + REST * contacts.energy_floor;
            if gap > limit || (lasts && -gap > limit) {
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

    /// The same without contact. Energy is looked at where velocities change by about as much as they are: in steps that
    /// make it they change many times as much.
    fn judge_motion(
        &mut self,
        before: Point<'_>,
        after: Point<'_>,
        part: f64,
    ) -> Result<(), EvaluationError> {
        let (turned, speed) = turned_and_speed(before.v, after.v);
        let liveliest = &mut self.memory.liveliest;
        if speed > FASTER * liveliest.speed {
            liveliest.speed = speed;
            let kinetic = self.model.energy_of_bodies(&self.altered, before.q, before.v)[0];
            liveliest.energy = liveliest.energy.max(kinetic);
        }
        if part <= SMALLEST_IN_MOTION
            || turned <= TURNED * speed
            || turned <= NOTABLE * liveliest.speed
        {
            self.noted_energy = None;
            return Ok(());
        }
        let (last, now, outside) = self.change(before, after);
        let gain = now.iter().sum::<f64>() - last.iter().sum::<f64>() - outside;
        let released = (last[1] - now[1]).max(0.0) + (last[2] - now[2]).max(0.0);
        let peak = self.memory.liveliest.energy;
        let limit = GAIN * (peak + released)
            + OUTSIDE * outside.abs()
            + self.model.rounding_of_energy(last[1], last[2]);
        if gain > limit {
            return refuse(format!(
                "{gain:.3e} J have come from nowhere within a step, of {peak:.3e} J in motion: it does not resolve this motion"
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

    /// Work of loads over a step; `noted` are their forces at its beginning.
    pub(super) fn work_of_step(
        &mut self,
        noted: Vec<f64>,
        before: Point<'_>,
        after: Point<'_>,
    ) -> Exchange {
        self.exchange(noted, before, after, Self::working_forces)
    }

    /// What damping and friction dissipate over a step, likewise.
    pub(super) fn loss_of_step(
        &mut self,
        noted: Vec<f64>,
        before: Point<'_>,
        after: Point<'_>,
    ) -> Exchange {
        self.exchange(noted, before, after, |system, at, force| {
            system.damping_forces(at.t, at.q, at.v, force);
        })
    }

    fn exchange(
        &mut self,
        mut noted: Vec<f64>,
        before: Point<'_>,
        after: Point<'_>,
        forces: impl Fn(&mut Self, Point<'_>, &mut [f64]),
    ) -> Exchange {
        let mut spare = std::mem::take(&mut self.forces);
        let energy = work(&mut noted, &mut spare, before, after, |at, force| {
            // Inputs that fail here have failed in the step itself.
            if self.refresh(at.t).is_ok() {
                forces(self, at, force);
            }
        });
        self.forces = spare;
        (after.t, energy, noted)
    }

    fn energy_with(&self, search: &mut Search, at: Point<'_>) -> [f64; 3] {
        let mut energy = self.model.energy_of_bodies(&self.altered, at.q, at.v);
        energy[1] += self.model.stored_energy(self.moment(at.t), at.q, at.v);
        energy[1] += self.model.gas_energy(self.moment(at.t), at.q, false);
        if !self.model.contacts.is_empty() {
            energy[1] += self.model.contacts.energy(search, at.q);
        }
        energy
    }
}
