//! Sparse factorisation with refinement: LDL^T of symmetric matrices, LU by fronts of all others, both regularised,
//! and LU with pivots from everywhere where these fail.
//!
//! The matrix is scaled to unit diagonal on the primal part and to Jacobian rows of unit norm. The multipliers'
//! diagonal is lowered by a tiny number, so that no order of elimination meets a zero pivot; refinement against the
//! true matrix removes what this does to the solution. Without pivoting an indefinite primal block may still spoil
//! the factors: every factorisation is probed by a known solution, and full pivoting takes over where that comes back
//! wrong. Where it comes back right at the first attempt, corrections inside iterations do without refinement, those of
//! large systems with factors in single precision.

mod factors;
mod fronts;
mod kernels;
mod pattern;
mod single;

use crate::linear_solver::{FactorError, LinearSolver, non_finite_element};
use crate::structure::Structure;
use factors::{Failed, Ldlt, Lu};
use fronts::Fronts;
use pattern::{Move, Pattern};

/// What the multipliers' diagonal is lowered by, after scaling.
const REGULARISATION: f64 = 1e-9;
/// Refinement steps of one solution at most.
const REFINEMENTS: usize = 4;
/// Error of the probe's primal unknowns, of size one, above which the factors are useless.
const PROBE_TOLERANCE: f64 = 1e-4;
/// Error of all of the probe's unknowns without refinement, below which corrections go without.
const ROUGH: f64 = 1e-5;
/// The same of factors in single precision.
const ROUGH_SINGLE: f64 = 1e-4;

/// Back end for large systems.
pub(crate) struct Sparse {
    velocities: usize,
    pattern: Pattern,
    moves: Vec<Move>,
    /// The scaled matrix, regularised unless by [`Method::Pivoted`].
    matrix: Vec<f64>,
    scale: Vec<f64>,
    /// Largest row sum of the scaled matrix.
    norm: f64,
    regular: Regular,
    /// Takes over where the regular method fails; made when it first does.
    pivoted: Option<WholeLu>,
    /// How the matrix was factorised last.
    by: Method,
    /// How corrections are solved for.
    correction: Correction,
    solution: Vec<f64>,
    residual: Vec<f64>,
    right: Vec<f64>,
}

/// The method that a structure asks for.
enum Regular {
    Ldlt(Ldlt),
    Fronts(Fronts),
}

impl Regular {
    /// Copies large factors to single precision; returns whether they are large.
    fn copy_single(&mut self) -> bool {
        match self {
            Self::Ldlt(ldlt) => ldlt.copy_single(),
            Self::Fronts(fronts) => fronts.copy_single(),
        }
    }

    /// Solves with the copy.
    fn solve_single(&mut self, x: &mut [f64]) {
        match self {
            Self::Ldlt(ldlt) => ldlt.solve_single(x),
            Self::Fronts(fronts) => fronts.solve_single(x),
        }
    }
}

/// What the factors at hand come from.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Method {
    Regular,
    Pivoted,
}

/// How corrections are solved for.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Correction {
    /// As all others.
    Refined,
    /// Without refinement.
    Plain,
    /// With factors in single precision.
    Single,
}

/// LU with the whole pattern it needs, and the index of each of its entries in the matrix kept.
struct WholeLu {
    lu: Lu,
    pattern: Pattern,
    from: Vec<u32>,
    matrix: Vec<f64>,
}

impl WholeLu {
    fn new(pattern: &Pattern) -> Result<Self, Failed> {
        let (pattern, from) = if pattern.upper {
            pattern.expanded()
        } else {
            (pattern.clone(), (0..pattern.rows.len() as u32).collect())
        };
        Ok(Self { lu: Lu::new(&pattern)?, matrix: vec![0.0; from.len()], pattern, from })
    }

    fn factor(&mut self, matrix: &[f64]) -> Result<(), Failed> {
        for (a, &k) in self.matrix.iter_mut().zip(&self.from) {
            *a = matrix[k as usize];
        }
        self.lu.factor(&self.pattern, &self.matrix)
    }
}

impl Sparse {
    pub(crate) fn new(structure: &Structure) -> Result<Self, FactorError> {
        let n = structure.unknowns();
        let symmetric = structure.is_symmetric();
        let (pattern, moves) = Pattern::new(structure, symmetric);
        let too_large = |_| FactorError::TooLarge { unknowns: n };
        let regular = if symmetric {
            Regular::Ldlt(Ldlt::new(&pattern).map_err(too_large)?)
        } else {
            Regular::Fronts(Fronts::new(&pattern).map_err(too_large)?)
        };
        Ok(Self {
            velocities: structure.velocities(),
            matrix: vec![0.0; pattern.rows.len()],
            scale: vec![1.0; n],
            norm: 0.0,
            regular,
            pivoted: None,
            by: Method::Regular,
            correction: Correction::Refined,
            solution: vec![0.0; n],
            residual: vec![0.0; n],
            right: vec![0.0; n],
            pattern,
            moves,
        })
    }

    /// Scales the matrix in place; on failure names an unknown whose row is empty.
    fn equilibrate(&mut self) -> Result<(), usize> {
        let Self { pattern, matrix, scale, .. } = self;
        let n = pattern.size();
        for i in 0..self.velocities {
            let d = matrix[pattern.diagonal[i] as usize].abs();
            scale[i] = if d > 0.0 { 1.0 / d.sqrt() } else { 1.0 };
        }
        for j in self.velocities..n {
            let squares: f64 = pattern
                .column(j)
                .filter(|&k| (pattern.rows[k] as usize) < self.velocities)
                .map(|k| (matrix[k] * scale[pattern.rows[k] as usize]).powi(2))
                .sum();
            scale[j] = if squares > 0.0 { 1.0 / squares.sqrt() } else { 1.0 };
        }
        let sums = &mut self.residual;
        sums.fill(0.0);
        for j in 0..n {
            for k in pattern.column(j) {
                let i = pattern.rows[k] as usize;
                matrix[k] *= scale[i] * scale[j];
                sums[i] += matrix[k].abs();
                if pattern.upper && i != j {
                    sums[j] += matrix[k].abs();
                }
            }
        }
        self.norm = sums.iter().fold(0.0, |m, s| m.max(*s));
        // Not `s > 0`: a sum that is not a number has failed too.
        match sums.iter().position(|s| !s.is_finite() || *s == 0.0) {
            Some(unknown) => Err(unknown),
            None => Ok(()),
        }
    }

    fn shift_multipliers(&mut self, by: f64) {
        for &k in &self.pattern.diagonal[self.velocities..] {
            self.matrix[k as usize] += by;
        }
    }

    /// Solves for a known solution; returns the worst primal unknown with its error, and notes whether the solution
    /// was right at once.
    fn probe(&mut self) -> (usize, f64) {
        let known = |i: usize| if (i * 2_654_435_761) & 64 == 0 { 1.0 } else { -1.0 };
        let worst = |x: &[f64]| {
            x.iter().enumerate().fold((0, 0.0), |worst: (usize, f64), (i, x)| {
                let error = (x - known(i)).abs();
                match error.is_nan() {
                    true => (i, f64::INFINITY),
                    false if error > worst.1 => (i, error),
                    false => worst,
                }
            })
        };
        let mut x = std::mem::take(&mut self.solution);
        for (i, x) in x.iter_mut().enumerate() {
            *x = known(i);
        }
        let mut b = std::mem::take(&mut self.right);
        b.fill(0.0);
        self.subtract_product(&x, &mut b, false);
        for (x, b) in x.iter_mut().zip(&mut b) {
            *b = -*b;
            *x = *b;
        }
        self.apply_factors(&mut x, false);
        let mut found = worst(&x);
        self.correction = Correction::Refined;
        if found.1 < ROUGH {
            self.correction = Correction::Plain;
            if self.by == Method::Regular && self.regular.copy_single() {
                x.copy_from_slice(&b);
                self.regular.solve_single(&mut x);
                if worst(&x).1 < ROUGH_SINGLE {
                    self.correction = Correction::Single;
                }
            }
        }
        self.solution = x;
        if self.correction == Correction::Refined {
            self.solve_scaled(&mut b, false);
            found = worst(&b[..self.velocities]);
        }
        self.right = b;
        found
    }

    /// `y -= A x` with the true, scaled matrix.
    fn subtract_product(&self, x: &[f64], y: &mut [f64], transposed: bool) {
        self.pattern.subtract_product(&self.matrix, x, y, transposed);
        if self.by == Method::Regular {
            let from = self.velocities;
            for (y, x) in y[from..].iter_mut().zip(&x[from..]) {
                *y -= REGULARISATION * x;
            }
        }
    }

    fn apply_factors(&mut self, x: &mut [f64], transposed: bool) {
        match (self.by, &mut self.regular, &mut self.pivoted) {
            (Method::Regular, Regular::Ldlt(ldlt), _) => ldlt.solve(x),
            (Method::Regular, Regular::Fronts(fronts), _) => fronts.solve(x, transposed),
            (Method::Pivoted, _, Some(whole)) => whole.lu.solve(x, transposed),
            (Method::Pivoted, _, None) => {}
        }
    }

    /// Solution of the scaled system, refined until the residual is at rounding level.
    fn solve_scaled(&mut self, b: &mut [f64], transposed: bool) {
        let mut x = std::mem::take(&mut self.solution);
        let mut r = std::mem::take(&mut self.residual);
        r.copy_from_slice(b);
        x.fill(0.0);
        let size = |v: &[f64]| v.iter().fold(0.0_f64, |m, a| m.max(a.abs()));
        let right = size(b);
        let mut last = f64::INFINITY;
        for _ in 0..=REFINEMENTS {
            self.apply_factors(&mut r, transposed);
            for (x, r) in x.iter_mut().zip(&r) {
                *x += r;
            }
            r.copy_from_slice(b);
            self.subtract_product(&x, &mut r, transposed);
            let now = size(&r);
            if now <= 2.0 * f64::EPSILON * (self.norm * size(&x) + right) || now > 0.5 * last {
                break;
            }
            last = now;
        }
        b.copy_from_slice(&x);
        self.solution = x;
        self.residual = r;
    }

    fn solve_with(&mut self, x: &mut [f64], transposed: bool, how: Correction) {
        for (x, s) in x.iter_mut().zip(&self.scale) {
            *x *= s;
        }
        match how {
            Correction::Single => self.regular.solve_single(x),
            Correction::Refined => self.solve_scaled(x, transposed),
            Correction::Plain => self.apply_factors(x, transposed),
        }
        for (x, s) in x.iter_mut().zip(&self.scale) {
            *x *= s;
        }
    }

    fn factor_regular(&mut self) -> Option<()> {
        self.by = Method::Regular;
        self.shift_multipliers(-REGULARISATION);
        let factored = match &mut self.regular {
            Regular::Ldlt(ldlt) => ldlt.factor(&self.pattern, &self.matrix),
            Regular::Fronts(fronts) => fronts.factor(&self.matrix),
        };
        if factored.is_ok() && self.probe().1 < PROBE_TOLERANCE {
            return Some(());
        }
        self.shift_multipliers(REGULARISATION);
        None
    }

    fn factor_pivoted(&mut self) -> Result<(), FactorError> {
        let unknowns = self.pattern.size();
        self.by = Method::Pivoted;
        let mut whole = match self.pivoted.take() {
            Some(whole) => whole,
            None => WholeLu::new(&self.pattern).map_err(|_| FactorError::TooLarge { unknowns })?,
        };
        let factored = whole.factor(&self.matrix).is_ok();
        self.pivoted = Some(whole);
        let (unknown, error) = if factored { self.probe() } else { (0, f64::INFINITY) };
        if error < PROBE_TOLERANCE { Ok(()) } else { Err(FactorError::Singular { unknown }) }
    }
}

impl LinearSolver for Sparse {
    fn factor(&mut self, structure: &Structure, values: &[f64]) -> Result<(), FactorError> {
        self.pattern.assemble(&self.moves, values, &mut self.matrix);
        let scaled = self.equilibrate();
        scaled.map_err(|unknown| match non_finite_element(structure, values) {
            Some(element) => FactorError::NotFinite { element },
            None => FactorError::Singular { unknown },
        })?;
        match self.factor_regular() {
            Some(()) => Ok(()),
            None => self.factor_pivoted(),
        }
    }

    fn solve(&mut self, x: &mut [f64]) {
        self.solve_with(x, false, Correction::Refined);
    }

    fn correct(&mut self, x: &mut [f64]) {
        self.solve_with(x, false, self.correction);
    }

    fn negative_eigenvalues(&self) -> Option<usize> {
        match (self.by, &self.regular) {
            (Method::Regular, Regular::Ldlt(ldlt)) => Some(ldlt.negative_pivots()),
            _ => None,
        }
    }

    fn solve_transposed(&mut self, x: &mut [f64]) {
        self.solve_with(x, true, Correction::Refined);
    }

    fn factor_cost(&self) -> f64 {
        match &self.regular {
            Regular::Ldlt(_) => 10.0,
            Regular::Fronts(_) => 8.0,
        }
    }

    fn describe(&self) -> String {
        let n = self.pattern.size();
        match &self.regular {
            Regular::Ldlt(ldlt) => {
                let (entries, blocked) = ldlt.size();
                let kind = if blocked { "supernodal" } else { "simplicial" };
                format!("sparse {kind} LDL^T: {n} unknowns, {entries} entries in L")
            }
            Regular::Fronts(fronts) => {
                format!("sparse LU by fronts: {n} unknowns, {} entries in L and U", fronts.size())
            }
        }
    }
}
