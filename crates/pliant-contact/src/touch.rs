//! Where a piece of a line touches another line or a shape, and the points that carry the force there.

use crate::curve::{Piece, sign_changes};
use crate::point::{Blocks, Laws, Motion, Place, Slide, Verge};
use crate::shapes::{Placed, Shape};
use crate::zones::{Bounds, Convexity, POINTS, Sample, Spot, Stretch, least, zones};
use nalgebra::{Matrix3, Vector3};

/// What a piece may touch.
#[derive(Clone, Copy, Debug)]
pub enum Master<'a> {
    /// A piece of a line, and whether nothing follows at its first and its second end: such ends are round.
    Line(&'a Piece, [bool; 2]),
    /// A shape at rest.
    Shape(&'a Placed),
}

/// A point in contact, and where it lies.
#[derive(Clone, Copy, Debug)]
pub struct Point {
    /// Its geometry.
    pub place: Place,
    /// xi on the slave piece.
    pub xi: f64,
    /// xi on the master piece; 0 on shapes.
    pub eta: f64,
    /// Where it lies between both ends of its zone, 0 to 1.
    pub part: f64,
}

/// A zone of the slave, or its free end, with the points that carry the force.
#[derive(Clone, Copy, Debug)]
pub struct Patch {
    /// The zone, between these xi of the slave; a point for a free end.
    pub zone: (f64, f64),
    /// Its ends where the gap vanishes, or where the next element of the master takes over: they move with the lines, and
    /// the points with them.
    pub verges: [Option<Verge>; 2],
    /// xi of the feet on the master at both ends; 0 on shapes.
    pub etas: [f64; 2],
    /// The gap at both ends, where something of the force is left there.
    ends: [Option<Sample>; 2],
    points: [Point; POINTS],
    count: usize,
}

impl Patch {
    /// The points: [`POINTS`] of a zone, one of a free end.
    #[must_use]
    pub fn points(&self) -> &[Point] {
        &self.points[..self.count]
    }

    /// The smallest gap of the zone, between its points and its ends, where something of the force is left.
    #[must_use]
    pub fn least_gap(&self) -> f64 {
        let [first, last] = self.ends;
        let points = self.points().iter().filter(|point| point.place.weight > 0.0);
        let points = points.map(|point| point.place.sample(point.xi));
        let samples: Vec<Sample> = first.into_iter().chain(points).chain(last).collect();
        least(&samples)
    }

    /// The gap that one of its points is to show: the deepest that of the zone, the others their own.
    #[must_use]
    pub fn gap_at(&self, point: &Point) -> f64 {
        let mut pressed = self.points().iter().filter(|other| other.place.weight > 0.0);
        let deepest = pressed.all(|other| point.place.gap <= other.place.gap);
        if deepest { self.least_gap() } else { point.place.gap }
    }

    /// Leaves each point this share, 0 to 1, of the length that it stands for, by its xi on the slave and the master.
    /// Returns whether anything is left.
    pub fn leave(&mut self, share: impl Fn(f64, f64) -> f64) -> bool {
        let mut left = false;
        for point in &mut self.points[..self.count] {
            let share = share(point.xi, point.eta);
            left |= share > 0.0;
            point.place.weight *= share;
        }
        for (end, eta) in self.ends.iter_mut().zip(self.etas) {
            *end = end.filter(|sample| share(sample.xi, eta) > 0.0);
        }
        left
    }

    /// Adds the derivatives of the forces at its points, as [`Place::linearise`] and [`Place::add_tangent`] explain;
    /// `motion` is that of a point, by its number.
    pub fn add_tangent<'m>(
        &self,
        laws: &Laws,
        motion: impl Fn(usize) -> Motion<'m>,
        factors: (f64, f64),
        symmetric: bool,
        out: &mut Blocks,
    ) {
        let width = self.zone.1 - self.zone.0;
        let moves = factors.0 != 0.0 && self.verges.iter().any(Option::is_some);
        let (mut first, mut last) = ([Vector3::zeros(); 8], [Vector3::zeros(); 8]);
        for (number, Point { place, part, .. }) in self.points().iter().enumerate() {
            let tangent = place.linearise(laws, &motion(number), factors, symmetric);
            place.add_tangent(&tangent, out);
            if moves {
                place.add_verge(&tangent, (*part, width), [&mut first, &mut last]);
            }
        }
        for (verge, by_end) in self.verges.iter().zip([&first, &last]) {
            if let Some(verge) = verge {
                verge.add_tangent(by_end, factors.0, symmetric, out);
            }
        }
    }

    /// Whether it is that of a free end.
    #[must_use]
    pub fn is_end(&self) -> bool {
        self.count == 1
    }
}

impl Master<'_> {
    /// The point of the slave at `xi`, its foot, and xi of the foot.
    #[must_use]
    pub fn face(&self, slave: &Piece, xi: f64, weight: f64) -> (Place, f64) {
        let q = slave.at(xi);
        let mut alpha = [0.0; 8];
        let own = slave.weights(xi);
        for k in 0..4 {
            alpha[4 + k] = -own[k];
        }
        let (along, along_weights) = (slave.slope(xi), slave.weight_slopes(xi));
        match self {
            Self::Shape(shape) => {
                let distance = shape.distance(q);
                let place = Place {
                    alpha,
                    gap: distance.value - slave.radius(),
                    // The slave's way to the shape; d is minus what the distance measures.
                    n: -distance.normal,
                    hessian: distance.hessian,
                    slide: None,
                    along,
                    along_weights,
                    weight,
                };
                (place, 0.0)
            }
            Self::Line(master, round) => {
                let eta = master.nearest(q);
                alpha[..4].copy_from_slice(&master.weights(eta));
                let d = master.at(eta) - q;
                let distance = d.norm();
                let n = if distance > 0.0 { d / distance } else { Vector3::z() };
                let slope = master.slope(eta);
                let c = slope.norm_squared() + d.dot(&master.bend(eta));
                // At the end of a line the foot stays, at that of an element it slides on; where c vanishes it would
                // slide without bound.
                let slides = (eta > 0.0 || !round[0]) && (eta < 1.0 || !round[1]);
                let inside = slides && c > 1e-3 * slope.norm_squared();
                let weights = master.weight_slopes(eta);
                let place = Place {
                    alpha,
                    gap: distance - slave.radius() - master.radius(),
                    n,
                    hessian: (Matrix3::identity() - n * n.transpose())
                        / distance.max(f64::MIN_POSITIVE),
                    slide: inside.then_some(Slide { slope, weights, c, d }),
                    along,
                    along_weights,
                    weight,
                };
                (place, eta)
            }
        }
    }

    /// Distance of the surfaces at a point of the slave [m].
    #[must_use]
    pub fn gap(&self, slave: &Piece, xi: f64) -> f64 {
        let q = slave.at(xi);
        match self {
            Self::Shape(shape) => shape.value(q) - slave.radius(),
            Self::Line(master, _) => {
                (master.at(master.nearest(q)) - q).norm() - slave.radius() - master.radius()
            }
        }
    }

    /// The same with its slope by xi of the slave.
    fn sample(&self, slave: &Piece, xi: f64) -> Sample {
        let q = slave.at(xi);
        let master = match self {
            Self::Line(master, _) => master,
            Self::Shape(shape) => {
                let (value, normal) = shape.value_and_normal(q);
                let slope = normal.dot(&slave.slope(xi));
                return Sample { xi, gap: value - slave.radius(), slope };
            }
        };
        let d = master.at(master.nearest(q)) - q;
        let distance = d.norm();
        let n = if distance > 0.0 { d / distance } else { Vector3::z() };
        let gap = distance - slave.radius() - master.radius();
        Sample { xi, gap, slope: -n.dot(&slave.slope(xi)) }
    }

    /// A length by which the two are certainly apart, below zero where they may touch.
    #[must_use]
    pub fn clearance(&self, slave: &Piece) -> f64 {
        let balls = self.clearance_of_balls(slave);
        let Self::Line(..) = self else { return balls };
        let ends = [0.0, 1.0].map(|xi| self.sample(slave, xi));
        let convexity = self.convexity(slave, &ends);
        balls.max(convexity.map_or(balls, |c| c.least(&ends[0], &ends[1])))
    }

    /// That of balls around both.
    fn clearance_of_balls(&self, slave: &Piece) -> f64 {
        let q = slave.at(0.5);
        let half = 0.5 * slave.speed_bound() + slave.radius();
        match self {
            Self::Shape(shape) => shape.value(q) - half,
            Self::Line(master, _) => {
                let reach = half + 0.5 * master.speed_bound() + master.radius();
                (master.at(0.5) - q).norm() - reach
            }
        }
    }

    /// How far from convex the gap is between two places: before a line that bends little beside their distance, and
    /// before a convex body. Within a bore it is the gap's opposite.
    fn convexity(&self, slave: &Piece, [a, b]: &[Sample; 2]) -> Option<Convexity> {
        let r = slave.radius();
        match self {
            Self::Line(master, _) => {
                let s = master.radius();
                Convexity::before(master.curvature_bound()?, (r + s, r.min(s)), slave, [a, b])
            }
            Self::Shape(Placed { shape: Shape::Bore(bore), .. }) => {
                let ends = [&a.opposite(), &b.opposite()];
                Convexity::before(bore.curvature_bound()?, (bore.radius() - r, r), slave, ends)
            }
            Self::Shape(Placed { shape, .. }) => shape.is_convex().then(|| Convexity {
                sag: slave.bend_bound(),
                reach: r + shape.reach(),
                floor: 1e-3 * r / slave.speed_bound(),
            }),
        }
    }

    /// Zones in a part of the slave, wherever the feet are.
    fn zones_in(
        &self,
        slave: &Piece,
        span: (f64, f64),
        bounds: &Bounds,
        found: &mut Vec<(f64, f64)>,
    ) {
        let ends = [span.0, span.1].map(|xi| self.sample(slave, xi));
        let Some(convexity) = self.convexity(slave, &ends) else {
            return found.extend(zones(|xi| self.gap(slave, xi), span, bounds));
        };
        let mut gap = |xi| self.sample(slave, xi);
        // Zones of neighbouring spans are not one.
        let mut here = Vec::new();
        match self {
            Self::Shape(Placed { shape: Shape::Bore(_), .. }) => {
                convexity.zones_of_opposite(&mut gap, &ends[0], &ends[1], &mut here);
            }
            _ => convexity.zones(&mut gap, &ends[0], &ends[1], &mut here),
        }
        found.append(&mut here);
    }

    /// Whether the foot of a point lies on this piece, not on the neighbours of it: inside, or at a round end.
    fn owns(&self, slave: &Piece, xi: f64) -> bool {
        match self {
            Self::Shape(_) => true,
            Self::Line(master, round) => {
                let q = slave.at(xi);
                let eta = master.nearest(q);
                let [r, t, r_2, t_2] = master.vectors();
                let shift = self.shift(slave);
                let begins = || round[0] || (q - r).dot(t) >= -shift * t.norm();
                // Feet right before a node that ends this piece lie at it but for the shift.
                let passed = || (q - r_2).dot(t_2) >= -shift * t_2.norm();
                let near_end = (1.0 - eta) * master.length() <= 2.0 * shift;
                (eta > 0.0 || begins()) && (round[1] || !(eta == 1.0 || near_end && passed()))
            }
        }
    }

    /// Length by which the pieces of a master meet before their nodes. A line may lie in the plane normal to the master
    /// at a node as a whole, as ropes that cross in their middle do: rounding must not tear its zone apart.
    fn shift(&self, slave: &Piece) -> f64 {
        SHIFT * slave.radius()
    }

    /// Bernstein coefficients along the slave of the distances from the planes normal to the master at those of its ends
    /// that something follows at, above zero on the master's side.
    fn planes(&self, slave: &Piece) -> [Option<[f64; 4]>; 2] {
        let Self::Line(master, round) = self else { return [None; 2] };
        let b = slave.control();
        let x = master.vectors();
        [0, 1].map(|end| {
            let sign = if end == 0 { 1.0 } else { -1.0 };
            let (node, slope) = (x[2 * end], x[2 * end + 1]);
            let shift = self.shift(slave) * slope.norm();
            (!round[end]).then(|| b.map(|b| sign * ((b - node).dot(&slope) + shift)))
        })
    }

    /// The parts of `span` that `wanted` says yes to in their middle, where the slave may cross the planes.
    fn cut(
        planes: &[Option<[f64; 4]>; 2],
        span: (f64, f64),
        wanted: impl Fn(f64) -> bool,
        out: &mut Vec<(f64, f64)>,
    ) {
        let mut cuts = vec![span.0];
        for plane in planes.iter().flatten() {
            cuts.extend(sign_changes(*plane).into_iter().filter(|&x| span.0 < x && x < span.1));
        }
        cuts.push(span.1);
        cuts.sort_unstable_by(f64::total_cmp);
        let spans = cuts.windows(2).map(|c| (c[0], c[1]));
        out.extend(spans.filter(|&(a, c)| c > a && wanted(0.5 * (a + c))));
    }

    fn bounds(&self, slave: &Piece) -> Bounds {
        let (reach, least) = match self {
            Self::Shape(shape) => (slave.radius() + shape.shape.reach(), slave.radius()),
            Self::Line(master, _) => {
                (slave.radius() + master.radius(), slave.radius().min(master.radius()))
            }
        };
        Bounds {
            speed: slave.speed_bound(),
            bend: slave.bend_bound(),
            reach,
            floor: 1e-3 * least,
            single: 0.25 * least,
        }
    }

    /// All zones along the slave piece, in order: where its surface is inside the other, and the foot on this piece of
    /// the other.
    #[must_use]
    pub fn zones(&self, slave: &Piece) -> Vec<(f64, f64)> {
        self.at_hand(slave, |this| {
            if this.clearance_of_balls(slave) > 0.0 { Vec::new() } else { this.zones_near(slave) }
        })
    }

    /// Calls `work` with as much of this as matters to the slave.
    fn at_hand<T>(&self, slave: &Piece, work: impl for<'b> FnOnce(&Master<'b>) -> T) -> T {
        match self {
            Self::Line(..) => work(self),
            Self::Shape(shape) => {
                let near = shape.near(slave.at(0.5), 0.5 * slave.speed_bound());
                work(&Master::Shape(&near))
            }
        }
    }

    fn zones_near(&self, slave: &Piece) -> Vec<(f64, f64)> {
        let mut found = Vec::new();
        let bounds = self.bounds(slave);
        let planes = self.planes(slave);
        let tame = match self {
            Self::Shape(_) => true,
            Self::Line(master, _) => master.is_tame(slave.radius() + master.radius()),
        };
        if !tame {
            // The planes do not say whose a foot is: all of the slave is searched, and the feet decide.
            let mut all = Vec::new();
            self.zones_in(slave, (0.0, 1.0), &bounds, &mut all);
            for zone in all {
                Self::cut(&planes, zone, |xi| self.owns(slave, xi), &mut found);
            }
            return found;
        }
        let belongs = |end: usize, p: f64| if end == 0 { p >= 0.0 } else { p > 0.0 };
        let all = |end: usize, p: &[f64; 4]| p.iter().all(|&p| belongs(end, p));
        let none = |end: usize, p: &[f64; 4]| !p.iter().any(|&p| belongs(end, p));
        let each = || planes.iter().enumerate().filter_map(|(end, p)| p.as_ref().map(|p| (end, p)));
        if each().any(|(end, p)| none(end, p)) {
            return found;
        }
        if each().all(|(end, p)| all(end, p)) {
            self.zones_in(slave, (0.0, 1.0), &bounds, &mut found);
            return found;
        }
        let inside = |x: f64| {
            let y = 1.0 - x;
            let w = [y * y * y, 3.0 * y * y * x, 3.0 * y * x * x, x * x * x];
            let value = |p: &[f64; 4]| (0..4).map(|k| w[k] * p[k]).sum::<f64>();
            each().all(|(end, p)| belongs(end, value(p)))
        };
        let mut spans = Vec::new();
        Self::cut(&planes, (0.0, 1.0), inside, &mut spans);
        for span in spans {
            self.zones_in(slave, span, &bounds, &mut found);
        }
        found
    }

    /// The zones with the points that carry the force between the two: five in each zone, and one at each free end of
    /// the slave. That counts as a length of one radius, for a zone under an end that meets the other head-on has
    /// hardly any.
    pub fn touch(&self, slave: &Piece, free: [bool; 2], found: &mut Vec<Patch>) {
        self.at_hand(slave, |this| this.touch_near(slave, free, found));
    }

    fn touch_near(&self, slave: &Piece, free: [bool; 2], found: &mut Vec<Patch>) {
        if self.clearance_of_balls(slave) > 0.0 {
            return;
        }
        let zones = self.zones_near(slave);
        let stretches = |zone| Stretch::of(slave, zone, |xi| self.sample(slave, xi));
        for stretch in zones.into_iter().flat_map(stretches) {
            let Stretch { zone, tops, .. } = stretch;
            let points = stretch.spots(slave).map(|Spot { xi, part, weight }| {
                let (place, eta) = self.face(slave, xi, weight);
                Point { place, xi, eta, part }
            });
            let faced = [zone.0, zone.1].map(|xi| (self.face(slave, xi, 0.0), xi));
            let ends = faced.map(|((place, _), xi)| Some(place.sample(xi)));
            let etas = faced.map(|((_, eta), _)| eta);
            let verges = [0, 1].map(|k| {
                let ((place, _), xi) = faced[k];
                if tops[k] {
                    return Verge::on_top(&place, slave.bend(xi));
                }
                let small = VANISHING * slave.radius();
                if place.gap.abs() < small {
                    return Verge::at(&place);
                }
                let Self::Line(master, round) = self else { return None };
                // The ends of an element stay, planes of the master's move.
                let inner = xi > 0.0 && xi < 1.0;
                let ends = (0..2).filter(|&end| inner && !round[end]);
                let x = master.vectors();
                let offsets = ends.map(|end| (end, slave.at(xi) - x[2 * end], x[2 * end + 1]));
                let mut on = offsets.filter(|(_, d, t)| d.dot(t).abs() < small * t.norm());
                on.next().and_then(|(end, d, t)| Verge::on_plane(&place, end, d, t))
            });
            found.push(Patch { zone, verges, etas, ends, points, count: POINTS });
        }
        for xi in [0.0, 1.0] {
            if !free[xi as usize] || !self.owns(slave, xi) {
                continue;
            }
            let (place, eta) = self.face(slave, xi, slave.radius());
            if place.gap < 0.0 {
                let points = [Point { place, xi, eta, part: 0.5 }; POINTS];
                found.push(Patch {
                    zone: (xi, xi),
                    verges: [None; 2],
                    etas: [eta; 2],
                    ends: [Some(place.sample(xi)); 2],
                    points,
                    count: 1,
                });
            }
        }
    }
}

/// See [`Master::shift`], in radii of the slave: far above rounding, far below what is seen.
const SHIFT: f64 = 1e-7;
/// Gap at the end of a zone, in radii, that is zero but for rounding.
const VANISHING: f64 = 1e-6;
