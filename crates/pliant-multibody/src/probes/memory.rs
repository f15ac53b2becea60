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
    /// Where it was on its rigid body [m].
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

/// All of them.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ProbeMemory {
    /// Probes that touched, by facing and number.
    pub spots: Vec<Spot>,
    /// For each contact: force on its first side [N] and its integral over time [N s].
    pub totals: Vec<[f64; 6]>,
    /// What touched there.
    pub patches: Vec<Patch>,
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
    /// Deflection of a probe with the normal `n`; of those without a number that of the nearest within `reach`.
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
        let near = |s: &&Spot| id != Spot::NEAREST || distance(s) < reach;
        here.filter(near)
            .min_by(|a, b| distance(a).total_cmp(&distance(b)))
            .map_or(Vector3::zeros(), |s| transport(Vector3::from(s.z), Vector3::from(s.n), n))
    }
}
