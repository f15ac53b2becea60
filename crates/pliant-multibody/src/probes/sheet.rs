//! Probes of a surface: on each face the points of the trapezoidal rule over a grid, corners and edges included.
//!
//! The corners matter: a robot stands on them. Neighbours have the points of their common edge twice, with the area of
//! either.

use crate::surface_map::SurfaceMap;
use crate::vector::vector;
use nalgebra::Vector3;

/// Pieces along each side of a face.
const FINE: usize = 4;

/// A face with its probes.
#[derive(Clone, Debug)]
pub(crate) struct Face {
    /// Coordinates of its nodal vectors.
    pub offsets: Vec<usize>,
    /// Weights of the nodal vectors and stress-free area [m^2] of each probe.
    pub rule: Vec<(Vec<f64>, f64)>,
    /// Half of its thickness [m].
    pub radius: f64,
    /// Nodal vectors at a node.
    vectors: usize,
    /// Bounds over the probes: of the sum of the positions' weights, and of each weight.
    reach: (f64, Vec<f64>),
}

/// Places of a face and their shares of the parameters' square, or triangle.
fn places(corners: usize) -> Vec<([f64; 2], f64)> {
    let n = FINE as f64;
    let mut all = Vec::new();
    for i in 0..=FINE {
        for j in 0..=if corners == 4 { FINE } else { FINE - i } {
            let at = [i as f64 / n, j as f64 / n];
            let share = if corners == 4 {
                let side = |k: usize| if k == 0 || k == FINE { 0.5 } else { 1.0 };
                side(i) * side(j) / (n * n)
            } else {
                // A third of each of the small triangles that meet here.
                let edges = usize::from(i == 0) + usize::from(j == 0) + usize::from(i + j == FINE);
                [6.0, 3.0, 1.0][edges] / (6.0 * n * n)
            };
            all.push((at, share));
        }
    }
    all
}

impl Face {
    /// All faces of a surface; `thickness` is one number or one for each.
    pub(crate) fn all(map: &SurfaceMap, thickness: &[f64]) -> Vec<Self> {
        let each = map.faces.iter().enumerate().map(|(number, face)| {
            let reference = map.reference_of(face);
            let chart = &face.chart;
            let last = face.kind.corners() - 1;
            let side = |to: usize| [0, 1].map(|c| chart.corners[to][c] - chart.corners[0][c]);
            let (x, y) = (side(1), side(last));
            let rule: Vec<(Vec<f64>, f64)> = places(face.kind.corners())
                .into_iter()
                .map(|(at, share)| {
                    let jets = face.kind.shape(chart, at);
                    let along = |d: [f64; 2]| -> Vector3<f64> {
                        let terms = jets.iter().zip(&reference);
                        terms.map(|(j, &r)| vector(r) * (d[0] * j.u + d[1] * j.v)).sum()
                    };
                    let area = along(x).cross(&along(y)).norm() * share;
                    (jets.iter().map(|j| j.value).collect(), area)
                })
                .collect();
            let vectors = map.vectors;
            let count = reference.len();
            let positions = |w: &[f64]| w.iter().step_by(vectors).map(|w| w.abs()).sum::<f64>();
            let total = rule.iter().map(|(w, _)| positions(w)).fold(0.0, f64::max);
            let most = |k: usize| rule.iter().map(|(w, _)| w[k].abs()).fold(0.0, f64::max);
            Self {
                offsets: map.vectors_of(face),
                radius: 0.5 * thickness[if thickness.len() == 1 { 0 } else { number }],
                vectors,
                reach: (total, (0..count).map(most).collect()),
                rule,
            }
        });
        each.collect()
    }

    /// A place in its midst, and a distance from it that no probe exceeds.
    pub(crate) fn ball(&self, q: &[f64]) -> (Vector3<f64>, f64) {
        let at = |k: usize| {
            let o = self.offsets[k];
            Vector3::new(q[o], q[o + 1], q[o + 2])
        };
        let corners = self.offsets.len() / self.vectors;
        let middle =
            (0..corners).map(|c| at(c * self.vectors)).sum::<Vector3<f64>>() / corners as f64;
        let (total, most) = &self.reach;
        let mut farthest = 0.0_f64;
        let mut rest = 0.0;
        for k in 0..self.offsets.len() {
            if k % self.vectors == 0 {
                farthest = farthest.max((at(k) - middle).norm());
            } else {
                rest += most[k] * at(k).norm();
            }
        }
        (middle, total * farthest + rest)
    }

    /// A bound of how far a probe has moved, by how far each nodal vector has.
    pub(crate) fn moved(&self, change: impl Fn(usize) -> f64) -> f64 {
        let (total, most) = &self.reach;
        let (mut farthest, mut rest) = (0.0_f64, 0.0);
        for (k, &o) in self.offsets.iter().enumerate() {
            if k % self.vectors == 0 {
                farthest = farthest.max(change(o));
            } else {
                rest += most[k] * change(o);
            }
        }
        total * farthest + rest
    }

    /// Where a probe is.
    pub(crate) fn probe(&self, number: usize, q: &[f64]) -> Vector3<f64> {
        let terms = self.offsets.iter().zip(&self.rule[number].0);
        terms.map(|(&o, &w)| Vector3::new(q[o], q[o + 1], q[o + 2]) * w).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_sum_to_the_whole() {
        for (corners, whole) in [(4, 1.0), (3, 0.5)] {
            let sum: f64 = places(corners).iter().map(|p| p.1).sum();
            // Rounding. The parameters' triangle has half of the square.
            assert!((sum - whole).abs() < 1e-14, "{corners}: {sum}");
        }
    }
}
