//! A probe: one point of a body that faces the distance function of a shape, its force and complete tangent.
//!
//! The slave's point is p; within a radius around it all is body: half of a shell's thickness, the radius of a ball.
//! The master is a shape with the signed distance D in its own frame `(r, E)`, at rest or moving:
//!
//! ```text
//! y = E^T (p - r),   g = D(y) - radius,   n = E grad D(y),   c = p - radius n
//! ```
//!
//! Both sides feel the force at the same place c, with the weights of the material points that are there now, so that
//! linear and angular momentum between rigid bodies are exchanged exactly:
//!
//! ```text
//! F = P n - T on the slave, -F on the master;   P = P(-g, -n.v),   T = T(slip of the slave)
//! ```
//!
//! A thin body (shell, membrane, line) feels it on its mid-surface instead: the couple `radius n x T` is left out there.
//!
//! Vectors come in the order: four of the slave (a point: one; a rigid body: centre and axes; at rest: none), four of
//! the master (rigid body: centre and axes; at rest: none).

use crate::friction::{Response, Slip};
use crate::normal::Pressure;
use crate::point::{Laws, Motion};
use crate::shapes::Distance;
use nalgebra::{Matrix3, Vector3};

/// Position and axes, one a column, of a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Origin [m].
    pub origin: Vector3<f64>,
    /// Axes.
    pub axes: Matrix3<f64>,
}

impl Pose {
    /// A place of the frame in the world.
    #[must_use]
    pub fn at(&self, local: Vector3<f64>) -> Vector3<f64> {
        self.origin + self.axes * local
    }

    /// A place of the world in the frame.
    #[must_use]
    pub fn local(&self, place: Vector3<f64>) -> Vector3<f64> {
        self.axes.transpose() * (place - self.origin)
    }
}

/// What carries the probe.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Slave {
    /// Nothing that moves.
    Rest,
    /// A point of a flexible body, or a mass.
    Point,
    /// A rigid body, and the probe's place in it.
    Body(Pose, Vector3<f64>),
}

impl Slave {
    /// Number of its vectors.
    #[must_use]
    pub fn vectors(&self) -> usize {
        match self {
            Self::Rest => 0,
            Self::Point => 1,
            Self::Body(..) => 4,
        }
    }

    /// Enters the weights of its vectors in the motion at the contact, which lies `aside` from p.
    pub(crate) fn add_weights(&self, aside: Vector3<f64>, w: &mut [f64; 8]) {
        match self {
            Self::Rest => {}
            Self::Point => w[0] = 1.0,
            Self::Body(pose, local) => {
                // In the slave's frame; p is at `local` whatever the axes have drifted to.
                let y = local + pose.axes.transpose() * aside;
                w[0] = 1.0;
                w[1..4].copy_from_slice(y.as_slice());
            }
        }
    }

    /// Derivatives of the weights of its axes by vector l, where those of the normal n are `d_n`.
    pub(crate) fn weights_by(
        &self,
        l: usize,
        d_n: &Matrix3<f64>,
        n: Vector3<f64>,
        radius: f64,
    ) -> Matrix3<f64> {
        let Self::Body(pose, _) = self else { return Matrix3::zeros() };
        let mut rows = pose.axes.transpose() * d_n * -radius;
        if (1..4).contains(&l) {
            let row = rows.row(l - 1) - n.transpose() * radius;
            rows.set_row(l - 1, &row);
        }
        rows
    }

    /// Weight of vector l in p.
    pub(crate) fn weight_in_place(&self, l: usize) -> f64 {
        match (self, l) {
            (Self::Point | Self::Body(..), 0) => 1.0,
            (Self::Body(_, local), 1..=3) => local[l - 1],
            _ => 0.0,
        }
    }
}

/// A probe before a shape.
#[derive(Clone, Copy, Debug)]
pub struct Probe {
    /// What carries it.
    pub slave: Slave,
    /// Where it is, p [m].
    pub p: Vector3<f64>,
    /// How far around it the body reaches [m].
    pub radius: f64,
    /// Frame of the master.
    pub master: Pose,
    /// Whether the master moves.
    pub moves: bool,
    /// D with gradient and Hessian in the master's frame.
    pub distance: Distance,
    /// What it counts for: area [m^2], or 1.
    pub weight: f64,
}

/// Force at a probe, per area where it stands for one.
#[derive(Clone, Copy, Debug)]
pub struct Force {
    /// Normal force and its derivatives.
    pub pressure: Pressure,
    /// Friction.
    pub friction: Response,
    /// F on the slave.
    pub total: Vector3<f64>,
}

/// Blocks of a tangent over the eight vectors.
pub type Blocks = [[Matrix3<f64>; 8]; 8];

/// A point of a body that faces another: what forces and tangents follow from, and these.
///
/// Vectors come in the order: four of the slave, four of the master.
pub trait Opposing {
    /// The gap, below zero in contact [m].
    fn gap(&self) -> f64;
    /// From the master to the slave.
    fn normal(&self) -> Vector3<f64>;
    /// Where the two touch.
    fn place(&self) -> Vector3<f64>;
    /// What the point counts for: area [m^2], length [m] or 1.
    fn weight(&self) -> f64;
    /// Weights of the eight vectors in the relative motion of the slave at the contact.
    fn weights(&self) -> [f64; 8];
    /// How many vectors of the slave take part, and how many of the master.
    fn vectors(&self) -> (usize, usize);
    /// How gap, normal and weights change with vector l.
    fn varied(&self, l: usize) -> Varied;

    /// Force on the slave: the normal one along n, less friction.
    fn force(&self, laws: &Laws, motion: &Motion<'_>) -> Force {
        Opposed::of(self).force(laws, motion)
    }

    /// Adds what a force on the slave adds to the inner forces of the eight vectors.
    fn add_force(&self, total: Vector3<f64>, out: &mut [Vector3<f64>; 8]) {
        Opposed::of(self).add_force(total, out);
    }

    /// Adds the derivatives of [`Self::add_force`], the first factor times that by the vectors plus the second times
    /// that by their velocities. How the bristles turn with the normal is left out; where `symmetric`, also how the
    /// rate of penetration depends on the place.
    fn add_tangent(
        &self,
        laws: &Laws,
        motion: &Motion<'_>,
        factors: (f64, f64),
        symmetric: bool,
        out: &mut Blocks,
    ) {
        let varied = |l: usize| self.varied(l);
        Opposed::of(self).add_tangent(laws, motion, factors, symmetric, (varied, out));
    }
}

fn sum(weights: &[f64; 8], x: &[Vector3<f64>; 8]) -> Vector3<f64> {
    (0..8).map(|k| x[k] * weights[k]).sum()
}

/// How what a contact is made of changes with one of the vectors.
#[derive(Clone, Copy, Debug)]
pub struct Varied {
    /// Gradient of the gap.
    pub gap: Vector3<f64>,
    /// Derivative of the normal.
    pub normal: Matrix3<f64>,
    /// Of the weights of vectors 1 to 3, by rows.
    pub own: Matrix3<f64>,
    /// Of the weights of vectors 5 to 7.
    pub other: Matrix3<f64>,
}

/// Both sides of a point as they are now.
struct Opposed {
    gap: f64,
    n: Vector3<f64>,
    w: [f64; 8],
    weight: f64,
    /// Vectors of the slave that take part, from 0, and of the master, from 4.
    slave: usize,
    master: usize,
}

impl Opposed {
    fn of(point: &(impl Opposing + ?Sized)) -> Self {
        let (slave, master) = point.vectors();
        Self {
            gap: point.gap(),
            n: point.normal(),
            w: point.weights(),
            weight: point.weight(),
            slave,
            master,
        }
    }

    fn active(&self) -> impl Iterator<Item = usize> + Clone {
        (0..self.slave).chain(4..4 + self.master)
    }

    fn tangential(&self, x: Vector3<f64>) -> Vector3<f64> {
        x - self.n * self.n.dot(&x)
    }

    fn force(&self, laws: &Laws, motion: &Motion<'_>) -> Force {
        let n = self.n;
        let v = sum(&self.w, motion.v);
        let pressure = laws.normal.pressure(-self.gap, -n.dot(&v));
        let friction = match laws.friction {
            Some(law) => {
                let h = motion.h;
                let moved = self.tangential(sum(&self.w, motion.moved));
                let end = self.tangential(v);
                let mean = if h > 0.0 { moved / h } else { end };
                law.respond(&Slip { z: motion.z, mean, end, normal: pressure.p, h })
            }
            None => Response::none(),
        };
        Force { pressure, friction, total: n * pressure.p - friction.force }
    }

    fn add_force(&self, total: Vector3<f64>, out: &mut [Vector3<f64>; 8]) {
        for k in self.active() {
            out[k] -= total * (self.weight * self.w[k]);
        }
    }

    fn add_tangent(
        &self,
        laws: &Laws,
        motion: &Motion<'_>,
        (stiffness, damping): (f64, f64),
        symmetric: bool,
        (varied, out): (impl Fn(usize) -> Varied, &mut Blocks),
    ) {
        let force = self.force(laws, motion);
        let (pressure, friction) = (force.pressure, force.friction);
        let (n, w) = (self.n, self.w);
        let plane = Matrix3::identity() - n * n.transpose();
        let v = sum(&w, motion.v);
        let moved = sum(&w, motion.moved);
        for l in self.active() {
            let Varied { gap: d_g, normal: d_n, own: d_own, other: d_other } = varied(l);
            let shifted = |x: &[Vector3<f64>; 8]| -> Matrix3<f64> {
                let mut total = Matrix3::zeros();
                for i in 0..3 {
                    total += x[1 + i] * d_own.row(i) + x[5 + i] * d_other.row(i);
                }
                total
            };
            let v_shift = shifted(motion.v);
            let rate = if symmetric {
                Vector3::zeros()
            } else {
                -(d_n.transpose() * v) - v_shift.transpose() * n
            };
            let d_p = (d_g * -pressure.by_depth + rate * pressure.by_rate) * stiffness
                - n * (pressure.by_rate * w[l] * damping);
            let mut d_f = n * d_p.transpose() + d_n * (pressure.p * stiffness);
            if laws.friction.is_some() {
                let turning =
                    |x: Vector3<f64>| d_n * n.dot(&x) + n * (d_n.transpose() * x).transpose();
                let d_end = (plane * v_shift - turning(v)) * stiffness + plane * (w[l] * damping);
                d_f -= friction.by_end * d_end + friction.by_normal * d_p.transpose();
                if motion.h == 0.0 {
                    d_f -= friction.by_mean * d_end;
                } else {
                    let d_moved = plane * w[l] + plane * shifted(motion.moved) - turning(moved);
                    d_f -= friction.by_mean * d_moved * (stiffness / motion.h);
                }
            }
            let f = force.total * stiffness;
            for k in self.active() {
                let mut block = d_f * w[k];
                match k {
                    1..=3 => block += f * d_own.row(k - 1),
                    5..=7 => block += f * d_other.row(k - 5),
                    _ => {}
                }
                out[k][l] -= block * self.weight;
            }
        }
    }
}

impl Probe {
    /// c in the master's frame.
    fn foot(&self) -> Vector3<f64> {
        self.master.local(self.p) - self.distance.normal * self.radius
    }

    /// Derivative of y by vector l.
    fn place_by(&self, l: usize) -> Matrix3<f64> {
        let frame = self.master.axes.transpose();
        match l {
            0..=3 => frame * self.slave.weight_in_place(l),
            4 => -frame,
            _ => {
                let mut rows = Matrix3::zeros();
                rows.set_row(l - 5, &(self.p - self.master.origin).transpose());
                rows
            }
        }
    }
}

impl Opposing for Probe {
    fn gap(&self) -> f64 {
        self.distance.value - self.radius
    }

    fn normal(&self) -> Vector3<f64> {
        self.master.axes * self.distance.normal
    }

    fn place(&self) -> Vector3<f64> {
        self.p - self.normal() * self.radius
    }

    fn weight(&self) -> f64 {
        self.weight
    }

    fn weights(&self) -> [f64; 8] {
        let mut w = [0.0; 8];
        self.slave.add_weights(self.normal() * -self.radius, &mut w);
        if self.moves {
            let y = self.foot();
            w[4] = -1.0;
            for i in 0..3 {
                w[5 + i] = -y[i];
            }
        }
        w
    }

    fn vectors(&self) -> (usize, usize) {
        (self.slave.vectors(), if self.moves { 4 } else { 0 })
    }

    fn varied(&self, l: usize) -> Varied {
        let d_y = self.place_by(l);
        let mut normal = self.master.axes * self.distance.hessian * d_y;
        if l >= 5 {
            normal += Matrix3::from_diagonal_element(self.distance.normal[l - 5]);
        }
        let gap = d_y.transpose() * self.distance.normal;
        let own = self.slave.weights_by(l, &normal, self.normal(), self.radius);
        let other = if self.moves {
            -(d_y - self.distance.hessian * d_y * self.radius)
        } else {
            Matrix3::zeros()
        };
        Varied { gap, normal, own, other }
    }
}
