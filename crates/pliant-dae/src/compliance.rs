//! What compliant equations add to the stiffness: `phi_q x + phi_lambda mu = 0` makes `phi_q^T mu` a force
//! `-sum g (g.x) / d` on the coordinates, g the rows of `phi_q` and d the diagonal `phi_lambda`.

use crate::problem::{Point, Problem, Weights};

/// Weights under which rows and diagonals of compliant equations are those of the equations themselves.
const PLAIN: Weights = Weights { mass: 0.0, damping: 0.0, stiffness: 1.0, jacobian: 1.0 };

/// Rows `phi_q` of the compliant equations and `-1 / phi_lambda`.
#[derive(Clone, Debug, Default)]
pub(crate) struct Compliance {
    rows: Vec<(Vec<f64>, f64)>,
}

impl Compliance {
    /// That of a problem at a state; empty where all equations are strict.
    pub fn new<P: Problem + ?Sized>(problem: &mut P, at: Point<'_>) -> Self {
        let equations = problem.compliant().to_vec();
        if equations.is_empty() {
            return Self::default();
        }
        let n = problem.velocities();
        let mut values = vec![0.0; problem.structure().values()];
        problem.tangent(at, PLAIN, &mut values);
        let structure = problem.structure();
        let rows = equations.iter().map(|&equation| {
            let mut unit = vec![0.0; structure.unknowns()];
            unit[n + equation] = 1.0;
            let mut column = vec![0.0; structure.unknowns()];
            structure.multiply_add(&values, &unit, &mut column, false);
            let diagonal = column[n + equation];
            column.truncate(n);
            (column, -1.0 / diagonal)
        });
        Self { rows: rows.collect() }
    }

    /// Rows and factors: `K x` gains `sum factor g (g.x)`.
    pub fn rows(&self) -> &[(Vec<f64>, f64)] {
        &self.rows
    }

    /// Adds to `y = K x` what belongs there.
    pub fn add_product(&self, x: &[f64], y: &mut [f64]) {
        for (row, factor) in &self.rows {
            let along: f64 = row.iter().zip(x).map(|(g, x)| g * x).sum();
            // A strict equation at this state: x keeps it.
            if factor.is_finite() {
                y.iter_mut().zip(row).for_each(|(y, g)| *y += factor * along * g);
            }
        }
    }
}
