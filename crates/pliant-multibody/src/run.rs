//! A run in progress: steps, and what is recorded of them.

use crate::checkpoint::Saved;
use crate::contact_coupling::memory::PatchRecord;
use crate::error::ModelError;
use crate::latches::{Scheduled, Switch};
use crate::memory::Memory;
use crate::model::Model;
use crate::system::{Inputs, Mode, System};
use pliant_dae::error::Error;
use pliant_dae::generalized_alpha::{Integrator, Options, State};
use pliant_dae::initial::Consistent;
use pliant_dae::linear_solver::LinearSolver;
use pliant_dae::problem::EvaluationError;
use pliant_dae::statistics::Statistics;
use pliant_dae::step_control::StepControl;
use serde::{Deserialize, Serialize};
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
    /// Inputs that are set from outside.
    pub inputs: Vec<f64>,
    /// What the forces show.
    pub outputs: Vec<f64>,
    /// For each row how many of the switches of the run lie before it.
    pub switches: Vec<f64>,
    /// For each row how many of the patches belong to it.
    pub touching: Vec<f64>,
    /// Where bodies touch, see [`PatchRecord`].
    pub patches: Vec<PatchRecord>,
    /// What joints were made to do since the start.
    pub history: Vec<Switch>,
}

impl Records {
    /// Adds a row.
    pub fn push(&mut self, system: &System, state: &State, lambda_: &[f64]) {
        let memory = system.memory();
        self.time.push(state.t);
        self.switches.push(memory.history.len() as f64);
        self.q.extend_from_slice(&state.q);
        self.v.extend_from_slice(&state.v);
        self.a.extend_from_slice(&state.a);
        self.lambda_.extend_from_slice(lambda_);
        let [kinetic, elastic, gravitational] = system.energy(state.t, &state.q, &state.v);
        let audit = memory.audit;
        self.energy.extend([kinetic, elastic, gravitational, audit.dissipated, audit.work]);
        self.inputs.extend_from_slice(&memory.held);
        system.outputs(state.point(), &mut self.outputs);
        let before = self.patches.len();
        self.patches.extend(memory.contact.records(system.model().contacts.list.len()));
        self.touching.push((self.patches.len() - before) as f64);
    }
}

/// A run in progress.
pub struct Run {
    integrator: Integrator<System>,
    pool: Option<rayon::ThreadPool>,
    steps: u64,
    records: Records,
    balance: Balance,
    /// For sharing multipliers out, where equations are redundant.
    sharing: Option<Box<dyn LinearSolver>>,
}

/// Watches for energy from nowhere: a step that is too long for an undamped impact can gain without bound while
/// Newton's iteration converges well.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Balance {
    /// Mechanical energy at the start [J].
    start: f64,
    /// Elastic and gravitational energy at the start [J].
    potential: [f64; 2],
    /// Largest energy that was seen to change hands [J].
    scale: f64,
}

/// Part of the energy in play that may come from nowhere; a useful run stays below a hundredth of it.
const LARGEST_GAIN: f64 = 0.5;
/// Steps after which energy is looked at where nothing is recorded.
const CHECKED: u64 = 100;

impl Balance {
    /// Notes kinetic, elastic and gravitational energy at the start.
    fn begin(&mut self, [kinetic, elastic, gravitational]: [f64; 3]) {
        self.start = kinetic + elastic + gravitational;
        self.potential = [elastic, gravitational];
        self.scale = kinetic;
    }

    /// Checks kinetic, elastic and gravitational energy and work: damping only takes. Less than `rounding` [J] is none.
    fn check(
        &mut self,
        [kinetic, elastic, gravitational, work]: [f64; 4],
        rounding: f64,
    ) -> Result<(), String> {
        let total = kinetic + elastic + gravitational - work;
        let [elastic_0, gravitational_0] = self.potential;
        let rise = (gravitational - gravitational_0).abs();
        let now = kinetic + elastic.max(elastic_0) + rise + work.abs();
        let gain = total - self.start;
        self.scale = self.scale.max(now);
        if gain <= LARGEST_GAIN * self.scale + rounding {
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
    /// Controls of the integrator.
    pub integrator: Options,
    /// Number of threads; the bits of a run do not depend on it.
    pub threads: usize,
}

/// Where a run begins, and what acts on it from outside.
#[derive(Default)]
pub struct Start<'a> {
    /// Coordinates; none: those of the model.
    pub q: Option<&'a [f64]>,
    /// Velocities; none: those of the model.
    pub v: Option<&'a [f64]>,
    /// Inputs that are set from outside, in the order of their numbers.
    pub held: &'a [f64],
    /// Inputs that are functions of time; their numbers follow.
    pub inputs: Option<Inputs>,
}

/// Steps to be taken.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Leg {
    /// Number of steps.
    pub steps: u64,
    /// Nominal step [s].
    pub step: f64,
    /// Time at which the last of them ends exactly [s], where that is to be more exact than rounding.
    pub end: Option<f64>,
    /// Every so manieth step is recorded, counted from the start; 0: none.
    pub output_every: u64,
}

/// Part of a step within which an event and a step's end are one.
const SNAP: f64 = 1e-6;
/// Residual, in units of its scale, at which an equation that was left out is needed again.
const LARGEST_DRIFT: f64 = 1e-9;

fn refused(t: f64, error: &ModelError) -> Error {
    let message = error.to_string();
    Error::Evaluation { t, source: EvaluationError { message, recoverable: false } }
}

/// Steps whose length the accuracy decides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FreeLeg {
    /// Time at which they end exactly [s]; infinity: nowhere.
    pub end: f64,
    /// Largest number of them.
    pub steps: u64,
    /// Accuracy and limits.
    pub control: StepControl,
    /// Every so manieth step is recorded, counted from the start; 0: none.
    pub output_every: u64,
}

/// `work`, on the threads of a pool where there is one.
fn on<T: Send>(pool: Option<&rayon::ThreadPool>, work: impl FnOnce() -> T + Send) -> T {
    match pool {
        Some(pool) => pool.install(work),
        None => work(),
    }
}

impl Run {
    /// Begins at time 0; returns how the start was made consistent, too.
    ///
    /// # Errors
    /// Positions off the constraints, singular masses, or bad options.
    pub fn new(
        model: Arc<Model>,
        options: &RunOptions,
        start: Start<'_>,
    ) -> Result<(Self, Consistent), Error> {
        let memory = Memory::new(start.held);
        let q = start.q.unwrap_or(&model.initial_q).to_vec();
        let v = start.v.unwrap_or(&model.initial_v).to_vec();
        let (pool, mut system, solver) = prepare(model, options, start.inputs, memory)?;
        system.begin(0.0, &q);
        while let Some(event) = system.next_event().filter(|event| event.t <= 0.0) {
            let switched = system.switch(event, &q);
            switched.map_err(|error| refused(0.0, &error))?;
            system.skip_event();
        }
        let (mut integrator, start) =
            on(pool.as_ref(), || Integrator::new(system, solver, options.integrator, 0.0, &q, &v))?;
        let here = integrator.state().clone();
        integrator.problem_mut().note_loads(here.point());
        let mut balance = Balance::default();
        let energy = integrator.problem().energy(0.0, &q, &integrator.state().v);
        balance.begin(energy);
        let records = Records::default();
        Ok((Self { integrator, pool, steps: 0, records, balance, sharing: None }, start))
    }

    /// Continues where a run was saved, with the same bits as if it had never stopped.
    ///
    /// # Errors
    /// A state of another model, or bad options.
    pub fn resume(
        model: Arc<Model>,
        options: &RunOptions,
        saved: Saved,
        inputs: Option<Inputs>,
    ) -> Result<Self, Error> {
        let Saved { state, memory, statistics, steps, balance } = saved;
        memory.check(&model, memory.held.len())?;
        let (pool, system, solver) = prepare(model, options, inputs, memory.at_tangent())?;
        let mut integrator =
            on(pool.as_ref(), || Integrator::resume(system, solver, options.integrator, state))?;
        integrator.problem_mut().set_memory(memory);
        integrator.set_statistics(statistics);
        let records = Records::default();
        Ok(Self { integrator, pool, steps, records, balance, sharing: None })
    }

    /// Goes back to where it was saved, and forgets what was recorded; counters go on.
    ///
    /// # Errors
    /// A state of another model; nothing has changed then.
    pub fn reset(&mut self, saved: Saved) -> Result<(), Error> {
        let Saved { state, memory, steps, balance, .. } = saved;
        let here = self.integrator.problem().memory().clone();
        memory.check(self.integrator.problem().model(), here.held.len())?;
        let Self { integrator, pool, .. } = self;
        integrator.problem_mut().set_memory(memory.at_tangent());
        let outcome = on(pool.as_ref(), || integrator.reset(state));
        integrator.problem_mut().set_memory(if outcome.is_ok() { memory } else { here });
        outcome?;
        self.steps = steps;
        self.balance = balance;
        self.records = Records::default();
        Ok(())
    }

    /// Time of the next scheduled event, no earlier than now: a step must end there.
    #[must_use]
    pub fn next_event(&self) -> Option<f64> {
        self.integrator.problem().next_event().map(|event| event.t.max(self.state().t))
    }

    /// Brings about all events scheduled up to the time `until`.
    ///
    /// # Errors
    /// As [`Self::switch`].
    pub fn pass_events(&mut self, until: f64) -> Result<(), Error> {
        let mut due = Vec::new();
        let events = self.integrator.problem().memory().events;
        let schedule = &self.integrator.problem().model().schedule;
        due.extend(schedule[events..].iter().take_while(|event| event.t <= until));
        self.switch_all(&due)?;
        for _ in &due {
            self.integrator.problem_mut().skip_event();
        }
        Ok(())
    }

    /// Engages or releases a joint now. What engages brings about an impact, whose loss of energy is added to what was
    /// dissipated.
    ///
    /// # Errors
    /// No such joint, points too far apart, contradictory constraints; nothing has changed then.
    pub fn switch(&mut self, joint: usize, engage: bool, gap: Option<f64>) -> Result<(), Error> {
        let joints = self.integrator.problem().model().latches.len();
        if joint >= joints {
            return Err(Error::Length { what: "joints", expected: joints, got: joint });
        }
        self.switch_all(&[Scheduled { t: self.state().t, joint, engage, gap }])
    }

    fn switch_all(&mut self, events: &[Scheduled]) -> Result<(), Error> {
        let kept = self.integrator.problem().memory().clone();
        let state = self.integrator.state().clone();
        let outcome = self.try_switch(events);
        if outcome.is_err() {
            self.integrator.problem_mut().set_memory(kept.at_tangent());
            let Self { integrator, pool, .. } = self;
            on(pool.as_ref(), || integrator.reset(state))?;
            self.integrator.problem_mut().set_memory(kept);
        }
        outcome
    }

    fn try_switch(&mut self, events: &[Scheduled]) -> Result<(), Error> {
        let Self { integrator, pool, .. } = self;
        let changes = |integrator: &Integrator<System>| {
            events.iter().any(|event| !integrator.problem().is_already(event))
        };
        if !changes(integrator) {
            return Ok(());
        }
        on(pool.as_ref(), || {
            integrator.settle()?;
            let before = integrator.state().clone();
            for event in events {
                let switched = integrator.problem_mut().switch(*event, &before.q);
                switched.map_err(|error| refused(before.t, &error))?;
            }
            integrator.restart()?;
            let after = integrator.state().v.clone();
            integrator.problem_mut().note_impact(&before.q, &before.v, &after);
            Ok(())
        })
    }

    /// A nominal step to `end`, or of length `step`, in parts where events lie within it.
    ///
    /// An event within [`SNAP`] of a step's end moves that end, so that no part is too short to be computed; an end
    /// that was asked for stays, and such an event happens there.
    fn nominal_step(&mut self, end: Option<f64>, step: f64) -> Result<(), Error> {
        let near = SNAP * step;
        self.pass_events(self.state().t + near)?;
        let finish = match end {
            Some(end) => end,
            None => self.integrator.nominal_end(step),
        };
        if self.next_event().is_none_or(|event| event > finish + near) {
            let Self { integrator, pool, .. } = self;
            on(pool.as_ref(), || integrator.advance_to(end, step))?;
            return self.check_drift();
        }
        while let Some(event) = self.next_event().filter(|&t| t < finish - near) {
            let Self { integrator, pool, .. } = self;
            on(pool.as_ref(), || integrator.advance_part(event, false))?;
            self.check_drift()?;
            self.pass_events(event)?;
        }
        let due = self.next_event().filter(|&t| t <= finish + near);
        let finish = end.or(due).unwrap_or(finish);
        let Self { integrator, pool, .. } = self;
        on(pool.as_ref(), || integrator.advance_part(finish, true))?;
        self.check_drift()?;
        self.pass_events(finish + near)
    }

    /// Takes equations that were left out because they followed from others in again where they do so no longer.
    fn check_drift(&mut self) -> Result<(), Error> {
        let state = self.integrator.state();
        if let Some(message) = self.integrator.problem().strayed(&state.q) {
            let source = EvaluationError { message, recoverable: false };
            return Err(Error::Evaluation { t: state.t, source });
        }
        if self.integrator.problem().drift(state.t, &state.q) > LARGEST_DRIFT {
            let Self { integrator, pool, .. } = self;
            on(pool.as_ref(), || integrator.restart_on_constraints())?;
        }
        Ok(())
    }

    /// The multipliers of the present state, shared out where equations are redundant.
    fn multipliers(&mut self) -> Vec<f64> {
        let Self { integrator, sharing, .. } = self;
        let (t, q) = (integrator.state().t, integrator.state().q.clone());
        let mut lambda_ = integrator.state().lambda_.clone();
        let system = integrator.problem_mut();
        if !system.memory().redundant.is_empty() {
            if sharing.is_none() {
                *sharing = system.model().solver(false).ok();
            }
            if let Some(solver) = sharing {
                system.smallest_multipliers(solver.as_mut(), t, &q, &mut lambda_);
            }
        }
        lambda_
    }

    /// What a continuation needs.
    #[must_use]
    pub fn save(&self) -> Saved {
        Saved {
            state: self.integrator.state().clone(),
            memory: self.integrator.problem().memory().clone(),
            statistics: self.integrator.statistics().clone(),
            steps: self.steps,
            balance: self.balance,
        }
    }

    /// Sets inputs from number `first` on; see [`System::set_held`].
    ///
    /// # Errors
    /// More values than inputs.
    pub fn set_inputs(&mut self, first: usize, values: &[f64]) -> Result<(), Error> {
        self.integrator.problem_mut().set_held(first, values)
    }

    /// Records the present state.
    ///
    /// # Errors
    /// Energy from nowhere; the state is recorded all the same.
    pub fn record(&mut self) -> Result<(), Error> {
        self.look();
        let lambda_ = self.multipliers();
        let system = self.integrator.problem();
        let state = self.integrator.state();
        self.records.push(system, state, &lambda_);
        let row = &self.records.energy[self.records.energy.len() - 5..];
        let energy = [row[0], row[1], row[2], row[4]];
        self.check_balance(energy)
    }

    /// Refuses a state with energy from nowhere.
    fn check_energy(&mut self) -> Result<(), Error> {
        self.look();
        let (system, state) = (self.integrator.problem(), self.integrator.state());
        let [kinetic, elastic, gravitational] = system.energy(state.t, &state.q, &state.v);
        self.check_balance([kinetic, elastic, gravitational, system.memory().audit.work])
    }

    /// The same for kinetic, elastic and gravitational energy, and work.
    fn check_balance(&mut self, energy: [f64; 4]) -> Result<(), Error> {
        let [elastic, gravitational] = self.balance.potential;
        let rounding = self.integrator.problem().model().rounding_of_energy(elastic, gravitational);
        let t = self.integrator.state().t;
        self.balance.check(energy, rounding).map_err(|message| {
            let source = EvaluationError { message, recoverable: false };
            Error::Evaluation { t, source }
        })
    }

    /// The present state as one row.
    #[must_use]
    pub fn present(&mut self) -> Records {
        self.look();
        let lambda_ = self.multipliers();
        let history = self.integrator.problem().memory().history.clone();
        let mut row = Records { history, ..Records::default() };
        row.push(self.integrator.problem(), self.integrator.state(), &lambda_);
        row
    }

    /// Makes inputs those of the present time.
    fn look(&mut self) {
        let t = self.integrator.state().t;
        self.integrator.problem_mut().look_at(t);
    }

    /// Takes the steps of `leg`, and stops after about `limit` of wall time. Returns the number taken.
    ///
    /// # Errors
    /// The step that failed; the state is the one before it, and what was recorded stays.
    pub fn advance(&mut self, leg: Leg, limit: Duration) -> Result<u64, Error> {
        let begin = Instant::now();
        for taken in 0..leg.steps {
            if taken > 0 && begin.elapsed() >= limit {
                return Ok(taken);
            }
            let end = leg.end.filter(|_| taken + 1 == leg.steps);
            self.nominal_step(end, leg.step)?;
            self.steps += 1;
            if leg.output_every > 0 && self.steps.is_multiple_of(leg.output_every) {
                self.record()?;
            } else if leg.output_every == 0 && self.steps.is_multiple_of(CHECKED) {
                self.check_energy()?;
            }
        }
        Ok(leg.steps)
    }

    /// Takes the steps of `leg`, and stops after about `limit` of wall time. Events and kinks of loads are met exactly, too.
    /// Returns the number taken.
    ///
    /// # Errors
    /// As [`Self::advance`].
    pub fn advance_freely(&mut self, leg: FreeLeg, limit: Duration) -> Result<u64, Error> {
        let begin = Instant::now();
        for taken in 0..leg.steps {
            let t = self.integrator.state().t;
            if t >= leg.end || taken > 0 && begin.elapsed() >= limit {
                return Ok(taken);
            }
            self.pass_events(t)?;
            let stop = leg.end.min(self.integrator.problem().model().next_break(t));
            let stop = self.next_event().map_or(stop, |event| event.min(stop));
            let Self { integrator, pool, .. } = self;
            on(pool.as_ref(), || integrator.advance_within(stop, &leg.control))?;
            self.check_drift()?;
            self.pass_events(self.state().t)?;
            self.steps += 1;
            if leg.output_every > 0 && self.steps.is_multiple_of(leg.output_every) {
                self.record()?;
            }
        }
        Ok(leg.steps)
    }

    /// What was recorded since the last call.
    pub fn take_records(&mut self) -> Records {
        let history = self.integrator.problem().memory().history.clone();
        Records { history, ..std::mem::take(&mut self.records) }
    }

    /// The size that errors of positions are measured against [m].
    #[must_use]
    pub fn size(&self) -> f64 {
        self.integrator.problem().model().size()
    }

    /// Steps taken since the start.
    #[must_use]
    pub fn steps(&self) -> u64 {
        self.steps
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

    /// Description of the linear solver.
    #[must_use]
    pub fn describe_solver(&self) -> String {
        self.integrator.solver().describe()
    }
}

/// The pool, the problem and the solver of a run.
type Parts = (Option<rayon::ThreadPool>, System, Box<dyn LinearSolver>);

/// Makes the parts of a run.
fn prepare(
    model: Arc<Model>,
    options: &RunOptions,
    inputs: Option<Inputs>,
    memory: Memory,
) -> Result<Parts, Error> {
    let pool = thread_pool(options.threads, &model);
    let parallel = pool.is_some();
    let solver = model.solver(parallel)?;
    let mut system = System::new(model, Mode::Dynamic, inputs, parallel);
    system.set_memory(memory);
    Ok((pool, system, solver))
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
        balance.begin([0.0, 0.0, 10.0]);
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
        balance.begin([0.0, 1e6, 1e6]);
        balance.check([1e-9, 1e6, 1e6 + 1e-6, 0.0], 0.0).unwrap();
        let mut still = Balance::default();
        still.check([1e-16, 1e-16, 0.0, 0.0], 1e-15).unwrap();
    }
}
