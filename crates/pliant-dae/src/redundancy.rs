//! Equations that follow from others: found, left out of the solution, and the multipliers shared out among them all.
//!
//! Rows of `phi_q` that depend on other rows carry no information about the motion, and their multipliers are not
//! determined. A largest set of independent rows is kept; the others read `lambda_ = 0` ([`Problem::leave_out`]).
//! The motion is that of all equations, and among the multipliers that cause it the smallest are found by
//! [`smallest_multipliers`].
//!
//! Rows are reduced one after the other by those before them, with the largest entry left over as pivot; those of
//! which little is left wait for the end. What is sparse stays sparse: chains, trees and many small components cost
//! in proportion to their number.

use std::collections::{BTreeMap, HashMap};

use crate::error::Error;
use crate::linear_solver::LinearSolver;
use crate::problem::{Point, Problem, Weights};
use crate::scaling::weighted_max;
use crate::structure::entry_number;

/// An equation that follows from others: its row is the sum of theirs, with these factors.
#[derive(Clone, Debug, PartialEq)]
pub struct Dependency {
    /// Number of the multiplier.
    pub equation: usize,
    /// Numbers of the multipliers of the others, and factors.
    pub on: Vec<(usize, f64)>,
}

/// What is left of a dependent row, relative to its largest entry on the way.
const DEPENDENT: f64 = 1e-8;
/// Rows of which less is left wait: others may make better pivots.
const POOR: f64 = 0.1;
/// Dimensionless factors below this are rounding.
const NEGLIGIBLE: f64 = 1e-6;
/// Part of the rates of equations by which they may differ from those that they follow from.
const AGREEMENT: f64 = 1e-7;

/// Residual, in units of its scale, of an equation that does not follow from those that hold.
const LARGEST_VIOLATION: f64 = 1e-7;
/// What cannot be had.
const POSITIONS: &str = "positions that all allow";

/// The Jacobian alone.
const JACOBIAN: Weights = Weights { mass: 0.0, damping: 0.0, stiffness: 0.0, jacobian: 1.0 };
/// The matrix `[M phi_q^T; phi_q 0]`.
const WITH_MASS: Weights = Weights { mass: 1.0, damping: 0.0, stiffness: 0.0, jacobian: 1.0 };

type Row = Vec<(usize, f64)>;

/// Rows of the dimensionless Jacobian at `(t, q)`, nothing being left out.
fn rows<P: Problem + ?Sized>(problem: &mut P, t: f64, q: &[f64]) -> Vec<Row> {
    let (n, m) = (problem.velocities(), problem.multipliers());
    let zero = vec![0.0; n.max(m)];
    let mut values = vec![0.0; problem.structure().values()];
    let at = Point { t, q, v: &zero[..n], a: &zero[..n], lambda_: &zero[..m] };
    problem.tangent(at, JACOBIAN, &mut values);
    let structure = problem.structure();
    let (scale, constraint_scale) = (problem.scale(), problem.constraint_scale());
    let mut rows: Vec<Row> = vec![Vec::new(); m];
    let mut unknowns = Vec::new();
    for e in 0..structure.elements() {
        unknowns.clear();
        unknowns.extend(structure.element_unknowns(e));
        for (i, &row) in unknowns.iter().enumerate().filter(|(_, row)| **row >= n) {
            let row = row - n;
            for (j, &column) in unknowns.iter().enumerate().filter(|(_, column)| **column < n) {
                let entry = structure.entry(e, unknowns.len(), i, j, &values);
                if entry != 0.0 {
                    rows[row].push((column, entry * scale[column] / constraint_scale[row]));
                }
            }
        }
    }
    for row in &mut rows {
        row.sort_by_key(|&(column, _)| column);
        row.dedup_by(|b, a| {
            let same = a.0 == b.0;
            if same {
                a.1 += b.1;
            }
            same
        });
    }
    rows
}

fn size(row: &[(usize, f64)]) -> f64 {
    row.iter().fold(0.0, |m, (_, x)| f64::max(m, x.abs()))
}

/// Takes out rows that own a column: they depend on nothing.
fn peel(rows: &[Row]) -> Vec<bool> {
    let mut users: HashMap<usize, Vec<usize>> = HashMap::new();
    for (i, row) in rows.iter().enumerate() {
        for &(column, _) in row {
            users.entry(column).or_default().push(i);
        }
    }
    let mut count: HashMap<usize, usize> = users.iter().map(|(&c, u)| (c, u.len())).collect();
    let mut left: Vec<bool> = rows.iter().map(|r| !r.is_empty()).collect();
    let mut queue: Vec<usize> = (0..rows.len()).collect();
    while let Some(i) = queue.pop() {
        let bound = POOR * size(&rows[i]);
        let owns = |&(c, x): &(usize, f64)| count.get(&c) == Some(&1) && x.abs() > bound;
        if !left[i] || !rows[i].iter().any(owns) {
            continue;
        }
        left[i] = false;
        for (column, _) in &rows[i] {
            let users = &users[column];
            if let Some(count) = count.get_mut(column) {
                *count -= 1;
                if *count == 1 {
                    queue.extend(users.iter().filter(|&&u| left[u]));
                }
            }
        }
    }
    left
}

/// A row that is reduced by those before it: `row - sum of factor * rest of step`.
struct Reduced {
    /// What is left.
    rest: Row,
    /// Numbers of the steps, ascending, and factors.
    steps: Row,
    /// The largest entry on the way.
    largest: f64,
}

/// One step of a staircase.
struct Step {
    /// Number of the row that it came from.
    row: usize,
    rest: Row,
    steps: Row,
}

/// Rows in a staircase: each reduced by those before it.
#[derive(Default)]
struct Staircase {
    steps: Vec<Step>,
    of_column: HashMap<usize, usize>,
}

impl Staircase {
    fn reduce(&self, row: &Row) -> Reduced {
        let mut entries: HashMap<usize, f64> = HashMap::with_capacity(4 * row.len());
        let mut waiting: BTreeMap<usize, usize> = BTreeMap::new();
        let mut largest = size(row);
        let mut steps = Row::new();
        for &(column, x) in row {
            entries.insert(column, x);
            if let Some(&k) = self.of_column.get(&column) {
                waiting.insert(k, column);
            }
        }
        while let Some((k, column)) = waiting.pop_first() {
            let Some(x) = entries.remove(&column) else { continue };
            if x == 0.0 {
                continue;
            }
            let pivot = &self.steps[k].rest;
            let factor = x / pivot.iter().find(|(c, _)| *c == column).map_or(1.0, |p| p.1);
            steps.push((k, factor));
            for &(c, p) in pivot.iter().filter(|(c, _)| *c != column) {
                let entry = entries.entry(c).or_insert(0.0);
                *entry -= factor * p;
                largest = largest.max(entry.abs());
                if let Some(&k) = self.of_column.get(&c) {
                    waiting.insert(k, c);
                }
            }
        }
        let mut rest: Row = entries.into_iter().filter(|(_, x)| *x != 0.0).collect();
        rest.sort_by_key(|&(column, _)| column);
        Reduced { rest, steps, largest }
    }

    /// Adds the row of that number, reduced.
    fn add(&mut self, row: usize, Reduced { rest, steps, .. }: Reduced) {
        // The first of equal entries: the order of columns decides, not that of a hash.
        let best = rest
            .iter()
            .fold((0, 0.0_f64), |b, &(c, x)| if x.abs() > b.1 { (c, x.abs()) } else { b });
        self.of_column.insert(best.0, self.steps.len());
        self.steps.push(Step { row, rest, steps });
    }

    /// Numbers of rows and factors whose sum is that of steps: each step is its row without those before it.
    fn in_rows(&self, steps: &Row) -> Row {
        let mut open: BTreeMap<usize, f64> = steps.iter().copied().collect();
        let mut rows = Row::new();
        while let Some((k, factor)) = open.pop_last() {
            let step = &self.steps[k];
            rows.push((step.row, factor));
            for &(j, x) in &step.steps {
                *open.entry(j).or_insert(0.0) -= factor * x;
            }
        }
        rows
    }
}

/// Which rows follow from others, with dimensionless factors; where there is a choice, those late in `order`.
fn dependent_rows(rows: &[Row], order: &[usize]) -> Vec<Dependency> {
    let left = peel(rows);
    let mut dependent = Vec::new();
    let mut stairs = Staircase::default();
    let mut waiting = Vec::new();
    for &i in order.iter().filter(|&&i| left[i]) {
        let reduced = stairs.reduce(&rows[i]);
        if size(&reduced.rest) > POOR * reduced.largest {
            stairs.add(i, reduced);
        } else {
            waiting.push(i);
        }
    }
    for i in waiting {
        let reduced = stairs.reduce(&rows[i]);
        if size(&reduced.rest) > DEPENDENT * reduced.largest {
            stairs.add(i, reduced);
        } else {
            let mut on = stairs.in_rows(&reduced.steps);
            on.retain(|(_, factor)| factor.abs() > NEGLIGIBLE);
            on.sort_by_key(|&(j, _)| j);
            dependent.push(Dependency { equation: i, on });
        }
    }
    dependent.sort_by_key(|d| d.equation);
    dependent
}

/// Leaves the equations out that follow from others at `(t, q)`, and tells how they follow.
pub fn leave_out_dependent<P: Problem + ?Sized>(
    problem: &mut P,
    t: f64,
    q: &[f64],
) -> Vec<Dependency> {
    if problem.multipliers() == 0 {
        return Vec::new();
    }
    problem.leave_out(&[]);
    let rows = rows(problem, t, q);
    let mut found = dependent_rows(&rows, &problem.constraint_order());
    let scale = problem.constraint_scale();
    for dependency in &mut found {
        for (j, factor) in &mut dependency.on {
            *factor *= scale[dependency.equation] / scale[*j];
        }
    }
    if !found.is_empty() {
        let mut left_out = vec![false; rows.len()];
        for dependency in &found {
            left_out[dependency.equation] = true;
        }
        problem.leave_out(&left_out);
    }
    found
}

/// Refuses equations whose rates or accelerations (`values`, one for each equation) contradict those of the equations
/// that they follow from.
pub(crate) fn require_agreement<P: Problem + ?Sized>(
    problem: &P,
    t: f64,
    dependencies: &[Dependency],
    values: &[f64],
    what: &'static str,
) -> Result<(), Error> {
    for dependency in dependencies {
        let i = dependency.equation;
        let terms = || dependency.on.iter().map(|&(j, factor)| factor * values[j]);
        let gap = values[i] - terms().sum::<f64>();
        let large = terms().fold(values[i].abs(), |m, x| m.max(x.abs()));
        let floor = 1e-10 * problem.constraint_scale()[i];
        if gap.abs() > AGREEMENT * large + floor {
            return Err(contradiction(problem, t, dependency, what));
        }
    }
    Ok(())
}

/// Refuses positions that satisfy equations, but not those that should follow from them.
pub(crate) fn require_met<P: Problem + ?Sized>(
    problem: &mut P,
    t: f64,
    q: &[f64],
    dependencies: &[Dependency],
) -> Result<(), Error> {
    if dependencies.is_empty() {
        return Ok(());
    }
    let (n, m) = (problem.velocities(), problem.multipliers());
    let zero = vec![0.0; n.max(m)];
    let (mut force, mut phi) = (vec![0.0; n], vec![0.0; m]);
    let at = Point { t, q, v: &zero[..n], a: &zero[..n], lambda_: &zero[..m] };
    let mut left_out = vec![false; m];
    for dependency in dependencies {
        left_out[dependency.equation] = true;
    }
    problem.leave_out(&[]);
    let outcome = problem.residual(at, &mut force, &mut phi);
    problem.leave_out(&left_out);
    outcome.map_err(|source| Error::Evaluation { t, source })?;
    let scale = problem.constraint_scale();
    let off = |d: &&Dependency| phi[d.equation].abs() > LARGEST_VIOLATION * scale[d.equation];
    match dependencies.iter().find(off) {
        Some(dependency) => Err(contradiction(problem, t, dependency, POSITIONS)),
        None => Ok(()),
    }
}

fn contradiction<P: Problem + ?Sized>(
    problem: &P,
    t: f64,
    dependency: &Dependency,
    what: &'static str,
) -> Error {
    let mut names = vec![problem.owner(dependency.equation)];
    for &(j, _) in &dependency.on {
        let name = problem.owner(j);
        if !names.contains(&name) {
            names.push(name);
        }
    }
    Error::Contradictory { t, names, what }
}

/// Moves positions onto all constraints, those included that were left out, by the least change in the mass.
///
/// # Errors
/// [`Error::Contradictory`] where there is no such position nearby.
pub fn project_positions<P: Problem + ?Sized>(
    problem: &mut P,
    solver: &mut dyn LinearSolver,
    t: f64,
    q: &mut Vec<f64>,
    tolerance: f64,
) -> Result<(), Error> {
    let (n, m) = (problem.velocities(), problem.multipliers());
    let weight: Vec<f64> = problem.constraint_scale().iter().map(|s| s.recip()).collect();
    let zero = vec![0.0; n.max(m)];
    let (mut force, mut phi) = (vec![0.0; n], vec![0.0; m]);
    let mut last = Vec::new();
    for _ in 0..8 {
        problem.leave_out(&[]);
        let mut lambda_ = zero[..m].to_vec();
        problem.determine(t, q, &mut lambda_);
        let at = Point { t, q, v: &zero[..n], a: &zero[..n], lambda_: &lambda_ };
        let outcome = problem.residual(at, &mut force, &mut phi);
        outcome.map_err(|source| Error::Evaluation { t, source })?;
        if weighted_max(&phi, &weight) <= tolerance {
            return Ok(());
        }
        last = leave_out_dependent(problem, t, q);
        let mut values = vec![0.0; problem.structure().values()];
        let at = Point { t, q, v: &zero[..n], a: &zero[..n], lambda_: &zero[..m] };
        problem.tangent(at, WITH_MASS, &mut values);
        let factored = solver.factor(problem.structure(), &values);
        factored.map_err(|e| Error::from_factor(problem, t, &e))?;
        for dependency in &last {
            phi[dependency.equation] = 0.0;
        }
        let mut x = zero[..n].to_vec();
        x.extend(phi.iter().map(|p| -p));
        solver.solve(&mut x);
        let mut moved = q.clone();
        problem.retract(q, &x[..n], &mut moved);
        *q = moved;
    }
    let what = POSITIONS;
    match last.first() {
        Some(dependency) => Err(contradiction(problem, t, dependency, what)),
        None => {
            let worst = crate::scaling::worst(&phi, &weight);
            Err(Error::Contradictory { t, names: vec![problem.owner(worst)], what })
        }
    }
}

/// Part of the mass that keeps coordinates apart which no constraint holds.
const WEAK: f64 = 1e-8;

/// The smallest multipliers, in units of work, that act on the coordinates as `lambda_` does: `min |S lambda_|` with
/// `phi_q^T lambda_` as given, S the scale of the constraints.
///
/// Being smallest means `lambda_ = S^-2 phi_q y`: one system for y and the multipliers with all equations, `-S^2` on the
/// diagonal of the multipliers, and a weak mass on the coordinates, whose part of the force is solved for again.
///
/// # Errors
/// A matrix that cannot be factorised.
pub fn smallest_multipliers<P: Problem + ?Sized>(
    problem: &mut P,
    solver: &mut dyn LinearSolver,
    t: f64,
    q: &[f64],
    lambda_: &mut [f64],
    left_out: &[bool],
) -> Result<(), Error> {
    let (n, m) = (problem.velocities(), problem.multipliers());
    let released: Vec<bool> =
        problem.idle().iter().zip(left_out).map(|(idle, left_out)| idle & !left_out).collect();
    problem.leave_out(&[]);
    let zero = vec![0.0; n.max(m)];
    let at = Point { t, q, v: &zero[..n], a: &zero[..n], lambda_: &zero[..m] };
    let mut values = vec![0.0; problem.structure().values()];
    let mass = Weights { jacobian: 0.0, ..WITH_MASS };
    problem.tangent(at, mass, &mut values);
    let heaviest = values.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    let weak = Weights { mass: WEAK / heaviest.max(f64::MIN_POSITIVE), ..WITH_MASS };
    problem.tangent(at, weak, &mut values);
    let jacobian = {
        let mut values = values.clone();
        problem.tangent(at, JACOBIAN, &mut values);
        values
    };
    let scale = problem.constraint_scale();
    let structure = problem.structure();
    let mut unknowns = Vec::new();
    let mut done = vec![false; m];
    for e in 0..structure.elements() {
        unknowns.clear();
        unknowns.extend(structure.element_unknowns(e));
        let slot = structure.slot(e);
        for (i, &unknown) in unknowns.iter().enumerate().filter(|(_, u)| **u >= n) {
            let j = unknown - n;
            if !done[j] && !released.get(j).copied().unwrap_or(false) {
                done[j] = true;
                let number = entry_number(unknowns.len(), i, i, slot.storage);
                values[slot.base + slot.stride * number] = -scale[j] * scale[j];
            }
        }
    }
    let factored = solver.factor(structure, &values);
    factored.map_err(|e| Error::from_factor(problem, t, &e))?;
    let structure = problem.structure();
    let mut forces = vec![0.0; n + m];
    let mut padded = vec![0.0; n];
    padded.extend_from_slice(lambda_);
    structure.multiply_add(&jacobian, &padded, &mut forces, false);
    let wanted = forces[..n].to_vec();
    lambda_.fill(0.0);
    for _ in 0..3 {
        padded[..n].fill(0.0);
        padded[n..].copy_from_slice(lambda_);
        forces.fill(0.0);
        structure.multiply_add(&jacobian, &padded, &mut forces, false);
        let mut x: Vec<f64> = wanted.iter().zip(&forces).map(|(w, f)| w - f).collect();
        x.resize(n + m, 0.0);
        solver.solve(&mut x);
        for (lambda_, x) in lambda_.iter_mut().zip(&x[n..]) {
            *lambda_ += x;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A ring of `n` rows with two columns each, whose last is the sum of the others, and a tail that owns its column.
    fn ring(n: usize) -> Vec<Row> {
        let mut rows: Vec<Row> = (0..n).map(|k| vec![(k, 1.0), (k + 1, -2.0)]).collect();
        // Columns 1 to n - 1 cancel with the factors 1, 2, 4, ...
        rows.push(vec![(0, 1.0), (n, -(2.0_f64.powi(n as i32)))]);
        rows.push(vec![(0, 1.0), (n + 1, 1.0)]);
        rows
    }

    #[test]
    fn dependent_rows_are_the_sums_that_are_told() {
        for n in [2, 5, 12] {
            let rows = ring(n);
            // Whichever is last in order is left out.
            for last in [n, 0, n / 2] {
                let order: Vec<usize> =
                    (0..rows.len()).filter(|&i| i != last).chain([last]).collect();
                let found = dependent_rows(&rows, &order);
                assert_eq!(found.len(), 1);
                assert!(found[0].equation != n + 1, "the tail depends on nothing");
                let mut rest: BTreeMap<usize, f64> =
                    rows[found[0].equation].iter().copied().collect();
                for &(j, factor) in &found[0].on {
                    for &(column, x) in &rows[j] {
                        *rest.entry(column).or_insert(0.0) -= factor * x;
                    }
                }
                // Small integers: what is left is rounding of the divisions.
                let bound = 1e-12 * size(&rows[found[0].equation]);
                assert!(rest.values().all(|x| x.abs() <= bound), "{last} of {n}: {rest:?}");
                assert_eq!(found[0].on.len(), n, "all others of the ring");
            }
        }
    }
}
