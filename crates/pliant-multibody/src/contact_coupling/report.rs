//! What a run shows of the places where bodies touch: one record for each zone, however many elements it runs over.

use super::memory::PatchRecord;
use super::run::Touch;
use nalgebra::Vector3;
use pliant_contact::point::Force;
use pliant_contact::touch::Point as Place;

/// Pieces of zones that are looked back at for those that go on here: those on other turns of the line lie between.
const BACK: usize = 8;

/// A zone, summed over its points.
struct Zone {
    contact: usize,
    is_end: bool,
    /// Arc lengths of the slave and of the master where it begins and where it ends along the slave [m].
    ends: [(f64, f64); 2],
    radius: f64,
    weighted: Vector3<f64>,
    normal: Vector3<f64>,
    friction: Vector3<f64>,
    force: f64,
    gap: f64,
}

impl Zone {
    fn of(touch: &Touch, radius: f64) -> Self {
        Self {
            contact: touch.contact,
            is_end: touch.patch.is_end(),
            ends: touch.ends(),
            radius,
            weighted: Vector3::zeros(),
            normal: Vector3::zeros(),
            friction: Vector3::zeros(),
            force: 0.0,
            gap: touch.patch.least_gap(),
        }
    }

    /// Whether another one begins on this one, or where it ends.
    fn leads_to(&self, next: &Self) -> bool {
        let ([first, last], there) = (self.ends, next.ends[0]);
        let slack = 1e-9 * (1.0 + last.0.abs());
        let width = last.0 - first.0;
        let part = if width > 0.0 { (there.0 - first.0) / width } else { 1.0 };
        let master = first.1 + (last.1 - first.1) * part;
        self.contact == next.contact
            && !self.is_end
            && !next.is_end
            && (first.0 - slack..=last.0 + slack).contains(&there.0)
            && (there.1 - master).abs() <= 4.0 * self.radius
    }

    /// Takes up one that runs on from this one, or leads here.
    fn join(&mut self, other: &Self) {
        let ends = |k: usize| [self.ends[k], other.ends[k]].into_iter();
        let least = ends(0).min_by(|a, b| a.0.total_cmp(&b.0));
        let most = ends(1).max_by(|a, b| a.0.total_cmp(&b.0));
        self.ends = [least.unwrap_or(self.ends[0]), most.unwrap_or(self.ends[1])];
        self.weighted += other.weighted;
        self.normal += other.normal;
        self.friction += other.friction;
        self.force += other.force;
        self.gap = self.gap.min(other.gap);
    }
}

/// Gathers patches into zones. They come element by element of the slave, and for each of the master: where that runs the
/// other way, the later piece of a zone comes first.
#[derive(Default)]
pub(super) struct Report {
    zones: Vec<Zone>,
    open: bool,
}

impl Report {
    /// Begins a patch.
    pub(super) fn begin(&mut self, touch: &Touch, radius: f64) {
        let mut zone = Zone::of(touch, radius);
        for k in (self.zones.len().saturating_sub(BACK)..self.zones.len()).rev() {
            if self.zones[k].leads_to(&zone) || zone.leads_to(&self.zones[k]) {
                zone.join(&self.zones.remove(k));
            }
        }
        self.zones.push(zone);
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
