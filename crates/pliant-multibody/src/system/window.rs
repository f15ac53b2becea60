//! Matrices of joints that act on one part of their coordinates at a time: an element of the structure for each part,
//! so that none spans them all, and nothing is analysed anew when the joint moves from one to the next.

use crate::joints::Joint;
use crate::model::PlacedJoint;
use crate::signal::Moment;
use pliant_dae::problem::{Point, Weights};
use pliant_dae::structure::{Storage, Structure, entries, entry_number};

/// A joint with windows, and which of its rows read `lambda_ = 0`.
pub(super) struct Window<'a> {
    pub placed: &'a PlacedJoint,
    pub joint: &'a dyn Joint,
    pub off: &'a [bool],
}

impl Window<'_> {
    /// Writes the matrices of all windows, of which one is not zero.
    pub fn tangents(
        &self,
        structure: &Structure,
        (at, now, x): (Point<'_>, Moment<'_>, &[f64]),
        weights: Weights,
        jacobian: &mut Vec<f64>,
        values: &mut [f64],
    ) {
        let (n, m) = (x.len(), self.joint.equations());
        jacobian.clear();
        jacobian.resize(n * m, 0.0);
        self.joint.jacobian(now, x, jacobian);
        let mut hessian = Vec::new();
        let lambda_ = &at.lambda_[self.placed.first..self.placed.first + m];
        self.joint.hessian_entries(x, lambda_, &mut hessian);
        let active = self.joint.window(x);
        for (number, window) in self.placed.windows.iter().enumerate() {
            let slot = structure.slot(self.placed.element + number);
            let size = window.len() + m;
            let place = |i: usize, j: usize| {
                slot.base + slot.stride * entry_number(size, i, j, Storage::Symmetric)
            };
            for k in 0..entries(size, Storage::Symmetric) {
                values[slot.base + slot.stride * k] = 0.0;
            }
            if number != active {
                continue;
            }
            for i in 0..m {
                let row = window.len() + i;
                if self.off[i] {
                    values[place(row, row)] = -weights.jacobian;
                    continue;
                }
                for (j, &unknown) in window.iter().enumerate() {
                    values[place(row, j)] = weights.jacobian * jacobian[i * n + unknown];
                }
            }
            let inside = |unknown: usize| window.iter().position(|&u| u == unknown);
            for &(i, j, entry) in &hessian {
                if let (Some(i), Some(j)) = (inside(i), inside(j))
                    && j <= i
                {
                    values[place(i, j)] += weights.stiffness * entry;
                }
            }
        }
    }
}
