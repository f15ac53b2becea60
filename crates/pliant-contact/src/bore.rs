//! Bores: channels along a line, touched from inside. All around them is solid.

use crate::curve::Piece;
use crate::shapes::Distance;
use nalgebra::{Matrix3, Vector3};
use std::sync::Arc;

/// A bore in its own frame. Beyond the ends of its line it goes on straight.
#[derive(Clone)]
pub struct Bore {
    pieces: Arc<Vec<Piece>>,
    radius: f64,
    reach: f64,
}

impl PartialEq for Bore {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.pieces, &other.pieces) && self.radius.to_bits() == other.radius.to_bits()
    }
}

impl std::fmt::Debug for Bore {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Bore of radius {} along {} pieces", self.radius, self.pieces.len())
    }
}

/// Samples of a piece where its curvature is looked at.
const SAMPLES: usize = 8;

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
        let curvature = |piece: &Piece, xi: f64| {
            let (t, c) = (piece.slope(xi), piece.bend(xi));
            t.cross(&c).norm() / t.norm().powi(3)
        };
        let sharpest = pieces
            .iter()
            .flat_map(|piece| (0..=SAMPLES).map(|k| curvature(piece, k as f64 / SAMPLES as f64)))
            .fold(0.0, f64::max);
        // Beyond the wall the distance has its kinks where the line's centres of curvature lie, within it on the line.
        let reach = (1.0 / sharpest - radius).min(radius);
        (reach > 0.0).then(|| Self { pieces: Arc::new(pieces), radius, reach })
    }

    /// How far outside of the wall the distance has its kinks [m].
    #[must_use]
    pub fn reach(&self) -> f64 {
        self.reach
    }

    /// The piece nearest to a point and its foot there, and how far before or behind the line's ends the point lies,
    /// as a vector along the line.
    fn foot(&self, q: Vector3<f64>) -> (&Piece, f64, Vector3<f64>) {
        // A piece is no nearer than its middle less half of its length.
        let bound = |piece: &Piece| (q - piece.at(0.5)).norm() - 0.5 * piece.speed_bound();
        let first = self.pieces.iter().map(bound).enumerate();
        let (guess, _) = first.fold((0, f64::INFINITY), |a, b| if b.1 < a.1 { b } else { a });
        let distance = |piece: &Piece, xi: f64| (q - piece.at(xi)).norm();
        let mut best = (guess, self.pieces[guess].nearest(q));
        let mut least = distance(&self.pieces[guess], best.1);
        for (k, piece) in self.pieces.iter().enumerate() {
            if k != guess && bound(piece) < least {
                let xi = piece.nearest(q);
                let here = distance(piece, xi);
                if here < least {
                    (best, least) = ((k, xi), here);
                }
            }
        }
        let mut found = (&self.pieces[best.0], best.1, Vector3::zeros());
        // The straight lines that go on beyond both ends.
        let last = self.pieces.len() - 1;
        for (k, xi, sign) in [(0, 0.0, -1.0), (last, 1.0, 1.0)] {
            let piece = &self.pieces[k];
            let outwards = piece.slope(xi).normalize() * sign;
            let d = q - piece.at(xi);
            let along = d.dot(&outwards);
            if along > 0.0 {
                let here = (d - outwards * along).norm();
                if here < least || (best.0 == k && best.1 == xi) {
                    found = (piece, xi, outwards * along);
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
    use proptest::prelude::*;
    use std::f64::consts::FRAC_PI_2;

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
            // 16 cubic pieces on a quarter of a circle are 1e-7 off.
            prop_assert!((found.value - 0.1 * (1.0 - part)).abs() < 1e-6, "{s} {found:?}");
            if part > 1e-2 {
                prop_assert!((found.normal + across).norm() < 1e-4, "{s} {found:?}");
            }
        }
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
