//! Single elements, one number at a time, over any kind of number: energies, tests. No claim to speed.

use pliant_math::{Dual, Real, Vec3};

use super::SurfaceBlock;
use super::point::{Frame, Vectors, membrane_gradient, membrane_rates, membrane_strain};
use super::precomputed;
use crate::element::{Block, Momentum, Motion, Weights, Workspace};
use crate::integrals::surface::Table;
use crate::materials::Voigt;

/// Vectors of an element at a point of its rule.
pub(super) fn vectors_at<T: Real>(
    block: &SurfaceBlock,
    table: &Table,
    p: usize,
    q: &[Vec3<T>],
) -> Vectors<T> {
    let (width, zero) = (block.width(), q[0].x.zero());
    let rows = block.rows();
    let sum = |s: usize| {
        if s >= rows {
            return Vec3::zero(zero);
        }
        let row = &table.rows[(rows * p + s) * width..];
        q.iter().zip(row).fold(Vec3::zero(zero), |sum, (&q, &w)| sum.add_scaled(w, q))
    };
    Vectors { a: [sum(0), sum(1)], h: [sum(2), sum(3), sum(4)] }
}

pub(super) fn local<T: Real>(x: &[T]) -> Vec<Vec3<T>> {
    x.chunks_exact(3).map(|c| Vec3::new(c[0], c[1], c[2])).collect()
}

impl SurfaceBlock {
    /// Coordinates of element `e`, nodal vector by nodal vector.
    #[must_use]
    pub fn local(&self, e: usize, global: &[f64]) -> Vec<f64> {
        self.vectors_of(e)
            .iter()
            .flat_map(|&o| global[o as usize..o as usize + 3].iter().copied())
            .collect()
    }

    /// Elastic energy of element `e` [J] at local coordinates.
    pub(crate) fn local_energy<T: Real>(&self, e: usize, q: &[T]) -> T {
        let (table, _, h) = self.element(e);
        let q = local(q);
        let material = &self.law.material;
        let mut sum = precomputed::energy(self, table, h, &q);
        let none = [sum.zero(); 3];
        for p in 0..table.points {
            let x = vectors_at(self, table, p, &q);
            let [membrane, bending] = table.areas[p];
            if self.rows() == 2 {
                sum = sum + material.energy(h, membrane_strain(&x.a), none).scale(membrane);
                continue;
            }
            let frame = Frame::new(&x, table.curvature[p]);
            if membrane == bending {
                sum = sum + material.energy(h, frame.membrane, frame.bending).scale(membrane);
            } else {
                sum = sum + material.energy(h, frame.membrane, none).scale(membrane);
                sum = sum + material.energy(h, none, frame.bending).scale(bending);
            }
        }
        sum
    }

    /// Inner force of element `e`, elastic and viscous, at local coordinates and velocities.
    pub(crate) fn local_force<T: Real>(&self, e: usize, q: &[T], v: &[T]) -> Vec<T> {
        let (table, _, h) = self.element(e);
        let (q, v) = (local(q), local(v));
        let zero = q[0].x.zero();
        let mut force = vec![Vec3::zero(zero); q.len()];
        let tau = self.law.retardation_time;
        let within = self.law.material.is_one_sided();
        // The membrane strain that the law sees.
        let seen = |e: Voigt<T>, rate: Voigt<T>| {
            let tau = if within { tau } else { 0.0 };
            [0, 1, 2].map(|k| e[k] + rate[k].scale(tau))
        };
        let viscous = |mut n: Voigt<T>, rate: Voigt<T>, factor: f64| {
            if tau != 0.0 && factor != 0.0 {
                let s = self.linear.stress(rate);
                for k in 0..3 {
                    n[k] = n[k] + s[k].scale(tau * factor);
                }
            }
            n
        };
        let beside = if within { 0.0 } else { h };
        let (width, rows) = (self.width(), self.rows());
        precomputed::add_force_of(self, table, h, (&q, &v), &mut force);
        for p in 0..table.points {
            let x = vectors_at(self, table, p, &q);
            let rate = vectors_at(self, table, p, &v);
            let [membrane, bending] = table.areas[p];
            let mut on = [Vec3::zero(zero); 5];
            if rows == 5 {
                let frame = Frame::new(&x, table.curvature[p]);
                let [e, k] = frame.rates(&x, &rate);
                let strain = seen(frame.membrane, e);
                let [n, m] = self.law.material.resultants(h, strain, frame.bending);
                let n = viscous(n, e, beside).map(|n| n.scale(membrane));
                let m = viscous(m, k, h * h * h / 12.0).map(|m| m.scale(bending));
                let gradient = frame.gradient(&x, n, m);
                on[..2].copy_from_slice(&gradient.a);
                on[2..].copy_from_slice(&gradient.h);
            } else {
                let none = [zero; 3];
                let e = membrane_rates(&x.a, &rate.a);
                let strain = seen(membrane_strain(&x.a), e);
                let [n, _] = self.law.material.resultants(h, strain, none);
                let n = viscous(n, e, beside).map(|n| n.scale(membrane));
                on[..2].copy_from_slice(&membrane_gradient(&x.a, n));
            }
            for (s, on) in on[..rows].iter().enumerate() {
                let row = &table.rows[(rows * p + s) * width..];
                for (f, &w) in force.iter_mut().zip(row) {
                    *f = f.add_scaled(w, *on);
                }
            }
        }
        force.into_iter().flat_map(Vec3::array).collect()
    }

    /// Element `e` as a block of its own over its local coordinates.
    #[must_use]
    pub fn alone(&self, e: usize) -> Self {
        let n = self.kind.vectors();
        Self {
            tables: vec![self.element(e).0.clone()],
            table_of: vec![0],
            thickness: vec![self.thickness[e]],
            offsets: (0..n as u32).map(|k| 3 * k).collect(),
            extent: 3 * n,
            ..self.clone()
        }
    }

    /// `M (a - g) + f(q, v)` of element `e`, nodal vector by nodal vector.
    #[must_use]
    pub fn element_force(&self, e: usize, motion: Motion<'_>, gravity: [f64; 3]) -> Vec<f64> {
        let [q, v, a] = [motion.q, motion.v, motion.a].map(|x| self.local(e, x));
        let mut force = vec![0.0; q.len()];
        let motion = Motion { q: &q, v: &v, a: &a };
        self.alone(e).residual(motion, gravity, &mut Workspace::default(), &mut force, false);
        force
    }

    /// Lower triangle by rows of the weighted tangent of element `e`.
    #[must_use]
    pub fn element_tangent(&self, e: usize, motion: Motion<'_>, weights: Weights) -> Vec<f64> {
        let [q, v, a] = [motion.q, motion.v, motion.a].map(|x| self.local(e, x));
        let mut values = vec![0.0; self.entries()];
        let motion = Motion { q: &q, v: &v, a: &a };
        self.alone(e).tangent(motion, weights, &mut values, false);
        values
    }

    /// The complete derivative of the inner force of element `e` by its coordinates, by dual numbers.
    #[must_use]
    pub fn element_jacobian(&self, e: usize, motion: Motion<'_>) -> Vec<Vec<f64>> {
        let v: Vec<Dual> = self.local(e, motion.v).into_iter().map(|c| Dual::new(c, 0.0)).collect();
        pliant_math::check::dual_jacobian(&self.local(e, motion.q), |q| self.local_force(e, q, &v))
    }

    /// Elastic energy of element `e` [J].
    #[must_use]
    pub fn element_elastic_energy(&self, e: usize, q: &[f64]) -> f64 {
        self.local_energy(e, &self.local(e, q))
    }

    /// Mass of element `e` [kg].
    #[must_use]
    pub fn element_mass(&self, e: usize) -> f64 {
        let (table, _, h) = self.element(e);
        let width = self.width();
        let sum: f64 = self
            .positions()
            .flat_map(|i| self.positions().map(move |j| (i, j)))
            .map(|(i, j)| table.mass[i * width + j])
            .sum();
        self.density * h * sum
    }

    /// `M x` of element `e`.
    fn mass_times(&self, e: usize, global: &[f64]) -> Vec<Vec3<f64>> {
        let (table, _, h) = self.element(e);
        let x = local(&self.local(e, global));
        let width = self.width();
        (0..x.len())
            .map(|i| {
                x.iter()
                    .zip(&table.mass[i * width..])
                    .fold(Vec3::zero(0.0), |sum, (&x, &m)| sum.add_times(self.density * h * m, x))
            })
            .collect()
    }

    pub(super) fn total_kinetic_energy(&self, v: &[f64]) -> f64 {
        (0..self.element_count())
            .map(|e| {
                let momentum = self.mass_times(e, v);
                let rates = local(&self.local(e, v));
                momentum.iter().zip(&rates).map(|(p, v)| 0.5 * p.dot(*v)).sum::<f64>()
            })
            .sum()
    }

    pub(super) fn total_dissipation(&self, q: &[f64], v: &[f64]) -> f64 {
        if !self.is_damped() {
            return 0.0;
        }
        (0..self.element_count())
            .map(|e| {
                let (q, v) = (self.local(e, q), self.local(e, v));
                let rest = vec![0.0; v.len()];
                let (total, elastic) =
                    (self.local_force(e, &q, &v), self.local_force(e, &q, &rest));
                total.iter().zip(&elastic).zip(&v).map(|((f, g), v)| (f - g) * v).sum::<f64>()
            })
            .sum()
    }

    pub(super) fn total_momentum(&self, q: &[f64], v: &[f64]) -> Momentum {
        let (mut linear, mut angular) = (Vec3::zero(0.0), Vec3::zero(0.0));
        for e in 0..self.element_count() {
            let momentum = self.mass_times(e, v);
            for i in self.positions() {
                linear = linear + momentum[i];
            }
            for (x, p) in local(&self.local(e, q)).iter().zip(&momentum) {
                angular = angular + x.cross(*p);
            }
        }
        Momentum { linear: linear.array(), angular: angular.array() }
    }

    pub(super) fn total_first_moment(&self, q: &[f64]) -> [f64; 3] {
        let each = (0..self.element_count()).map(|e| self.element_first_moment(e, q));
        each.fold([0.0; 3], |sum, m| [sum[0] + m[0], sum[1] + m[1], sum[2] + m[2]])
    }

    /// First moment of mass of element `e` about the origin [kg m].
    #[must_use]
    pub fn element_first_moment(&self, e: usize, q: &[f64]) -> [f64; 3] {
        let moment = self.mass_times(e, q);
        self.positions().fold(Vec3::zero(0.0), |sum, i| sum + moment[i]).array()
    }
}
