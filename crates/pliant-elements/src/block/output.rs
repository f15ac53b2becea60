//! Energies, momenta, masses and measures of strain.

use pliant_math::Vec3;
use pliant_math::quadrature::{GAUSS_5, LOBATTO_3};

use super::scalar::vectors;
use super::{CableBlock, place};
use crate::element::{Momentum, Motion};
use crate::elements::cable::{
    Column, Integration, Strain, curvature, inertia, mid_strain_and_force, wound_force,
};

impl CableBlock {
    /// The column's number at `place`.
    fn number(&self, e: usize, place: usize) -> f64 {
        Column::<f64>::get(self.column(e), place)
    }

    /// Scalar mass matrix, entry (i, j).
    fn mass_entry(&self, e: usize, i: usize, j: usize) -> f64 {
        let (i, j) = (i.max(j), i.min(j));
        self.number(e, place::MASS + i * (i + 1) / 2 + j)
    }

    /// `M x` of element `e`, as vectors.
    fn mass_times(&self, e: usize, global: &[f64]) -> [Vec3<f64>; 4] {
        inertia(self.column(e), &vectors(&self.local(e, global)))
    }

    pub(super) fn total_kinetic_energy(&self, v: &[f64]) -> f64 {
        self.real_elements()
            .map(|(e, _)| {
                let momentum = self.mass_times(e, v);
                let rates = vectors(&self.local(e, v));
                (0..4).map(|k| 0.5 * momentum[k].dot(rates[k])).sum::<f64>()
            })
            .sum()
    }

    pub(super) fn total_dissipation(&self, q: &[f64], v: &[f64]) -> f64 {
        if !self.law.damped {
            return 0.0;
        }
        let nodes: f64 = self
            .real_elements()
            .map(|(e, _)| {
                let x = vectors(&self.local(e, q));
                let rates = vectors(&self.local(e, v));
                let (column, scale) = (self.column(e), self.scale(e, 1.0));
                let total = wound_force(self.law, column, &x, Some(&rates), scale);
                let elastic = wound_force(self.law, column, &x, None, scale);
                (0..4).map(|k| (total[k] - elastic[k]).dot(rates[k])).sum::<f64>()
            })
            .sum();
        nodes + self.length_dissipation(Motion { q, v, a: v })
    }

    pub(super) fn total_momentum(&self, q: &[f64], v: &[f64]) -> Momentum {
        let mut linear = Vec3::zero(0.0);
        let mut angular = Vec3::zero(0.0);
        for (e, _) in self.real_elements() {
            let momentum = self.mass_times(e, v);
            let x = vectors(&self.local(e, q));
            // The line is r = sum N_k x_k: only the nodes' positions move with a translation.
            linear = linear + momentum[0] + momentum[2];
            for k in 0..4 {
                angular = angular + x[k].cross(momentum[k]);
            }
        }
        Momentum { linear: linear.array(), angular: angular.array() }
    }

    pub(super) fn total_mass(&self) -> f64 {
        self.real_elements()
            .map(|(e, _)| {
                self.mass_entry(e, 0, 0) + 2.0 * self.mass_entry(e, 2, 0) + self.mass_entry(e, 2, 2)
            })
            .sum()
    }

    pub(super) fn total_first_moment(&self, q: &[f64]) -> [f64; 3] {
        let mut sum = Vec3::zero(0.0);
        for (e, _) in self.real_elements() {
            let moment = self.mass_times(e, q);
            sum = sum + moment[0] + moment[2];
        }
        sum.array()
    }

    /// Number of the middle among the axial points, and J0 = |r0'| there.
    fn mid_metric(&self, e: usize) -> (usize, f64) {
        let k = match self.law.integration {
            Integration::Lobatto => 1,
            Integration::Full => 2,
        };
        let metric = self.number(e, place::AXIAL_METRIC + k);
        let j0 = match self.law.strain {
            Strain::GreenLagrange => 1.0 / metric.sqrt(),
            Strain::Biot => 1.0 / metric,
        };
        (k, j0)
    }

    /// EA at the middle, from the weighted one.
    fn mid_stiffness(&self, e: usize) -> f64 {
        let (k, j0) = self.mid_metric(e);
        let weight = match self.law.integration {
            Integration::Lobatto => LOBATTO_3.weight[k],
            Integration::Full => GAUSS_5.weight[k],
        };
        let inverse_length = self.number(e, place::INVERSE_LENGTH);
        self.number(e, place::AXIAL + k) * inverse_length / (weight * j0)
    }

    fn mid_strain_and_force(&self, e: usize, q: &[f64]) -> (f64, f64) {
        let x = vectors(&self.local(e, q));
        mid_strain_and_force(self.law, self.column(e), &x, self.scale(e, 1.0))
    }

    /// Axial strain at the middle of element `e`.
    #[must_use]
    pub fn axial_strain(&self, e: usize, q: &[f64]) -> f64 {
        self.mid_strain_and_force(e, q).0
    }

    /// Elastic axial force at the middle of element `e` [N], conjugate to the strain; damping left out.
    #[must_use]
    pub fn axial_force(&self, e: usize, q: &[f64]) -> f64 {
        self.mid_strain_and_force(e, q).1 * self.mid_stiffness(e)
    }

    /// Material curvature vector `r' x r''/(|r'|^2 J0)` at the middle of element `e` [1/m].
    #[must_use]
    pub fn curvature(&self, e: usize, q: &[f64]) -> [f64; 3] {
        let j0 = self.mid_metric(e).1;
        let scale = self.scale(e, 1.0);
        curvature(self.column(e), &vectors(&self.local(e, q)), scale).map(|c| c / j0)
    }
}
