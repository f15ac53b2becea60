//! Single elements, one number at a time, over any kind of number: energies, tests. No claim to speed.

use pliant_math::{Dual, Real, Vec3};

use super::BeamBlock;
use crate::element::{Momentum, Motion, Weights};
use crate::elements::beam::{Column, ENTRIES, Nodal, energy, force, inertia, tangent};

/// Numbers of one element.
#[derive(Clone, Copy)]
pub(crate) struct ScalarColumn<'a>(&'a [f64]);

impl Column<f64> for ScalarColumn<'_> {
    fn get(self, place: usize) -> f64 {
        self.0[place]
    }
}

impl Column<Dual> for ScalarColumn<'_> {
    fn get(self, place: usize) -> Dual {
        Dual::new(self.0[place], 0.0)
    }
}

pub(super) fn vectors<T: Real>(x: &[T; 24]) -> Nodal<T> {
    std::array::from_fn(|k| Vec3::new(x[3 * k], x[3 * k + 1], x[3 * k + 2]))
}

fn flatten<T: Real>(x: &Nodal<T>) -> [T; 24] {
    let x = x.map(Vec3::array);
    std::array::from_fn(|k| x[k / 3][k % 3])
}

impl BeamBlock {
    fn column(&self, e: usize) -> ScalarColumn<'_> {
        ScalarColumn(&self.tables[self.table_of[e] as usize])
    }

    /// Coordinates (r1, x1, y1, z1, r2, x2, y2, z2) of element `e`.
    #[must_use]
    pub fn local(&self, e: usize, global: &[f64]) -> [f64; 24] {
        let nodes = self.nodes[e];
        std::array::from_fn(|k| global[nodes[k / 12] as usize + k % 12])
    }

    /// Elastic energy of element `e` [J] at local coordinates, over any kind of number.
    pub(crate) fn local_energy<T: Real>(&self, e: usize, q: &[T; 24]) -> T
    where
        for<'a> ScalarColumn<'a>: Column<T>,
    {
        energy(self.column(e), &vectors(q))
    }

    /// Inner force of element `e`, elastic and viscous, at local coordinates and velocities.
    pub(crate) fn local_force<T: Real>(&self, e: usize, q: &[T; 24], v: &[T; 24]) -> [T; 24]
    where
        for<'a> ScalarColumn<'a>: Column<T>,
    {
        let rates = self.is_damped().then(|| vectors(v));
        flatten(&force(self.column(e), &vectors(q), rates.as_ref()))
    }

    /// Lower triangle by rows of the weighted tangent of element `e`.
    #[must_use]
    pub fn element_tangent(&self, e: usize, motion: Motion<'_>, weights: Weights) -> Vec<f64> {
        let x = vectors(&self.local(e, motion.q));
        let rates = self.is_damped().then(|| vectors(&self.local(e, motion.v)));
        let mut out = vec![0.0; ENTRIES];
        tangent(self.column(e), &x, rates.as_ref(), weights, |k, c| out[k] = c);
        out
    }

    /// `M (a - g) + f(q, v)` of element `e`.
    #[must_use]
    pub fn element_force(&self, e: usize, motion: Motion<'_>, gravity: [f64; 3]) -> [f64; 24] {
        let inner = self.local_force(e, &self.local(e, motion.q), &self.local(e, motion.v));
        let mut a = vectors(&self.local(e, motion.a));
        for node in [0, 4] {
            a[node] = a[node] - gravity.into();
        }
        let inertial = flatten(&inertia(self.column(e), &a));
        std::array::from_fn(|k| inner[k] + inertial[k])
    }

    /// Elastic energy of element `e` [J].
    #[must_use]
    pub fn element_elastic_energy(&self, e: usize, q: &[f64]) -> f64 {
        self.local_energy(e, &self.local(e, q))
    }

    /// Momenta of the nodal vectors, `M v`.
    fn momenta(&self, e: usize, v: &[f64]) -> Nodal<f64> {
        inertia(self.column(e), &vectors(&self.local(e, v)))
    }

    /// Mass of element `e` [kg].
    #[must_use]
    pub fn element_mass(&self, e: usize) -> f64 {
        let one = Vec3::new(1.0, 0.0, 0.0);
        let mut a = [Vec3::zero(0.0); 8];
        (a[0], a[4]) = (one, one);
        let f = inertia(self.column(e), &a);
        f[0].x + f[4].x
    }

    /// First moment of mass of element `e` about the origin [kg m].
    #[must_use]
    pub fn element_first_moment(&self, e: usize, q: &[f64]) -> [f64; 3] {
        let moment = self.momenta(e, q);
        (moment[0] + moment[4]).array()
    }

    pub(super) fn total_kinetic_energy(&self, v: &[f64]) -> f64 {
        (0..self.nodes.len())
            .map(|e| {
                let rates = vectors(&self.local(e, v));
                let momenta = self.momenta(e, v);
                rates.iter().zip(&momenta).map(|(v, p)| 0.5 * v.dot(*p)).sum::<f64>()
            })
            .sum()
    }

    pub(super) fn total_dissipation(&self, q: &[f64], v: &[f64]) -> f64 {
        if !self.is_damped() {
            return 0.0;
        }
        (0..self.nodes.len())
            .map(|e| {
                let (q, v) = (self.local(e, q), self.local(e, v));
                let total = self.local_force(e, &q, &v);
                let elastic = self.local_force(e, &q, &[0.0; 24]);
                (0..24).map(|k| (total[k] - elastic[k]) * v[k]).sum::<f64>()
            })
            .sum()
    }

    pub(super) fn total_momentum(&self, q: &[f64], v: &[f64]) -> Momentum {
        let (mut linear, mut angular) = (Vec3::zero(0.0), Vec3::zero(0.0));
        for e in 0..self.nodes.len() {
            let momenta = self.momenta(e, v);
            linear = linear + momenta[0] + momenta[4];
            for (x, p) in vectors(&self.local(e, q)).iter().zip(&momenta) {
                angular = angular + x.cross(*p);
            }
        }
        Momentum { linear: linear.array(), angular: angular.array() }
    }
}
