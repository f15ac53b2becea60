//! Functions of time during a run: values, derivatives, integrals; what joints remember of the last accepted point.

use super::{Mode, System};
use crate::memory::Last;
use crate::model::{Beginning, PlacedIntegral, PlacedJoint};
use crate::signal::Moment;
use pliant_dae::problem::{EvaluationError, Point};

/// Points of a one-sided difference.
const POINTS: usize = 9;
/// Their distances are 2^-3, 2^-6, ... seconds; for each number those are taken whose derivative changes least.
const DISTANCES: i32 = 7;

/// Points and weights of Gauss's rule on (0, 1).
const GAUSS: [(f64, f64); 5] = [
    (0.046_910_077_030_668_004, 0.118_463_442_528_094_54),
    (0.230_765_344_947_158_45, 0.239_314_335_249_683_23),
    (0.5, 0.284_444_444_444_444_44),
    (0.769_234_655_052_841_6, 0.239_314_335_249_683_23),
    (0.953_089_922_969_332, 0.118_463_442_528_094_54),
];

/// Weights of the first three derivatives at 0 on the points 0, 1, ..., 8 (Fornberg 1988).
fn weights() -> [[f64; 4]; POINTS] {
    let mut w = [[0.0; 4]; POINTS];
    w[0][0] = 1.0;
    let mut c1 = 1.0;
    for i in 1..POINTS {
        let x_i = i as f64;
        let mut c2 = 1.0;
        for j in 0..i {
            let c3 = x_i - j as f64;
            c2 *= c3;
            let row = w[i - 1];
            if j == i - 1 {
                for m in (0..4).rev() {
                    let lower = if m > 0 { m as f64 * row[m - 1] } else { 0.0 };
                    w[i][m] = c1 * (lower - (x_i - 1.0) * row[m]) / c2;
                }
            }
            for m in (0..4).rev() {
                let lower = if m > 0 { m as f64 * w[j][m - 1] } else { 0.0 };
                w[j][m] = (x_i * w[j][m] - lower) / c3;
            }
        }
        c1 = c2;
    }
    w
}

/// First three derivatives at `t` of what `f` returns, from values at and after t: the right ones where something
/// begins at t, and nothing is asked for before.
pub(super) fn derivatives<E>(
    t: f64,
    mut f: impl FnMut(f64) -> Result<Vec<f64>, E>,
) -> Result<[Vec<f64>; 3], E> {
    let weights = weights();
    let here = f(t)?;
    let n = here.len();
    let mut best: [Vec<f64>; 3] = std::array::from_fn(|_| vec![0.0; n]);
    let mut change: [Vec<f64>; 3] = std::array::from_fn(|_| vec![f64::INFINITY; n]);
    let mut last: Option<[Vec<f64>; 3]> = None;
    for level in 1..=DISTANCES {
        let h = 0.125_f64.powi(level);
        let mut now: [Vec<f64>; 3] = std::array::from_fn(|_| vec![0.0; n]);
        for (j, w) in weights.iter().enumerate() {
            let values = if j == 0 { here.clone() } else { f(t + j as f64 * h)? };
            for (m, now) in now.iter_mut().enumerate() {
                for (now, x) in now.iter_mut().zip(&values) {
                    *now += w[m + 1] * x / h.powi(m as i32 + 1);
                }
            }
        }
        if let Some(last) = &last {
            for m in 0..3 {
                let weight: f64 = weights.iter().map(|w| w[m + 1].abs()).sum();
                for k in 0..n {
                    // No better than rounding, even where two values agree by chance.
                    let rounding = f64::EPSILON * here[k].abs() * weight / h.powi(m as i32 + 1);
                    let error = (now[m][k] - last[m][k]).abs().max(rounding);
                    if error < change[m][k] {
                        change[m][k] = error;
                        best[m][k] = now[m][k];
                    }
                }
            }
        }
        last = Some(now);
    }
    Ok(best)
}

impl System {
    /// Time and what signals see of it.
    pub(super) fn moment(&self, t: f64) -> Moment<'_> {
        let constants = match self.mode {
            Mode::Dynamic => 1.0,
            Mode::Static => t,
        };
        Moment {
            t,
            constants,
            inputs: &self.input_values,
            rates: (self.mode == Mode::Dynamic).then_some(&self.rates[..]),
            derivatives: &self.input_rates,
            integrals: &self.integrals,
            angles: &self.memory.last.angles,
            memory: &[],
        }
    }

    fn ask(&mut self, t: f64) -> Result<Vec<f64>, EvaluationError> {
        let mut values = self.memory.held.clone();
        if let Some(inputs) = self.inputs.as_mut() {
            let asked = inputs(t);
            values
                .extend(asked.map_err(|message| EvaluationError { message, recoverable: false })?);
        }
        Ok(values)
    }

    /// Asks the caller's functions of time, once for each time, and integrates up to there.
    pub(super) fn refresh_inputs(&mut self, t: f64) -> Result<(), EvaluationError> {
        if self.input_time == Some(t) {
            return Ok(());
        }
        if self.inputs.is_some() {
            self.input_values = self.ask(t)?;
        }
        self.integrate(t)?;
        self.input_time = Some(t);
        Ok(())
    }

    /// Integrals from the last accepted point to time t. An input that is set from outside goes from its old value to
    /// the new one over a step: the trapezoidal rule is exact. Other signals take five Gauss points.
    fn integrate(&mut self, t: f64) -> Result<(), EvaluationError> {
        let model = self.model.clone();
        if model.integrals.is_empty() {
            return Ok(());
        }
        let (start, held) = (self.memory.last.t, self.memory.held.len());
        let mut sums = self.memory.last.integrals.clone();
        let h = t - start;
        let dynamic = self.mode == Mode::Dynamic;
        let grows = |integral: &PlacedIntegral| dynamic || integral.in_statics;
        if h != 0.0 && model.integrals.iter().any(grows) {
            let is_held = |first: usize| first < held;
            for (k, integral) in model.integrals.iter().enumerate() {
                if grows(integral) && integral.rate.any_input(&is_held) {
                    let now = Moment { inputs: &self.input_values, ..Moment::at(t) };
                    let before = self.memory.last.rates[k];
                    sums[k] += 0.5 * h * (before + integral.rate.at(now)[0]);
                }
            }
            for (xi, weight) in GAUSS {
                let t = start + xi * h;
                let inputs = self.ask(t)?;
                let now = Moment { inputs: &inputs, ..Moment::at(t) };
                for (sum, integral) in sums.iter_mut().zip(&model.integrals) {
                    if grows(integral) && !integral.rate.any_input(&is_held) {
                        *sum += weight * h * integral.rate.at(now)[0];
                    }
                }
            }
        }
        self.integrals = sums;
        Ok(())
    }

    /// Differences the caller's functions of time, where drives depend on them.
    pub(super) fn refresh_rates(&mut self, t: f64) {
        if self.inputs.is_none() || !self.model.joints.iter().any(|j| j.joint.is_driven()) {
            return;
        }
        // A failing function of time fails in the residual, too.
        if let Ok(rates) = derivatives(t, |t| self.ask(t)) {
            self.input_rates = rates.into();
        }
    }

    /// Begins at time t and coordinates q: what joints remember there.
    pub fn begin(&mut self, t: f64, q: &[f64]) {
        let model = self.model.clone();
        let angles = model.freedoms.iter().map(|f| f.y.value(q)).collect();
        let first = |integral: &PlacedIntegral| match &integral.from {
            Beginning::Freedom(y) => y.value(q),
            Beginning::Mass(chamber) => model.chambers[*chamber].first_mass(q),
        };
        let integrals: Vec<f64> = model.integrals.iter().map(first).collect();
        let rates = vec![0.0; integrals.len()];
        let joints = vec![0.0; model.joint_memory];
        self.memory.last = Last { t, angles, integrals, rates, joints };
        self.input_time = None;
        // A failing function of time fails in the residual, too.
        let _ = self.refresh_inputs(t);
        let now = self.moment(t);
        let rates = model.integrals.iter().map(|i| i.rate.at(now)[0]).collect();
        let mut joints = vec![0.0; model.joint_memory];
        for joint in model.joints.iter().filter(|joint| !joint.memory.is_empty()) {
            joint.joint.begin(now, &mut joints[joint.memory.clone()]);
        }
        self.memory.last.rates = rates;
        self.memory.last.joints = joints;
        self.begin_past(t, q);
    }

    /// Remembers an accepted point.
    pub(super) fn remember(&mut self, at: Point<'_>) {
        let model = self.model.clone();
        if model.freedoms.is_empty() && model.integrals.is_empty() && model.joint_memory == 0 {
            return;
        }
        if self.refresh_inputs(at.t).is_err() {
            return;
        }
        let now = self.moment(at.t);
        let last_point = &self.memory.last;
        let angles = model.freedoms.iter().zip(&last_point.angles);
        let angles = angles.map(|(f, &last)| f.y.near(at.q, last)).collect();
        let mut joints = last_point.joints.clone();
        for joint in model.joints.iter().filter(|joint| !joint.memory.is_empty()) {
            let now = Moment { memory: &last_point.joints[joint.memory.clone()], ..now };
            joint.joint.remember(now, &mut joints[joint.memory.clone()]);
        }
        let rates = model.integrals.iter().map(|i| i.rate.at(now)[0]).collect();
        let integrals = self.integrals.clone();
        self.memory.last = Last { t: at.t, angles, integrals, rates, joints };
    }

    /// Appends what forces, drives, freedoms, chambers, winches, cables that yield and contacts show at the last
    /// accepted point.
    pub fn outputs(&self, at: Point<'_>, out: &mut Vec<f64>) {
        let now = self.moment(at.t);
        self.model.outputs(now, at.q, at.v, out);
        for (k, placed) in self.driven() {
            if !self.joints.is_engaged(k) {
                out.extend([0.0; 6]);
                continue;
            }
            let x: Vec<f64> = placed.joint.support().unknowns.iter().map(|&u| at.q[u]).collect();
            let lambda_ = &at.lambda_[placed.first..placed.first + placed.joint.equations()];
            let memory = self.memory.of(placed);
            let (force, moment) = placed.joint.reaction(Moment { memory, ..now }, &x, lambda_);
            out.extend(force);
            out.extend(moment);
        }
        out.extend(&self.memory.last.angles);
        self.chamber_outputs(at, out);
        out.extend(self.altered.lengths.iter().flatten());
        out.extend(&self.altered.past);
        self.show_contact(out);
    }

    /// Drives and their numbers.
    fn driven(&self) -> impl Iterator<Item = (usize, &PlacedJoint)> {
        self.model.joints.iter().enumerate().filter(|(_, placed)| placed.joint.is_driven())
    }

    /// Adds the generalized forces of the drives.
    pub(super) fn drive_forces(&self, at: Point<'_>, force: &mut [f64]) {
        let now = self.moment(at.t);
        for (_, placed) in self.driven().filter(|&(k, _)| self.joints.is_engaged(k)) {
            let unknowns = &placed.joint.support().unknowns;
            let x: Vec<f64> = unknowns.iter().map(|&u| at.q[u]).collect();
            let (n, m) = (x.len(), placed.joint.equations());
            let mut jacobian = vec![0.0; n * m];
            let memory = self.memory.of(placed);
            placed.joint.jacobian(Moment { memory, ..now }, &x, &mut jacobian);
            for (row, lambda_) in jacobian.chunks_exact(n).zip(&at.lambda_[placed.first..]) {
                for (&u, entry) in unknowns.iter().zip(row) {
                    force[u] -= entry * lambda_;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn functions_of_any_speed_are_differenced() {
        for omega in [0.3, 2.0, 60.0, 4000.0] {
            let t = 0.7;
            let sine = |t: f64| Ok::<_, ()>(vec![(omega * t).sin(), 3.0 + t]);
            let rates = derivatives(t, sine).unwrap();
            let (s, c) = (omega * t).sin_cos();
            let exact = [omega * c, -omega * omega * s, -omega.powi(3) * c];
            for (m, (exact, tolerance)) in exact.iter().zip([1e-9, 1e-6, 1e-3]).enumerate() {
                let error = (rates[m][0] - exact).abs() / omega.powi(m as i32 + 1);
                assert!(error < tolerance, "{omega}, {m}: {error:.1e}");
            }
            assert!((rates[0][1] - 1.0).abs() < 1e-11 && rates[2][1].abs() < 1e-6);
        }
    }

    #[test]
    fn a_kink_is_seen_from_the_right() {
        let ramp = |t: f64| Ok::<_, ()>(vec![if t < 1.0 { 0.0 } else { (t - 1.0) * (2.0 - t) }]);
        let rates = derivatives(1.0, ramp).unwrap();
        assert!((rates[0][0] - 1.0).abs() < 1e-10 && (rates[1][0] + 2.0).abs() < 1e-7);
    }
}
