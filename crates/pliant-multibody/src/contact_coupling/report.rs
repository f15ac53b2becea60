//! What a run shows of the places where bodies touch: one record for each zone, however many elements it runs over.

use super::memory::PatchRecord;
use super::run::Touch;
use nalgebra::Vector3;
use pliant_contact::point::Force;
use pliant_contact::touch::Point as Place;

/// Pieces of a zone that are looked back at for one that goes on here: those on other turns of the line lie between.
const BACK: usize = 8;

/// A zone, summed over its points.
struct Zone {
    contact: usize,
    is_end: bool,
    /// Arc length of the slave where it ends, and of the master there [m].
    end: (f64, f64),
    radius: f64,
    weighted: Vector3<f64>,
    normal: Vector3<f64>,
    friction: Vector3<f64>,
    force: f64,
    gap: f64,
}

/// Gathers patches, which come along the slave, into zones.
#[derive(Default)]
pub(super) struct Report {
    zones: Vec<Zone>,
    open: bool,
}

impl Report {
    /// Begins a patch.
    pub(super) fn begin(&mut self, touch: &Touch, radius: f64) {
        let (first, last) = touch.ends();
        let slack = 1e-9 * (1.0 + first.0.abs());
        let follows = |zone: &Zone| {
            zone.contact == touch.contact
                && !zone.is_end
                && !touch.patch.is_end()
                && (first.0 - zone.end.0).abs() <= slack
                && (first.1 - zone.end.1).abs() <= 4.0 * radius
        };
        let from = self.zones.len().saturating_sub(BACK);
        if let Some(k) = self.zones[from..].iter().position(follows) {
            let mut zone = self.zones.remove(from + k);
            zone.end = last;
            zone.gap = zone.gap.min(touch.patch.least_gap());
            self.zones.push(zone);
        } else {
            self.zones.push(Zone {
                contact: touch.contact,
                is_end: touch.patch.is_end(),
                end: last,
                radius,
                weighted: Vector3::zeros(),
                normal: Vector3::zeros(),
                friction: Vector3::zeros(),
                force: 0.0,
                gap: touch.patch.least_gap(),
            });
        }
        self.open = true;
    }

    /// Adds a point of the patch, which lies at `r`.
    pub(super) fn add(&mut self, r: Vector3<f64>, point: &Place, force: &Force) {
        let Some(zone) = self.zones.last_mut().filter(|_| self.open) else { return };
        let place = &point.place;
        let normal = force.pressure.p * place.weight;
        // On the slave's surface; n points to the master.
        zone.weighted += (r + place.n * (zone.radius + 0.5 * place.gap)) * normal;
        zone.normal -= place.n * normal;
        zone.friction -= force.friction.force * place.weight;
        zone.force += normal;
    }

    /// The zones that press, as records.
    pub(super) fn records(&self) -> impl Iterator<Item = PatchRecord> + '_ {
        self.zones.iter().filter(|zone| zone.force > 0.0).map(|zone| {
            let point = zone.weighted / zone.force;
            let n = zone.normal.try_normalize(0.0).unwrap_or_else(Vector3::z);
            let f = zone.friction;
            let (k, gap, force) = (zone.contact as f64, zone.gap, zone.force);
            [k, point.x, point.y, point.z, n.x, n.y, n.z, gap, force, f.x, f.y, f.z]
        })
    }
}
