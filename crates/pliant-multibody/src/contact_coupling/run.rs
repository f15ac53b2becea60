//! Who touches whom at given coordinates, and the forces there.

use super::memory::{Bristle, ContactMemory, Pair, bristle};
use super::report::Report;
use super::{Contact, Contacts, Corner, Master};
use crate::probes::find::Found;
use nalgebra::Vector3;
use pliant_contact::broad_phase::{Box3, pairs};
use pliant_contact::curve::Piece;
use pliant_contact::point::{Force, Laws, Motion};
use pliant_contact::touch::{Master as Facing, Patch, Point as Place};
use pliant_contact::zones::POINTS;
use pliant_dae::problem::Point;

/// Looks at the coordinates between two of all pairs that are few, and that are many.
const OFTEN: u32 = 40;
const SELDOM: u32 = 400;
/// Steps without touching after which a pair leaves the iteration matrix.
pub(super) const PATIENCE: u32 = 20;

/// A zone or an end in contact, and whose it is.
#[derive(Clone, Copy, Debug)]
pub struct Touch {
    /// Number of the contact.
    pub contact: usize,
    /// Element of the slave line.
    pub slave: usize,
    /// Element of the master line; `usize::MAX` for a shape.
    pub master: usize,
    /// Where the two touch.
    pub patch: Patch,
    /// Arc length where the slave's element begins, and the master's [m].
    starts: [f64; 2],
    /// Their lengths [m]; 0 for shapes.
    lengths: [f64; 2],
}

impl Touch {
    /// Arc lengths on slave and master at both ends of the zone [m].
    #[must_use]
    pub fn ends(&self) -> [(f64, f64); 2] {
        let Patch { zone, etas, .. } = self.patch;
        [(zone.0, etas[0]), (zone.1, etas[1])].map(|at| self.arcs(at))
    }

    fn arcs(&self, (xi, eta): (f64, f64)) -> (f64, f64) {
        (self.starts[0] + xi * self.lengths[0], self.starts[1] + eta * self.lengths[1])
    }

    /// Arc lengths of a point on slave and master [m].
    #[must_use]
    pub fn arc(&self, point: &Place) -> (f64, f64) {
        self.arcs((point.xi, point.eta))
    }
}

/// Coordinates at which forces are asked for.
#[derive(Clone, Copy, Debug)]
pub struct At<'a> {
    /// Time [s].
    pub t: f64,
    /// Coordinates.
    pub q: &'a [f64],
    /// Velocities.
    pub v: &'a [f64],
}

impl<'a> From<Point<'a>> for At<'a> {
    fn from(at: Point<'a>) -> Self {
        Self { t: at.t, q: at.q, v: at.v }
    }
}

/// Two that were near each other when the search last looked at all of them.
#[derive(Clone, Copy, Debug)]
pub struct Candidate {
    /// Number of the contact.
    pub contact: usize,
    /// Element of the slave.
    pub slave: usize,
    /// Element of the master; `usize::MAX` for a shape.
    pub master: usize,
    /// Length by which they were apart then, at least [m].
    clearance: f64,
    /// Where they meet.
    corner: Option<Corner>,
}

impl Candidate {
    /// Whether the two were not further apart than that.
    pub(super) fn is_within(&self, distance: f64) -> bool {
        self.clearance <= distance
    }

    /// Whether the two meet in a corner and touch nowhere else.
    pub(super) fn parts(&self, contacts: &Contacts, q: &[f64]) -> bool {
        let contact = &contacts.list[self.contact];
        match (&contact.master, self.corner) {
            (Master::Line(line), Some(corner)) => {
                let pair = [
                    &contacts.lines[contact.slave][self.slave],
                    &contacts.lines[*line][self.master],
                ];
                corner.parts(pair, q)
            }
            _ => false,
        }
    }
}

/// Scratch of the search: candidates hold while nothing has moved far. Nothing of it changes what is found.
#[derive(Clone, Debug, Default)]
pub struct Search {
    candidates: Vec<Candidate>,
    built_at: Vec<f64>,
    /// How far anything has moved since then, at most [m].
    moved: f64,
    margin: f64,
    /// Coordinates looked at since then.
    looks: u32,
    touches: Vec<Touch>,
    found_at: Vec<f64>,
    found: Vec<Patch>,
    /// Probes in contact.
    pub probes: Found,
}

impl Search {
    /// All points in contact at `q`. Equal coordinates give equal points.
    pub fn touches(&mut self, contacts: &Contacts, q: &[f64]) -> &[Touch] {
        if self.found_at != q {
            self.refresh(contacts, q);
            self.touches.clear();
            let Self { candidates, moved, touches, found, .. } = self;
            // Both sides may have come nearer.
            for candidate in candidates.iter().filter(|c| c.clearance <= 2.0 * *moved) {
                touch(contacts, candidate, q, found, touches);
            }
            self.found_at.clear();
            self.found_at.extend_from_slice(q);
        }
        &self.touches
    }

    /// Whether anything touches at `q`.
    pub fn any(&mut self, contacts: &Contacts, q: &[f64]) -> bool {
        !self.touches(contacts, q).is_empty() || contacts.probes.touch(&mut self.probes, q)
    }

    /// Finds candidates anew where something may have moved by more than their boxes allow.
    pub(super) fn refresh(&mut self, contacts: &Contacts, q: &[f64]) {
        let mut moved = f64::INFINITY;
        if self.built_at.len() == q.len() {
            moved = contacts.moved(&self.built_at, q);
            if 2.0 * moved <= self.margin {
                self.moved = moved;
                self.looks += 1;
                return;
            }
        }
        let least = 0.5 * contacts.radius;
        // Wide margins keep more pairs that are apart, narrow ones have all of them looked at more often. How far things
        // moved does not count beyond: an iteration that goes astray would make all of them candidates.
        let most = 8.0 * least;
        self.margin = match self.looks {
            _ if moved.is_infinite() => least,
            0..OFTEN => f64::max(2.0 * self.margin, 2.0 * moved).min(most),
            OFTEN..=SELDOM => f64::max(self.margin, 2.0 * moved).min(most),
            _ => f64::max(least, 0.5 * self.margin),
        };
        self.candidates = candidates(contacts, q, self.margin);
        self.moved = 0.0;
        self.looks = 0;
        self.built_at.clear();
        self.built_at.extend_from_slice(q);
    }

    /// Pairs near each other where [`Self::touches`] last looked.
    #[must_use]
    pub fn candidates(&self) -> &[Candidate] {
        &self.candidates
    }
}

fn hull(piece: &Piece, margin: f64) -> Box3 {
    let control: [[f64; 3]; 4] = piece.control().map(Into::into);
    Box3::around(&control, piece.radius() + margin)
}

/// Pairs whose boxes, grown by half the margin, meet; sorted.
pub(super) fn candidates(contacts: &Contacts, q: &[f64], margin: f64) -> Vec<Candidate> {
    let clearance = |&(contact, slave, master): &(usize, usize, usize)| {
        let this = &contacts.list[contact];
        let piece = contacts.lines[this.slave][slave].piece(q);
        let mut corner = None;
        let clearance = match &this.master {
            Master::Shape(shape) => Facing::Shape(shape).clearance(&piece),
            Master::Line(line) => {
                let segment = &contacts.lines[*line][master];
                corner = this.corner(&contacts.lines[this.slave][slave], segment);
                Facing::Line(&segment.piece(q), segment.round).clearance(&piece)
            }
        };
        // Less what rounding may hide: what is found must not depend on where the search last looked at all.
        let clearance = clearance - 1e-6 * contacts.thinnest;
        Candidate { contact, slave, master, clearance, corner }
    };
    near(contacts, q, margin).iter().map(clearance).collect()
}

/// The same, as contact, element of the slave, of the master.
fn near(contacts: &Contacts, q: &[f64], margin: f64) -> Vec<(usize, usize, usize)> {
    let mut owner = Vec::new();
    let mut boxes = Vec::new();
    for (line, segments) in contacts.lines.iter().enumerate() {
        for (e, segment) in segments.iter().enumerate() {
            owner.push((line, e));
            boxes.push(hull(&segment.piece(q), margin));
        }
    }
    let mut all = Vec::new();
    if contacts.list.iter().any(|c| matches!(c.master, Master::Line(_))) {
        let contact_of = |i: u32, j: u32| {
            let ((a, e), (b, m)) = (owner[i as usize], owner[j as usize]);
            let number = contacts.of_lines(a, b)?;
            let contact = &contacts.list[number];
            let (e, m) = if contact.slave == a { (e, m) } else { (m, e) };
            let beside = contact.is_self() && is_beside(contact, contacts, e, m);
            (!beside).then_some((number, e, m))
        };
        let near = pairs(&boxes, |i, j| contact_of(i, j).is_some());
        all.extend(near.into_iter().filter_map(|(i, j)| contact_of(i, j)));
    }
    for (number, contact) in contacts.list.iter().enumerate() {
        let Master::Shape(shape) = &contact.master else { continue };
        for (e, segment) in contacts.lines[contact.slave].iter().enumerate() {
            let piece = segment.piece(q);
            let reach = 0.5 * piece.speed_bound() + piece.radius() + margin;
            if shape.value(piece.at(0.5)) <= reach {
                all.push((number, e, usize::MAX));
            }
        }
    }
    all.sort_unstable();
    all
}

/// Whether all of two elements of one line are closer along it than may touch.
fn is_beside(contact: &Contact, contacts: &Contacts, e: usize, m: usize) -> bool {
    let line = &contacts.lines[contact.slave];
    let (a, b) = (&line[e.min(m)], &line[e.max(m)]);
    b.start + b.length - a.start < contact.window
}

fn touch(
    contacts: &Contacts,
    candidate: &Candidate,
    q: &[f64],
    found: &mut Vec<Patch>,
    out: &mut Vec<Touch>,
) {
    let &Candidate { contact: number, slave: e, master: m, .. } = candidate;
    let contact = &contacts.list[number];
    let slave = &contacts.lines[contact.slave][e];
    if candidate.parts(contacts, q) {
        return;
    }
    let piece = slave.piece(q);
    let (mut starts, mut lengths) = ([slave.start, 0.0], [slave.length, 0.0]);
    found.clear();
    match &contact.master {
        Master::Shape(shape) => Facing::Shape(shape).touch(&piece, slave.free, found),
        Master::Line(line) => {
            let master = &contacts.lines[*line][m];
            (starts[1], lengths[1]) = (master.start, master.length);
            let other = master.piece(q);
            Facing::Line(&other, master.round).touch(&piece, slave.free, found);
        }
    }
    let strands = match contact.master {
        Master::Line(line) => [slave.strand, contacts.lines[line][m].strand],
        Master::Shape(_) => [slave.strand; 2],
    };
    for mut patch in found.drain(..) {
        let share = |xi: f64, eta: f64| {
            contact.share([starts[0] + xi * lengths[0], starts[1] + eta * lengths[1]], strands)
        };
        if m == usize::MAX || patch.leave(share) {
            out.push(Touch { contact: number, slave: e, master: m, patch, starts, lengths });
        }
    }
}

/// Which part of the forces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// All of them.
    All,
    /// What dissipates: friction and damping.
    Dissipated,
}

impl Contacts {
    /// A bound of how far a point of any line has moved from one place to another [m].
    pub(super) fn moved(&self, from: &[f64], to: &[f64]) -> f64 {
        // A control point moves with its node and a third of the slope's change.
        let (mut by_node, mut by_slope, mut longest) = (0.0_f64, 0.0_f64, 0.0_f64);
        let change = |o: usize| -> f64 { (0..3).map(|c| (to[o + c] - from[o + c]).powi(2)).sum() };
        for segment in self.lines.iter().flatten() {
            let [r, t, r_2, t_2] = segment.offsets;
            longest = longest.max(segment.length);
            by_node = by_node.max(change(r));
            by_slope = by_slope.max(change(t));
            // The second end is the first of the element that follows, unless none does.
            if segment.last {
                by_node = by_node.max(change(r_2));
                by_slope = by_slope.max(change(t_2));
            }
        }
        by_node.sqrt() + longest / 3.0 * by_slope.sqrt()
    }

    /// The laws at hand: at rest there is no friction.
    pub(super) fn laws(&self, number: usize, at_rest: bool) -> Laws {
        let laws = self.list[number].laws;
        if at_rest { Laws { friction: None, ..laws } } else { laws }
    }

    /// The offsets of the eight vectors of a point: master, then slave. Before a shape the slave's stand for the
    /// master's, which have no weight.
    pub(super) fn offsets(&self, touch: &Touch) -> [usize; 8] {
        let contact = &self.list[touch.contact];
        let slave = self.lines[contact.slave][touch.slave].offsets;
        let master = match contact.master {
            Master::Line(line) => self.lines[line][touch.master].offsets,
            Master::Shape(_) => slave,
        };
        std::array::from_fn(|k| if k < 4 { master[k] } else { slave[k - 4] })
    }

    /// Calls `work` with the motion of a point over the present step.
    pub(super) fn with_motion<T>(
        &self,
        touch: &Touch,
        memory: &ContactMemory,
        at: At<'_>,
        work: impl for<'m> FnOnce(&(dyn Fn(usize) -> Motion<'m> + 'm)) -> T,
    ) -> T {
        let offsets = self.offsets(touch);
        let gather = |x: &[f64]| offsets.map(|o| Vector3::new(x[o], x[o + 1], x[o + 2]));
        let v = gather(at.v);
        let mut moved = [Vector3::zeros(); 8];
        let mut h = 0.0;
        if memory.q.len() == at.q.len() && at.t > memory.t {
            h = at.t - memory.t;
            let before = gather(&memory.q);
            let now = gather(at.q);
            moved = std::array::from_fn(|k| now[k] - before[k]);
        }
        let contact = &self.list[touch.contact];
        // Both as each point sees them, where the slave turns.
        let mut turned = None;
        if self.turns(touch) {
            let (v, moved) = turned.insert(([v; POINTS], [moved; POINTS]));
            for (number, point) in touch.patch.points().iter().enumerate() {
                let arms = self.arms(touch, point, at.q);
                // Weights of positions add up to one: so the slip takes the motion of the surface, and nothing else.
                let add = |x: &mut [Vector3<f64>; 8], extra: Vector3<f64>| {
                    x[4] -= extra;
                    x[6] -= extra;
                };
                add(&mut v[number], arms.sum(at.v));
                if h > 0.0 {
                    add(&mut moved[number], arms.sum(at.q) - arms.sum(&memory.q));
                }
            }
        }
        let bristles = match contact.laws.friction {
            Some(_) => memory.bristles_of(touch.contact as u32, touch.patch.is_end()),
            None => &[],
        };
        let radius = self.lines[contact.slave][touch.slave].radius;
        work(&|number| {
            let (v, moved) = match &turned {
                Some((v, moved)) => (&v[number], &moved[number]),
                None => (&v, &moved),
            };
            let point = &touch.patch.points()[number];
            let z = bristle(bristles, touch.arc(point), point.place.n, radius);
            Motion { v, moved, h, z }
        })
    }

    /// Calls `work` with each point of a patch and the force there.
    fn each_force(
        &self,
        touch: &Touch,
        memory: &ContactMemory,
        at: At<'_>,
        at_rest: bool,
        mut work: impl FnMut(&Place, &Force),
    ) {
        let laws = self.laws(touch.contact, at_rest);
        self.with_motion(touch, memory, at, |motion| {
            for (number, point) in touch.patch.points().iter().enumerate() {
                if point.place.weight > 0.0 {
                    work(point, &point.place.force(&laws, &motion(number)));
                }
            }
        });
    }

    /// Adds what contact adds to the inner forces.
    pub fn add_forces(
        &self,
        search: &mut Search,
        memory: &ContactMemory,
        at: At<'_>,
        (part, at_rest): (Part, bool),
        out: &mut [f64],
    ) {
        for touch in search.touches(self, at.q) {
            let mut share = [Vector3::zeros(); 8];
            let normal = self.list[touch.contact].laws.normal;
            let turns = self.turns(touch);
            self.each_force(touch, memory, at, at_rest, |point, force| {
                let place = &point.place;
                if turns {
                    let arms = self.arms(touch, point, at.q);
                    for (o, b) in arms.offsets.into_iter().zip(arms.beta) {
                        let f = force.friction.force * (-place.weight * b);
                        (0..3).for_each(|c| out[o + c] += f[c]);
                    }
                }
                let mut total = force.total;
                if part == Part::Dissipated {
                    total -= place.n * normal.elastic(-place.gap).0;
                }
                place.add_force(total, &mut share);
            });
            for (o, f) in self.offsets(touch).into_iter().zip(&share) {
                for c in 0..3 {
                    out[o + c] += f[c];
                }
            }
        }
        self.probes.add_forces(&mut search.probes, memory, at, (part, at_rest), out);
    }

    /// Energy stored where lines press [J].
    pub fn energy(&self, search: &mut Search, q: &[f64]) -> f64 {
        let touches = search.touches(self, q).iter();
        let of = |touch: &Touch| -> f64 {
            let normal = self.list[touch.contact].laws.normal;
            let points = touch.patch.points().iter();
            points.map(|p| p.place.weight * normal.energy(-p.place.gap)).sum()
        };
        touches.map(of).sum::<f64>() + self.probes.energy(&mut search.probes, q)
    }

    /// Commits a step: bristles, pairs that touch, forces and their impulse.
    pub fn accept(
        &self,
        search: &mut Search,
        memory: &mut ContactMemory,
        at: At<'_>,
        at_rest: bool,
    ) {
        memory.had_touched = memory.has_touched();
        let of_probes = self.probes.accept(&mut search.probes, memory, at, at_rest);
        let mut bristles = Vec::new();
        let h = if memory.q.is_empty() { 0.0 } else { at.t - memory.t };
        memory.totals.resize(self.list.len(), [0.0; 6]);
        let before: Vec<[f64; 6]> = memory.totals.clone();
        for totals in &mut memory.totals {
            totals[..3].fill(0.0);
        }
        let mut touching: Vec<Pair> = Vec::new();
        let mut totals = std::mem::take(&mut memory.totals);
        let mut report = Report::default();
        for touch in search.touches(self, at.q) {
            touching.push(pair_of(touch));
            let rubs = self.list[touch.contact].laws.friction.is_some();
            let segment = &self.lines[self.list[touch.contact].slave][touch.slave];
            let zone = [touch.patch.zone.0, touch.patch.zone.1];
            report.begin(touch, segment.radius);
            let x = segment.vectors(at.q);
            self.each_force(touch, memory, at, at_rest, |point, force| {
                for c in 0..3 {
                    totals[touch.contact][c] -= point.place.weight * force.total[c];
                }
                // The slave's weights count as negative.
                let r: Vector3<f64> = (0..4).map(|k| x[k] * -point.place.alpha[4 + k]).sum();
                report.add(r, point, force);
                if rubs && force.pressure.p > 0.0 {
                    let (slave, master) = touch.arc(point);
                    bristles.push(Bristle {
                        contact: touch.contact as u32,
                        end: touch.patch.is_end(),
                        slave,
                        master,
                        zone: zone.map(|xi| segment.start + xi * segment.length),
                        z: force.friction.z.into(),
                        n: point.place.n.into(),
                    });
                }
            });
        }
        memory.totals = totals;
        memory.patches = report.records().collect();
        for (totals, before) in memory.totals.iter_mut().zip(&before) {
            for c in 0..3 {
                totals[3 + c] = before[3 + c] + 0.5 * h * (before[c] + totals[c]);
            }
        }
        memory.bristles = bristles;
        memory.bristles.extend(of_probes);
        memory.arrange();
        touching.sort_unstable();
        touching.dedup();
        for (pair, idle) in &mut memory.coupled {
            let touches = touching.binary_search(pair).is_ok();
            *idle = if touches { 0 } else { idle.saturating_add(1) };
        }
        memory.t = at.t;
        memory.q.clear();
        memory.q.extend_from_slice(at.q);
    }
}

/// The pair that a point belongs to.
pub(super) fn pair_of(touch: &Touch) -> Pair {
    let contact = touch.contact as u32;
    if touch.master == usize::MAX {
        Pair { contact, slave: u32::MAX, master: u32::MAX }
    } else {
        Pair { contact, slave: touch.slave as u32, master: touch.master as u32 }
    }
}
