//! Probes on surfaces: which faces are near, where the feet lie, and from which side each probe has come.
//!
//! A surface has two sides, and nothing in its distance says which a probe belongs to. It is the one on which it was at the
//! last accepted step: above or below the material point that it faces now, or where that is askew, its foot of then. So
//! a thin sheet is not passed through, however far a step would carry; a probe accepted beyond the mid-surface keeps
//! its side in [`Crossed`].

use super::find::{Blend, Ground, Mark, Meets, Touch, carried, points};
use super::memory::Crossed;
use super::skin::{self, Posed, Skin, Spot, holds};
use super::{Facing, Probes, Side};
use crate::contact_coupling::Segment;
use nalgebra::Vector3;
use pliant_contact::broad_phase::{Box3, pairs};
use pliant_contact::curve::Piece;
use pliant_contact::foot::Foot;
use pliant_contact::net::{Feature, hull};
use pliant_contact::probe::{Opposing, Slave};
use pliant_contact::zones::{Bounds, POINTS, Sample, Spot as Place, Stretch, least, zones};

/// Cosine of the angle between normals below which two feet are those of one place.
const ONE: f64 = 0.866;
/// Cosine between normals of two faces above which they are not folded on each other.
const UNFOLDED: f64 = 0.2;

/// Scratch of the search, and what it must know of the last accepted step.
#[derive(Clone, Debug, Default)]
pub(crate) struct Onto {
    /// Coordinates of the last accepted step; empty: sides are what they look like.
    pub was: Vec<f64>,
    pub crossed: Vec<Crossed>,
    now: Vec<Posed>,
    before: Vec<Posed>,
    before_at: Vec<f64>,
    near: Vec<Near>,
}

/// Faces near the parts of a slave.
#[derive(Clone, Debug, Default)]
struct Near {
    faces: Vec<Vec<usize>>,
    margin: f64,
    /// Hulls of slave and master where they were gathered.
    built: Vec<Vector3<f64>>,
    built_master: Vec<Vector3<f64>>,
    /// Hulls of the slave now and at the last accepted step.
    now: Hulls,
    before: Hulls,
}

/// Points in whose hull the probes of each part lie, part by part, and where those of each end.
#[derive(Clone, Debug, Default)]
struct Hulls {
    points: Vec<Vector3<f64>>,
    ends: Vec<usize>,
}

impl Hulls {
    fn add(&mut self, points: impl IntoIterator<Item = Vector3<f64>>) {
        self.points.extend(points);
        self.ends.push(self.points.len());
    }

    fn part(&self, number: usize) -> &[Vector3<f64>] {
        let first = if number == 0 { 0 } else { self.ends[number - 1] };
        &self.points[first..self.ends[number]]
    }

    /// A box that holds a part.
    fn around(&self, number: usize, margin: f64) -> Box3 {
        hull(self.part(number), margin)
    }

    fn look(&mut self, facing: &Facing, posed: &[Posed], probes: &Probes, q: &[f64]) {
        self.points.clear();
        self.ends.clear();
        match &facing.slave {
            Side::Sheet(faces) => {
                let Some(number) = facing.own_skin else { return };
                let (skin, posed) = (&probes.skins[number], &posed[number]);
                for face in 0..faces.len() {
                    let nets = skin.nets_of(face).map(|net| posed.nets[net].points());
                    self.add(nets.flatten().copied());
                }
            }
            Side::Line(line) => line.iter().for_each(|s| self.add(s.piece(q).control())),
            Side::Mass(terms, _) => self.add([at(terms, q)]),
            Side::Rigid(..) | Side::Rest(..) => {
                let Some((pose, shape)) = facing.slave.shape(q) else { return };
                let half = Vector3::from(shape.half_extent());
                let corner = |i: usize| {
                    let sign = |k: usize| if i >> k & 1 == 1 { 1.0 } else { -1.0 };
                    pose.at(Vector3::from_fn(|k, _| sign(k) * half[k]))
                };
                self.add((0..8).map(corner));
            }
        }
    }
}

fn at(terms: &[(usize, f64)], q: &[f64]) -> Vector3<f64> {
    terms.iter().map(|&(o, w)| Vector3::new(q[o], q[o + 1], q[o + 2]) * w).sum()
}

fn flat(posed: &Posed) -> impl Iterator<Item = &Vector3<f64>> {
    posed.nets.iter().flat_map(|net| net.points())
}

fn farthest<'a, 'b>(
    a: impl IntoIterator<Item = &'a Vector3<f64>>,
    b: impl IntoIterator<Item = &'b Vector3<f64>>,
) -> f64 {
    a.into_iter().zip(b).map(|(a, b)| (a - b).norm_squared()).fold(0.0, f64::max).sqrt()
}

fn sign(x: f64) -> f64 {
    if x < 0.0 { -1.0 } else { 1.0 }
}

/// A probe and what there is to know of it.
struct One<'a> {
    slave: Slave,
    p: Vector3<f64>,
    /// Where it was.
    was: Option<Vector3<f64>>,
    radius: f64,
    weight: f64,
    part: usize,
    mark: Mark,
    blend: Blend,
    /// Stress-free place on a surface that touches itself.
    own: Option<Vector3<f64>>,
    faces: &'a [usize],
    range: f64,
}

/// An element of a line over faces that it may touch.
struct Over<'a> {
    segment: &'a Segment,
    piece: Piece,
    /// Where it was.
    before: Option<Piece>,
    part: usize,
    faces: &'a [usize],
    range: f64,
    /// Gap from which on feet do not count [m].
    most: f64,
}

impl Over<'_> {
    /// The gap of a probe at `xi`: the foot's own way does not count in its slope.
    fn sample(&self, xi: f64, probe: &Foot) -> Sample {
        Sample { xi, gap: probe.gap(), slope: probe.normal().dot(&self.piece.slope(xi)) }
    }
}

/// One facing, at hand.
struct Here<'a> {
    number: usize,
    facing: &'a Facing,
    skin: &'a Skin,
    now: &'a Posed,
    before: Option<&'a Posed>,
    crossed: &'a [Crossed],
    /// Normals of the faces at some places, where the surface touches itself.
    normals: Vec<[Vector3<f64>; 5]>,
}

impl Onto {
    /// Adds all probes in contact with surfaces at `q`.
    pub(crate) fn find(&mut self, probes: &Probes, q: &[f64], out: &mut Vec<Touch>) {
        if probes.skins.is_empty() {
            return;
        }
        // Others have no probe before them and none of their own before a surface.
        let faces = |number: usize| {
            let of = |f: &Facing| f.skin == Some(number) || f.own_skin == Some(number);
            probes.facings.iter().any(|f| f.skin.is_some() && of(f))
        };
        let pose = |posed: &mut Vec<Posed>, q: &[f64]| {
            posed.resize_with(probes.skins.len(), Posed::default);
            for (number, (skin, posed)) in probes.skins.iter().zip(posed).enumerate() {
                if faces(number) {
                    skin.at(q, posed);
                }
            }
        };
        pose(&mut self.now, q);
        self.near.resize_with(probes.facings.len(), Near::default);
        let mut fresh = false;
        if self.was.len() == q.len() {
            if self.before_at != self.was {
                pose(&mut self.before, &self.was);
                self.before_at.clone_from(&self.was);
                fresh = true;
            }
        } else {
            self.before.clear();
            self.before_at.clear();
        }
        for (number, facing) in probes.facings.iter().enumerate() {
            if let Some(skin) = facing.skin {
                if fresh {
                    let before = &mut self.near[number].before;
                    before.look(facing, &self.before, probes, &self.was);
                }
                self.find_on(probes, (number, facing, skin), q, out);
            }
        }
    }

    fn find_on(
        &mut self,
        probes: &Probes,
        (number, facing, master): (usize, &Facing, usize),
        q: &[f64],
        out: &mut Vec<Touch>,
    ) {
        let skin = &probes.skins[master];
        let near = &mut self.near[number];
        near.now.look(facing, &self.now, probes, q);
        let own = &near.now.points;
        let other = || flat(&self.now[master]);
        let reach = facing.reach;
        let mut travel = 0.0;
        if let Some(before) = self.before.get(master) {
            travel = farthest(own, &near.before.points) + farthest(other(), flat(before));
        }
        // Distances along lines are cut off above this.
        let ahead = match &facing.slave {
            Side::Line(line) => {
                let speeds = line.iter().map(|s| s.piece(q).speed_bound());
                0.5 * speeds.fold(0.0, f64::max)
            }
            _ => 0.0,
        };
        let range = reach + travel + ahead;
        let moved = farthest(own, &near.built) + farthest(other(), &near.built_master);
        if near.built.len() != own.len() || moved + travel + ahead > near.margin {
            near.margin = 1.5 * (travel + ahead) + f64::max(0.5 * reach, 0.1 * facing.size);
            near.faces = gather(&near.now, &self.now[master].boxes, reach + near.margin);
            near.built.clone_from(own);
            near.built_master.clear();
            near.built_master.extend(other());
        }
        let mut here = Here {
            number,
            facing,
            skin,
            now: &self.now[master],
            before: self.before.get(master),
            crossed: &self.crossed,
            normals: Vec::new(),
        };
        if facing.own.is_some() {
            here.look();
        }
        let was = (!self.before.is_empty()).then_some(self.was.as_slice());
        let near = &self.near[number];
        for part in 0..near.now.ends.len() {
            if near.faces[part].is_empty() {
                continue;
            }
            let around = near.now.around(part, range);
            let faces: Vec<usize> = near.faces[part]
                .iter()
                .copied()
                .filter(|&face| here.now.boxes[face].meets(&around) && here.may_touch(part, face))
                .collect();
            if !faces.is_empty() {
                here.part((part, &faces), (q, was), (range, range - ahead), out);
            }
        }
    }
}

/// Faces whose boxes are within a margin of each part's.
fn gather(parts: &Hulls, faces: &[Box3], margin: f64) -> Vec<Vec<usize>> {
    let n = parts.ends.len();
    let hulls = (0..n).map(|part| parts.around(part, margin));
    let boxes: Vec<Box3> = hulls.chain(faces.iter().copied()).collect();
    let mut out = vec![Vec::new(); n];
    for (i, j) in pairs(&boxes, |i, j| (i as usize) < n && (j as usize) >= n) {
        out[i as usize].push(j as usize - n);
    }
    out
}

impl Here<'_> {
    /// Notes the normals of all faces.
    fn look(&mut self) {
        let places = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.5, 0.5], [1.0, 1.0]];
        self.normals = (0..self.skin.faces.len())
            .map(|face| {
                let nets = self.skin.nets_of(face);
                let (first, count) = (nets.start, nets.len());
                std::array::from_fn(|k| {
                    let net = &self.now.nets[first + k % count];
                    let last = net.form() != pliant_contact::net::Form::Square && k == 4;
                    net.jet(if last { [1.0 / 3.0; 2] } else { places[k] }).normal()
                })
            })
            .collect();
    }

    /// Whether a face may touch a part: of the same surface one near it only where the two are folded.
    fn may_touch(&self, part: usize, face: usize) -> bool {
        let Some(own) = &self.facing.own else { return true };
        if part == face {
            return false;
        }
        own.near[part].binary_search(&face).is_err()
            || self.normals[part]
                .iter()
                .any(|a| self.normals[face].iter().any(|b| a.dot(b) < UNFOLDED))
    }

    fn part(
        &self,
        (part, faces): (usize, &[usize]),
        (q, was): (&[f64], Option<&[f64]>),
        (range, near): (f64, f64),
        out: &mut Vec<Touch>,
    ) {
        let facing = self.facing;
        match &facing.slave {
            Side::Sheet(own) => {
                let face = &own[part];
                for (k, &(_, area)) in face.rule.iter().enumerate() {
                    let one = One {
                        slave: Slave::Point,
                        p: face.probe(k, q),
                        was: was.map(|was| face.probe(k, was)),
                        radius: face.radius,
                        weight: area * facing.share,
                        part,
                        mark: Mark::Number((part as u64) << 8 | k as u64),
                        blend: Blend::Rule(k),
                        own: facing.own.is_some().then(|| self.skin.places[part][k]),
                        faces,
                        range,
                    };
                    self.touch(&one, out);
                }
            }
            Side::Line(line) => {
                self.line(&line[part], (part, faces), (q, was), (range, near), out);
            }
            Side::Mass(terms, radius) => {
                let one = One {
                    slave: Slave::Point,
                    p: at(terms, q),
                    was: was.map(|was| at(terms, was)),
                    radius: *radius,
                    weight: facing.share,
                    part,
                    mark: Mark::Number(0),
                    blend: Blend::Mass,
                    own: None,
                    faces,
                    range,
                };
                self.touch(&one, out);
            }
            Side::Rigid(..) | Side::Rest(..) => {
                let Some((pose, shape)) = facing.slave.shape(q) else { return };
                let before = was.and_then(|was| facing.slave.shape(was));
                let own = points(shape, Vector3::zeros());
                for (k, (local, radius)) in own.into_iter().enumerate() {
                    let one = One {
                        slave: carried(&facing.slave, pose, local),
                        p: pose.at(local),
                        was: before.map(|(before, _)| before.at(local)),
                        radius,
                        weight: facing.share,
                        part,
                        mark: Mark::Number(k as u64),
                        blend: Blend::Own,
                        own: None,
                        faces,
                        range,
                    };
                    self.touch(&one, out);
                }
            }
        }
    }

    /// Side of the surface that a point at a foot belongs to, and whether it is on the other.
    fn side(&self, one: &One<'_>, foot: &skin::Foot) -> f64 {
        if matches!(foot.spot, Spot::Side(_, true) | Spot::Corner(_, true)) {
            return 1.0;
        }
        let here = sign((one.p - foot.jet.r).dot(&foot.upright));
        let mut side = here;
        if let (Some(before), Some(was)) = (self.before, one.was) {
            let jet = before.nets[foot.net].jet(foot.at);
            let (d, n) = (was - jet.r, jet.normal());
            let up = d.dot(&n);
            if up.abs() >= (d - n * up).norm() {
                side = sign(up);
            } else if let Some(then) = self.skin.nearest(before, one.faces, was)
                && !matches!(then.spot, Spot::Side(_, true) | Spot::Corner(_, true))
            {
                side = sign((was - then.jet.r).dot(&then.upright));
            }
            if !self.crossed.is_empty() {
                let place = self.skin.place(foot);
                let is = |c: &Crossed| {
                    c.is(self.number as u32, key(&one.mark), place, self.facing.reach)
                };
                if self.crossed.iter().any(is) {
                    side = -side;
                }
            }
        }
        if foot.spot == Spot::Inside { side } else { side * here }
    }

    fn excluded(&self, place: Vector3<f64>) -> bool {
        self.facing.apart.iter().any(|(center, width)| (place - center).norm() < *width)
    }

    /// A probe before one of its feet.
    fn before(&self, one: &One<'_>, foot: &skin::Foot) -> Foot {
        let form = self.now.nets[foot.net].form();
        let feature = if foot.spot == Spot::Inside { Feature::Inside } else { foot.feature };
        Foot::new(
            (one.slave, one.p, one.radius),
            (foot.jet, self.skin.faces[foot.face].radius),
            (form, feature),
            self.side(one, foot),
            one.weight,
        )
    }

    /// All feet of a probe that it may touch, the nearest first, with their stress-free places.
    fn feet(&self, one: &One<'_>) -> Vec<(skin::Foot, Foot, Vector3<f64>)> {
        let mut found = Vec::new();
        self.skin.feet(self.now, one.faces, (one.p, one.range), &mut found);
        if let (Some(before), Some(was)) = (self.before, one.was) {
            for foot in &mut found {
                let followed = self.skin.followed([before, self.now], [was, one.p], foot);
                *foot = followed.unwrap_or(*foot);
            }
        }
        if let (Some(own), Some(x)) = (&self.facing.own, one.own) {
            let too_near = |face: usize, place: Vector3<f64>| {
                own.near[one.part].binary_search(&face).is_ok() && (place - x).norm() < own.width
            };
            found = found
                .into_iter()
                .filter_map(|foot| {
                    if !too_near(foot.face, self.skin.place(&foot)) {
                        return Some(foot);
                    }
                    let wanted = |place: Vector3<f64>| !too_near(foot.face, place);
                    self.skin.other_foot(self.now, foot.face, one.p, wanted)
                })
                .collect();
        }
        // Before a surface that wraps around the probe which of several feet is nearest turns about within the iteration:
        // the one that was at the last accepted step counts.
        let wraps = found.len() > 1 && found.iter().any(|foot| foot.jet.is_sharp(one.p));
        let far = |foot: &skin::Foot| match (wraps, self.before, one.was) {
            (true, Some(before), Some(was)) => before.nets[foot.net].nearest(was).square,
            _ => foot.distance * foot.distance,
        };
        let mut ranked: Vec<(f64, skin::Foot)> = found.into_iter().map(|f| (far(&f), f)).collect();
        ranked.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.face.cmp(&b.1.face)));
        let mut kept: Vec<(skin::Foot, Foot, Vector3<f64>)> = Vec::new();
        for (_, foot) in ranked {
            let place = self.skin.place(&foot);
            let reach = 2.0 * self.facing.reach;
            let probe = self.before(one, &foot);
            let n = probe.normal();
            let known = kept.iter().any(|(_, other, there)| {
                (place - there).norm() < reach && n.dot(&other.normal()) > ONE
            });
            if !known && !self.excluded(place) {
                kept.push((foot, probe, place));
            }
        }
        kept
    }

    fn touch(&self, one: &One<'_>, out: &mut Vec<Touch>) {
        if one.weight <= 0.0
            || !one.faces.iter().any(|&f| holds(&self.now.boxes[f], one.p, one.range))
        {
            return;
        }
        for (foot, probe, place) in self.feet(one) {
            if probe.gap() < 0.0 {
                let weights = self.skin.weights(foot.face, foot.net, foot.at);
                let ground = Ground { face: foot.face, weights, place };
                out.push(Touch {
                    facing: self.number,
                    part: one.part,
                    blend: one.blend,
                    mark: one.mark,
                    gap: probe.gap(),
                    meets: Meets::Face(probe, ground),
                });
            }
        }
    }

    /// A probe on an element of a line, in a zone of it or, a free end, on its own.
    fn one<'b>(
        &self,
        over: &Over<'b>,
        (xi, weight): (f64, f64),
        zone: (f64, f64),
        end: bool,
    ) -> One<'b> {
        let arc = |xi: f64| over.segment.start + xi * over.segment.length;
        One {
            slave: Slave::Point,
            p: over.piece.at(xi),
            was: over.before.map(|before| before.at(xi)),
            radius: over.segment.radius,
            weight: weight * self.facing.share,
            part: over.part,
            mark: Mark::Along { arc: arc(xi), zone: [arc(zone.0), arc(zone.1)], end },
            blend: Blend::Line(over.piece.weights(xi)),
            own: None,
            faces: over.faces,
            range: over.range,
        }
    }

    /// The least gap at a place, where one is within reach.
    fn nearest(&self, over: &Over<'_>, xi: f64) -> Option<Sample> {
        let one = self.one(over, (xi, 1.0), (xi, xi), false);
        let mut feet = Vec::new();
        self.skin.feet(self.now, over.faces, (one.p, over.range), &mut feet);
        feet.into_iter()
            .filter(|foot| self.facing.apart.is_empty() || !self.excluded(self.skin.place(foot)))
            .map(|foot| over.sample(xi, &self.before(&one, &foot)))
            .filter(|sample| sample.gap < over.most)
            .min_by(|a, b| a.gap.total_cmp(&b.gap))
    }

    /// Zones of an element of a line, and its free ends.
    fn line(
        &self,
        segment: &Segment,
        (part, faces): (usize, &[usize]),
        (q, was): (&[f64], Option<&[f64]>),
        (range, near): (f64, f64),
        out: &mut Vec<Touch>,
    ) {
        let half = faces.iter().map(|&f| self.skin.faces[f].radius).fold(0.0, f64::max);
        let mut over = Over {
            segment,
            piece: segment.piece(q),
            before: was.map(|was| segment.piece(was)),
            part,
            faces,
            range: near,
            most: near - segment.radius - half,
        };
        let plain = self.facing.apart.is_empty() && self.stays(&over);
        let zones = plain.then(|| self.zones_of_nets(&over)).flatten().unwrap_or_else(|| {
            (over.range, over.most) = (range, range - segment.radius - half);
            let bounds = Bounds {
                speed: over.piece.speed_bound(),
                bend: over.piece.bend_bound(),
                reach: segment.radius + half,
                floor: 1e-3 * segment.radius,
                single: 0.25 * segment.radius,
            };
            zones(|xi| self.least(&over, xi).gap, (0.0, 1.0), &bounds)
        });
        for zone in zones {
            for stretch in Stretch::of(&over.piece, zone, |xi| self.least(&over, xi)) {
                self.stretch(&over, &stretch, out);
            }
        }
        for xi in [0.0, 1.0] {
            if segment.free[xi as usize] {
                self.touch(&self.one(&over, (xi, segment.radius), (xi, xi), true), out);
            }
        }
    }

    /// The least gap at a place, cut off.
    fn least(&self, over: &Over<'_>, xi: f64) -> Sample {
        let flat = Sample { xi, gap: over.most, slope: 0.0 };
        self.nearest(over, xi).unwrap_or(flat)
    }

    /// Zones of an element of a line before each net by itself, joined; none where a net bends too sharply for that.
    ///
    /// This takes distances for gaps: no part of the element may be beyond the mid-surface by more than reaches back.
    fn zones_of_nets(&self, over: &Over<'_>) -> Option<Vec<(f64, f64)>> {
        let mut all = Vec::new();
        for &face in over.faces {
            let reach = over.segment.radius + self.skin.faces[face].radius;
            for number in self.skin.nets_of(face) {
                all.append(&mut self.now.nets[number].zones(&over.piece, reach)?);
            }
        }
        all.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        all.dedup_by(|next, last| {
            let one = next.0 <= last.1;
            if one {
                last.1 = last.1.max(next.1);
            }
            one
        });
        Some(all)
    }

    /// Whether no part of an element can be beyond the mid-surface by more than reaches back: nothing was at the last
    /// accepted step, and since then neither side has come that far.
    fn stays(&self, over: &Over<'_>) -> bool {
        let (Some(then), Some(was)) = (self.before, &over.before) else { return true };
        let faces = &self.skin.faces;
        let half = over.faces.iter().map(|&f| faces[f].radius).fold(f64::INFINITY, f64::min);
        let nets = || over.faces.iter().flat_map(|&face| self.skin.nets_of(face));
        let moved = nets().map(|k| farthest(self.now.nets[k].points(), then.nets[k].points()));
        let travel = farthest(&over.piece.control(), &was.control()) + moved.fold(0.0, f64::max);
        travel <= over.segment.radius + half
            && self.crossed.iter().all(|crossed| crossed.facing != self.number as u32)
    }

    /// The points of a stretch; the deepest shows the least gap of all of it.
    fn stretch(&self, over: &Over<'_>, stretch: &Stretch, out: &mut Vec<Touch>) {
        let (zone, from) = (stretch.zone, out.len());
        let mut samples = Vec::with_capacity(POINTS + 2);
        samples.extend(self.nearest(over, zone.0));
        for Place { xi, weight, .. } in stretch.spots(&over.piece) {
            let first = out.len();
            self.touch(&self.one(over, (xi, weight), zone, false), out);
            let probes = out[first..].iter().filter_map(|touch| match &touch.meets {
                Meets::Face(probe, _) => Some(over.sample(xi, probe)),
                Meets::Shape(_) => None,
            });
            samples.extend(probes.min_by(|a, b| a.gap.total_cmp(&b.gap)));
        }
        samples.extend(self.nearest(over, zone.1));
        if let Some(deepest) = out[from..].iter_mut().min_by(|a, b| a.gap.total_cmp(&b.gap)) {
            deepest.gap = least(&samples);
        }
    }
}

/// Number by which a probe is known among those that have crossed a surface.
pub(crate) fn key(mark: &Mark) -> f64 {
    match *mark {
        Mark::Number(id) => id as f64,
        Mark::Along { arc, .. } => arc,
    }
}
