//! What is read from a state in the middle of elements.

use super::BeamBlock;
use crate::elements::beam::{pair, place};
use crate::integrals::beam::{Row, shown};

/// Strains in the middle of an element, measured against the stress-free shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BeamStrain {
    /// Axial Green-Lagrange strain of the centre line.
    pub axial: f64,
    /// Shear of the centre line against the section, along its y and z.
    pub shear: [f64; 2],
    /// Twist, curvature about y and about z of the section [1/m].
    pub curvature: [f64; 3],
}

impl BeamBlock {
    /// Products g - g0 of element `e`.
    fn products(&self, e: usize, q: &[f64]) -> Row {
        let table = &self.tables[self.table_of[e] as usize];
        let x = super::scalar::vectors(&self.local(e, q));
        let inverse_length = table[place::INVERSE_LENGTH];
        let v = [(x[4] - x[0]).times(inverse_length), x[1], x[2], x[3], x[5], x[6], x[7]];
        let mut g = [0.0; crate::elements::beam::PRODUCTS];
        for i in 0..v.len() {
            for j in 0..=i {
                g[pair(i, j)] = v[i].dot(v[j]) - table[place::G0 + pair(i, j)];
            }
        }
        g
    }

    fn twist_rate(&self, e: usize) -> f64 {
        self.tables[self.table_of[e] as usize][place::TWIST]
    }

    fn length(&self, e: usize) -> f64 {
        1.0 / self.tables[self.table_of[e] as usize][place::INVERSE_LENGTH]
    }

    /// Strains in the middle of element `e`.
    #[must_use]
    pub fn strain(&self, e: usize, q: &[f64]) -> BeamStrain {
        let g = self.products(e, q);
        let [axial, shear_y, shear_z, twist, about_y, about_z] =
            shown(self.length(e), self.twist_rate(e))
                .map(|row| row.iter().zip(&g).map(|(r, g)| r * g).sum());
        BeamStrain { axial, shear: [shear_y, shear_z], curvature: [twist, about_y, about_z] }
    }

    /// Elastic axial force in the middle of element `e` [N], along the tangent: stress on the centre line, with what
    /// the section's own strains add, times area and stretch.
    #[must_use]
    pub fn axial_force(&self, e: usize, q: &[f64]) -> f64 {
        let g = self.products(e, q);
        let axial = self.strain(e, q).axial;
        let mean = |i: usize, j: usize| 0.25 * (g[pair(i, i)] + g[pair(j, j)]);
        let (modulus, nu) = (self.law.youngs_modulus, self.law.poisson_ratio);
        let lambda = modulus * nu / ((1.0 + nu) * (1.0 - 2.0 * nu));
        let across = mean(2, 5) + mean(3, 6);
        let stress = (lambda + 2.0 * self.law.shear_modulus()) * axial + lambda * across;
        let stretch = (1.0 + 2.0 * axial).max(0.0).sqrt();
        stress * self.areas[e] * stretch
    }

    /// Elastic energy of element `e` at a strain of one [J], as a measure of rounding.
    #[must_use]
    pub fn stiffness_scale(&self, e: usize) -> f64 {
        self.law.youngs_modulus * self.areas[e] * self.length(e)
    }
}
