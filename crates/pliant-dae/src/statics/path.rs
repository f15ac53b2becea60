//! Equilibria along a path that need not rise with the load: Riks' arc length method.
//!
//! Points are sought on the plane normal to the path's tangent at the last one (Riks 1979), which has no choice of
//! roots to go wrong; each Newton step solves twice with one factorisation (Batoz & Dhatt 1979). The tangent keeps
//! its sense by its product with the last one, so that limit points are passed and points where branches meet
//! are crossed; where forces have kinks the load may turn at a corner, and the sense is that of the motion alone.
//! Lengths are `|dq / scale|_rms^2 + dload^2`.
//!
//! Inside each step the path is searched for what is critical: limit points, where the load stops rising or falling, by
//! the sign of its rate, and bifurcations, where stability changes without that, by the number of motions that lower
//! the energy. Both are located and kept as points of the path.

use super::{NOISE, Place, Search, StaticOptions, StaticPoint};
use crate::error::{Error, check_length};
use crate::linear_solver::LinearSolver;
use crate::modes::{Mode, ModeOptions, solve_modes};
use crate::problem::{Kinks, Problem};
use crate::redundancy::{leave_out_dependent, require_met};
use crate::scaling::weighted_max;

/// Controls of the path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathOptions {
    /// Those of each equilibrium; the path ends where it reaches `to` for the first time.
    pub equilibrium: StaticOptions,
    /// Largest change of the load in one step.
    pub largest_load: f64,
    /// Largest change of any coordinate in one step, in units of its scale.
    pub largest_move: f64,
    /// Points after which the path is given up.
    pub max_points: usize,
    /// Leave for the branch that crosses where the path loses its stability.
    pub switch: bool,
}

impl Default for PathOptions {
    fn default() -> Self {
        Self {
            equilibrium: StaticOptions::default(),
            largest_load: 0.1,
            largest_move: 0.1,
            max_points: 1000,
            switch: true,
        }
    }
}

/// What is special about a point of the path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Nothing.
    Regular,
    /// The load stops rising or falling.
    Limit,
    /// Another branch crosses.
    Bifurcation,
}

/// A point of the path.
#[derive(Clone, Debug, PartialEq)]
pub struct PathPoint {
    /// The equilibrium.
    pub point: StaticPoint,
    /// What is special about it.
    pub kind: Kind,
    /// Of a critical point the motion that costs no force, of modal mass 1; else empty.
    pub shape: Vec<f64>,
}

/// Iterations aimed at in each step, and their largest number.
const WANTED: f64 = 6.0;
const ITERATIONS: usize = 15;
/// Range of the change of the step.
const SHRINK: f64 = 0.5;
const GROW: f64 = 1.5;
/// Smallest part of the largest step.
const SMALLEST: f64 = 1e-9;
/// Cosine of the largest angle between tangents of successive points.
const BEND: f64 = 0.8;
/// Difference of loads for the derivative by the load.
const DIFFERENCE: f64 = 1e-4;
/// Trials that locate a critical point.
const TRIALS: usize = 50;
/// Modes watched for changes of stability, and the size up to which all are known: a dense solution of slender parts
/// loses the slowest in the rounding of the fastest.
const MODES: usize = 6;
const DENSE: usize = 4 * MODES + 24;
/// First displacement onto another branch, in units of the scale.
const PUSH: f64 = 0.02;

/// A point of the path with its tangent of length one: `(q, lambda_ scaled)` and the load.
#[derive(Clone, Debug)]
struct Station {
    place: Place,
    load: f64,
    tangent: Vec<f64>,
    rate: f64,
    iterations: usize,
    last_increment: f64,
    /// Motions that lower the energy; none: not known.
    falling: Option<usize>,
    /// Squares of the angular frequencies nearest to zero, ascending, once they have been asked for.
    squares: Option<Vec<f64>>,
}

/// Follows the path from the load `options.equilibrium.from`; `sink` gets its points.
///
/// # Errors
/// As [`super::solve_static`]; [`Error::PathEnded`] where the load is not reached.
pub fn follow_path<P: Problem + ?Sized>(
    problem: &mut P,
    solver: &mut dyn LinearSolver,
    q: &[f64],
    lambda_: &[f64],
    options: &PathOptions,
    poll: &mut dyn FnMut() -> bool,
    sink: &mut dyn FnMut(PathPoint),
) -> Result<(), Error> {
    check_length("q", q, problem.coordinates())?;
    check_length("lambda_", lambda_, problem.multipliers())?;
    let dependencies = leave_out_dependent(problem, options.equilibrium.from, q);
    let mut lambda_ = lambda_.to_vec();
    for dependency in &dependencies {
        lambda_[dependency.equation] = 0.0;
    }
    let mut search = Search::new(problem, solver, options.equilibrium, poll);
    search.measure_forces(options.equilibrium.from, q, &lambda_);
    let mut here = search.begin(q, &lambda_, options)?;
    search.found(here.load, &here.place.q, &here.place.lambda_);
    sink(search.point(&here, Kind::Regular, Vec::new()));
    let to = options.equilibrium.to;
    let mut part = 0.5;
    let mut points = 1;
    while points < options.max_points {
        if (search.poll)() {
            return Err(Error::Interrupted { t: here.load });
        }
        let longest = search.longest(&here, options);
        let mut taken = search.advance(&here, part * longest);
        if let Ok(next) = &taken
            && part > SMALLEST
            && search.is_crooked(&here, next)
        {
            taken = Err(search.failure(here.load, part, &[], 0));
        }
        let next = match taken {
            Ok(next) => next,
            Err(error) if error.is_recoverable() && part > SMALLEST => {
                part *= SHRINK;
                continue;
            }
            Err(error) => return Err(error),
        };
        // One event in a step: where more happens, it is cut.
        let turns = here.rate * next.rate < 0.0;
        let changes = match (here.falling, next.falling) {
            (Some(a), Some(b)) => a.abs_diff(b),
            _ => usize::from(turns),
        };
        if turns && changes != 1 && part > 1e-4 {
            part *= SHRINK;
            continue;
        }
        let length = part * longest;
        let grown = (WANTED / next.iterations as f64).sqrt().clamp(SHRINK, GROW);
        let summit = if turns { Some(search.locate(&here, length, &next, true)?) } else { None };
        let crosses = |a: f64, b: f64| a < to && b >= to;
        let crossing = match &summit {
            Some(summit) if crosses(here.load, summit.load) => Some(summit),
            _ if crosses(here.load, next.load) => Some(&next),
            _ => None,
        };
        let meeting = if !turns && changes > 0 {
            Some(search.locate(&here, length, &next, false)?)
        } else {
            None
        };
        if let Some(beyond) = crossing.filter(|_| meeting.as_ref().is_none_or(|m| m.load >= to)) {
            match search.land(&here, beyond) {
                Some(end) => {
                    sink(end);
                    return Ok(());
                }
                None if part > SMALLEST => {
                    part *= SHRINK;
                    continue;
                }
                None => return Err(search.failure(to, length, &[], 0)),
            }
        }
        if let Some(summit) = summit {
            let shape = search.critical_shape(&summit);
            sink(search.point(&summit, Kind::Limit, shape));
            points += 1;
        }
        let mut follow = next;
        if let Some(meeting) = meeting {
            let shape = search.critical_shape(&meeting);
            sink(search.point(&meeting, Kind::Bifurcation, shape.clone()));
            points += 1;
            // Of several motions at once, as those of a round strut to all sides, none is preferred.
            if options.switch && here.falling == Some(0) && changes == 1 {
                if let Some(branch) = search.switch(&meeting, &shape)? {
                    follow = branch;
                    part = 0.1;
                }
            } else if crosses(here.load, follow.load) {
                // The load lies between the meeting and the next point.
                if let Some(end) = search.land(&meeting, &follow) {
                    sink(end);
                    return Ok(());
                }
            }
        }
        here = follow;
        search.found(here.load, &here.place.q, &here.place.lambda_);
        sink(search.point(&here, Kind::Regular, Vec::new()));
        points += 1;
        require_met(search.problem, here.load, &here.place.q, &dependencies)?;
        part = (part * grown).min(1.0);
    }
    Err(Error::PathEnded { t: here.load, points, to })
}

impl<P: Problem + ?Sized> Search<'_, P> {
    /// The first point: at the starting load where there is an equilibrium, else at the first load that has one.
    fn begin(
        &mut self,
        q: &[f64],
        lambda_: &[f64],
        options: &PathOptions,
    ) -> Result<Station, Error> {
        let n = self.zero.len();
        let mut place = Place { q: q.to_vec(), lambda_: lambda_.to_vec(), moved: vec![0.0; n] };
        let StaticOptions { from, to, .. } = options.equilibrium;
        let step = options.largest_load.min((to - from).abs()) * (to - from).signum();
        let at_rest = self.search(from, step, &mut place, self.exact())?;
        let started = match at_rest {
            super::Outcome::Equilibrium { last_increment, iterations } => {
                let rises = vec![0.0; n];
                self.station(place, from, &rises, 1.0, iterations, last_increment)
            }
            super::Outcome::Failed(error) => Err(error),
        };
        match started {
            Ok(station) => Ok(station),
            Err(error) if error.is_recoverable() => {
                // A slack line has no stiffness without its load.
                let load = from + 0.1 * step;
                let point = self.equilibrium(load, step, q, lambda_, false)?;
                let place = Place { q: point.q, lambda_: point.lambda_, moved: vec![0.0; n] };
                let rises = vec![0.0; n];
                self.station(place, load, &rises, 1.0, point.iterations, point.last_increment)
            }
            Err(error) => Err(error),
        }
    }

    /// The tangent at a place, in the sense of `(before, rate)`, and its stability.
    fn station(
        &mut self,
        mut place: Place,
        load: f64,
        before: &[f64],
        rate_before: f64,
        iterations: usize,
        last_increment: f64,
    ) -> Result<Station, Error> {
        let n = self.zero.len();
        place.moved.fill(0.0);
        self.correction(load, &place, 0.0, None)?;
        let mut tangent = self.load_rate(load, &place)?;
        self.solver.solve(&mut tangent);
        let norm = (self.product(&tangent[..n], &tangent[..n]) + 1.0).sqrt();
        if !norm.is_finite() {
            return Err(self.failure(load, 0.0, &[], 0));
        }
        let mut forward = self.product(&tangent[..n], before);
        if forward == 0.0 || self.problem.kinks() != Kinks::Many {
            forward += rate_before;
        }
        let sign = if forward < 0.0 { -1.0 } else { 1.0 };
        tangent.iter_mut().for_each(|t| *t *= sign / norm);
        let (falling, squares) = self.falling(load, &place)?;
        let rate = sign / norm;
        Ok(Station { place, load, tangent, rate, iterations, last_increment, falling, squares })
    }

    /// Mean of products in units of the scale.
    fn product(&self, a: &[f64], b: &[f64]) -> f64 {
        let terms = a.iter().zip(b).zip(&self.inverse_scale).map(|((a, b), w)| a * b * w * w);
        terms.sum::<f64>() / self.zero.len() as f64
    }

    /// Right-hand side of the tangent: minus the derivative of the residual by the load.
    fn load_rate(&mut self, load: f64, place: &Place) -> Result<Vec<f64>, Error> {
        let mut rate = self.right_hand_side(load + DIFFERENCE, place, 0.0)?;
        let before = self.right_hand_side(load - DIFFERENCE, place, 0.0)?;
        for (rate, before) in rate.iter_mut().zip(&before) {
            *rate = (*rate - before) / (2.0 * DIFFERENCE);
        }
        Ok(rate)
    }

    /// Arc length within the bounds of load and motion.
    fn longest(&self, from: &Station, options: &PathOptions) -> f64 {
        let n = self.zero.len();
        let moves = weighted_max(&from.tangent[..n], &self.inverse_scale);
        (options.largest_load / from.rate.abs()).min(options.largest_move / moves)
    }

    /// The point of the path at `length` along the tangent.
    fn advance(&mut self, from: &Station, length: f64) -> Result<Station, Error> {
        let (tangent, rate) = (from.tangent.clone(), from.rate);
        let (place, load, iterations, last) =
            self.correct(&from.place, from.load, &tangent, rate, length)?;
        self.station(place, load, &tangent[..self.zero.len()], rate, iterations, last)
    }

    /// Newton's method on the plane `(tangent, rate).(x - from) = length`, from the point straight ahead.
    fn correct(
        &mut self,
        from: &Place,
        load: f64,
        tangent: &[f64],
        rate: f64,
        length: f64,
    ) -> Result<(Place, f64, usize, f64), Error> {
        let n = self.zero.len();
        let mut place = from.clone();
        place.moved.fill(0.0);
        if self.part(&place.q, tangent, length) != length {
            return Err(self.failure(load, length, &[], 0));
        }
        self.add(&mut place, tangent, length);
        let mut now = load + length * rate;
        let mut sizes: Vec<f64> = Vec::new();
        let predicts = self.problem.predicts();
        let mut last: Vec<f64> = tangent[..n].iter().map(|t| length * t).collect();
        while sizes.len() < ITERATIONS {
            let dx = self.correction(now, &place, 0.0, predicts.then_some(&last[..]))?;
            let mut along = self.load_rate(now, &place)?;
            self.solver.solve(&mut along);
            let off = self.product(&tangent[..n], &place.moved) + rate * (now - load) - length;
            let slope = self.product(&tangent[..n], &along[..n]) + rate;
            let dload = -(off + self.product(&tangent[..n], &dx[..n])) / slope;
            let step: Vec<f64> = dx.iter().zip(&along).map(|(d, a)| d + dload * a).collect();
            let size = weighted_max(&step[..n], &self.inverse_scale);
            let previous = sizes.last().copied().unwrap_or(f64::INFINITY);
            sizes.push(size);
            let absurd = !size.is_finite() || size > self.options.max_increment;
            if absurd
                || sizes.len() > 3 && size > previous && size > NOISE * self.options.tolerance
                || self.part(&place.q, &step, 1.0) < 1.0
            {
                break;
            }
            self.add(&mut place, &step, 1.0);
            last.copy_from_slice(&step[..n]);
            now += dload;
            let noise = size > 0.5 * previous && size <= NOISE * self.options.tolerance;
            if size <= self.options.tolerance || noise {
                return Ok((place, now, sizes.len(), size));
            }
        }
        Err(self.failure(now, length, &sizes, 0))
    }

    fn is_crooked(&self, from: &Station, to: &Station) -> bool {
        let n = self.zero.len();
        self.product(&from.tangent[..n], &to.tangent[..n]) + from.rate * to.rate < BEND
    }

    /// Number of motions that lower the energy, by the inertia of the stiffness on the constraints that was
    /// factorised last; else by the modes nearest to none, whose squares are returned, too.
    fn falling(
        &mut self,
        load: f64,
        place: &Place,
    ) -> Result<(Option<usize>, Option<Vec<f64>>), Error> {
        if !self.problem.has_potential() {
            return Ok((None, None));
        }
        if let Some(falling) = self.falling_by_inertia() {
            return Ok((Some(falling), None));
        }
        match self.modes(load, place) {
            Ok(modes) => Ok((
                Some(modes.iter().filter(|m| m.unstable).count()),
                Some(modes.iter().map(|m| m.omega_squared).collect()),
            )),
            Err(error) if error.is_recoverable() => Ok((None, None)),
            Err(error) => Err(error),
        }
    }

    /// The modes nearest to zero, or all of a small problem.
    fn modes(&mut self, load: f64, place: &Place) -> Result<Vec<Mode>, Error> {
        let options = ModeOptions { count: MODES, dense_limit: DENSE, ..ModeOptions::default() };
        solve_modes(self.problem, self.solver, load, &place.q, &place.lambda_, &options)
    }

    /// The square of the frequency that has `below` others under it; zero where it is not known.
    fn square(&mut self, station: &Station, below: usize) -> f64 {
        let found;
        let squares = match &station.squares {
            Some(squares) => squares,
            None => {
                let modes = self.modes(station.load, &station.place).unwrap_or_default();
                found = modes.iter().map(|m| m.omega_squared).collect::<Vec<_>>();
                &found
            }
        };
        // Those far below zero are not among the modes.
        let negative = squares.iter().filter(|square| **square < 0.0).count();
        let missing = station.falling.unwrap_or(negative).saturating_sub(negative);
        squares.get(below.wrapping_sub(missing)).copied().unwrap_or(0.0)
    }

    /// The motion that costs least force.
    fn critical_shape(&mut self, at: &Station) -> Vec<f64> {
        self.modes(at.load, &at.place)
            .ok()
            .and_then(|modes| {
                modes
                    .into_iter()
                    .min_by(|a, b| a.omega_squared.abs().total_cmp(&b.omega_squared.abs()))
            })
            .map(|mode| mode.shape)
            .unwrap_or_default()
    }

    /// The critical point between two stations `length` apart, by false position with Illinois' weights: where the
    /// load's rate vanishes, or the square of the frequency that changes its sign.
    fn locate(
        &mut self,
        from: &Station,
        length: f64,
        to: &Station,
        limit: bool,
    ) -> Result<Station, Error> {
        let first = from.falling.unwrap_or(0).min(to.falling.unwrap_or(0));
        let measure = |search: &mut Self, station: &Station| {
            if limit { station.rate } else { search.square(station, first) }
        };
        let (mut low, mut high) = (0.0, length);
        let (mut at_low, mut at_high) = (measure(self, from), measure(self, to));
        let size = at_low.abs().max(at_high.abs());
        let mut best = if at_low.abs() < at_high.abs() { from.clone() } else { to.clone() };
        let mut smallest = at_low.abs().min(at_high.abs());
        if at_low * at_high >= 0.0 {
            // The sign changed within rounding of one of them.
            return Ok(best);
        }
        let mut side = 0;
        for _ in 0..TRIALS {
            let trial = (low * at_high - high * at_low) / (at_high - at_low);
            let middle = match self.advance(from, trial) {
                Ok(middle) => middle,
                // Too close to the critical point for its matrix: near enough.
                Err(error) if error.is_recoverable() => break,
                Err(error) => return Err(error),
            };
            let value = measure(self, &middle);
            if value.abs() <= smallest {
                (best, smallest) = (middle, value.abs());
            }
            if value * at_low > 0.0 {
                (low, at_low) = (trial, value);
                if side == -1 {
                    at_high *= 0.5;
                }
                side = -1;
            } else {
                (high, at_high) = (trial, value);
                if side == 1 {
                    at_low *= 0.5;
                }
                side = 1;
            }
            if value.abs() <= 1e-10 * size || high - low <= 1e-12 * length {
                break;
            }
        }
        Ok(best)
    }

    /// The equilibrium at the full load between two stations.
    fn land(&mut self, from: &Station, beyond: &Station) -> Option<PathPoint> {
        let to = self.options.to;
        let part = (to - from.load) / (beyond.load - from.load);
        let n = self.zero.len();
        let mut place = from.place.clone();
        for (q, (a, b)) in place.q.iter_mut().zip(from.place.q.iter().zip(&beyond.place.q)) {
            *q = a + part * (b - a);
        }
        for (l, b) in place.lambda_.iter_mut().zip(&beyond.place.lambda_) {
            *l += part * (b - *l);
        }
        place.moved.fill(0.0);
        let gap: Vec<f64> =
            beyond.place.q[..n].iter().zip(&from.place.q).map(|(b, a)| b - a).collect();
        let far = weighted_max(&gap, &self.inverse_scale).max(1e-6);
        let outcome = self.newton(to, to - from.load, &mut place, self.exact()).ok()?;
        let super::Outcome::Equilibrium { last_increment, iterations } = outcome else {
            return None;
        };
        if weighted_max(&place.moved, &self.inverse_scale) > far {
            return None;
        }
        let (tangent, rate) = (from.tangent.clone(), from.rate);
        let station =
            self.station(place, to, &tangent[..n], rate, iterations, last_increment).ok()?;
        Some(self.point(&station, Kind::Regular, Vec::new()))
    }

    /// The first point of the branch that leaves along `shape`, to the side that the load favours.
    fn switch(&mut self, at: &Station, shape: &[f64]) -> Result<Option<Station>, Error> {
        let n = self.zero.len();
        if shape.len() != n {
            return Ok(None);
        }
        let favoured = self.load_rate(at.load, &at.place)?;
        let ahead: f64 = favoured[..n].iter().zip(shape).map(|(f, x)| f * x).sum();
        let first = if ahead < 0.0 { -1.0 } else { 1.0 };
        let norm = self.product(shape, shape).sqrt();
        let mut direction: Vec<f64> = shape.iter().map(|x| x / norm).collect();
        direction.resize(n + at.place.lambda_.len(), 0.0);
        let length = PUSH / weighted_max(&direction[..n], &self.inverse_scale);
        for (sign, part) in [(first, 1.0), (-first, 1.0), (first, 0.25), (first, 3.0)] {
            let along: Vec<f64> = direction.iter().map(|x| sign * x).collect();
            let found = self.correct(&at.place, at.load, &along, 0.0, part * length);
            let station = match found {
                Ok((place, load, iterations, last)) => {
                    self.station(place, load, &along[..n], 0.0, iterations, last)
                }
                Err(error) => Err(error),
            };
            match station {
                Ok(station) => return Ok(Some(station)),
                Err(error) if error.is_recoverable() => {}
                Err(error) => return Err(error),
            }
        }
        Ok(None)
    }

    fn point(&self, station: &Station, kind: Kind, shape: Vec<f64>) -> PathPoint {
        PathPoint {
            point: StaticPoint {
                load: station.load,
                q: station.place.q.clone(),
                lambda_: station.place.lambda_.clone(),
                iterations: station.iterations,
                last_increment: station.last_increment,
                stable: station.falling.map(|falling| falling == 0),
            },
            kind,
            shape,
        }
    }
}
