//! What the chambers of a model add to residual, tangent, energy and outputs of a run.

use super::System;
use crate::chambers::{Border, Chamber};
use crate::model::Model;
use crate::signal::Moment;
use pliant_dae::problem::{Point, Weights};

impl Model {
    /// Energy of the gas in all chambers, or in those into which gas flows [J].
    pub(crate) fn gas_energy(&self, now: Moment<'_>, q: &[f64], flowing: bool) -> f64 {
        let counts = |chamber: &&Chamber| chamber.flows || !flowing;
        self.chambers.iter().filter(counts).map(|chamber| chamber.energy(now, q)).sum()
    }
}

impl System {
    /// Adds the forces of the gas, `phi_q^T lambda_`, and writes `phi`.
    pub(super) fn chamber_residuals(&self, at: Point<'_>, force: &mut [f64], phi: &mut [f64]) {
        for chamber in &self.model.chambers {
            let lambda_ = at.lambda_[chamber.multiplier];
            chamber.add_force(at.q, lambda_, force);
            phi[chamber.multiplier] = chamber.residual(self.moment(at.t), at.q, lambda_);
        }
    }

    pub(super) fn chamber_tangents(&self, at: Point<'_>, weights: Weights, values: &mut [f64]) {
        let border = Border { stiffness: weights.stiffness, jacobian: weights.jacobian };
        for chamber in &self.model.chambers {
            let lambda_ = at.lambda_[chamber.multiplier];
            chamber.tangent(&self.model.structure, (at.q, lambda_), border, values);
        }
    }

    /// Adds the forces of gas that becomes more or less: beside the change of its energy they are its work.
    pub(super) fn flowing_forces(&self, at: Point<'_>, force: &mut [f64]) {
        for chamber in self.model.chambers.iter().filter(|chamber| chamber.flows) {
            chamber.add_force(at.q, -at.lambda_[chamber.multiplier], force);
        }
    }

    /// Writes the multipliers of all chambers where coordinates determine them.
    pub(super) fn determine_pressures(&mut self, t: f64, q: &[f64], lambda_: &mut [f64]) {
        // A failing function of time fails in the residual, too.
        let _ = self.refresh(t);
        for chamber in &self.model.chambers {
            lambda_[chamber.multiplier] = chamber.multiplier_at(self.moment(t), q);
        }
    }

    /// Appends absolute pressure, volume and mass of each chamber.
    pub(super) fn chamber_outputs(&self, at: Point<'_>, out: &mut Vec<f64>) {
        let now = self.moment(at.t);
        for chamber in &self.model.chambers {
            let pressure = chamber.pressure(at.lambda_[chamber.multiplier]);
            out.extend([pressure, chamber.volume(at.q), chamber.mass(now)]);
        }
    }
}
