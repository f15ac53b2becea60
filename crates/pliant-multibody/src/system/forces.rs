//! What the forces of a model add to residual, tangent, energy and outputs of a run.

use super::System;
use crate::forces::{At, Part};
use crate::model::{Model, PlacedForce};
use crate::point::Support;
use crate::signal::Moment;
use pliant_dae::problem::{Point, Weights};
use pliant_dae::structure::{Storage, entries, entry_number};

/// Local coordinates, velocities and results.
#[derive(Default)]
pub(super) struct Room {
    x: Vec<f64>,
    v: Vec<f64>,
    out: Vec<f64>,
}

/// Local coordinates of a support.
pub(super) fn gather(support: &Support, q: &[f64], x: &mut Vec<f64>) {
    x.clear();
    x.extend(support.unknowns.iter().map(|&u| q[u]));
}

impl Model {
    /// Calls `work` with each force at its local coordinates.
    fn each_force(
        &self,
        room: &mut Room,
        now: Moment<'_>,
        (q, v): (&[f64], &[f64]),
        mut work: impl FnMut(&PlacedForce, At<'_>, &mut Vec<f64>),
    ) {
        let Room { x, v: local_v, out } = room;
        for placed in &self.forces {
            gather(placed.force.support(), q, x);
            gather(placed.force.support(), v, local_v);
            work(placed, At { now, x, v: local_v }, out);
        }
    }

    /// Energy stored in the forces [J].
    pub(crate) fn stored_energy(&self, now: Moment<'_>, q: &[f64], v: &[f64]) -> f64 {
        let mut energy = 0.0;
        self.each_force(&mut Room::default(), now, (q, v), |placed, at, _| {
            energy += placed.force.energy(at);
        });
        energy
    }

    /// Appends what the forces show, one after the other.
    pub(crate) fn outputs(&self, now: Moment<'_>, q: &[f64], v: &[f64], all: &mut Vec<f64>) {
        self.each_force(&mut Room::default(), now, (q, v), |placed, at, out| {
            out.clear();
            out.resize(placed.force.output_count(), 0.0);
            placed.force.outputs(at, out);
            all.extend_from_slice(out);
        });
    }

    /// Whether anything does work from outside, loads included.
    pub(super) fn has_work(&self) -> bool {
        let works =
            |f: &PlacedForce| f.force.is_rheonomic() || f.force.parts().contains(&Part::Work);
        let driven = self.joints.iter().any(|joint| joint.joint.is_driven());
        let flows = self.chambers.iter().any(|chamber| chamber.flows);
        driven || flows || !self.loads.is_empty() || self.forces.iter().any(works)
    }
}

impl System {
    /// Adds `factor` times the chosen parts of all forces to `force`.
    pub(super) fn add_forces(
        &mut self,
        (t, q, v): (f64, &[f64], &[f64]),
        factor: f64,
        chosen: impl Fn(&PlacedForce, Part) -> bool,
        force: &mut [f64],
    ) {
        let mut room = std::mem::take(&mut self.room);
        self.model.each_force(&mut room, self.moment(t), (q, v), |placed, at, out| {
            out.clear();
            out.resize(at.x.len(), 0.0);
            for &part in placed.force.parts().iter().filter(|&&part| chosen(placed, part)) {
                placed.force.add_force(part, at, factor, out);
            }
            for (&u, f) in placed.force.support().unknowns.iter().zip(out.iter()) {
                force[u] += f;
            }
        });
        self.room = room;
    }

    /// Energy whose change in time, at rest, is work.
    pub(super) fn changing_energy(&self, t: f64, q: &[f64], v: &[f64]) -> f64 {
        let mut energy = 0.0;
        self.model.each_force(&mut Room::default(), self.moment(t), (q, v), |placed, at, _| {
            if placed.force.is_rheonomic() {
                energy += placed.force.energy(at);
            }
        });
        energy + self.model.gas_energy(self.moment(t), q, true)
    }

    /// Power that passes forces from outside into loss.
    pub(super) fn transit(&self, t: f64, q: &[f64], v: &[f64]) -> f64 {
        let mut power = 0.0;
        self.model.each_force(&mut Room::default(), self.moment(t), (q, v), |placed, at, _| {
            power += placed.force.transit(at);
        });
        power
    }

    pub(super) fn force_tangents(&mut self, at: Point<'_>, weights: Weights, values: &mut [f64]) {
        let mut room = std::mem::take(&mut self.room);
        let structure = &self.model.structure;
        self.model.each_force(&mut room, self.moment(at.t), (at.q, at.v), |placed, at, out| {
            let n = at.x.len();
            out.clear();
            out.resize(n * n, 0.0);
            placed.force.add_tangent(at, weights.stiffness, weights.damping, out);
            let slot = structure.slot(placed.element);
            match slot.storage {
                Storage::Full => values[slot.base..slot.base + n * n].copy_from_slice(out),
                Storage::Symmetric => {
                    let values = &mut values[slot.base..slot.base + entries(n, slot.storage)];
                    for i in 0..n {
                        for j in 0..=i {
                            values[entry_number(n, i, j, slot.storage)] = out[i * n + j];
                        }
                    }
                }
            }
        });
        self.room = room;
    }
}
