//! A probe before a surface: its foot is the nearest point of the mid-surface, force and complete tangent.
//!
//! The probe p, within a radius around which all is body, faces the point r(u, v) of a surface of a thickness t; side
//! is 1 or -1, where it has come from. With `d = p - r` and the gap's normal n, from the surface to the probe,
//!
//! ```text
//! inside a face:         n = side (r_u x r_v)/|r_u x r_v|,   D = n.d
//! on a rim or a fold:    n = side d/|d|,                     D = side |d|
//! g = D - radius - t/2
//! ```
//!
//! so that a probe that has been pressed through the mid-surface is pushed back to where it belongs. The foot slides:
//! `M_ab du_b = r_a.(dp - dr) + d.dr_a`, `M_ab = r_a.r_b - d.r_ab`; along a side of a face by one parameter, at a corner
//! not at all.
//!
//! Vectors come in the order: four of the slave (a point: one; a rigid body: centre and axes), then r, r_u and r_v of
//! the surface at the foot, which are sums of its nodal vectors. The force acts on the material points of the mid-surface
//! and of the probe (of a rigid body at `p - radius n`): linear momentum is kept exactly, and angular momentum without
//! friction; the couple of friction over half of the thickness is left out.

use crate::net::{Feature, Form, Jet, along};
use crate::probe::{Opposing, Slave, Varied};
use nalgebra::{Matrix2, Matrix2x3, Matrix3, Vector3};

/// A probe before its foot.
#[derive(Clone, Copy, Debug)]
pub struct Foot {
    /// What carries the probe.
    pub slave: Slave,
    /// Where it is, p [m].
    pub p: Vector3<f64>,
    /// How far around it the body reaches [m].
    pub radius: f64,
    /// Half of the surface's thickness [m].
    pub half: f64,
    /// The surface at the foot.
    pub jet: Jet,
    /// Directions in the parameters in which it may slide: two, one or none.
    free: Free,
    /// Side of the surface; at rims and folds 1 but where the probe has been pressed through.
    pub side: f64,
    /// What the probe counts for: area [m^2], length [m] or 1.
    pub weight: f64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Free {
    Plane,
    Line([f64; 2]),
    Fixed,
}

/// Part of the metric that the foot's stiffness must exceed, lest it slides without bound.
const LEAST: f64 = 1e-3;

impl Foot {
    /// A probe of a slave at p before a surface of half thickness `half`.
    #[must_use]
    pub fn new(
        (slave, p, radius): (Slave, Vector3<f64>, f64),
        (jet, half): (Jet, f64),
        (form, feature): (Form, Feature),
        side: f64,
        weight: f64,
    ) -> Self {
        let free = match feature {
            Feature::Inside => Free::Plane,
            Feature::Side(k) => Free::Line(along(form, k)),
            Feature::Corner(_) => Free::Fixed,
        };
        Self { slave, p, radius, half, jet, free, side, weight }
    }

    /// Distance from the mid-surface, below zero beyond it [m].
    #[must_use]
    pub fn distance(&self) -> f64 {
        self.normal().dot(&(self.p - self.jet.r))
    }

    /// Weight of vector l in d.
    fn weight_in_d(&self, l: usize) -> f64 {
        if l == 4 { -1.0 } else { self.slave.weight_in_place(l) }
    }

    /// Derivatives of the foot's parameters by vector l.
    fn slide(&self, l: usize) -> Matrix2x3<f64> {
        let d = self.p - self.jet.r;
        let slopes = &self.jet.slopes;
        // r_a.(dp - dr) + d.dr_a
        let pull = match l {
            5 | 6 => {
                let mut rows = Matrix2x3::zeros();
                rows.set_row(l - 5, &d.transpose());
                rows
            }
            _ => {
                let w = self.weight_in_d(l);
                Matrix2x3::from_rows(&[slopes[0].transpose() * w, slopes[1].transpose() * w])
            }
        };
        let metric = Matrix2::from_fn(|a, b| slopes[a].dot(&slopes[b]));
        let full = metric - Matrix2::from_fn(|a, b| d.dot(&self.jet.bend(a, b)));
        match self.free {
            Free::Plane => {
                let convex =
                    full.trace() > 0.0 && full.determinant() > LEAST * LEAST * metric.determinant();
                let matrix = if convex { full } else { metric };
                matrix.try_inverse().map_or_else(Matrix2x3::zeros, |inverse| inverse * pull)
            }
            Free::Line(e) => {
                let e = nalgebra::Vector2::from(e);
                let (stiff, safe) = (e.dot(&(full * e)), e.dot(&(metric * e)));
                let stiff = if stiff > LEAST * safe { stiff } else { safe };
                if stiff > 0.0 { e * ((e.transpose() * pull) / stiff) } else { Matrix2x3::zeros() }
            }
            Free::Fixed => Matrix2x3::zeros(),
        }
    }
}

impl Opposing for Foot {
    fn gap(&self) -> f64 {
        self.distance() - self.radius - self.half
    }

    fn normal(&self) -> Vector3<f64> {
        let upright = || self.jet.normal() * self.side;
        match self.free {
            Free::Plane => upright(),
            _ => (self.p - self.jet.r).try_normalize(0.0).map_or_else(upright, |n| n * self.side),
        }
    }

    fn place(&self) -> Vector3<f64> {
        self.jet.r + self.normal() * self.half
    }

    fn weight(&self) -> f64 {
        self.weight
    }

    fn weights(&self) -> [f64; 8] {
        let mut w = [0.0; 8];
        self.slave.add_weights(self.normal() * -self.radius, &mut w);
        w[4] = -1.0;
        w
    }

    fn vectors(&self) -> (usize, usize) {
        (self.slave.vectors(), 3)
    }

    fn varied(&self, l: usize) -> Varied {
        let jet = &self.jet;
        let (n, slide) = (self.normal(), self.slide(l));
        let gap = n * self.weight_in_d(l);
        let normal = match self.free {
            Free::Plane => {
                // n.r_a = 0 stays: dn = -sum_a a^a n.(dr_a + r_ab du_b).
                let [r_u, r_v] = jet.slopes;
                let metric = Matrix2::from_fn(|a, b| jet.slopes[a].dot(&jet.slopes[b]));
                let inverse = metric.try_inverse().unwrap_or_else(Matrix2::zeros);
                let mut rows = Matrix2x3::zeros();
                if l == 5 || l == 6 {
                    rows.set_row(l - 5, &n.transpose());
                }
                rows += Matrix2::from_fn(|a, b| n.dot(&jet.bend(a, b))) * slide;
                let up = |a: usize| r_u * inverse[(a, 0)] + r_v * inverse[(a, 1)];
                -(up(0) * rows.row(0) + up(1) * rows.row(1))
            }
            _ => {
                let d = self.distance();
                let plane = Matrix3::identity() - n * n.transpose();
                let moved = Matrix3::from_diagonal_element(self.weight_in_d(l))
                    - jet.slopes[0] * slide.row(0)
                    - jet.slopes[1] * slide.row(1);
                if d == 0.0 { Matrix3::zeros() } else { plane * moved / d }
            }
        };
        let own = self.slave.weights_by(l, &normal, n, self.radius);
        let mut other = Matrix3::zeros();
        other.set_row(0, &-slide.row(0));
        other.set_row(1, &-slide.row(1));
        Varied { gap, normal, own, other }
    }
}
