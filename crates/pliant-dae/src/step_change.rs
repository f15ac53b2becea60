//! What a change of step does to the velocities and algorithmic accelerations.
//!
//! Discrete positions lie on the constraints, discrete velocities do not: they carry `c h^2` times the part of the
//! jerk normal to the constraints, and `a_alg` belongs to the time `t + Delta h`. Both depend on the step. Values
//! prepared for another step (or the exact ones, at the start) reduce the order of the multipliers to one (Arnold,
//! Bruls & Cardona 2015), so they are corrected before the first step of a new length.
//!
//! The normal jerk is the kinematic one, from the constraints' third derivative: differences of accelerations
//! would feed the multipliers' noise back and grow without bound.

use crate::error::Error;
use crate::initial::{consistent_acceleration, normal_component, normal_components};
use crate::integrator::Integrator;
use crate::problem::{Problem, Weights};
use crate::scaling::weighted_max;

/// Velocities and algorithmic accelerations before they were prepared for a new step.
#[derive(Clone, Debug, Default)]
pub(crate) struct Saved {
    v: Vec<f64>,
    a: Vec<f64>,
    a_alg: Vec<f64>,
    h: f64,
}

/// Part of the velocities by which they may change with the accelerations' change over a step that follows a shorter
/// one.
const UNRESOLVED: f64 = 0.05;
/// Time over which the initial jerk is measured, in steps.
const JERK_SPAN: f64 = 0.1;

impl<P: Problem> Integrator<P> {
    /// Corrects velocities and algorithmic accelerations for a first step of length `h`.
    pub(crate) fn prepare(&mut self, h: f64) -> Result<(), Error> {
        let saved = &mut self.work.saved;
        saved.v.clone_from(&self.state.v);
        saved.a.clone_from(&self.state.a);
        saved.a_alg.clone_from(&self.state.a_alg);
        saved.h = self.state.h;
        let outcome = self.correct(h);
        if outcome.is_err() {
            self.undo_prepare();
        }
        outcome
    }

    /// Takes the last [`Self::prepare`] back.
    pub(crate) fn undo_prepare(&mut self) {
        let saved = &self.work.saved;
        self.state.v.clone_from(&saved.v);
        self.state.a.clone_from(&saved.a);
        self.state.a_alg.clone_from(&saved.a_alg);
        self.state.h = saved.h;
    }

    fn correct(&mut self, h: f64) -> Result<(), Error> {
        if self.state.h == 0.0 {
            self.correct_start(h)?;
        } else {
            self.correct_change(h)?;
        }
        self.state.h = h;
        Ok(())
    }

    fn correct_start(&mut self, h: f64) -> Result<(), Error> {
        let shift = self.coefficients.shift();
        let factor = h * h * self.coefficients.error_constant();
        let dv = self.normal_velocity_correction(factor)?;
        let jerk = self.initial_jerk(JERK_SPAN * h)?;
        self.settle_acceleration(h)?;
        if self.is_resolved(&jerk, &dv, factor, h) {
            for (a_alg, j) in self.state.a_alg.iter_mut().zip(&jerk) {
                *a_alg += shift * h * j;
            }
        }
        for (v, d) in self.state.v.iter_mut().zip(&dv) {
            *v += d;
        }
        Ok(())
    }

    /// Along the constraints `a_alg` moves by the difference of accelerations; normal to them all is known from the
    /// motion itself, and set. So whatever noise the multipliers had is gone.
    fn correct_change(&mut self, h: f64) -> Result<(), Error> {
        let shift = self.coefficients.shift();
        if self.outgrows(h) {
            self.state.factor.h = 0.0;
            self.settle_acceleration(h)?;
        } else {
            let state = &mut self.state;
            let factor = shift * (h - state.h) / state.h;
            let changes = state.a.iter().zip(&state.a_previous);
            for (a_alg, (a, a_previous)) in state.a_alg.iter_mut().zip(changes) {
                *a_alg += factor * (a - a_previous);
            }
        }
        let state = &mut self.state;
        let m = self.problem.multipliers();
        if m == 0 {
            return Ok(());
        }
        // phi_q j and phi_q a; phi_q v is -phi_t up to what positions on the constraints ask for.
        let (mut jerk, mut acceleration) = (vec![0.0; m], vec![0.0; m]);
        self.problem.constraint_jerk(state.point(), &mut jerk);
        self.problem.constraint_acceleration(state.point(), &mut acceleration);
        let mut rate = vec![0.0; m];
        self.problem.constraint_rate(state.t, &state.q, &mut rate);
        let c = self.coefficients.error_constant();
        for (rate, jerk) in rate.iter_mut().zip(&jerk) {
            *rate += c * h * h * jerk;
        }
        let mut v = state.v.clone();
        if !self.problem.is_flat() {
            let mut bracket = vec![0.0; v.len()];
            self.problem.commutator(&state.v, &state.a, &mut bracket);
            for (v, b) in v.iter_mut().zip(&bracket) {
                *v -= h * h / 12.0 * b;
            }
        }
        let later: Vec<f64> =
            acceleration.iter().zip(&jerk).map(|(a, j)| a + shift * h * j).collect();
        // The solver serves the iteration matrix as well: what it held is lost.
        state.factor.h = 0.0;
        self.statistics.factorizations += 1;
        let wrong = normal_components(
            &mut self.problem,
            self.solver.as_mut(),
            state.t,
            &state.q,
            [(&v, &rate), (&state.a, &acceleration), (&state.a_alg, &later)],
        )?;
        for (right, wrong) in [&mut state.v, &mut state.a, &mut state.a_alg].into_iter().zip(&wrong)
        {
            for (right, wrong) in right.iter_mut().zip(wrong) {
                *right -= wrong;
            }
        }
        Ok(())
    }

    /// Whether accelerations change by as much as themselves within a step that is longer than the last one, and
    /// velocities by a part of themselves: what short steps have seen of a blow, carried on over a long one, would
    /// make energy.
    fn outgrows(&self, h: f64) -> bool {
        let state = &self.state;
        if h <= state.h {
            return false;
        }
        let weight = &self.work.inverse_scale;
        let size = |x: &[f64]| weighted_max(x, weight);
        let change: Vec<f64> = state.a.iter().zip(&state.a_previous).map(|(a, b)| a - b).collect();
        let change = h / state.h * size(&change);
        change > size(&state.a) && h * change > UNRESOLVED * size(&state.v)
    }

    /// `factor P_n (j + [v, a] / (12 c))`, the commutator being the part of the local error that curved
    /// configuration spaces add (empty without constraints).
    pub(crate) fn normal_velocity_correction(&mut self, factor: f64) -> Result<Vec<f64>, Error> {
        let m = self.problem.multipliers();
        if m == 0 {
            return Ok(Vec::new());
        }
        let c = self.coefficients.error_constant();
        let state = &self.state;
        let mut jerk = vec![0.0; m];
        self.problem.constraint_jerk(state.point(), &mut jerk);
        for j in &mut jerk {
            *j *= -factor;
        }
        let mut bracket = vec![0.0; state.v.len()];
        if !self.problem.is_flat() {
            self.problem.commutator(&state.v, &state.a, &mut bracket);
            for b in &mut bracket {
                *b *= factor / (12.0 * c);
            }
        }
        // The solver serves the iteration matrix as well: what it held is lost.
        self.state.factor.h = 0.0;
        self.statistics.factorizations += 1;
        let state = &self.state;
        normal_component(
            &mut self.problem,
            self.solver.as_mut(),
            state.t,
            &state.q,
            &bracket,
            &jerk,
        )
    }

    /// Third derivative of the positions: a central difference of consistent accelerations along the motion, and
    /// a forward one in time (loads may begin at the start).
    fn initial_jerk(&mut self, e: f64) -> Result<Vec<f64>, Error> {
        self.state.factor.h = 0.0;
        let state = &self.state;
        let n = state.v.len();
        let mut q = state.q.clone();
        let mut v = state.v.clone();
        let mut step = vec![0.0; n];
        let mut along = |dt: f64, e: f64| {
            for i in 0..n {
                step[i] = e * state.v[i] + 0.5 * e * e * state.a[i];
                v[i] = state.v[i] + e * state.a[i];
            }
            self.problem.retract(&state.q, &step, &mut q);
            consistent_acceleration(&mut self.problem, self.solver.as_mut(), state.t + dt, &q, &v)
                .map(|(a, _)| a)
        };
        let later = along(e, 0.0)?;
        let mut jerk: Vec<f64> = later.iter().zip(&state.a).map(|(b, a)| (b - a) / e).collect();
        self.statistics.factorizations += 1;
        if state.v.iter().any(|&v| v != 0.0) {
            let (ahead, behind) = (along(0.0, e)?, along(0.0, -e)?);
            for ((j, b), a) in jerk.iter_mut().zip(&ahead).zip(&behind) {
                *j += 0.5 * (b - a) / e;
            }
            self.statistics.factorizations += 2;
        }
        Ok(jerk)
    }

    /// Takes out of the accelerations what the step cannot resolve: `(M + beta h^2 K) a1 = M a`, with the
    /// constraints' accelerations kept.
    ///
    /// Let go, a stiff structure accelerates its stiffest parts at once (the slopes beside a support, in a fine
    /// mesh), though they come to rest within a fraction of the step. Taken over it, that acceleration throws
    /// them far from where they belong; damped by the scheme alone, it rings on for many steps. What the step resolves
    /// changes by its square, the order of the scheme.
    fn settle_acceleration(&mut self, h: f64) -> Result<(), Error> {
        let n = self.state.v.len();
        let beta = self.coefficients.beta;
        let mass = Weights { mass: 1.0, damping: 0.0, stiffness: 0.0, jacobian: 0.0 };
        let settled = Weights { stiffness: beta * h * h, jacobian: 1.0, ..mass };
        let Self { problem, solver, state, work, .. } = self;
        let at = state.point();
        let mut a = at.a.to_vec();
        a.resize(n + at.lambda_.len(), 0.0);
        let x = &mut work.x;
        x.fill(0.0);
        problem.tangent(at, mass, &mut work.values);
        problem.structure().multiply_add(&work.values, &a, x, false);
        problem.constraint_acceleration(at, &mut x[n..]);
        for remainder in &mut x[n..] {
            *remainder = -*remainder;
        }
        problem.tangent(at, settled, &mut work.values);
        self.statistics.factorizations += 1;
        let factored = solver.factor(problem.structure(), &work.values);
        if factored.is_err() {
            // An unstable start: nothing to settle to.
            return Ok(());
        }
        solver.solve(x);
        if x.iter().all(|x| x.is_finite()) {
            state.a.copy_from_slice(&x[..n]);
            state.a_alg.copy_from_slice(&x[..n]);
        }
        Ok(())
    }

    /// Whether the step is short against the fastest motion that the start excites; else the jerk says nothing
    /// about the step, and the scheme's own damping does better without it. What constraints ask for (`dv` is `factor`
    /// times the jerk normal to them) is no such motion: a drive may begin from rest.
    fn is_resolved(&self, jerk: &[f64], dv: &[f64], factor: f64, h: f64) -> bool {
        let weight = &self.work.inverse_scale;
        let size = |x: &[f64]| weighted_max(x, weight);
        let still = size(&self.state.a).max(size(&self.state.v) / h);
        if dv.is_empty() {
            return h * size(jerk) <= still;
        }
        let free: Vec<f64> = jerk.iter().zip(dv).map(|(j, d)| j - d / factor).collect();
        h * size(&free) <= still.max(h * weighted_max(dv, weight) / factor.abs())
    }
}
