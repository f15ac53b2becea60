//! Whether two lines have passed through each other within a step: penalty forces would push them on to the wrong side.
//!
//! Where two lines cross, one lies on a side of the other: the sign of `(r_a - r_b).(t_a x t_b)` at the points that face
//! each other. A crossing is followed from before the step to after it by where it lies on both lines.

use super::run::{Candidate, Search};
use super::{Contacts, Master};
use nalgebra::Vector3;

/// Chords that stand for a piece.
const CHORDS: usize = 4;

/// A crossing of two lines.
struct Crossing {
    contact: usize,
    /// Arc lengths on both [m].
    arc: [f64; 2],
    side: f64,
    /// How far it may move along the lines within a step, an element [m].
    reach: f64,
}

impl Crossing {
    /// How far apart two of them are along the lines [m].
    fn distance(&self, other: &Self) -> f64 {
        (0..2).map(|k| (other.arc[k] - self.arc[k]).abs()).fold(0.0, f64::max)
    }

    /// The nearest one of the same lines.
    fn nearest<'a>(&self, all: &'a [Self]) -> Option<&'a Self> {
        let same = all.iter().filter(|other| other.contact == self.contact);
        same.min_by(|a, b| self.distance(a).total_cmp(&self.distance(b)))
    }
}

/// Where two straight lines face each other, counted from 0 to 1 along each, and on which side.
fn facing(a: [Vector3<f64>; 2], b: [Vector3<f64>; 2]) -> Option<(f64, f64, f64)> {
    let (u, v, w) = (a[1] - a[0], b[1] - b[0], a[0] - b[0]);
    let (uu, uv, vv, uw, vw) = (u.dot(&u), u.dot(&v), v.dot(&v), u.dot(&w), v.dot(&w));
    let det = uu * vv - uv * uv;
    // Parallel lines do not pass through each other at a point.
    if det < 1e-3 * uu * vv {
        return None;
    }
    let (s, t) = ((uv * vw - vv * uw) / det, (uu * vw - uv * uw) / det);
    Some((s, t, w.dot(&u.cross(&v))))
}

/// All crossings of candidates at `q`.
fn crossings(contacts: &Contacts, search: &Search, q: &[f64]) -> Vec<Crossing> {
    let mut found = Vec::new();
    let points = |b: &[Vector3<f64>; 4]| -> [Vector3<f64>; CHORDS + 1] {
        std::array::from_fn(|i| {
            let x = i as f64 / CHORDS as f64;
            let y = 1.0 - x;
            b[0] * (y * y * y) + (b[1] * y + b[2] * x) * (3.0 * x * y) + b[3] * (x * x * x)
        })
    };
    let inside = |x: f64| (0.0..1.0).contains(&x);
    for candidate in search.candidates() {
        let &Candidate { contact, slave: e, master: m, .. } = candidate;
        let this = &contacts.list[contact];
        let Master::Line(line) = this.master else { continue };
        if candidate.parts(contacts, q) {
            continue;
        }
        let (slave, master) = (&contacts.lines[this.slave][e], &contacts.lines[line][m]);
        let (a, b) = (points(&slave.control(q)), points(&master.control(q)));
        let strands = [slave.strand, master.strand];
        for i in 0..CHORDS {
            for j in 0..CHORDS {
                let Some((s, t, side)) = facing([a[i], a[i + 1]], [b[j], b[j + 1]]) else {
                    continue;
                };
                let at = |segment: &super::Segment, k: usize, x: f64| {
                    segment.start + segment.length * (k as f64 + x) / CHORDS as f64
                };
                let arc = [at(slave, i, s), at(master, j, t)];
                if inside(s) && inside(t) && this.share(arc, strands) > 0.0 {
                    let reach = slave.length.min(master.length);
                    found.push(Crossing { contact, arc, side, reach });
                }
            }
        }
    }
    found
}

/// Part of the sum of two radii by which the points of a zone may miss how near the lines come.
const MISSED: f64 = 0.3;

impl Search {
    /// Whether no two lines are as near each other as lines that have just passed through each other: each has moved
    /// by at most `moved`.
    fn certainly_beside(&mut self, contacts: &Contacts, q: &[f64], moved: f64) -> bool {
        // Others are two radii apart or more.
        moved < contacts.thinnest
            && self.touches(contacts, q).iter().all(|touch| {
                let contact = &contacts.list[touch.contact];
                let Master::Line(line) = contact.master else { return true };
                let radii = contacts.lines[contact.slave][touch.slave].radius
                    + contacts.lines[line][touch.master].radius;
                let points = touch.patch.points().iter();
                let gap = points.map(|p| p.place.gap).fold(f64::INFINITY, f64::min);
                (1.0 - MISSED) * radii + gap > 2.0 * moved
            })
    }

    /// Whether two lines have passed through each other between two places.
    pub fn have_passed(&mut self, contacts: &Contacts, before: &[f64], after: &[f64]) -> bool {
        if contacts.probes.have_passed(before, after) {
            return true;
        }
        if !contacts.list.iter().any(|c| matches!(c.master, Master::Line(_))) {
            return false;
        }
        let moved = contacts.moved(before, after);
        if self.certainly_beside(contacts, after, moved) {
            return false;
        }
        let now = crossings(contacts, self, after);
        if now.is_empty() {
            return false;
        }
        let was = crossings(contacts, self, before);
        // Each is followed to the nearest one, there and back: where one comes in beside another, it was not the other.
        now.iter().any(|crossing| {
            let followed = crossing.nearest(&was).filter(|before| {
                before.nearest(&now).is_some_and(|back| std::ptr::eq(back, crossing))
            });
            followed.is_some_and(|before| {
                before.distance(crossing) < crossing.reach && before.side * crossing.side < 0.0
            })
        })
    }
}
