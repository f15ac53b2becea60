//! Equilibria and modes of a model.

use crate::contact_coupling::way::Overlap;
use crate::memory::Memory;
use crate::model::Model;
use crate::run::Records;
use crate::system::{Chosen, Growth, Inputs, Mode, System};
use pliant_dae::error::Error;
use pliant_dae::generalized_alpha::State;
use pliant_dae::linear_solver::LinearSolver;
use pliant_dae::modes::{ModeOptions, solve_modes};
use pliant_dae::problem::{Point, Problem, Weights};
use pliant_dae::redundancy::leave_out_dependent;
use pliant_dae::statics::path::{Kind, PathOptions, PathPoint, follow_path};
use pliant_dae::statics::{self, StaticPoint, solve_static};
use std::cell::Cell;
use std::sync::Arc;

/// Controls of [`statics()`].
#[derive(Clone, Debug, PartialEq)]
pub struct StaticOptions {
    /// Number of load increments, each cut and grown as needed; along a path the least number of steps.
    pub load_steps: usize,
    /// Newton's tolerance, in units of the model's size; none: down to rounding.
    pub tolerance: Option<f64>,
    /// Leave unstable equilibria for stable ones; along a path the branch that loses its stability.
    pub stable: bool,
    /// Follow the path through limit points.
    pub arc_length: bool,
    /// What grows; none: everything.
    pub chosen: Option<Chosen>,
    /// Let the forces out of balance at the start fade: it is an equilibrium at factor 0.
    pub fade: bool,
}

/// A critical point of a path.
#[derive(Clone, Debug, PartialEq)]
pub struct Critical {
    /// Number of its record.
    pub record: usize,
    /// Whether branches meet there; else the load stops rising or falling.
    pub bifurcation: bool,
    /// The motion that costs no force, of modal mass 1.
    pub shape: Vec<f64>,
}

/// Equilibria along the load.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Path {
    /// Those at the load factors reached.
    pub records: Records,
    /// Load factors at which they are unstable.
    pub unstable: Vec<f64>,
    /// Critical points among them.
    pub critical: Vec<Critical>,
}

/// Equilibria at the load factors reached, the last at 1, and whether the search got there: on failure (no
/// equilibrium, something that floats free, a failing function of time) those reached before it.
///
/// `poll` is told the load factor aimed at and stops the search by returning false.
pub fn statics(
    model: &Arc<Model>,
    options: &StaticOptions,
    start: (Option<&[f64]>, Option<&[f64]>),
    inputs: Option<Inputs>,
    poll: &mut dyn FnMut(f64) -> bool,
) -> (Path, Result<(), Error>) {
    let mut path = Path::default();
    let outcome = follow(model, options, start, inputs, poll, &mut path);
    (path, outcome)
}

fn follow(
    model: &Arc<Model>,
    options: &StaticOptions,
    (q, lambda_): (Option<&[f64]>, Option<&[f64]>),
    inputs: Option<Inputs>,
    poll: &mut dyn FnMut(f64) -> bool,
    path: &mut Path,
) -> Result<(), Error> {
    let mut system = System::new(model.clone(), Mode::Static, inputs, false);
    let mut solver = model.solver(false)?;
    let zero = vec![0.0; model.coordinates()];
    let state = State {
        q: q.unwrap_or(&model.initial_q).to_vec(),
        v: zero.clone(),
        a: zero,
        lambda_: lambda_.map_or_else(|| vec![0.0; model.multipliers()], <[f64]>::to_vec),
        ..State::default()
    };
    system.begin(0.0, &state.q);
    system.note_loads(point_of(&state));
    let chosen = options.chosen.clone();
    system.set_growth(Growth { chosen: chosen.clone(), fading: Vec::new() });
    if options.fade {
        let mut fading = vec![0.0; model.coordinates()];
        let mut phi = vec![0.0; model.multipliers()];
        system
            .residual(point_of(&state), &mut fading, &mut phi)
            .map_err(|source| Error::Evaluation { t: 0.0, source })?;
        system.set_growth(Growth { chosen, fading });
    }
    let search = statics::StaticOptions {
        tolerance: options.tolerance.unwrap_or(statics::StaticOptions::default().tolerance),
        stable: options.stable,
        ..statics::StaticOptions::default()
    };
    let mut visited = Visited { state, path };
    let load_steps = options.load_steps.max(1);
    if options.arc_length {
        let at = Cell::new(0.0);
        let mut points: Vec<PathPoint> = Vec::new();
        let memory = system.memory().clone();
        let outcome = {
            let (q, lambda_) = (visited.state.q.clone(), visited.state.lambda_.clone());
            let along = PathOptions {
                equilibrium: search,
                largest_load: 1.0 / load_steps as f64,
                switch: options.stable,
                ..PathOptions::default()
            };
            let mut stop = || !poll(at.get());
            let mut sink = |point: PathPoint| {
                at.set(point.point.load);
                points.push(point);
            };
            follow_path(&mut system, solver.as_mut(), &q, &lambda_, &along, &mut stop, &mut sink)
        };
        again(&mut system, memory);
        for PathPoint { point, kind, shape } in points {
            visited.push(&mut system, solver.as_mut(), point);
            if kind != Kind::Regular {
                let record = visited.path.records.time.len() - 1;
                let bifurcation = kind == Kind::Bifurcation;
                visited.path.critical.push(Critical { record, bifurcation, shape });
            }
        }
        return outcome;
    }
    for k in 0..load_steps {
        let factor = |k: usize| k as f64 / load_steps as f64;
        let search = statics::StaticOptions { from: factor(k), to: factor(k + 1), ..search };
        let mut stop = || !poll(search.to);
        let State { q, lambda_, .. } = visited.state.clone();
        let memory = system.memory().clone();
        let points = solve_static(&mut system, solver.as_mut(), &q, &lambda_, &search, &mut stop)?;
        again(&mut system, memory);
        for point in points {
            visited.push(&mut system, solver.as_mut(), point);
        }
    }
    Ok(())
}

/// The points of a path as records.
struct Visited<'a> {
    state: State,
    path: &'a mut Path,
}

impl Visited<'_> {
    fn push(&mut self, system: &mut System, solver: &mut dyn LinearSolver, point: StaticPoint) {
        let before = self.state.clone();
        let state = &mut self.state;
        state.t = point.load;
        state.q = point.q;
        state.lambda_ = point.lambda_;
        system.accept(point_of(&before), point_of(state));
        let mut lambda_ = state.lambda_.clone();
        if !system.memory().redundant.is_empty() {
            system.smallest_multipliers(solver, state.t, &state.q, &mut lambda_);
        }
        system.look_at(state.t);
        self.path.records.push(system, state, &lambda_);
        if point.stable == Some(false) {
            self.path.unstable.push(point.load);
        }
    }
}

fn point_of(state: &State) -> Point<'_> {
    Point { t: state.t, q: &state.q, v: &state.v, a: &state.a, lambda_: &state.lambda_ }
}

/// Joints with equations that follow from others at the start, how many, and the joints that they follow from.
#[must_use]
pub fn redundant(model: &Arc<Model>) -> Vec<(String, usize, Vec<String>)> {
    let mut system = System::new(model.clone(), Mode::Dynamic, None, false);
    let dependencies = leave_out_dependent(&mut system, 0.0, &model.initial_q);
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
    found
}

/// Part of the half thickness of the thinner one by which two may overlap at the start: more is no penetration that
/// forces would make, nor what is left where a bent line is laid out by hand (knots begin as deep as 0.92).
const OVERLAP: f64 = 1.0;

/// Contacts whose sides overlap by much at coordinates `q`; none: those of the model.
#[must_use]
pub fn overlaps(model: &Model, q: Option<&[f64]>) -> Vec<Overlap> {
    model.contacts.overlaps(q.unwrap_or(&model.initial_q), OVERLAP)
}

/// Goes back to what was remembered before a search, whose equilibria are gone through again, one after the other.
fn again(system: &mut System, memory: Memory) {
    let redundant = system.memory().redundant.clone();
    system.set_memory(memory);
    system.leave_out(&redundant);
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
    /// What the load factor acts on; none: everything.
    pub chosen: Option<&'a Chosen>,
}

impl<'a> About<'a> {
    /// The system there, with its functions of time known.
    fn system(&self, model: &Arc<Model>, inputs: Option<Inputs>) -> Result<System, Error> {
        let mode = if self.load_factor { Mode::Static } else { Mode::Dynamic };
        let mut system = System::new(model.clone(), mode, inputs, false);
        system.keep_elastic();
        system.leave_out_friction();
        system.set_growth(Growth { chosen: self.chosen.cloned(), fading: Vec::new() });
        system.begin(self.t, self.q.unwrap_or(&model.initial_q));
        let mut force = vec![0.0; model.coordinates()];
        let mut phi = vec![0.0; model.multipliers()];
        let (zero, no_force) = (force.clone(), self.multipliers(&mut system));
        let evaluated = system.residual(self.point(model, &zero, &no_force), &mut force, &mut phi);
        evaluated.map_err(|source| Error::Evaluation { t: self.t, source })?;
        Ok(system)
    }

    /// Multipliers where none are given: zero, but for those that coordinates determine.
    fn multipliers(&self, system: &mut System) -> Vec<f64> {
        let mut lambda_ = vec![0.0; system.multipliers()];
        let model = system.model().clone();
        system.determine(self.t, self.q.unwrap_or(&model.initial_q), &mut lambda_);
        lambda_
    }

    fn point<'b>(&self, model: &'b Model, zero: &'b [f64], no_force: &'b [f64]) -> Point<'b>
    where
        'a: 'b,
    {
        Point {
            t: self.t,
            q: self.q.unwrap_or(&model.initial_q),
            v: zero,
            a: zero,
            lambda_: self.lambda_.unwrap_or(no_force),
        }
    }
}

/// The equations of small motions `M x'' + C x' + K x + phi_q^T mu = 0`, `phi_q x = 0` as sums of entries.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Linear {
    /// Row of each entry: coordinates, then multipliers.
    pub rows: Vec<i64>,
    /// Column of each entry.
    pub columns: Vec<i64>,
    /// Mass, damping, stiffness with `(phi_q^T lambda_)_q`, and `phi_q` beside its transpose.
    pub values: [Vec<f64>; 4],
    /// Rows b of what enclosed gas adds to the stiffness, `sum b b^T`, one after the other.
    pub borders: Vec<f64>,
}

/// Whether there is neither damping nor a force without potential.
#[must_use]
pub fn is_conservative(model: &Arc<Model>) -> bool {
    let system = System::new(model.clone(), Mode::Static, None, false);
    system.has_potential() && !system.has_damping()
}

/// Small motions about a state at rest.
///
/// # Errors
/// A failing function of time.
pub fn linear(
    model: &Arc<Model>,
    about: &About<'_>,
    inputs: Option<Inputs>,
) -> Result<Linear, Error> {
    let mut system = about.system(model, inputs)?;
    let zero = vec![0.0; model.coordinates()];
    let no_force = about.multipliers(&mut system);
    let at = about.point(model, &zero, &no_force);
    let weights = |[mass, damping, stiffness, jacobian]: [f64; 4]| Weights {
        mass,
        damping,
        stiffness,
        jacobian,
    };
    let parts = [0, 1, 2, 3].map(|part| {
        let mut only = [0.0; 4];
        only[part] = 1.0;
        let mut values = vec![0.0; system.structure().values()];
        system.tangent(at, weights(only), &mut values);
        values
    });
    let mut linear = Linear::default();
    for chamber in &model.chambers {
        linear.borders.extend(chamber.stiffness_root(at.q, at.lambda_[chamber.multiplier]));
    }
    // With what touches there: the first tangent brought it in.
    let structure = system.structure();
    for e in 0..structure.elements() {
        let unknowns: Vec<usize> = structure.element_unknowns(e).collect();
        let n = unknowns.len();
        for (i, &row) in unknowns.iter().enumerate() {
            for (j, &column) in unknowns.iter().enumerate() {
                linear.rows.push(row as i64);
                linear.columns.push(column as i64);
                for (out, values) in linear.values.iter_mut().zip(&parts) {
                    out.push(structure.entry(e, n, i, j, values));
                }
            }
        }
    }
    Ok(linear)
}

/// The `count` lowest squares of angular frequencies [1/s^2] and mass-normalised shapes, one after the other.
///
/// # Errors
/// A singular mass matrix, or a failing function of time.
pub fn modes(
    model: &Arc<Model>,
    count: usize,
    about: &About<'_>,
    inputs: Option<Inputs>,
) -> Result<(Vec<f64>, Vec<f64>), Error> {
    let mut system = about.system(model, inputs)?;
    let mut solver = model.solver(false)?;
    let zero = vec![0.0; model.coordinates()];
    let no_force = about.multipliers(&mut system);
    let point = about.point(model, &zero, &no_force);
    // Iteration with the inverse keeps the lowest modes of slender lines exact, where a dense solution loses them
    // in the rounding of the highest; it needs room for its basis.
    let options = ModeOptions { count, dense_limit: 4 * count + 24, ..ModeOptions::default() };
    let modes =
        solve_modes(&mut system, solver.as_mut(), about.t, point.q, point.lambda_, &options)?;
    let squares = modes.iter().map(|m| m.omega_squared).collect();
    let shapes = modes.into_iter().flat_map(|m| m.shape).collect();
    Ok((squares, shapes))
}
