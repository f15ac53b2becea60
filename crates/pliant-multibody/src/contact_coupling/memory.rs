//! What contact remembers from the last accepted step: where bristles stood and how far they were bent.
//!
//! The bristles of a new point are interpolated between the points of the last step on the same zone (equal points give
//! them back exactly); beyond the ends of the old zone those of the nearest point within two radii serve. A grid fixed
//! to the material would smear them at every step, and a sloping load would creep.

use crate::probes::memory::ProbeMemory;
use nalgebra::Vector3;
use pliant_contact::friction::transport;
use serde::{Deserialize, Serialize};

/// A point of the last step.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Bristle {
    /// Number of the contact.
    pub contact: u32,
    /// Whether it is that of a free end.
    pub end: bool,
    /// Arc length on the slave [m].
    pub slave: f64,
    /// Arc length on the master [m]; 0 on shapes.
    pub master: f64,
    /// The zone it lies in, by arc length on the slave [m].
    pub zone: [f64; 2],
    /// Deflection [m].
    pub z: [f64; 3],
    /// Normal.
    pub n: [f64; 3],
}

/// A pair whose tangent is in the iteration matrix.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Pair {
    /// Number of the contact.
    pub contact: u32,
    /// Element of the slave; `u32::MAX` for all of them, before a shape.
    pub slave: u32,
    /// Element of the master.
    pub master: u32,
}

/// Numbers of a [`PatchRecord`].
pub const PATCH: usize = 12;
/// A place where bodies touch: number of the contact, point [m], normal towards its first side (of lines the slave),
/// smallest gap [m], normal force [N], friction on the first side [N].
pub type PatchRecord = [f64; PATCH];

/// What contact remembers.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ContactMemory {
    /// Time of the last accepted step [s].
    pub t: f64,
    /// Coordinates there; empty before the first.
    pub q: Vec<f64>,
    /// Points there with friction, by contact and arc length of the slave.
    pub bristles: Vec<Bristle>,
    /// Pairs in the iteration matrix, and for how many steps each has not touched.
    pub coupled: Vec<(Pair, u32)>,
    /// For each contact: force on the slave [N] and its integral over time [N s].
    pub totals: Vec<[f64; 6]>,
    /// Whether anything touched at the step before that.
    pub had_touched: bool,
    /// Where lines touch.
    pub patches: Vec<PatchRecord>,
    /// Of bodies other than lines.
    pub probes: ProbeMemory,
}

impl ContactMemory {
    /// Whether anything touched at the last accepted step.
    #[must_use]
    pub fn has_touched(&self) -> bool {
        let all = self.totals.iter().chain(&self.probes.totals);
        all.into_iter().any(|f| f[..3] != [0.0; 3])
    }

    /// What touched at the last accepted step; contacts of lines, `lines` of them, count first.
    pub fn records(&self, lines: usize) -> impl Iterator<Item = PatchRecord> + '_ {
        let others = self.probes.patches.iter().map(move |patch| {
            let mut record = [0.0; PATCH];
            record[0] = (lines + patch.contact as usize) as f64;
            record[1..4].copy_from_slice(&patch.point);
            record[4..7].copy_from_slice(&patch.normal);
            (record[7], record[8]) = (patch.gap, patch.normal_force);
            record[9..].copy_from_slice(&patch.friction_force);
            record
        });
        self.patches.iter().copied().chain(others)
    }

    /// The points with friction of a contact, those of its free ends or all others, by arc length of the slave.
    #[must_use]
    pub fn bristles_of(&self, contact: u32, end: bool) -> &[Bristle] {
        let key = |b: &Bristle| (b.contact, b.end);
        let first = self.bristles.partition_point(|b| key(b) < (contact, end));
        let here = &self.bristles[first..];
        &here[..here.partition_point(|b| key(b) <= (contact, end))]
    }

    /// Sorts the points, and joins zones that touch: they end at the borders of elements.
    pub fn arrange(&mut self) {
        self.bristles.sort_by(|a, b| {
            let key = |b: &Bristle| (b.contact, b.end);
            key(a)
                .cmp(&key(b))
                .then(a.slave.total_cmp(&b.slave))
                .then(a.master.total_cmp(&b.master))
        });
        let mut from = 0;
        while from < self.bristles.len() {
            let first = self.bristles[from];
            let mut zone = first.zone;
            let mut to = from + 1;
            while let Some(next) = self.bristles.get(to) {
                let slack = 1e-9 * (1.0 + zone[1].abs());
                let same = next.contact == first.contact
                    && next.end == first.end
                    && next.zone[0] <= zone[1] + slack;
                if !same {
                    break;
                }
                zone[1] = zone[1].max(next.zone[1]);
                to += 1;
            }
            for b in &mut self.bristles[from..to] {
                b.zone = zone;
            }
            from = to;
        }
    }
}

/// Cosine of the angle between normals up to which points may be those of one track.
const ALIKE: f64 = 0.5;

/// Of some points the first that faces as `n` does. In a groove of a surface a point has a foot on each slope: of several
/// at one place the one whose normal is nearest counts.
fn alike<'a>(points: impl Iterator<Item = &'a Bristle>, n: Vector3<f64>) -> Option<&'a Bristle> {
    let along = |b: &Bristle| Vector3::from(b.n).dot(&n);
    let mut best: Option<&Bristle> = None;
    for point in points {
        if best.is_some_and(|best| best.slave != point.slave) {
            break;
        }
        if along(point) > best.map_or(ALIKE, along) {
            best = Some(point);
        }
    }
    best
}

/// Deflection at a new point with the normal `n`, among the `bristles` of its contact.
#[must_use]
pub fn bristle(
    bristles: &[Bristle],
    (slave, master): (f64, f64),
    n: Vector3<f64>,
    radius: f64,
) -> Vector3<f64> {
    let middle = bristles.partition_point(|b| b.slave <= slave);
    // Other turns of the same line may lie on the same place.
    let same = |b: &&Bristle| (b.master - master).abs() <= (b.slave - slave).abs() + 4.0 * radius;
    let before = alike(bristles[..middle].iter().rev().filter(same), n);
    let after = alike(bristles[middle..].iter().filter(same), n);
    let carried = |b: &Bristle| transport(Vector3::from(b.z), Vector3::from(b.n), n);
    let near = |b: &&Bristle| {
        (b.zone[0] <= slave && slave <= b.zone[1]) || (b.slave - slave).abs() <= 2.0 * radius
    };
    match (before, after) {
        (Some(a), Some(b)) if a.zone == b.zone && b.slave > a.slave => {
            let part = (slave - a.slave) / (b.slave - a.slave);
            carried(a) * (1.0 - part) + carried(b) * part
        }
        (a, b) => {
            let distance = |x: &&Bristle| (x.slave - slave).abs();
            let nearest =
                [a, b].into_iter().flatten().min_by(|x, y| distance(x).total_cmp(&distance(y)));
            nearest.filter(near).map_or(Vector3::zeros(), carried)
        }
    }
}
