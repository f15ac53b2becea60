//! Bores: channels along a line, touched from inside. All around them is solid.

use crate::curve::Piece;
use crate::shapes::Distance;
use nalgebra::{Matrix3, Vector3};
use std::f64::consts::FRAC_PI_2;
use std::sync::Arc;

/// A bore in its own frame. Beyond the ends of its line it goes on straight.
#[derive(Clone)]
pub struct Bore {
    line: Arc<Line>,
    radius: f64,
    reach: f64,
    /// Pieces that are looked at, in order: all of them, or those that are nearest to any point of a ball.
    near: Arc<[usize]>,
    /// Whether what goes on beyond either end is looked at.
    beyond: [bool; 2],
}

/// The middle line.
struct Line {
    pieces: Vec<Piece>,
    /// Middles of the pieces, and how far along the line they are at most [m].
    middles: Vec<Vector3<f64>>,
    along: Vec<f64>,
    /// Bound of the length of half a piece [m].
    half: f64,
    /// Ends, and directions from there.
    ends: [(Vector3<f64>, Vector3<f64>); 2],
    /// Bounds of the angle by which each piece turns and of its curvature [1/m].
    turns: Vec<f64>,
    curvatures: Vec<f64>,
}

impl PartialEq for Bore {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.line, &other.line)
            && self.radius.to_bits() == other.radius.to_bits()
            && self.near == other.near
            && self.beyond == other.beyond
    }
}

impl std::fmt::Debug for Bore {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Bore of radius {} along {} pieces", self.radius, self.near.len())
    }
}

impl Line {
    fn new(pieces: Vec<Piece>) -> Self {
        let middles = pieces.iter().map(|piece| piece.at(0.5)).collect();
        let mut end = 0.0;
        let along = pieces.iter().map(|piece| {
            end += piece.speed_bound();
            end - 0.5 * piece.speed_bound()
        });
        let along = along.collect();
        let outwards = |k: usize, xi: f64, sign: f64| {
            (pieces[k].at(xi), pieces[k].slope(xi).normalize() * sign)
        };
        let ends = [outwards(0, 0.0, -1.0), outwards(pieces.len() - 1, 1.0, 1.0)];
        // A slope turns no further than the legs of the control points.
        let turn = |piece: &Piece| {
            let b = piece.control();
            let angle = |i: usize| (b[i + 1] - b[i]).angle(&(b[i + 2] - b[i + 1]));
            angle(0) + angle(1)
        };
        let half = pieces.iter().map(|piece| 0.5 * piece.speed_bound()).fold(0.0, f64::max);
        let turns = pieces.iter().map(turn).collect();
        let curvature = |piece: &Piece| piece.curvature_bound().unwrap_or(f64::INFINITY);
        let curvatures = pieces.iter().map(curvature).collect();
        Self { pieces, middles, along, half, ends, turns, curvatures }
    }

    /// Calls `work` with pieces and the distances of their middles from `q`, all whose middles may be as near as what it
    /// returns: along the line nothing comes nearer faster than it goes on.
    fn each_near(&self, q: Vector3<f64>, mut work: impl FnMut(usize, f64) -> f64) {
        let mut next = f64::NEG_INFINITY;
        for (k, &along) in self.along.iter().enumerate() {
            if along >= next {
                let far = (q - self.middles[k]).norm();
                next = along + far - work(k, far);
            }
        }
    }
}

impl Bore {
    /// The bore of a radius [m] along the cubic pieces between `points` [m] with unit `tangents`, `lengths` [m] apart
    /// along the line; none where these do not go together or the line bends more sharply than the radius.
    #[must_use]
    pub fn new(
        points: &[[f64; 3]],
        tangents: &[[f64; 3]],
        lengths: &[f64],
        radius: f64,
    ) -> Option<Self> {
        let n = lengths.len();
        let fits = n > 0 && points.len() == n + 1 && tangents.len() == n + 1;
        if !fits || radius.is_nan() || radius <= 0.0 {
            return None;
        }
        let vector = |v: &[f64; 3]| Vector3::from(*v);
        let pieces: Vec<Piece> = (0..n)
            .map(|k| {
                let x = [&points[k], &tangents[k], &points[k + 1], &tangents[k + 1]].map(vector);
                Piece::new(x, lengths[k], radius)
            })
            .collect();
        let sharpest = pieces.iter().map(Piece::sharpest).fold(0.0, f64::max);
        // Beyond the wall the distance has its kinks where the line's centres of curvature lie, within it on the line.
        let reach = (1.0 / sharpest - radius).min(radius);
        let near = (0..n).collect();
        let line = Arc::new(Line::new(pieces));
        (reach > 0.0).then_some(Self { line, radius, reach, near, beyond: [true; 2] })
    }

    /// How far outside of the wall the distance has its kinks [m].
    #[must_use]
    pub fn reach(&self) -> f64 {
        self.reach
    }

    /// Its radius [m].
    #[must_use]
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// As much of it as matters to points within `reach` of `q`: their distances are the same.
    #[must_use]
    pub fn near(&self, q: Vector3<f64>, reach: f64) -> Self {
        let Line { pieces, ends, .. } = &*self.line;
        let mut least = f64::INFINITY;
        self.line.each_near(q, |_, far| {
            least = least.min(far);
            least
        });
        let ways = ends.map(|(end, out)| {
            let d = q - end;
            let along = d.dot(&out);
            // How far the ball is from the straight line beyond the end; none: before it.
            (along > -reach).then(|| (d - out * along.max(0.0)).norm())
        });
        let least = ways.iter().flatten().fold(least, |least, way| least.min(*way));
        // The ball's points are no farther from the line than this, and what is nearest to them no farther from q than
        // twice the ball's radius more. A piece is no nearer than its middle less half of its length.
        let most = least + 2.0 * reach;
        let mut near = Vec::new();
        self.line.each_near(q, |k, far| {
            if far - 0.5 * pieces[k].speed_bound() <= most {
                near.push(k);
            }
            most + self.line.half
        });
        let beyond = ways.map(|way| way.is_some_and(|way| way <= most));
        // What goes on beyond an end goes on from its piece.
        if beyond[0] && near.first() != Some(&0) {
            near.insert(0, 0);
        }
        if beyond[1] && near.last() != Some(&(pieces.len() - 1)) {
            near.push(pieces.len() - 1);
        }
        Self { near: near.into(), beyond, ..self.clone() }
    }

    /// A bound of the curvature of its line [1/m], where this is in one piece and turns by less than a right angle: then
    /// every point nearer than the radius of curvature has one foot.
    #[must_use]
    pub fn curvature_bound(&self) -> Option<f64> {
        let (first, last) = (*self.near.first()?, *self.near.last()?);
        let whole = last - first + 1 == self.near.len();
        let turn: f64 = self.line.turns[first..=last].iter().sum();
        let kappa = self.line.curvatures[first..=last].iter().fold(0.0, |a, &b| f64::max(a, b));
        (whole && turn < FRAC_PI_2 && kappa.is_finite()).then_some(kappa)
    }

    /// The piece nearest to a point and its foot there, and how far before or behind the line's ends the point lies,
    /// as a vector along the line.
    fn foot(&self, q: Vector3<f64>) -> (&Piece, f64, Vector3<f64>) {
        let Line { pieces, middles, ends, .. } = &*self.line;
        // A piece is no nearer than its middle less half of its length.
        let bound = |k: usize| (q - middles[k]).norm() - 0.5 * pieces[k].speed_bound();
        let distance = |piece: &Piece, xi: f64| (q - piece.at(xi)).norm();
        let mut best = (0, 0.0);
        let mut least = f64::INFINITY;
        let mut guess = None;
        if let [_, _, ..] = *self.near {
            let bounds = self.near.iter().map(|&k| (k, bound(k)));
            guess = bounds.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(k, _)| k);
        }
        let others = self.near.iter().copied().filter(|&k| Some(k) != guess);
        for k in guess.into_iter().chain(others) {
            if least == f64::INFINITY || bound(k) < least {
                let xi = pieces[k].nearest(q);
                let here = distance(&pieces[k], xi);
                if here < least {
                    (best, least) = ((k, xi), here);
                }
            }
        }
        let mut found = (&pieces[best.0], best.1, Vector3::zeros());
        // The straight lines that go on beyond both ends.
        let last = pieces.len() - 1;
        for (side, (k, xi)) in [(0, 0.0), (last, 1.0)].into_iter().enumerate() {
            let (end, outwards) = ends[side];
            let along = (q - end).dot(&outwards);
            if self.beyond[side] && along > 0.0 {
                let here = (q - end - outwards * along).norm();
                if here < least || best == (k, xi) {
                    found = (&pieces[k], xi, outwards * along);
                    least = here;
                }
            }
        }
        found
    }

    /// Distance of the wall, below zero in it.
    #[must_use]
    pub fn distance(&self, q: Vector3<f64>) -> Distance {
        let (piece, xi, beyond) = self.foot(q);
        let d = q - piece.at(xi) - beyond;
        let l = d.norm();
        if l == 0.0 {
            // On the line every direction leads to the wall.
            let normal = piece.slope(xi).cross(&Vector3::ith(piece.slope(xi).iamin(), 1.0));
            return Distance {
                value: self.radius,
                normal: normal.normalize(),
                hessian: Matrix3::zeros(),
            };
        }
        let n = d / l;
        let slope = piece.slope(xi);
        // The foot slides as the line turns; straight on it does not turn.
        let turn = if beyond == Vector3::zeros() { d.dot(&piece.bend(xi)) } else { 0.0 };
        let c = slope.norm_squared() - turn;
        let space = Matrix3::identity() - n * n.transpose() - slope * slope.transpose() / c;
        Distance { value: self.radius - l, normal: -n, hessian: -space / l }
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    #[test]
    fn a_hook_between_any_two_places_is_seen() {
        let hook = |radius: f64| {
            let tangents = [[1.0, 0.0, 0.0], [-0.5_f64.cos(), 0.5_f64.sin(), 0.0]];
            Bore::new(&[[0.0; 3], [1.0, 0.0, 0.0]], &tangents, &[1.363_174_11], radius)
        };
        // By the roots of the derivative of its curvature, largest at xi = 0.821.
        let least = 1.0 / 95.777_994_98;
        assert!(hook(0.9999 * least).is_some() && hook(1.0001 * least).is_none());
    }
    use proptest::prelude::*;

    const STRAIGHT: f64 = 0.3;
    const BEND: f64 = 0.5;

    /// Place and tangent along a line that goes straight on along x, round a quarter of a circle, straight on along y.
    fn line(s: f64) -> (Vector3<f64>, Vector3<f64>) {
        let angle = ((s - STRAIGHT) / BEND).clamp(0.0, FRAC_PI_2);
        let (before, after) = (s.min(STRAIGHT), (s - STRAIGHT - FRAC_PI_2 * BEND).max(0.0));
        let at = Vector3::new(before + BEND * angle.sin(), BEND * (1.0 - angle.cos()) + after, 0.0);
        (at, Vector3::new(angle.cos(), angle.sin(), 0.0))
    }

    /// A bore of 0.1 m along that line, and the line's length.
    pub(crate) fn quarter() -> (Bore, f64) {
        let mut places = vec![0.0];
        for (length, n) in [(STRAIGHT, 2), (FRAC_PI_2 * BEND, 16), (STRAIGHT, 2)] {
            let start = places[places.len() - 1];
            places.extend((1..=n).map(|k| start + length * f64::from(k) / f64::from(n)));
        }
        let points: Vec<[f64; 3]> = places.iter().map(|&s| line(s).0.into()).collect();
        let tangents: Vec<[f64; 3]> = places.iter().map(|&s| line(s).1.into()).collect();
        let lengths: Vec<f64> = places.windows(2).map(|s| s[1] - s[0]).collect();
        (Bore::new(&points, &tangents, &lengths, 0.1).unwrap(), places[places.len() - 1])
    }

    proptest! {
        #[test]
        fn it_is_its_radius_less_the_distance_from_its_line(
            s in -0.5..2.0_f64, part in 0.0..1.5_f64, around in 0.0..std::f64::consts::TAU,
        ) {
            let (at, tangent) = line(s);
            let across = Vector3::z().cross(&tangent) * around.cos() + Vector3::z() * around.sin();
            let found = quarter().0.distance(at + across * (0.1 * part));
            // 16 cubic pieces on a quarter of a circle are 1e-7 off, which turns the normal the more the nearer the line is.
            let (distance, off) = (0.1 * part, 2e-7);
            prop_assert!((found.value - (0.1 - distance)).abs() < off, "{s} {found:?}");
            if part > 1e-2 {
                prop_assert!((found.normal + across).norm() < off / distance + 1e-5, "{s} {found:?}");
            }
        }
    }

    proptest! {
        #[test]
        fn a_part_of_it_is_as_far_as_all_of_it(
            middle in prop::array::uniform3(-0.5..1.5_f64), reach in 0.0..0.4_f64,
            offsets in prop::collection::vec(prop::array::uniform3(-1.0..1.0_f64), 20),
        ) {
            let (bore, middle) = (quarter().0, Vector3::from(middle));
            let near = bore.near(middle, reach);
            for offset in offsets.into_iter().map(Vector3::from) {
                let q = middle + offset * (reach / offset.norm().max(1.0));
                let (all, part) = (bore.distance(q), near.distance(q));
                // Rounding; where two feet are as near the normals may differ.
                prop_assert!((all.value - part.value).abs() < 1e-14, "{all:?} {part:?}");
                if all.value > -bore.reach() {
                    prop_assert!((all.normal - part.normal).norm() < 1e-9, "{all:?} {part:?}");
                }
            }
            prop_assert!(near.near.len() <= bore.near.len());
        }
    }

    #[test]
    fn a_ball_in_it_needs_few_pieces() {
        let (bore, _) = quarter();
        let (at, _) = line(0.6);
        let near = bore.near(at, 0.02);
        assert!(near.near.len() < 6, "{:?}", near.near);
        // A quarter of a circle of half a metre; cubic pieces of a sixteenth of it bend a per mille more.
        let kappa = near.curvature_bound().unwrap();
        assert!((2.0..2.2).contains(&kappa), "{kappa}");
        assert!(bore.curvature_bound().is_none());
    }

    #[test]
    fn a_line_too_sharp_for_its_radius_is_none() {
        let t = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        let points = [[0.0; 3], [0.1, 0.1, 0.0]];
        assert!(Bore::new(&points, &t, &[0.157], 0.2).is_none());
        assert!(Bore::new(&points, &t, &[0.157], 0.05).is_some());
        assert!(Bore::new(&points, &t, &[], 0.05).is_none());
    }
}
