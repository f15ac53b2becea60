//! What probes remember from the last accepted step. Those along lines are kept with the lines' own bristles.

use nalgebra::Vector3;
use pliant_contact::friction::transport;
use serde::{Deserialize, Serialize};

/// A probe with friction.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Spot {
    /// Number of the facing.
    pub facing: u32,
    /// Number of the probe; [`Self::NEAREST`] for points that have none.
    pub id: u64,
    /// Where it was on its rigid body, or its foot on the stress-free surface [m].
    pub at: [f64; 3],
    /// Deflection of the bristles [m].
    pub z: [f64; 3],
    /// Normal.
    pub n: [f64; 3],
}

impl Spot {
    /// Of points that are told by their place.
    pub const NEAREST: u64 = u64::MAX;
}

/// A probe that was beyond the mid-surface of what it touches.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Crossed {
    /// Number of the facing.
    pub facing: u32,
    /// Number of the probe; along lines arc length [m].
    pub key: f64,
    /// Its foot on the stress-free surface [m].
    pub place: [f64; 3],
}

impl Crossed {
    /// Whether it is a given probe, on the same place of the surface but for what it may have slid.
    #[must_use]
    pub fn is(&self, facing: u32, key: f64, place: Vector3<f64>, reach: f64) -> bool {
        let numbered = self.key == key;
        let beside = (self.key - key).abs() <= reach && self.key.fract() != 0.0;
        let far = (Vector3::from(self.place) - place).norm();
        self.facing == facing && (numbered || beside) && far <= 10.0 * reach
    }
}

/// Two parts whose tangent is in the iteration matrix.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Couple {
    /// Number of the facing.
    pub facing: u32,
    /// Part of its slave.
    pub part: u32,
    /// Face of its master.
    pub face: u32,
}

/// All of them.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ProbeMemory {
    /// Probes that touched, by facing and number.
    pub spots: Vec<Spot>,
    /// For each contact: force on its first side [N] and its integral over time [N s].
    pub totals: Vec<[f64; 6]>,
    /// What touched there.
    pub patches: Vec<Patch>,
    /// Probes beyond mid-surfaces there.
    pub crossed: Vec<Crossed>,
    /// Couples in the iteration matrix, and for how many steps each has not touched.
    pub coupled: Vec<(Couple, u32)>,
}

/// A patch in contact.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Patch {
    /// Number of the contact.
    pub contact: u32,
    /// Its middle, weighted by the normal force [m].
    pub point: [f64; 3],
    /// Mean normal, towards the contact's first side.
    pub normal: [f64; 3],
    /// Smallest gap [m].
    pub gap: f64,
    /// Normal force [N].
    pub normal_force: f64,
    /// Friction on the contact's first side [N].
    pub friction_force: [f64; 3],
}

impl ProbeMemory {
    /// Deflection of a probe with the normal `n`: of several with its number that of the nearest within `reach`.
    #[must_use]
    pub fn bristle(
        &self,
        facing: u32,
        id: u64,
        at: Vector3<f64>,
        n: Vector3<f64>,
        reach: f64,
    ) -> Vector3<f64> {
        let first = self.spots.partition_point(|s| (s.facing, s.id) < (facing, id));
        let last = self.spots.partition_point(|s| (s.facing, s.id) <= (facing, id));
        let here = self.spots[first..last].iter();
        let distance = |s: &&Spot| (Vector3::from(s.at) - at).norm();
        let near = |s: &&Spot| distance(s) < reach;
        here.filter(near)
            .min_by(|a, b| distance(a).total_cmp(&distance(b)))
            .map_or(Vector3::zeros(), |s| transport(Vector3::from(s.z), Vector3::from(s.n), n))
    }
}
