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

use crate::friction::Response;
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

fn sum(weights: &[f64; 8], x: &[Vector3<f64>; 8]) -> Vector3<f64> {
    (0..8).map(|k| x[k] * weights[k]).sum()
}

impl Probe {
    /// The gap, below zero in contact [m].
    #[must_use]
    pub fn gap(&self) -> f64 {
        self.distance.value - self.radius
    }

    /// From the master to the slave.
    #[must_use]
    pub fn normal(&self) -> Vector3<f64> {
        self.master.axes * self.distance.normal
    }

    /// Where the two touch.
    #[must_use]
    pub fn place(&self) -> Vector3<f64> {
        self.p - self.normal() * self.radius
    }

    /// Weights of the eight vectors in the relative motion of the slave at the contact.
    #[must_use]
    pub fn weights(&self) -> [f64; 8] {
        let mut w = [0.0; 8];
        let c = self.place();
        match &self.slave {
            Slave::Rest => {}
            Slave::Point => w[0] = 1.0,
            Slave::Body(pose, local) => {
                // c - p in the slave's frame; p is at `local` whatever the axes have drifted to.
                let y = local + pose.axes.transpose() * (c - self.p);
                w[0] = 1.0;
                w[1..4].copy_from_slice(y.as_slice());
            }
        }
        if self.moves {
            let y = self.foot();
            w[4] = -1.0;
            for i in 0..3 {
                w[5 + i] = -y[i];
            }
        }
        w
    }

    /// c in the master's frame.
    fn foot(&self) -> Vector3<f64> {
        self.master.local(self.p) - self.distance.normal * self.radius
    }

    fn is_body(&self) -> bool {
        matches!(self.slave, Slave::Body(..))
    }

    /// The vectors that take part.
    fn active(&self) -> impl Iterator<Item = usize> + Clone {
        let slave = match self.slave {
            Slave::Rest => 0,
            Slave::Point => 1,
            Slave::Body(..) => 4,
        };
        (0..slave).chain(4..if self.moves { 8 } else { 4 })
    }

    fn tangential(&self, n: Vector3<f64>, x: Vector3<f64>) -> Vector3<f64> {
        x - n * n.dot(&x)
    }

    /// The force.
    #[must_use]
    pub fn force(&self, laws: &Laws, motion: &Motion<'_>) -> Force {
        let (n, w) = (self.normal(), self.weights());
        let v = sum(&w, motion.v);
        let pressure = laws.normal.pressure(-self.gap(), -n.dot(&v));
        let friction = match laws.friction {
            Some(law) => {
                let h = motion.h;
                let moved = self.tangential(n, sum(&w, motion.moved));
                let mean = if h > 0.0 { moved / h } else { Vector3::zeros() };
                let end = self.tangential(n, v);
                law.respond(&crate::friction::Slip {
                    z: motion.z,
                    mean,
                    end,
                    normal: pressure.p,
                    h,
                })
            }
            None => Response::none(),
        };
        Force { pressure, friction, total: n * pressure.p - friction.force }
    }

    /// Adds what a force on the slave adds to the inner forces of the eight vectors.
    pub fn add_force(&self, total: Vector3<f64>, out: &mut [Vector3<f64>; 8]) {
        let w = self.weights();
        for k in self.active() {
            out[k] -= total * (self.weight * w[k]);
        }
    }

    /// Derivative of y by vector l.
    fn place_by(&self, l: usize) -> Matrix3<f64> {
        let frame = self.master.axes.transpose();
        match l {
            0 => frame,
            1..=3 => match self.slave {
                Slave::Body(_, local) => frame * local[l - 1],
                _ => Matrix3::zeros(),
            },
            4 => -frame,
            _ => {
                let mut rows = Matrix3::zeros();
                rows.set_row(l - 5, &(self.p - self.master.origin).transpose());
                rows
            }
        }
    }

    /// Adds the derivatives of [`Self::add_force`], `stiffness` times that by the vectors plus `damping` times that by
    /// their velocities. How the bristles turn with the normal is left out; where `symmetric`, also how the rate of
    /// penetration depends on the place.
    pub fn add_tangent(
        &self,
        laws: &Laws,
        motion: &Motion<'_>,
        (stiffness, damping): (f64, f64),
        symmetric: bool,
        out: &mut Blocks,
    ) {
        let force = self.force(laws, motion);
        let (pressure, friction) = (force.pressure, force.friction);
        let (n, w) = (self.normal(), self.weights());
        let plane = Matrix3::identity() - n * n.transpose();
        let v = sum(&w, motion.v);
        let moved = sum(&w, motion.moved);
        let axes = &self.master.axes;
        let own = match &self.slave {
            Slave::Body(pose, _) => pose.axes,
            _ => Matrix3::identity(),
        };
        for l in self.active() {
            let d_y = self.place_by(l);
            let mut d_n = axes * self.distance.hessian * d_y;
            if l >= 5 {
                d_n += Matrix3::from_diagonal_element(self.distance.normal[l - 5]);
            }
            let d_g = d_y.transpose() * self.distance.normal;
            // Rows of the derivatives of the weights: of the slave's axes and of the master's.
            let mut d_own = if self.is_body() {
                own.transpose() * d_n * -self.radius
            } else {
                Matrix3::zeros()
            };
            if self.is_body() && (1..4).contains(&l) {
                let row = d_own.row(l - 1) - n.transpose() * self.radius;
                d_own.set_row(l - 1, &row);
            }
            let d_foot = if self.moves {
                -(d_y - self.distance.hessian * d_y * self.radius)
            } else {
                Matrix3::zeros()
            };
            let shifted = |x: &[Vector3<f64>; 8]| -> Matrix3<f64> {
                let mut total = Matrix3::zeros();
                for i in 0..3 {
                    total += x[1 + i] * d_own.row(i) + x[5 + i] * d_foot.row(i);
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
                if motion.h > 0.0 {
                    let d_moved = plane * w[l] + plane * shifted(motion.moved) - turning(moved);
                    d_f -= friction.by_mean * d_moved * (stiffness / motion.h);
                }
            }
            let f = force.total * stiffness;
            for k in self.active() {
                let mut block = d_f * w[k];
                match k {
                    1..=3 => block += f * d_own.row(k - 1),
                    5..=7 => block += f * d_foot.row(k - 5),
                    _ => {}
                }
                out[k][l] -= block * self.weight;
            }
        }
    }
}
