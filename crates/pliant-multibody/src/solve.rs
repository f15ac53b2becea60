//! Equilibria and modes of a model.

use crate::model::Model;
use crate::run::Records;
use crate::system::{Inputs, Mode, System};
use pliant_dae::error::Error;
use pliant_dae::generalized_alpha::State;
use pliant_dae::modes::{ModeOptions, solve_modes};
use pliant_dae::problem::{Point, Problem};
use pliant_dae::redundancy::leave_out_dependent;
use pliant_dae::statics::{self, solve_static};
use std::sync::Arc;

/// Controls of [`statics()`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StaticOptions {
    /// Number of load increments, each cut and grown as needed.
    pub load_steps: usize,
    /// Newton's tolerance, in units of the model's size; none: down to rounding.
    pub tolerance: Option<f64>,
    /// Leave unstable equilibria for stable ones.
    pub stable: bool,
}

/// Equilibria along the load.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Path {
    /// Those at the load factors reached.
    pub records: Records,
    /// Load factors at which they are unstable.
    pub unstable: Vec<f64>,
}

/// Equilibria at the load factors reached, the last at 1, and whether the search got there: on failure (no
/// equilibrium, something that floats free, a failing function of time) those reached before it.
///
/// `poll` is told the load factor aimed at and stops the search by returning false.
pub fn statics(
    model: &Arc<Model>,
    options: &StaticOptions,
    q: Option<&[f64]>,
    inputs: Option<Inputs>,
    poll: &mut dyn FnMut(f64) -> bool,
) -> (Path, Result<(), Error>) {
    let mut path = Path::default();
    let outcome = follow(model, options, q, inputs, poll, &mut path);
    (path, outcome)
}

fn follow(
    model: &Arc<Model>,
    options: &StaticOptions,
    q: Option<&[f64]>,
    inputs: Option<Inputs>,
    poll: &mut dyn FnMut(f64) -> bool,
    path: &mut Path,
) -> Result<(), Error> {
    let mut system = System::new(model.clone(), Mode::Static, inputs, false);
    let mut solver = model.solver(false)?;
    let zero = vec![0.0; model.coordinates()];
    let mut state = State {
        q: q.unwrap_or(&model.initial_q).to_vec(),
        v: zero.clone(),
        a: zero,
        lambda_: vec![0.0; model.multipliers()],
        ..State::default()
    };
    let load_steps = options.load_steps.max(1);
    for k in 0..load_steps {
        let factor = |k: usize| k as f64 / load_steps as f64;
        let options = statics::StaticOptions {
            from: factor(k),
            to: factor(k + 1),
            tolerance: options.tolerance.unwrap_or(statics::StaticOptions::default().tolerance),
            stable: options.stable,
            ..statics::StaticOptions::default()
        };
        let mut poll = || !poll(options.to);
        let points = solve_static(
            &mut system,
            solver.as_mut(),
            &state.q,
            &state.lambda_,
            &options,
            &mut poll,
        )?;
        for point in points {
            let before = state.clone();
            state.t = point.load;
            state.q = point.q;
            state.lambda_ = point.lambda_;
            system.accept(point_of(&before), point_of(&state));
            let mut lambda_ = state.lambda_.clone();
            if !system.memory().redundant.is_empty() {
                system.smallest_multipliers(solver.as_mut(), state.t, &state.q, &mut lambda_);
            }
            system.look_at(state.t);
            path.records.push(&system, &state, &lambda_);
            if point.stable == Some(false) {
                path.unstable.push(point.load);
            }
        }
    }
    Ok(())
}

fn point_of(state: &State) -> Point<'_> {
    Point { t: state.t, q: &state.q, v: &state.v, a: &state.a, lambda_: &state.lambda_ }
}

/// Joints with equations that follow from others at the start, how many, and the joints that they follow from.
///
/// # Errors
/// A singular mass matrix.
pub fn redundant(model: &Arc<Model>) -> Result<Vec<(String, usize, Vec<String>)>, Error> {
    let mut system = System::new(model.clone(), Mode::Dynamic, None, false);
    let mut solver = model.solver(false)?;
    let dependencies = leave_out_dependent(&mut system, solver.as_mut(), 0.0, &model.initial_q)?;
    let name = |multiplier: usize| {
        model.joint_of(multiplier).map_or_else(String::new, |k| model.joints[k].name.clone())
    };
    let mut found: Vec<(String, usize, Vec<String>)> = Vec::new();
    for dependency in &dependencies {
        let joint = name(dependency.equation);
        let at = found.iter().position(|(other, ..)| *other == joint).unwrap_or_else(|| {
            found.push((joint.clone(), 0, Vec::new()));
            found.len() - 1
        });
        found[at].1 += 1;
        for other in dependency.on.iter().map(|&(j, _)| name(j)) {
            if other != joint && !found[at].2.contains(&other) {
                found[at].2.push(other);
            }
        }
    }
    Ok(found)
}

/// The state that modes are taken about.
#[derive(Clone, Copy, Debug)]
pub struct About<'a> {
    /// Coordinates; none: those of the model.
    pub q: Option<&'a [f64]>,
    /// Multipliers; none: zero.
    pub lambda_: Option<&'a [f64]>,
    /// Time [s], or the load factor.
    pub t: f64,
    /// Whether `t` is a load factor.
    pub load_factor: bool,
}

/// The `count` lowest squares of angular frequencies [1/s^2] and mass-normalised shapes, one after the other.
///
/// # Errors
/// A singular mass matrix, or a failing function of time.
pub fn modes(
    model: &Arc<Model>,
    count: usize,
    about: About<'_>,
    inputs: Option<Inputs>,
) -> Result<(Vec<f64>, Vec<f64>), Error> {
    let mode = if about.load_factor { Mode::Static } else { Mode::Dynamic };
    let mut system = System::new(model.clone(), mode, inputs, false);
    let mut solver = model.solver(false)?;
    let zero = vec![0.0; model.coordinates()];
    let no_force = vec![0.0; model.multipliers()];
    let point = Point {
        t: about.t,
        q: about.q.unwrap_or(&model.initial_q),
        v: &zero,
        a: &zero,
        lambda_: about.lambda_.unwrap_or(&no_force),
    };
    // Loads are functions of time: let them be known at the time of linearisation.
    let mut force = zero.clone();
    let mut phi = no_force.clone();
    let evaluated = system.residual(point, &mut force, &mut phi);
    evaluated.map_err(|source| Error::Evaluation { t: about.t, source })?;
    // Iteration with the inverse keeps the lowest modes of slender lines exact, where a dense solution loses them
    // in the rounding of the highest; it needs room for its basis.
    let options = ModeOptions { count, dense_limit: 4 * count + 24, ..ModeOptions::default() };
    let modes =
        solve_modes(&mut system, solver.as_mut(), about.t, point.q, point.lambda_, &options)?;
    let squares = modes.iter().map(|m| m.omega_squared).collect();
    let shapes = modes.into_iter().flat_map(|m| m.shape).collect();
    Ok((squares, shapes))
}
