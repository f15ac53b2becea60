//! What a run remembers beside the state of the integrator: inputs, and integrals over its steps.

use crate::contact_coupling::memory::ContactMemory;
use crate::latches::Switch;
use crate::model::{Model, PlacedJoint};
use crate::system::Liveliest;
use crate::winch::Pace;
use pliant_dae::error::Error;
use pliant_dae::problem::Point;
use serde::{Deserialize, Serialize};

/// Integrals over the accepted steps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Audit {
    /// Energy dissipated by the material [J].
    pub dissipated: f64,
    /// Work of loads [J].
    pub work: f64,
}

/// What joints and forces remember of the last accepted point.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Last {
    /// Its time [s].
    pub t: f64,
    /// Freedoms of the joints, angles with all their turns.
    pub angles: Vec<f64>,
    /// Integrals of signals up to there.
    pub integrals: Vec<f64>,
    /// Values of these signals there.
    pub rates: Vec<f64>,
    /// What joints remember, one after the other.
    pub joints: Vec<f64>,
}

/// What a run remembers beside the state of the integrator.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Memory {
    /// Integrals since the start.
    pub audit: Audit,
    /// What joints were made to do since the start.
    pub history: Vec<Switch>,
    /// How many of the scheduled events are over.
    pub events: usize,
    /// For each multiplier whether its equation follows from others; empty: none does.
    pub redundant: Vec<bool>,
    /// Values of the inputs that are set from outside; those of functions of time follow them.
    pub held: Vec<f64>,
    /// The same when the tangent was last asked for: the kept factorisation contains them.
    held_at_tangent: Vec<f64>,
    /// Generalized forces of the loads and of damping at the last accepted point.
    pub(crate) loads: Vec<f64>,
    pub(crate) damping: Vec<f64>,
    /// What joints and forces remember.
    pub(crate) last: Last,
    /// The same when the tangent was last asked for.
    last_at_tangent: Last,
    /// Stored energy there of forces that store more or less as time goes by.
    pub(crate) potential: f64,
    /// Factor of the length of each winch there, and the forces on it, elastic and of damping [J].
    pub(crate) winches: Vec<[f64; 3]>,
    /// Power there that passes forces from outside into loss [W]; none: it and the forces on winches are to be found
    /// anew, for velocities have jumped.
    pub(crate) transit: Option<f64>,
    /// Inputs at the last points, where their rates are asked for.
    pub(crate) pace: Pace,
    /// The same when the tangent was last asked for.
    pace_at_tangent: Pace,
    /// The liveliest motion so far.
    pub(crate) liveliest: Liveliest,
    /// What contact remembers, and what it did when the tangent was last asked for.
    pub(crate) contact: ContactMemory,
    contact_at_tangent: ContactMemory,
    /// What the points of cables that yield remember, and what they did when the tangent was last asked for.
    pub(crate) past: Vec<f64>,
    past_at_tangent: Vec<f64>,
}

impl Memory {
    /// That of a run that begins with these inputs.
    #[must_use]
    pub fn new(held: &[f64]) -> Self {
        Self { held: held.to_vec(), held_at_tangent: held.to_vec(), ..Self::default() }
    }

    /// Refuses what belongs to another model.
    pub(crate) fn check(&self, model: &Model, inputs: usize) -> Result<(), Error> {
        let full = |forces: &[f64]| if forces.is_empty() { 0 } else { model.coordinates() };
        for (what, expected, got) in [
            ("inputs", inputs, self.held.len()),
            ("inputs of the tangent", inputs, self.held_at_tangent.len()),
            ("loads", full(&self.loads), self.loads.len()),
            ("damping", full(&self.damping), self.damping.len()),
            ("winches", model.winches.len(), self.winches.len()),
            ("freedoms", model.freedoms.len(), self.last.angles.len()),
            ("integrals", model.integrals.len(), self.last.integrals.len()),
            ("rates", model.integrals.len(), self.last.rates.len()),
            ("numbers of joints", model.joint_memory, self.last.joints.len()),
            ("plastic strains", model.initial_past.len(), self.past.len()),
            ("contact", full(&self.contact.q), self.contact.q.len()),
            (
                "contact of the tangent",
                full(&self.contact_at_tangent.q),
                self.contact_at_tangent.q.len(),
            ),
        ] {
            if expected != got {
                return Err(Error::Length { what, expected, got });
            }
        }
        let redundant = if self.redundant.is_empty() { 0 } else { model.multipliers };
        let (expected, got) = (redundant, self.redundant.len());
        if expected != got {
            return Err(Error::Length { what: "redundant equations", expected, got });
        }
        let (expected, got) = (model.schedule.len(), self.events);
        if got > expected {
            return Err(Error::Length { what: "events", expected, got });
        }
        for switch in &self.history {
            let joint =
                model.joints.get(switch.joint).filter(|_| switch.joint < model.latches.len());
            let expected = joint.map_or(0, |j| j.joint.support().unknowns.len());
            let got = switch.pose.len();
            if expected != got || joint.is_none() {
                return Err(Error::Length { what: "the pose of a joint", expected, got });
            }
        }
        Ok(())
    }

    /// What a joint remembers; nothing where the run has not begun.
    pub(crate) fn of(&self, joint: &PlacedJoint) -> &[f64] {
        self.last.joints.get(joint.memory.clone()).unwrap_or_default()
    }

    /// Notes what the tangent is made with.
    pub(crate) fn note_tangent(&mut self) {
        self.held_at_tangent.clone_from(&self.held);
        self.pace_at_tangent.clone_from(&self.pace);
        self.last_at_tangent.clone_from(&self.last);
        self.contact_at_tangent.clone_from(&self.contact);
        self.past_at_tangent.clone_from(&self.past);
    }

    /// The same with the inputs of the time when the kept factorisation was made.
    pub(crate) fn at_tangent(&self) -> Self {
        Self {
            held: self.held_at_tangent.clone(),
            pace: self.pace_at_tangent.clone(),
            last: self.last_at_tangent.clone(),
            contact: self.contact_at_tangent.clone(),
            past: self.past_at_tangent.clone(),
            ..self.clone()
        }
    }
}

/// Mean of `forces` (added to a vector of zeros) at both ends of a step, times the displacement between. `noted` holds
/// those at its beginning (empty: to be found) and is left with those at its end; `spare` is scratch.
pub(crate) fn work(
    noted: &mut Vec<f64>,
    spare: &mut Vec<f64>,
    before: Point<'_>,
    after: Point<'_>,
    mut forces: impl FnMut(Point<'_>, &mut [f64]),
) -> f64 {
    let n = before.q.len();
    if noted.is_empty() {
        noted.resize(n, 0.0);
        forces(before, noted);
    }
    spare.clear();
    spare.resize(n, 0.0);
    forces(after, spare);
    let mean = noted.iter().zip(spare.iter()).map(|(b, a)| 0.5 * (b + a));
    let moved = after.q.iter().zip(before.q).map(|(a, b)| a - b);
    let work = mean.zip(moved).map(|(f, d)| f * d).sum();
    std::mem::swap(noted, spare);
    work
}
