//! Sections that turn: friction acts on the surface of a beam, a radius off its centre line, and so about it.
//!
//! At a point of contact the surface lies `rho n` from the line, `rho = R + g/2`: both sides meet in the middle of the
//! gap. Over the section's directions `g_y`, `g_z` that is `y g_y + z g_z`, `y = rho n.g_y`, `z = rho n.g_z`. Slip counts the
//! motion of that point, and friction acts on the directions with the weights y and z as it does on positions and
//! slopes with theirs. A cable has no directions: friction acts on its line. The tangent holds the weights.

use super::run::Touch;
use super::{Contacts, Master};
use nalgebra::Vector3;
use pliant_contact::touch::Point;

/// Coordinates of the directions of both sides, master then slave, and their weights in the slip.
#[derive(Clone, Copy, Debug)]
pub(super) struct Arms {
    /// Where they are.
    pub(super) offsets: [usize; 8],
    /// Their weights; 0 where a side has none.
    pub(super) beta: [f64; 8],
}

impl Arms {
    /// What they add to the slip, from their velocities or displacements.
    pub(super) fn sum(&self, x: &[f64]) -> Vector3<f64> {
        let terms = self.offsets.iter().zip(&self.beta).filter(|&(_, &b)| b != 0.0);
        terms.map(|(&o, &b)| Vector3::new(x[o], x[o + 1], x[o + 2]) * b).sum()
    }
}

impl Contacts {
    /// Whether friction turns anything here.
    pub(super) fn turns(&self, touch: &Touch) -> bool {
        let contact = &self.list[touch.contact];
        let beam = |line: usize| self.lines[line].first().is_some_and(|s| s.section.is_some());
        let master = matches!(contact.master, Master::Line(line) if beam(line));
        contact.laws.friction.is_some() && (beam(contact.slave) || master)
    }

    /// The arms of a point at coordinates `q`.
    pub(super) fn arms(&self, touch: &Touch, point: &Point, q: &[f64]) -> Arms {
        let contact = &self.list[touch.contact];
        let mut arms = Arms { offsets: [0; 8], beta: [0.0; 8] };
        let slave = &self.lines[contact.slave][touch.slave];
        let master = match contact.master {
            Master::Line(line) => Some(&self.lines[line][touch.master]),
            Master::Shape(_) => None,
        };
        let (n, gap) = (point.place.n, point.place.gap);
        // From the slave's line to its surface along n, from the master's against it; slip is the master's less the
        // slave's: both signs are the same.
        let sides = [(0, master, point.eta), (4, Some(slave), point.xi)];
        for (first, segment, xi) in sides {
            let Some((segment, offsets)) = segment.and_then(|s| Some((s, s.section?))) else {
                continue;
            };
            let rho = segment.radius + 0.5 * gap;
            let x = offsets.map(|o| Vector3::new(q[o], q[o + 1], q[o + 2]));
            for k in 0..2 {
                let weight = -rho * n.dot(&(x[k] * (1.0 - xi) + x[k + 2] * xi));
                for (end, part) in [(0, 1.0 - xi), (2, xi)] {
                    arms.offsets[first + k + end] = offsets[k + end];
                    arms.beta[first + k + end] = weight * part;
                }
            }
        }
        arms
    }
}
