//! Zones: where along a slave piece the gap is below zero. None is missed.
//!
//! Before a line that bends little, a convex body and within a bore the gap is convex, or concave, but for a known rest:
//! see [`Convexity`]. Else:
//!
//! The distance to any set changes no faster than the point moves, so on an interval whose image is at most `ell`
//! long `min g >= (g_a + g_b - ell)/2`; and it is semiconcave, `g'' <= M` with `M = v^2/d + |r''|`, so that
//! `min g >= min(g_a, g_b) - M (b - a)^2/8`. Intervals that can be neither dropped nor accepted are halved.
//!
//! The force of a zone is a sum over some of its points, the same for lines, shapes and surfaces: see [`Stretch`].

use crate::curve::{Piece, root};
use pliant_math::quadrature::{GAUSS_5, Rule};

/// What bounds the gap along a slave piece.
#[derive(Clone, Copy, Debug)]
pub struct Bounds {
    /// Bound v of the speed `|dr/dxi|` of the slave [m].
    pub speed: f64,
    /// Bound of `|d^2r/dxi^2|` of the slave [m].
    pub bend: f64,
    /// Distance from the gap's zero to where the distance function has its kinks: the sum of the radii between lines,
    /// infinite before a plane [m].
    pub reach: f64,
    /// Length below which nothing is resolved further [m].
    pub floor: f64,
    /// Length below which a single change of sign is believed to be one [m].
    pub single: f64,
}

/// Place of a zone's end among the xi [1].
const END: f64 = 1e-13;

/// The zones in [a, b], in order: intervals where `gap` is below zero.
#[must_use]
pub fn zones(
    mut gap: impl FnMut(f64) -> f64,
    (a, b): (f64, f64),
    bounds: &Bounds,
) -> Vec<(f64, f64)> {
    let mut found = Vec::new();
    let (g_a, g_b) = (gap(a), gap(b));
    search(&mut gap, (a, g_a), (b, g_b), bounds, &mut found);
    found
}

fn search(
    gap: &mut impl FnMut(f64) -> f64,
    (a, g_a): (f64, f64),
    (b, g_b): (f64, f64),
    bounds: &Bounds,
    found: &mut Vec<(f64, f64)>,
) {
    let ell = bounds.speed * (b - a);
    let mean = 0.5 * (g_a + g_b);
    let (mut least, mut most) = (mean - 0.5 * ell, mean + 0.5 * ell);
    let distance = least + bounds.reach;
    if distance > 0.0 {
        let m = bounds.speed * bounds.speed / distance + bounds.bend;
        let dip = m * (b - a) * (b - a) / 8.0;
        least = least.max(g_a.min(g_b) - dip);
        most = most.min(g_a.max(g_b) + dip);
    }
    if least > 0.0 {
        return;
    }
    if most < 0.0 {
        return add(found, a, b);
    }
    if ell < bounds.single && g_a * g_b < 0.0 {
        let end = root(&mut *gap, (a, g_a), (b, g_b), END);
        return if g_a < 0.0 { add(found, a, end) } else { add(found, end, b) };
    }
    if ell < bounds.floor {
        if g_a < 0.0 || g_b < 0.0 {
            add(found, a, b);
        }
        return;
    }
    let c = 0.5 * (a + b);
    let g_c = gap(c);
    search(gap, (a, g_a), (c, g_c), bounds, found);
    search(gap, (c, g_c), (b, g_b), bounds, found);
}

fn add(found: &mut Vec<(f64, f64)>, a: f64, b: f64) {
    match found.last_mut() {
        Some(last) if a <= last.1 => last.1 = b,
        _ => found.push((a, b)),
    }
}

/// Points of a stretch.
pub const POINTS: usize = 5;

/// Their places and weights. The points move with the ends: force and stored energy belong together no better than the
/// rule resolves the ramp of the normal force. Three points are five per cent off, five 0.6 per cent at most.
const RULE: Rule<POINTS> = GAUSS_5;

/// Length, in radii, from which on zones are looked at for places where they may part, and that from which on they are
/// cut there as a whole; number of places.
const WIDE: (f64, f64) = (4.0, 6.0);
const SAMPLES: usize = 8;
/// Depth where the gap is largest, in parts of that on the shallower side, at which a zone is cut there as a whole, and
/// from which on it is not.
const PARTING: (f64, f64) = (0.4, 0.8);

/// A zone, or a part of one, with points that carry its force.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stretch {
    /// Between these xi of the slave.
    pub zone: (f64, f64),
    /// Whether either end is a place where the gap is largest.
    pub tops: [bool; 2],
    /// Part of the force that its points carry.
    pub share: f64,
}

/// A point of a stretch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spot {
    /// Its xi on the slave.
    pub xi: f64,
    /// Where it lies between both ends, 0 to 1.
    pub part: f64,
    /// Length of the slave that it stands for [m].
    pub weight: f64,
}

/// A smooth step from 0 at the first to 1 at the second place.
#[must_use]
pub fn step(x: f64, (from, to): (f64, f64)) -> f64 {
    let x = ((x - from) / (to - from)).clamp(0.0, 1.0);
    x * x * (3.0 - 2.0 * x)
}

impl Stretch {
    /// A zone in stretches, cut where it is about to part: where the gap is largest in between. Where two zones become
    /// one, all at once, the force would jump by what the points of the one leave out. So that it does not jump where
    /// such a place comes up either, points of the zone as a whole hand over to those of its parts while it does. A
    /// line that lies on something is not cut: its gap is largest anywhere, and friction would not find rest.
    #[must_use]
    pub fn of(slave: &Piece, zone: (f64, f64), mut sample: impl FnMut(f64) -> Sample) -> Vec<Self> {
        let width = zone.1 - zone.0;
        let wide = step(width * slave.length() / slave.radius(), WIDE);
        let mut cuts = if wide > 0.0 { Self::cuts(zone, &mut sample) } else { Vec::new() };
        for (_, parted) in &mut cuts {
            *parted *= wide;
        }
        let mut levels: Vec<f64> = cuts.iter().map(|&(_, parted)| parted).collect();
        levels.push(1.0);
        levels.push(0.0);
        levels.sort_unstable_by(|a, b| b.total_cmp(a));
        let mut all = Vec::new();
        // What is cut up to one level hands over to what is cut up to the next.
        for pair in levels.windows(2) {
            let share = pair[0] - pair[1];
            if share > 0.0 {
                let here = cuts.iter().filter(|cut| cut.1 >= pair[0]).map(|cut| cut.0);
                let ends: Vec<f64> = [zone.0].into_iter().chain(here).chain([zone.1]).collect();
                let last = ends.len() - 2;
                all.extend(ends.windows(2).enumerate().map(|(k, ends)| Self {
                    zone: (ends[0], ends[1]),
                    tops: [k > 0, k < last],
                    share,
                }));
            }
        }
        all
    }

    /// Places where the gap is largest within a zone, and how far it has parted there, 0 to 1.
    fn cuts(zone: (f64, f64), sample: &mut impl FnMut(f64) -> Sample) -> Vec<(f64, f64)> {
        let width = zone.1 - zone.0;
        let samples: [Sample; SAMPLES + 1] =
            std::array::from_fn(|k| sample(zone.0 + width * k as f64 / SAMPLES as f64));
        let deepest = |side: &[Sample]| -side.iter().fold(0.0, |gap, s| s.gap.min(gap));
        let mut cuts = Vec::new();
        let mut last = 0;
        for k in 1..=SAMPLES {
            let ends = [last, k].map(|k| (samples[k].xi, samples[k].slope));
            if ends[0].1 > 0.0 && ends[1].1 < 0.0 {
                let top = root(|xi| sample(xi).slope, ends[0], ends[1], END);
                let shallower = deepest(&samples[..=last]).min(deepest(&samples[k..]));
                let depth = -sample(top).gap;
                if depth < PARTING.1 * shallower {
                    cuts.push((top, 1.0 - step(depth / shallower, PARTING)));
                }
            }
            // A sample may hit the very place.
            if ends[1].1 != 0.0 {
                last = k;
            }
        }
        cuts
    }

    /// Its points.
    #[must_use]
    pub fn spots(&self, slave: &Piece) -> [Spot; POINTS] {
        let width = self.zone.1 - self.zone.0;
        RULE.pairs().map(|(part, w)| Spot {
            xi: self.zone.0 + part * width,
            part,
            weight: w * width * slave.length() * self.share,
        })
    }
}

/// A place along a slave piece, the gap there and its slope by xi.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Its xi.
    pub xi: f64,
    /// Gap [m].
    pub gap: f64,
    /// `dg/dxi` [m].
    pub slope: f64,
}

impl Sample {
    /// That of the gap's opposite.
    #[must_use]
    pub fn opposite(&self) -> Self {
        Self { gap: -self.gap, slope: -self.slope, ..*self }
    }
}

/// What bounds the gap along a slave piece before a line that bends little or a convex body: there it is convex but for
/// `sag`.
///
/// Nearer than its radius of curvature a curve has one foot for each point, and the Hessian of the distance d is never
/// below `-kappa/(1 - kappa d)`: a point that moves with speed v and acceleration a meets `g'' >= -sag`,
/// `sag = v^2 kappa/(1 - kappa d) + |a|`. So `g + sag x^2/2` is convex: above its tangents, below its chords. The signed
/// distance of a convex body is convex: before one `sag = |a|`. Within a bore it is the gap's opposite that is all this,
/// for there the distance from a line is what is left of a radius.
#[derive(Clone, Copy, Debug)]
pub struct Convexity {
    /// Bound of `-g''` [m].
    pub sag: f64,
    /// Distance from the gap's zero to the distance function's kinks, as in [`Bounds`] [m].
    pub reach: f64,
    /// Width among the xi below which nothing is resolved further.
    pub floor: f64,
}

/// What is left of one less distances over radii of curvature, from which on a line counts as bent little.
const STRAIGHT: f64 = 0.2;
/// Newton's increments, by xi, below which the next one is rounding.
const CONVERGED: f64 = 1e-9;

impl Convexity {
    /// That of a slave before a set whose every point nearer than `1/kappa` has one foot, between places where the distance
    /// exceeds `reach` by their gaps; none where it may come near `1/kappa`. `least` is the smaller radius [m].
    #[must_use]
    pub fn before(
        kappa: f64,
        (reach, least): (f64, f64),
        slave: &Piece,
        [a, b]: [&Sample; 2],
    ) -> Option<Self> {
        let speed = slave.speed_bound();
        let farthest = reach + 0.5 * (a.gap + b.gap + speed * (b.xi - a.xi));
        let rest = 1.0 - kappa * farthest;
        (rest > STRAIGHT).then(|| Self {
            sag: speed * speed * kappa / rest + slave.bend_bound(),
            reach,
            floor: 1e-3 * least / speed,
        })
    }

    /// How far g may leave convexity between two places.
    fn slack(&self, a: &Sample, b: &Sample) -> f64 {
        0.125 * self.sag * (b.xi - a.xi).powi(2)
    }

    /// A bound of the gap from below between two places: where the tangents of the convex function meet.
    #[must_use]
    pub fn least(&self, a: &Sample, b: &Sample) -> f64 {
        let width = b.xi - a.xi;
        let turn = 0.5 * self.sag * width;
        let (s_a, s_b) = (a.slope - turn, b.slope + turn);
        // The convex function lies above g by the same at both ends, and by at most that between.
        if s_a >= 0.0 {
            a.gap
        } else if s_b <= 0.0 {
            b.gap
        } else {
            let way = (b.gap - a.gap - s_b * width) / (s_a - s_b);
            a.gap + s_a * way
        }
    }

    /// Appends the zones between two places, in order: intervals where the gap is below zero.
    pub fn zones(
        &self,
        gap: &mut impl FnMut(f64) -> Sample,
        a: &Sample,
        b: &Sample,
        found: &mut Vec<(f64, f64)>,
    ) {
        if self.least(a, b) > 0.0 {
            return;
        }
        let slack = self.slack(a, b);
        if a.gap.max(b.gap) + slack < 0.0 {
            return add(found, a.xi, b.xi);
        }
        let opposite = (a.gap < 0.0) != (b.gap < 0.0);
        let small = b.xi - a.xi < self.floor;
        if opposite {
            let end = self.end(gap, a, b);
            if small || self.is_single(a, b, end) {
                return if a.gap < 0.0 {
                    add(found, a.xi, end.xi)
                } else {
                    add(found, end.xi, b.xi)
                };
            }
        } else if small {
            if a.gap < 0.0 || b.gap < 0.0 {
                add(found, a.xi, b.xi);
            }
            return;
        }
        let middle = if opposite || a.gap < 0.0 { 0.5 } else { self.lowest(a, b) };
        let c = gap(a.xi + middle * (b.xi - a.xi));
        self.zones(gap, a, &c, found);
        self.zones(gap, &c, b, found);
    }

    /// Half of what squared distances at the ends exceed that of the gap's zero by, over that distance, and the slopes, on
    /// an interval of width one: of straight lines they are a parabola's. Far from its kinks the gap itself.
    fn squares(&self, a: &Sample, b: &Sample) -> [f64; 4] {
        let width = b.xi - a.xi;
        let value = |s: &Sample| s.gap * (1.0 + 0.5 * s.gap / self.reach);
        let slope = |s: &Sample| s.slope * (1.0 + s.gap / self.reach) * width;
        [value(a), slope(a), value(b), slope(b)]
    }

    /// Appends the zones between two places where this is what bounds the gap's opposite: the rest of where that is below
    /// zero.
    pub fn zones_of_opposite(
        &self,
        gap: &mut impl FnMut(f64) -> Sample,
        a: &Sample,
        b: &Sample,
        found: &mut Vec<(f64, f64)>,
    ) {
        let mut free = Vec::new();
        self.zones(&mut |xi| gap(xi).opposite(), &a.opposite(), &b.opposite(), &mut free);
        let mut from = a.xi;
        for (start, end) in free.into_iter().chain([(b.xi, b.xi)]) {
            if start > from {
                add(found, from, start);
            }
            from = end;
        }
    }

    /// Where, as a part of the interval, the gap is about lowest.
    fn lowest(&self, a: &Sample, b: &Sample) -> f64 {
        let at = lowest(self.squares(a, b));
        if at.is_finite() { at.clamp(0.1, 0.9) } else { 0.5 }
    }

    /// The place between two of opposite sign where the gap vanishes: Newton's method in a bracket, from where the
    /// cubic through the squares does.
    fn end(&self, gap: &mut impl FnMut(f64) -> Sample, a: &Sample, b: &Sample) -> Sample {
        let [f_a, s_a, f_b, s_b] = self.squares(a, b);
        let (rise, width) = (f_b - f_a, b.xi - a.xi);
        let (two, three) = (3.0 * rise - 2.0 * s_a - s_b, s_a + s_b - 2.0 * rise);
        let cubic = |x: f64| {
            let value = f_a + x * (s_a + x * (two + x * three));
            Sample { xi: x, gap: value, slope: s_a + x * (2.0 * two + 3.0 * x * three) }
        };
        let rises = b.gap > 0.0;
        let guess = newton(&mut |x| cubic(x), (0.0, 1.0), 0.5, rises, 1e-3).xi;
        newton(gap, (a.xi, b.xi), a.xi + guess * width, rises, CONVERGED)
    }

    /// Whether the gap changes its sign nowhere else between two places of opposite sign.
    fn is_single(&self, a: &Sample, b: &Sample, end: Sample) -> bool {
        let (inside, outside) = if a.gap < 0.0 { (a, b) } else { (b, a) };
        let (way_in, way_out) = ((end.xi - inside.xi).abs(), (outside.xi - end.xi).abs());
        end.slope.abs() >= 0.5 * self.sag * way_out
            && -inside.gap >= 0.5 * self.sag * way_in * way_in
    }
}

/// The lowest point, on an interval of width one, of the cubic with these values and slopes at its ends.
fn lowest([f_a, s_a, f_b, s_b]: [f64; 4]) -> f64 {
    let u = s_a + s_b - 3.0 * (f_b - f_a);
    let root = (u * u - s_a * s_b).max(0.0).sqrt();
    1.0 - (s_b + root - u) / (s_b - s_a + 2.0 * root)
}

/// The least gap along places in order: between two of them it is taken for a cubic.
#[must_use]
pub fn least(samples: &[Sample]) -> f64 {
    let between = samples.windows(2).filter(|pair| pair[0].slope < 0.0 && pair[1].slope > 0.0);
    let dip = |pair: &[Sample]| {
        let width = pair[1].xi - pair[0].xi;
        let (f_a, s_a) = (pair[0].gap, pair[0].slope * width);
        let (f_b, s_b) = (pair[1].gap, pair[1].slope * width);
        let (rise, x) = (f_b - f_a, lowest([f_a, s_a, f_b, s_b]));
        f_a + x * (s_a + x * (3.0 * rise - 2.0 * s_a - s_b + x * (s_a + s_b - 2.0 * rise)))
    };
    let gaps = samples.iter().map(|sample| sample.gap).chain(between.map(dip));
    gaps.fold(f64::INFINITY, f64::min)
}

/// Where a function vanishes in a bracket, from `x` on.
fn newton(
    value: &mut impl FnMut(f64) -> Sample,
    (mut low, mut high): (f64, f64),
    mut x: f64,
    rises: bool,
    tolerance: f64,
) -> Sample {
    let mut here = value(x);
    for _ in 0..100 {
        if (here.gap < 0.0) == rises {
            low = x;
        } else {
            high = x;
        }
        let step = -here.gap / here.slope;
        let next = x + step;
        if step.abs() <= tolerance {
            return Sample { xi: next.clamp(low, high), gap: 0.0, slope: here.slope };
        }
        x = if next > low && next < high { next } else { 0.5 * (low + high) };
        here = value(x);
    }
    Sample { xi: x, ..here }
}
