//! Pressure on elements: `f_i = p sum N_i (a_1 x a_2) dA`, along the normal of the vertex order.
//!
//! The tangent `K_ij = p sum N_i ([a_1]x B_2j - [a_2]x B_1j) dA` of one element is unsymmetric. Summed over a closed
//! surface, or one whose rim is held, it is symmetric, and then so is the sum of the elements' symmetric parts.

use super::SurfaceBlock;
use super::scalar::local;
use pliant_math::Vec3;

/// A point of the rule of an element: its reference area [m^2] and rows of the shape functions.
#[derive(Clone, Debug)]
pub struct RulePoint {
    /// Reference area [m^2].
    pub area: f64,
    /// N, B_1 and B_2 for each nodal vector.
    pub rows: [Vec<f64>; 3],
}

impl SurfaceBlock {
    /// Points of the rule of element `e`; `a_1 x a_2` there is the vector area per reference area.
    #[must_use]
    pub fn rule_points(&self, e: usize) -> Vec<RulePoint> {
        let mut points = Vec::new();
        self.each_point(e, &vec![0.0; self.extent], |area, shape, [b1, b2], _| {
            points.push(RulePoint { area, rows: [shape, b1, b2].map(<[f64]>::to_vec) });
        });
        points
    }

    /// Calls `work` with the area, the shape functions, B_1 and B_2 and the vectors a_1 and a_2 of each point.
    pub(super) fn each_point(
        &self,
        e: usize,
        q: &[f64],
        mut work: impl FnMut(f64, &[f64], [&[f64]; 2], [Vec3<f64>; 2]),
    ) {
        let (table, _, _) = self.element(e);
        let q = local(&self.local(e, q));
        for point in &table.pressure {
            let sum = |row: &[f64]| {
                q.iter().zip(row).fold(Vec3::zero(0.0), |sum, (&q, &w)| sum.add_times(w, q))
            };
            let [b1, b2] = &point.rows;
            work(point.area, &point.shape, [b1, b2], [sum(b1), sum(b2)]);
        }
    }

    /// Nodal forces of a unit pressure on element `e`, nodal vector by nodal vector.
    #[must_use]
    pub fn pressure_force(&self, e: usize, q: &[f64]) -> Vec<f64> {
        let mut force = vec![0.0; 3 * self.kind.vectors()];
        self.each_point(e, q, |area, shape, _, a| {
            let f = a[0].cross(a[1]).times(area).array();
            for (to, n) in force.chunks_exact_mut(3).zip(shape) {
                for c in 0..3 {
                    to[c] += n * f[c];
                }
            }
        });
        force
    }

    /// Adds `factor` times the derivative of [`Self::pressure_force`] by the coordinates to `out`, row by row.
    pub fn add_pressure_jacobian(&self, e: usize, q: &[f64], factor: f64, out: &mut [f64]) {
        let n = 3 * self.kind.vectors();
        self.each_point(e, q, |area, shape, [b1, b2], [a1, a2]| {
            for (i, &weight) in shape.iter().enumerate() {
                for j in 0..b1.len() {
                    // d(a_1 x a_2) = a_1 x da_2 - a_2 x da_1 = [v]x dq_j
                    let v = a1.times(b2[j]).add_times(-b1[j], a2).times(factor * area * weight);
                    let cross = [[0.0, -v.z, v.y], [v.z, 0.0, -v.x], [-v.y, v.x, 0.0]];
                    for (c, row) in cross.iter().enumerate() {
                        for (d, entry) in row.iter().enumerate() {
                            out[(3 * i + c) * n + 3 * j + d] += entry;
                        }
                    }
                }
            }
        });
    }
}
