//! Precomputed numbers of surface elements: shape-function rows in the local Cartesian frame of the reference surface.
//!
//! At each point of the rule, with A_a = X,a: e_1 = A_1/|A_1|, e_2 = n_0 x e_1, `J_ia = A_a.e_i`,
//! `B_i = (J^-1)_ai N,a` and `H_ij = (J^-1)_ai (J^-1)_bj N,ab`. Strains come out in the frame, free of metrics, and the
//! reference is free of strain by construction, whatever its curvature.

use super::invariants::{self, Membrane};
use crate::elements::cable::Bending;
use crate::elements::surface::{Chart, Integrals, Jet, Quadrature, QuadraturePoint, SurfaceKind};
use crate::surface::SurfaceLaw;
use pliant_math::Vec3;

/// Rows at a point: B_1, B_2, H_11, H_22, H_12.
pub(crate) type Rows = [Vec<f64>; 5];

/// Precomputed numbers of one geometry; equal elements share them.
#[derive(Clone, Debug)]
pub(crate) struct Table {
    /// Number of points.
    pub points: usize,
    /// Row (5 or 2 a point) by row, each padded to the width.
    pub rows: Vec<f64>,
    /// Their transpose, columns padded to a multiple of 8.
    pub columns: Vec<f64>,
    /// Length of a column.
    pub stride: usize,
    /// Reference area of each point in the membrane and in the bending part [m^2].
    pub areas: Vec<[f64; 2]>,
    /// Reference curvature (11, 22, 12) at each point [1/m].
    pub curvature: Vec<[f64; 3]>,
    /// Points at which pressure acts.
    pub pressure: Vec<PressurePoint>,
    /// Integrals of the membrane, where they are precomputed.
    pub membrane: Option<Membrane>,
    /// Matrix of simplified bending.
    pub bending: Option<Vec<f64>>,
    /// Mass matrix for unit mass per area, width by width [m^2].
    pub mass: Vec<f64>,
    /// The same of the middle: rows, reference curvature.
    pub middle: (Rows, [f64; 3]),
}

/// What pressure at a point needs.
#[derive(Clone, Debug)]
pub(crate) struct PressurePoint {
    /// Reference area [m^2].
    pub area: f64,
    /// Shape functions.
    pub shape: Vec<f64>,
    /// B_1 and B_2.
    pub rows: [Vec<f64>; 2],
}

/// What is found at a place of the reference surface.
pub(crate) struct Place {
    pub rows: Rows,
    pub curvature: [f64; 3],
    /// Reference area for each parameter area.
    pub density: f64,
    pub shape: Vec<f64>,
}

/// Sum of nodal vectors.
pub(crate) fn sum(weights: impl Iterator<Item = f64>, vectors: &[[f64; 3]]) -> Vec3<f64> {
    weights.zip(vectors).fold(Vec3::zero(0.0), |sum, (w, &x)| sum.add_times(w, Vec3::from(x)))
}

/// Rows and geometry at a place; none where the surface is degenerate.
pub(crate) fn place(
    kind: SurfaceKind,
    chart: &Chart,
    reference: &[[f64; 3]],
    at: [f64; 2],
) -> Option<Place> {
    let jets = kind.shape(chart, at);
    let along = |part: fn(&Jet) -> f64| sum(jets.iter().map(part), reference);
    let (a, b) = (along(|j| j.u), along(|j| j.v));
    let normal = a.cross(b);
    let (length, area) = (a.dot(a).sqrt(), normal.dot(normal).sqrt());
    if area.is_nan() || area <= 1e-12 * (a.dot(a) + b.dot(b)) {
        return None;
    }
    let normal = normal.times(1.0 / area);
    let e = [a.times(1.0 / length), normal.cross(a.times(1.0 / length))];
    // J = [[A1.e1, A2.e1], [0, A2.e2]]
    let (j11, j12, j22) = (length, b.dot(e[0]), b.dot(e[1]));
    // inverse[a][i]
    let inverse = [[1.0 / j11, -j12 / (j11 * j22)], [0.0, 1.0 / j22]];
    let first = |i: usize| -> Vec<f64> {
        jets.iter().map(|j| inverse[0][i] * j.u + inverse[1][i] * j.v).collect()
    };
    let second = |i: usize, k: usize| -> Vec<f64> {
        jets.iter()
            .map(|j| {
                inverse[0][i] * inverse[0][k] * j.uu
                    + inverse[1][i] * inverse[1][k] * j.vv
                    + (inverse[0][i] * inverse[1][k] + inverse[1][i] * inverse[0][k]) * j.uv
            })
            .collect()
    };
    let rows: Rows = [first(0), first(1), second(0, 0), second(1, 1), second(0, 1)];
    let curvature = [2, 3, 4].map(|k: usize| sum(rows[k].iter().copied(), reference).dot(normal));
    Some(Place { rows, curvature, density: area, shape: jets.iter().map(|j| j.value).collect() })
}

impl Table {
    /// Integrals over an element; none where its reference surface is degenerate.
    pub fn new(
        kind: SurfaceKind,
        law: &SurfaceLaw,
        chart: &Chart,
        reference: &[[f64; 3]],
        width: usize,
    ) -> Option<Self> {
        let rows_per_point = law.rows(kind);
        let whole = kind.rule(law.quadrature);
        let exact = match law.integrals {
            Integrals::Quadrature => None,
            Integrals::Precomputed => kind.exact_rule(),
        };
        // What is left to quadrature.
        let weights = |point: &QuadraturePoint| {
            let membrane = if exact.is_some() { 0.0 } else { point.membrane };
            let bending = if rows_per_point == 5 { point.bending } else { 0.0 };
            QuadraturePoint { membrane, bending, ..*point }
        };
        let rule: Vec<QuadraturePoint> = whole
            .iter()
            .map(weights)
            .filter(|point| point.membrane != 0.0 || point.bending != 0.0)
            .collect();
        let parameters = kind.parameter_area(chart);
        let n = kind.vectors();
        let stride = (rows_per_point * rule.len()).next_multiple_of(8);
        let mut table = Self {
            points: rule.len(),
            rows: Vec::with_capacity(rule.len() * rows_per_point * width),
            columns: vec![0.0; width * stride],
            stride,
            areas: Vec::with_capacity(rule.len()),
            curvature: Vec::with_capacity(rule.len()),
            pressure: Vec::with_capacity(whole.len()),
            membrane: None,
            bending: None,
            mass: vec![0.0; width * width],
            middle: Default::default(),
        };
        let pad = |to: &mut Vec<f64>, row: &[f64]| {
            to.extend_from_slice(row);
            to.resize(to.len() + width - row.len(), 0.0);
        };
        for (p, &QuadraturePoint { at, membrane, bending }) in rule.iter().enumerate() {
            let here = place(kind, chart, reference, at)?;
            for (s, row) in here.rows[..rows_per_point].iter().enumerate() {
                pad(&mut table.rows, row);
                for (i, c) in row.iter().enumerate() {
                    table.columns[i * stride + rows_per_point * p + s] = *c;
                }
            }
            let area = here.density * parameters;
            table.areas.push([membrane * area, bending * area]);
            table.curvature.push(here.curvature);
        }
        // Reduced rules would not be exact for a_1 x a_2, and closed surfaces would feel a force.
        let pressure = match law.quadrature {
            Quadrature::Reduced => kind.rule(Quadrature::Standard),
            _ => whole,
        };
        for point in &pressure {
            let Place { rows: [b1, b2, ..], density, shape, .. } =
                place(kind, chart, reference, point.at)?;
            let area = point.membrane * density * parameters;
            table.pressure.push(PressurePoint { area, shape, rows: [b1, b2] });
        }
        let linear = law.material.linear();
        if let Some(rule) = exact {
            table.membrane = Some(Membrane::new(kind, &linear, &rule, chart, reference, width)?);
        }
        if kind.bends() && law.bending == Bending::Simplified {
            table.bending = Some(invariants::bending(kind, &linear, chart, reference, width)?);
        }
        for point in kind.mass_rule() {
            let here = place(kind, chart, reference, point.at)?;
            let area = point.membrane * here.density * parameters;
            for i in 0..n {
                for j in 0..n {
                    table.mass[i * width + j] += area * here.shape[i] * here.shape[j];
                }
            }
        }
        let middle = place(kind, chart, reference, kind.middle())?;
        table.middle = (middle.rows, middle.curvature);
        Some(table)
    }

    /// Whether parts of the energy are integrated already.
    pub fn has_integrals(&self) -> bool {
        self.membrane.is_some() || self.bending.is_some()
    }

    /// Key under which equal tables are found: numbers to eleven digits.
    pub fn key(&self) -> Vec<i64> {
        let digits = |x: f64, scale: f64| {
            let y = x / scale * 1e11;
            // Beyond the range of rounding there is nothing to tell apart.
            if y.is_finite() { y.round() as i64 } else { 0 }
        };
        let size = |numbers: &[f64]| numbers.iter().fold(f64::MIN_POSITIVE, |m, x| x.abs().max(m));
        let first: Vec<f64> = self.pressure.iter().flat_map(|point| point.rows.concat()).collect();
        let mut key = Vec::with_capacity(self.rows.len() + first.len());
        for numbers in [&self.rows, &first, &self.mass] {
            let scale = size(numbers);
            key.push(scale.to_bits() as i64 >> 16);
            key.extend(numbers.iter().map(|&x| digits(x, scale)));
        }
        let flat = size(&first);
        key.extend(self.curvature.iter().flatten().map(|&b| digits(b, flat)));
        key
    }
}
