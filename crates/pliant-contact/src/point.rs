//! One point in contact: its force and complete tangent.
//!
//! A point of the slave line, `r_s = sum_k N_k x_k`, faces its foot on the master: the nearest point of a line, or of a
//! shape at rest. `d = r_m - r_s`, `n = d/|d|` from slave to master. With the weights `alpha = (N_m, -N_s)` of all eight
//! vectors, `F = P n + T` acts as `alpha_k F` on vector k: the sum over a body is F, that over both zero.
//!
//! The foot slides along a master line: `dxi/dx_l = -b_l^T/c`, `b_l = alpha_l r_m' + alpha'_l d`,
//! `c = r_m'.r_m' + d.r_m''`; it does not where an end is clamped.
//!
//! The points of a zone move with its ends. In the integral that adds nothing, for the force vanishes there; in a sum
//! over some points it makes up for the ramp of the normal force, which they step over.

use crate::friction::{Friction, Response, Slip};
use crate::normal::{Normal, Pressure};
use crate::zones::Sample;
use nalgebra::{Matrix3, Vector3};

/// How the foot slides along a master line.
#[derive(Clone, Copy, Debug)]
pub struct Slide {
    /// `r_m'`, by xi of the master.
    pub slope: Vector3<f64>,
    /// `N_m'`.
    pub weights: [f64; 4],
    /// `c`.
    pub c: f64,
    /// `d`.
    pub d: Vector3<f64>,
}

/// A point in contact.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    /// `alpha`: four vectors of the master, four of the slave.
    pub alpha: [f64; 8],
    /// Distance of the surfaces, below zero in contact [m].
    pub gap: f64,
    /// From slave to master.
    pub n: Vector3<f64>,
    /// `dn/dd`.
    pub hessian: Matrix3<f64>,
    /// How the foot slides.
    pub slide: Option<Slide>,
    /// `r_s'`, by xi of the slave.
    pub along: Vector3<f64>,
    /// `N_s'`.
    pub along_weights: [f64; 4],
    /// Length of the slave that it stands for [m].
    pub weight: f64,
}

/// The motion of the eight vectors.
#[derive(Clone, Copy, Debug)]
pub struct Motion<'a> {
    /// Their velocities.
    pub v: &'a [Vector3<f64>; 8],
    /// Their displacements within the step.
    pub moved: &'a [Vector3<f64>; 8],
    /// Length of the step [s]; 0 outside of steps, where the velocities say how the bristles move.
    pub h: f64,
    /// Deflection of the bristles at its beginning, carried to the present normal.
    pub z: Vector3<f64>,
}

/// The laws of a contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Laws {
    /// Normal force.
    pub normal: Normal,
    /// Friction.
    pub friction: Option<Friction>,
}

/// Force per length at a point.
#[derive(Clone, Copy, Debug)]
pub struct Force {
    /// Normal force and its derivatives.
    pub pressure: Pressure,
    /// Friction.
    pub friction: Response,
    /// `F` on the master [N/m].
    pub total: Vector3<f64>,
}

fn sum(weights: &[f64; 8], x: &[Vector3<f64>; 8]) -> Vector3<f64> {
    (0..8).map(|k| x[k] * weights[k]).sum()
}

impl Place {
    fn tangential(&self, x: Vector3<f64>) -> Vector3<f64> {
        x - self.n * self.n.dot(&x)
    }

    /// The force per length.
    #[must_use]
    pub fn force(&self, laws: &Laws, motion: &Motion<'_>) -> Force {
        let v = sum(&self.alpha, motion.v);
        let pressure = laws.normal.pressure(-self.gap, -self.n.dot(&v));
        let friction = match laws.friction {
            Some(law) => {
                let moved = sum(&self.alpha, motion.moved);
                let h = motion.h;
                let end = -self.tangential(v);
                let mean = if h > 0.0 { -self.tangential(moved) / h } else { end };
                law.respond(&Slip { z: motion.z, mean, end, normal: pressure.p, h })
            }
            None => Response::none(),
        };
        Force { pressure, friction, total: self.n * pressure.p + friction.force }
    }

    /// Adds `-weight alpha_k F` for each of the eight vectors: what the contact adds to the inner forces.
    pub fn add_force(&self, total: Vector3<f64>, out: &mut [Vector3<f64>; 8]) {
        for k in 0..8 {
            out[k] -= total * (self.weight * self.alpha[k]);
        }
    }

    /// How much the gap grows by xi of the slave: the foot's own way does not count.
    #[must_use]
    pub fn gap_slope(&self) -> f64 {
        -self.n.dot(&self.along)
    }

    /// The gap there, at this xi of the slave.
    #[must_use]
    pub fn sample(&self, xi: f64) -> Sample {
        Sample { xi, gap: self.gap, slope: self.gap_slope() }
    }

    /// Force and tangent: `stiffness` times its derivative by the vectors plus `damping` times that by their
    /// velocities. Where `symmetric`, without what is not in a contact free of friction: how the rate of penetration
    /// depends on the place.
    #[must_use]
    pub fn linearise(
        &self,
        laws: &Laws,
        motion: &Motion<'_>,
        (stiffness, damping): (f64, f64),
        symmetric: bool,
    ) -> Tangent {
        self.derivatives(laws, motion, (stiffness, damping), (true, symmetric)).0
    }

    /// The same of the friction alone, and how both the whole force and the friction change with a displacement of the
    /// surfaces that leaves the lines where they are.
    #[must_use]
    pub fn linearise_friction(
        &self,
        laws: &Laws,
        motion: &Motion<'_>,
        factors: (f64, f64),
    ) -> (Tangent, [Matrix3<f64>; 2]) {
        let (_, whole) = self.derivatives(laws, motion, factors, (true, false));
        let (tangent, friction) = self.derivatives(laws, motion, factors, (false, false));
        (tangent, [whole, friction])
    }

    /// Tangent of the force, `pressed` with its normal part, and its derivative by the relative displacement alone.
    fn derivatives(
        &self,
        laws: &Laws,
        motion: &Motion<'_>,
        (stiffness, damping): (f64, f64),
        (pressed, symmetric): (bool, bool),
    ) -> (Tangent, Matrix3<f64>) {
        let force = self.force(laws, motion);
        let (pressure, friction) = (force.pressure, force.friction);
        let n = self.n;
        let v = sum(&self.alpha, motion.v);
        let moved = sum(&self.alpha, motion.moved);
        let inverse_h = if motion.h > 0.0 { 1.0 / motion.h } else { 0.0 };
        // F by d, by the relative velocity, and by the relative displacement.
        let mut p_d = n * -pressure.by_depth;
        if !symmetric {
            p_d -= self.hessian * v * pressure.by_rate;
        }
        let part = if pressed { 1.0 } else { 0.0 };
        let pushed = n * part + friction.by_normal;
        let mut by_d = pushed * p_d.transpose() + self.hessian * (part * pressure.p);
        let mut by_v = pushed * n.transpose() * -pressure.by_rate;
        let mut by_moved = Matrix3::zeros();
        if laws.friction.is_some() {
            let plane = Matrix3::identity() - n * n.transpose();
            let turning =
                |x: Vector3<f64>| Matrix3::from_diagonal_element(n.dot(&x)) + n * x.transpose();
            // Outside of steps the bristles see the velocity at hand.
            let by_end =
                if motion.h > 0.0 { friction.by_end } else { friction.by_end + friction.by_mean };
            let by_n = by_end * turning(v) + friction.by_mean * turning(moved) * inverse_h;
            by_d += by_n * self.hessian;
            by_v -= by_end * plane;
            by_moved = friction.by_mean * plane * -inverse_h;
        }
        let total = if pressed { force.total } else { friction.force };
        let mut tangent = Tangent {
            force: total,
            by_x: (by_d + by_moved) * stiffness + by_v * damping,
            by_slope: Matrix3::zeros(),
            turned: Matrix3::zeros(),
            turned_slope: Matrix3::zeros(),
            along: Vector3::zeros(),
            eta_along: 0.0,
        };
        let slave = |x: &[Vector3<f64>; 8]| -> Vector3<f64> {
            (0..4).map(|k| x[4 + k] * self.along_weights[k]).sum()
        };
        let (mut d_along, mut v_along) = (-self.along, -slave(motion.v));
        let mut moved_along = -slave(motion.moved);
        if let Some(slide) = &self.slide {
            let master = |x: &[Vector3<f64>; 8]| -> Vector3<f64> {
                (0..4).map(|k| x[k] * slide.weights[k]).sum()
            };
            let (v_slope, moved_slope) = (master(motion.v), master(motion.moved));
            let mut slid = by_d * slide.slope;
            if !symmetric {
                slid += by_v * v_slope + by_moved * moved_slope;
            }
            let (across, way) = (slide.slope / slide.c, slide.d / slide.c);
            tangent.by_x -= slid * across.transpose() * stiffness;
            tangent.by_slope = slid * way.transpose() * -stiffness;
            tangent.turned = total * across.transpose() * -stiffness;
            tangent.turned_slope = total * way.transpose() * -stiffness;
            let eta = across.dot(&self.along);
            tangent.eta_along = eta;
            d_along += slide.slope * eta;
            v_along += v_slope * eta;
            moved_along += moved_slope * eta;
        }
        tangent.along = by_d * d_along + by_v * v_along + by_moved * moved_along;
        (tangent, by_moved * stiffness + by_v * damping)
    }

    /// Derivative of `-weight F` by vector `l`, where F has this tangent.
    #[must_use]
    pub fn column(&self, tangent: &Tangent, l: usize) -> Matrix3<f64> {
        let slope = self.slide.and_then(|slide| slide.weights.get(l).copied()).unwrap_or(0.0);
        (tangent.by_x * self.alpha[l] + tangent.by_slope * slope) * -self.weight
    }

    /// Adds the derivative of [`Self::add_force`], as blocks (k, l).
    pub fn add_tangent(&self, tangent: &Tangent, out: &mut Blocks) {
        let Tangent { by_x, by_slope, turned, turned_slope, .. } = tangent;
        let first = self.first();
        let slopes = self.slide.map_or([0.0; 4], |slide| slide.weights);
        for l in first..8 {
            let (w, w_slope) =
                (-self.weight * self.alpha[l], -self.weight * slopes.get(l).unwrap_or(&0.0));
            let column = by_x * w + by_slope * w_slope;
            for k in first..8 {
                out[k][l] += column * self.alpha[k];
            }
            if self.slide.is_some() {
                let column = turned * w + turned_slope * w_slope;
                for k in 0..4 {
                    out[k][l] += column * slopes[k];
                }
            }
        }
    }

    /// Adds how the force changes because the point moves with the ends of its zone, `part` of the zone from the first
    /// to the second end, which are `width` apart among the xi of the slave.
    pub fn add_verge(
        &self,
        tangent: &Tangent,
        (part, width): (f64, f64),
        out: [&mut [Vector3<f64>; 8]; 2],
    ) {
        let mut slopes = [0.0; 8];
        if let Some(slide) = &self.slide {
            for k in 0..4 {
                slopes[k] = slide.weights[k] * tangent.eta_along;
            }
        }
        for k in 0..4 {
            slopes[4 + k] = -self.along_weights[k];
        }
        let [first, last] = out;
        for k in self.first()..8 {
            let q = tangent.force * (-self.weight * self.alpha[k]);
            let along = (tangent.force * slopes[k] + tangent.along * self.alpha[k]) * -self.weight;
            first[k] += along * (1.0 - part) - q / width;
            last[k] += along * part + q / width;
        }
    }

    /// Shapes at rest have no vectors.
    fn first(&self) -> usize {
        if self.slide.is_none() && self.alpha[..4] == [0.0; 4] { 4 } else { 0 }
    }
}

/// Derivatives of the forces on eight vectors by these vectors.
pub type Blocks = [[Matrix3<f64>; 8]; 8];

/// How the force at a point changes with the vectors x_l: `dF/dx_l = alpha_l by_x + alpha'_l by_slope`, and the share of
/// vector k turns with the foot by `alpha'_k F dxi/dx_l`.
#[derive(Clone, Copy, Debug)]
pub struct Tangent {
    force: Vector3<f64>,
    by_x: Matrix3<f64>,
    by_slope: Matrix3<f64>,
    turned: Matrix3<f64>,
    turned_slope: Matrix3<f64>,
    /// `dF/dxi` along the slave, and how far the foot slides with it.
    along: Vector3<f64>,
    eta_along: f64,
}

/// An end of a zone that moves with the vectors: where the gap vanishes, `dxi/dx_l = alpha_l n^T / -(dg/dxi)`, or where
/// the slave crosses the plane through an end of the master, `(r_s - r_m).t_m = 0`.
#[derive(Clone, Copy, Debug)]
pub struct Verge {
    /// `dxi/dx_l`.
    ways: [Vector3<f64>; 8],
}

impl Verge {
    /// The end of a zone at a place where the gap vanishes; none where it does so without a slope.
    #[must_use]
    pub fn at(place: &Place) -> Option<Self> {
        let slope = place.gap_slope();
        (slope.abs() > 1e-9 * place.along.norm())
            .then(|| Self { ways: place.alpha.map(|alpha| place.n * (alpha / -slope)) })
    }

    /// The end of a part of a zone where the gap is largest, `-n.r_s' = 0`; `bend` is `r_s''` there.
    #[must_use]
    pub fn on_top(place: &Place, bend: Vector3<f64>) -> Option<Self> {
        // n turns by the Hessian times the change of d, in which the foot takes part.
        let u = place.hessian * place.along;
        let mut growth = place.along.dot(&u) - place.n.dot(&bend);
        let mut by_foot = 0.0;
        if let Some(slide) = &place.slide {
            by_foot = slide.slope.dot(&u) / slide.c;
            growth -= by_foot * slide.slope.dot(&place.along);
        }
        if growth >= -1e-9 * place.along.norm() {
            return None;
        }
        let mut ways = [Vector3::zeros(); 8];
        for k in 0..8 {
            let mut slope = -u * place.alpha[k];
            if let Some(slide) = &place.slide {
                slope += slide.slope * (place.alpha[k] * by_foot);
                if k < 4 {
                    slope += slide.d * (slide.weights[k] * by_foot);
                }
            }
            if k >= 4 {
                slope -= place.n * place.along_weights[k - 4];
            }
            ways[k] = slope / -growth;
        }
        Some(Self { ways })
    }

    /// The place of a zone's end on the plane through position and slope of the master's end `end`, 0 or 1, `d` away
    /// from that position; none where the slave runs along the plane.
    #[must_use]
    pub fn on_plane(
        place: &Place,
        end: usize,
        d: Vector3<f64>,
        slope: Vector3<f64>,
    ) -> Option<Self> {
        let rate = place.along.dot(&slope);
        if rate.abs() <= 1e-9 * place.along.norm() * slope.norm() {
            return None;
        }
        // The slave's weights count as negative.
        let mut ways = [Vector3::zeros(); 8];
        for k in 4..8 {
            ways[k] = slope * (place.alpha[k] / rate);
        }
        ways[2 * end] = slope / rate;
        ways[2 * end + 1] = -d / rate;
        Some(Self { ways })
    }

    /// Adds the derivative of forces that change with the end by `by_end`.
    pub fn add_tangent(
        &self,
        by_end: &[Vector3<f64>; 8],
        factor: f64,
        symmetric: bool,
        out: &mut Blocks,
    ) {
        for k in 0..8 {
            for l in 0..8 {
                let block = by_end[k] * (self.ways[l] * factor).transpose();
                if symmetric {
                    out[k][l] += block * 0.5;
                    out[l][k] += block.transpose() * 0.5;
                } else {
                    out[k][l] += block;
                }
            }
        }
    }
}
