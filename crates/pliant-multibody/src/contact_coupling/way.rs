//! How far a search for equilibria may go at once, where bodies are in its way.
//!
//! Increments of statics know nothing of what they do not touch yet: at once they may carry a rope to the other side of
//! a bar, where nothing pushes it back. So each is looked at along its straight way, in parts short beside the depth at
//! which the middles of two bodies meet, and ends where two press into each other by a good part of that. What the
//! iterates went is a way then that bodies can go, wherever it leads.
//!
//! Surfaces as masters know the side from which each body came and are not passed through anyway.

use super::run::{Candidate, Search};
use super::{Contacts, Master};
use crate::probes::Facing;
use crate::probes::find::Touch;

/// Part of the depth at which middles meet by which an increment may press deeper, and beyond which none does.
const DEEPER: f64 = 0.25;
const DEEPEST: f64 = 0.9;
/// Part of the same depth by which anything moves between two looks.
const SHORT: f64 = 0.125;
/// Looks at one increment: where bodies are near, none is longer.
const LOOKS: f64 = 100.0;
/// How often a part of the way is halved that is too long.
const HALVINGS: usize = 4;

/// Whether there is a middle, with something around it.
fn finite(middle: f64) -> bool {
    middle.is_finite() && middle > 0.0
}

/// Two that overlap.
#[derive(Clone, Debug, PartialEq)]
pub struct Overlap {
    /// Name of the contact.
    pub contact: String,
    /// How deep they are in each other [m].
    pub depth: f64,
    /// Half of the thickness of the thinner one [m].
    pub thinner: f64,
}

impl Contacts {
    /// How deep inside of them the middles of both sides of a contact of lines lie [m].
    fn depths(&self, number: usize) -> [f64; 2] {
        let contact = &self.list[number];
        let thin = |line: usize| {
            self.lines[line].iter().map(|segment| segment.radius).fold(f64::INFINITY, f64::min)
        };
        let master = match &contact.master {
            Master::Line(line) => thin(*line),
            Master::Shape(placed) => placed.shape.depth(),
        };
        [thin(contact.slave), master]
    }

    /// How deep two are in each other where their middles meet [m], for all contacts of lines, then for all ways in which
    /// others face each other; infinite where nothing passes.
    fn middles(&self) -> Vec<f64> {
        let of_lines = (0..self.list.len()).map(|number| self.depths(number).iter().sum());
        of_lines.chain(self.probes.facings.iter().map(Facing::middle)).collect()
    }

    /// Contacts whose sides are in each other at `q` by more than a part of half the thickness of the thinner one, with
    /// how deep they are at most.
    #[must_use]
    pub fn overlaps(&self, q: &[f64], part: f64) -> Vec<Overlap> {
        let mut search = Search::default();
        let mut all: Vec<Overlap> = Vec::new();
        let mut add = |contact: &str, depth: f64, thinner: f64| {
            if depth <= part * thinner {
                return;
            }
            match all.iter_mut().find(|other| other.contact == contact) {
                Some(other) if other.depth < depth => other.depth = depth,
                Some(_) => {}
                None => all.push(Overlap { contact: contact.to_owned(), depth, thinner }),
            }
        };
        for touch in search.touches(self, q) {
            let [a, b] = self.depths(touch.contact);
            add(&self.list[touch.contact].name, -touch.patch.least_gap(), a.min(b));
        }
        for touch in search.probes.touches(&self.probes, q) {
            let facing = &self.probes.facings[touch.facing];
            let contact = &self.probes.contacts[facing.contact];
            // What has no thickness of its own is measured by the contact's size.
            let thinner = facing.thinner();
            let thinner = if finite(thinner) { thinner } else { 0.5 * contact.size };
            add(&contact.name, -touch.gap, thinner);
        }
        all
    }

    /// Name of the contact that belongs to such a number.
    fn name_of(&self, number: usize) -> &str {
        match self.list.get(number) {
            Some(contact) => &contact.name,
            None => {
                let facing = &self.probes.facings[number - self.list.len()];
                &self.probes.contacts[facing.contact].name
            }
        }
    }
}

/// Room for looking.
struct Look<'a> {
    contacts: &'a Contacts,
    middles: &'a [f64],
    /// Whether lines, and each facing, may touch on the way.
    lines: bool,
    facings: Vec<bool>,
    touches: Vec<Touch>,
}

impl Look<'_> {
    /// Depth over that at which middles meet, for each contact.
    fn depths(&mut self, search: &mut Search, q: &[f64]) -> Vec<f64> {
        let mut depths = vec![0.0_f64; self.middles.len()];
        if self.lines {
            for touch in search.touches(self.contacts, q) {
                let depth = &mut depths[touch.contact];
                *depth = depth.max(-touch.patch.least_gap() / self.middles[touch.contact]);
            }
        }
        self.touches.clear();
        for (k, facing) in self.contacts.probes.facings.iter().enumerate() {
            if self.facings[k] {
                facing.find(k, q, &mut self.touches);
            }
        }
        let first = self.contacts.list.len();
        for touch in &self.touches {
            let depth = &mut depths[first + touch.facing];
            *depth = depth.max(-touch.gap / self.middles[first + touch.facing]);
        }
        depths
    }
}

impl Search {
    /// Whether lines that can pass through what they face come near it where they move by at most `moved`.
    fn may_meet(contacts: &Contacts, middles: &[f64], q: &[f64], moved: f64) -> bool {
        let near = |candidate: &Candidate| {
            finite(middles[candidate.contact]) && candidate.is_within(2.0 * moved)
        };
        super::run::candidates(contacts, q, 2.0 * moved).iter().any(near)
    }

    /// Part of an increment that may be gone, at most 1, and the name of the contact that is in the way beyond.
    pub fn way<'a>(
        &mut self,
        contacts: &'a Contacts,
        q: &[f64],
        increment: &[f64],
    ) -> (f64, Option<&'a str>) {
        let free = (1.0, None);
        let middles = contacts.middles();
        let first = contacts.list.len();
        let thinnest = middles[..first].iter().copied().filter(|m| finite(*m));
        let thinnest = thinnest.fold(f64::INFINITY, f64::min);
        let end: Vec<f64> = q.iter().zip(increment).map(|(q, d)| q + d).collect();
        let moved = if thinnest.is_finite() { contacts.moved(q, &end) } else { 0.0 };
        let mut looks = moved / (SHORT * thinnest);
        // A short way is looked at sooner than asked whether it leads anywhere.
        let lines = looks > 0.0 && (looks <= 1.0 || Self::may_meet(contacts, &middles, q, moved));
        if !lines {
            looks = 0.0;
        }
        let mut facings = Vec::with_capacity(contacts.probes.facings.len());
        for (facing, &middle) in contacts.probes.facings.iter().zip(&middles[first..]) {
            let moved = if finite(middle) { facing.moved(q, &end) } else { 0.0 };
            let meets = moved > 0.0 && facing.may_meet(q, moved);
            if meets {
                looks = looks.max(moved / (SHORT * middle));
            }
            facings.push(meets);
        }
        if looks == 0.0 {
            return free;
        }
        let mut look = Look { contacts, middles: &middles, lines, facings, touches: Vec::new() };
        let limits: Vec<f64> = look.depths(self, q).iter().map(limit).collect();
        let mut beyond = |search: &mut Self, part: f64| {
            let at: Vec<f64> = q.iter().zip(increment).map(|(q, d)| q + part * d).collect();
            let depths = look.depths(search, &at);
            depths.iter().zip(&limits).position(|(depth, limit)| depth > limit)
        };
        let count = looks.ceil().clamp(1.0, LOOKS);
        let each = if looks > LOOKS { 1.0 / looks } else { 1.0 / count };
        for k in 0..count as usize {
            let mut low = k as f64 * each;
            let mut high =
                if k + 1 == count as usize && looks <= LOOKS { 1.0 } else { (k + 1) as f64 * each };
            let Some(mut number) = beyond(self, high) else { continue };
            for _ in 0..HALVINGS {
                let middle = 0.5 * (low + high);
                match beyond(self, middle) {
                    Some(found) => (high, number) = (middle, found),
                    None => low = middle,
                }
            }
            return (low, Some(contacts.name_of(number)));
        }
        (if looks <= LOOKS { 1.0 } else { count * each }, None)
    }
}

/// How deep two may be at the end of an increment that begins where they are `depth` deep.
fn limit(depth: &f64) -> f64 {
    (depth + DEEPER).min(DEEPEST).max(*depth)
}
