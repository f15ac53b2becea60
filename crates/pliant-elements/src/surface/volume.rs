//! Volume between an element and a point o, `V = 1/3 sum x.(a_1 x a_2) dA` with x = r - o.
//!
//! Gradient and second derivative are those of the sum: energy of an enclosed gas and its forces agree to rounding. Over a
//! closed surface V does not depend on o, and its gradient is the force of a unit pressure. Over an open one it is that
//! force and a line integral along the rim.

use super::SurfaceBlock;
use super::scalar::local;
use pliant_math::Vec3;

impl SurfaceBlock {
    /// Calls `work` with the area, the rows N, B_1, B_2 and the vectors x, a_1, a_2 of each point.
    fn each_cone(
        &self,
        e: usize,
        q: &[f64],
        origin: [f64; 3],
        mut work: impl FnMut(f64, [&[f64]; 3], [Vec3<f64>; 3]),
    ) {
        let nodal = local(&self.local(e, q));
        let origin = Vec3::from(origin).times(-1.0);
        self.each_point(e, q, |area, shape, [b1, b2], [a1, a2]| {
            let x = nodal.iter().zip(shape).fold(origin, |sum, (&q, &w)| sum.add_times(w, q));
            work(area, [shape, b1, b2], [x, a1, a2]);
        });
    }

    /// Volume between element `e` and the point `origin` [m^3].
    #[must_use]
    pub fn volume(&self, e: usize, q: &[f64], origin: [f64; 3]) -> f64 {
        let mut sum = 0.0;
        self.each_cone(e, q, origin, |area, _, [x, a1, a2]| {
            sum += area * x.dot(a1.cross(a2)) / 3.0
        });
        sum
    }

    /// Area of element `e` [m^2].
    #[must_use]
    pub fn current_area(&self, e: usize, q: &[f64]) -> f64 {
        let mut sum = 0.0;
        self.each_point(e, q, |area, _, _, [a1, a2]| {
            let normal = a1.cross(a2);
            sum += area * normal.dot(normal).sqrt();
        });
        sum
    }

    /// Derivative of [`Self::volume`] by the coordinates of the element, nodal vector by nodal vector.
    #[must_use]
    pub fn volume_gradient(&self, e: usize, q: &[f64], origin: [f64; 3]) -> Vec<f64> {
        let mut out = vec![0.0; 3 * self.kind.vectors()];
        self.each_cone(e, q, origin, |area, rows, [x, a1, a2]| {
            let on = [a1.cross(a2), a2.cross(x), x.cross(a1)].map(|f| f.times(area / 3.0));
            for (i, to) in out.chunks_exact_mut(3).enumerate() {
                let sum = (0..3).fold(Vec3::zero(0.0), |sum, k| sum.add_times(rows[k][i], on[k]));
                for (to, f) in to.iter_mut().zip(sum.array()) {
                    *to += f;
                }
            }
        });
        out
    }

    /// Adds `factor` times its second derivative to `out`, row by row: blocks `[c_ij]x` with
    /// `c_ij = 1/3 sum (a_2 (B_1i N_j - N_i B_1j) + a_1 (N_i B_2j - B_2i N_j) + x (B_2i B_1j - B_1i B_2j)) dA`.
    pub fn add_volume_hessian(
        &self,
        e: usize,
        q: &[f64],
        origin: [f64; 3],
        factor: f64,
        out: &mut [f64],
    ) {
        let n = self.kind.vectors();
        let mut sums = vec![Vec3::zero(0.0); n * n];
        self.each_cone(e, q, origin, |area, [shape, b1, b2], [x, a1, a2]| {
            let [x, a1, a2] = [x, a1, a2].map(|v| v.times(factor * area / 3.0));
            for i in 0..n {
                for j in 0..i {
                    sums[i * n + j] = sums[i * n + j]
                        .add_times(b1[i] * shape[j] - shape[i] * b1[j], a2)
                        .add_times(shape[i] * b2[j] - b2[i] * shape[j], a1)
                        .add_times(b2[i] * b1[j] - b1[i] * b2[j], x);
                }
            }
        });
        for i in 0..n {
            for j in 0..i {
                let v = sums[i * n + j];
                let cross = [[0.0, -v.z, v.y], [v.z, 0.0, -v.x], [-v.y, v.x, 0.0]];
                for c in 0..3 {
                    for d in 0..3 {
                        out[(3 * i + c) * 3 * n + 3 * j + d] += cross[c][d];
                        // c_ji = -c_ij, so the block there is the transpose.
                        out[(3 * j + d) * 3 * n + 3 * i + c] += cross[c][d];
                    }
                }
            }
        }
    }
}
