//! A run in progress: steps, and what is recorded of them.

use crate::model::Model;
use crate::system::{Audit, Inputs, Mode, System};
use pliant_dae::error::Error;
use pliant_dae::generalized_alpha::{Integrator, Options, State};
use pliant_dae::initial::Consistent;
use pliant_dae::problem::EvaluationError;
use pliant_dae::statistics::Statistics;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// What was recorded: row after row of each array.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Records {
    /// Times [s], or load factors.
    pub time: Vec<f64>,
    /// Coordinates.
    pub q: Vec<f64>,
    /// Velocities.
    pub v: Vec<f64>,
    /// Accelerations.
    pub a: Vec<f64>,
    /// Multipliers.
    pub lambda_: Vec<f64>,
    /// Kinetic, elastic, gravitational, dissipated energy and work [J].
    pub energy: Vec<f64>,
}

impl Records {
    /// Adds a row.
    pub fn push(&mut self, model: &Model, state: &State, audit: Audit) {
        self.time.push(state.t);
        self.q.extend_from_slice(&state.q);
        self.v.extend_from_slice(&state.v);
        self.a.extend_from_slice(&state.a);
        self.lambda_.extend_from_slice(&state.lambda_);
        let [kinetic, elastic, gravitational] = model.energy(&state.q, &state.v);
        self.energy.extend([kinetic, elastic, gravitational, audit.dissipated, audit.work]);
    }
}

/// A run in progress.
pub struct Run {
    integrator: Integrator<System>,
    pool: Option<rayon::ThreadPool>,
    step: f64,
    steps: u64,
    start: Consistent,
    records: Records,
    balance: Balance,
}

/// Watches for energy from nowhere: a step that is too long for an undamped impact can gain without bound while
/// Newton's iteration converges well.
#[derive(Default)]
struct Balance {
    /// Mechanical energy less work at the start [J].
    start: Option<f64>,
    /// Elastic and gravitational energy at the start [J].
    potential: [f64; 2],
    /// Largest energy that was seen to change hands [J].
    scale: f64,
}

/// Part of the energy in play that may come from nowhere; a useful run stays below a hundredth of it.
const LARGEST_GAIN: f64 = 0.5;
/// Square of strains that are rounding: stiff lines at rest hum with as much.
const ROUNDING: f64 = 1e-20;

impl Balance {
    /// Checks kinetic, elastic and gravitational energy and work: damping only takes. Less than `rounding` [J] is none.
    fn check(
        &mut self,
        [kinetic, elastic, gravitational, work]: [f64; 4],
        rounding: f64,
    ) -> Result<(), String> {
        let total = kinetic + elastic + gravitational - work;
        let Some(start) = self.start else {
            self.start = Some(total);
            self.potential = [elastic, gravitational];
            self.scale = kinetic;
            return Ok(());
        };
        let [elastic_0, gravitational_0] = self.potential;
        let rise = (gravitational - gravitational_0).abs();
        let now = kinetic + elastic.max(elastic_0) + rise + work.abs();
        let gain = total - start;
        self.scale = self.scale.max(now);
        // Rounding in large energies that cancel is no gain.
        let floor = 1e-9 * (elastic_0.abs() + gravitational_0.abs()) + rounding;
        if gain <= LARGEST_GAIN * self.scale + floor {
            return Ok(());
        }
        Err(format!(
            "{gain:.3e} J have come from nowhere, of {:.3e} J in play: the step does not resolve this motion; take a \
             smaller step or spectral_radius, or give the material a retardation_time",
            self.scale
        ))
    }
}

/// How a run is made.
pub struct RunOptions {
    /// Nominal step [s].
    pub step: f64,
    /// Controls of the integrator.
    pub integrator: Options,
    /// Number of threads; the bits of a run do not depend on it.
    pub threads: usize,
}

impl Run {
    /// Starts at `q`, `v` (none: those of the model).
    ///
    /// # Errors
    /// Positions off the constraints, singular masses, or bad options.
    pub fn new(
        model: Arc<Model>,
        options: &RunOptions,
        q: Option<&[f64]>,
        v: Option<&[f64]>,
        inputs: Option<Inputs>,
    ) -> Result<Self, Error> {
        if !(options.step > 0.0 && options.step.is_finite()) {
            return Err(Error::Value { what: "step", expected: "above zero", got: options.step });
        }
        let pool = thread_pool(options.threads, &model);
        let parallel = pool.is_some();
        let system = System::new(model.clone(), Mode::Dynamic, inputs, parallel);
        let solver = model.solver(parallel)?;
        let q = q.unwrap_or(&model.initial_q);
        let v = v.unwrap_or(&model.initial_v);
        let begin = || Integrator::new(system, solver, options.integrator, 0.0, q, v);
        let (integrator, start) = match &pool {
            Some(pool) => pool.install(begin)?,
            None => begin()?,
        };
        let mut run = Self {
            integrator,
            pool,
            step: options.step,
            steps: 0,
            start,
            records: Records::default(),
            balance: Balance::default(),
        };
        run.record()?;
        Ok(run)
    }

    fn record(&mut self) -> Result<(), Error> {
        let system = self.integrator.problem();
        let state = self.integrator.state();
        self.records.push(system.model(), state, system.audit);
        let rounding = ROUNDING * system.model().axial_energy;
        let row = &self.records.energy[self.records.energy.len() - 5..];
        let t = state.t;
        self.balance.check([row[0], row[1], row[2], row[4]], rounding).map_err(|message| {
            Error::Evaluation { t, source: EvaluationError { message, recoverable: false } }
        })
    }

    /// Takes up to `steps` steps, records every `output_every`-th counted from the start, and stops after about
    /// `limit` of wall time. Returns the number taken.
    ///
    /// # Errors
    /// The step that failed; the state is the one before it, and what was recorded stays.
    pub fn advance(
        &mut self,
        steps: u64,
        output_every: u64,
        limit: Duration,
    ) -> Result<u64, Error> {
        let begin = Instant::now();
        for taken in 0..steps {
            if taken > 0 && begin.elapsed() >= limit {
                return Ok(taken);
            }
            let Self { integrator, pool, step, .. } = self;
            match pool {
                Some(pool) => pool.install(|| integrator.advance(*step))?,
                None => integrator.advance(*step)?,
            };
            self.steps += 1;
            if self.steps.is_multiple_of(output_every.max(1)) {
                self.record()?;
            }
        }
        Ok(steps)
    }

    /// What was recorded since the last call.
    pub fn take_records(&mut self) -> Records {
        std::mem::take(&mut self.records)
    }

    /// The state reached.
    #[must_use]
    pub fn state(&self) -> &State {
        self.integrator.state()
    }

    /// Cost so far.
    #[must_use]
    pub fn statistics(&self) -> &Statistics {
        self.integrator.statistics()
    }

    /// How the start was made consistent.
    #[must_use]
    pub fn start(&self) -> &Consistent {
        &self.start
    }

    /// Description of the linear solver.
    #[must_use]
    pub fn describe_solver(&self) -> String {
        self.integrator.solver().describe()
    }
}

/// Elements for each further thread, below which handing over costs more than it gains.
const ELEMENTS_PER_THREAD: usize = 2000;

/// A pool for more than one thread where the model is worth it. Where none can be had the run is serial, with the
/// same bits.
fn thread_pool(threads: usize, model: &Model) -> Option<rayon::ThreadPool> {
    let threads = threads.min(model.elements() / ELEMENTS_PER_THREAD);
    if threads < 2 {
        return None;
    }
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn energy_may_change_hands_but_not_come_from_nowhere() {
        let mut balance = Balance::default();
        // Ten joules fall, stretch and are spent; loads do work.
        for [kinetic, elastic, gravitational, work] in [
            [0.0, 0.0, 10.0, 0.0],
            [9.0, 1.0, 0.0, 0.0],
            [0.0, 10.1, 0.0, 0.0],
            [2.0, 0.0, 0.0, 0.0],
            [102.0, 0.0, 0.0, 100.0],
            [0.0, 0.0, 0.0, -2.0],
        ] {
            balance.check([kinetic, elastic, gravitational, work], 0.0).unwrap();
        }
        let message = balance.check([500.0, 0.0, 0.0, 100.0], 0.0).unwrap_err();
        assert!(message.contains("3.900e2 J have come from nowhere"), "{message}");
    }

    #[test]
    fn equilibrium_under_great_stress_is_not_disturbed_by_rounding() {
        let mut balance = Balance::default();
        balance.check([0.0, 1e6, 1e6, 0.0], 0.0).unwrap();
        balance.check([1e-9, 1e6, 1e6 + 1e-6, 0.0], 0.0).unwrap();
        let mut still = Balance::default();
        still.check([0.0; 4], 1e-15).unwrap();
        still.check([1e-16, 1e-16, 0.0, 0.0], 1e-15).unwrap();
    }
}
