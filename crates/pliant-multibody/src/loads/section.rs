//! Forces and moments on the section of a beam, which its gradients y = r,y and z = r,z span.
//!
//! A moment m acts as on a rigid section: `f_i = mu x r_i` for r_i = y, z with `T mu = m`,
//! `T = sum_i (r_i.r_i) I - r_i r_i^T`, for `sum_i r_i x f_i = T mu = m`: it neither stretches nor shears the section in
//! its plane. Tangent: `df_i/dr_j = -[r_i]x dmu/dr_j + delta_ij [mu]x`,
//! `dmu/dr_j = -T^-1 (2 mu r_j^T - (r_j.mu) I - r_j mu^T)`.
//!
//! A force that follows is `F = sum_k p_k a_k`, a_k the axes of the section ([`section_axes`]) and p_k its components
//! along them at the start; its tangent comes from dual numbers.

use super::Load;
use super::force::add_outer;
use crate::joints::side::section_axes;
use crate::point::{Interpolation, Support};
use crate::signal::Moment;
use crate::vector::vector;
use nalgebra::{Matrix3, Vector3};
use pliant_math::{Dual, Real, Vec3};

/// A moment fixed in space.
#[derive(Clone, Debug)]
pub struct SectionMoment {
    /// The gradients y and z.
    gradients: [Interpolation; 2],
    support: Support,
}

impl SectionMoment {
    /// A moment on the section of the gradients.
    #[must_use]
    pub fn new(gradients: [Interpolation; 2], support: Support) -> Self {
        Self { gradients, support }
    }

    /// Gradients, T^-1 and mu.
    #[allow(clippy::type_complexity)]
    fn parts(
        &self,
        value: [f64; 3],
        q: &[f64],
    ) -> Option<([Vector3<f64>; 2], Matrix3<f64>, Vector3<f64>)> {
        let r = self.gradients.each_ref().map(|g| vector(g.at(q)));
        let spread = r[0].norm_squared() + r[1].norm_squared();
        let t = Matrix3::from_diagonal_element(spread)
            - r[0] * r[0].transpose()
            - r[1] * r[1].transpose();
        let inverse = t.try_inverse()?;
        Some((r, inverse, inverse * vector(value)))
    }
}

impl Load for SectionMoment {
    fn add_force(
        &self,
        _now: Moment<'_>,
        value: [f64; 3],
        q: &[f64],
        factor: f64,
        force: &mut [f64],
    ) {
        let Some((r, _, mu)) = self.parts(value, q) else { return };
        for (gradient, r) in self.gradients.iter().zip(r) {
            gradient.add_force((mu.cross(&r) * factor).into(), force);
        }
    }

    fn supports(&self) -> &[Support] {
        std::slice::from_ref(&self.support)
    }

    fn jacobian(&self, _part: usize, value: [f64; 3], q: &[f64], factor: f64, out: &mut [f64]) {
        out.fill(0.0);
        let Some((r, inverse, mu)) = self.parts(value, q) else { return };
        for j in 0..2 {
            let change = mu * r[j].transpose() * 2.0
                - Matrix3::from_diagonal_element(r[j].dot(&mu))
                - r[j] * mu.transpose();
            let by_r = inverse * change * -1.0;
            for i in 0..2 {
                let mut k = r[i].cross_matrix() * by_r * -1.0;
                if i == j {
                    k += mu.cross_matrix();
                }
                let (at, by) = (&self.gradients[i], &self.gradients[j]);
                add_outer(&self.support, at, by, &(k * factor), out);
            }
        }
    }
}

/// A force that turns with the section.
#[derive(Clone, Debug)]
pub struct SectionForce {
    r: Interpolation,
    gradients: [Interpolation; 2],
    start: [Vector3<f64>; 3],
    support: Support,
}

impl SectionForce {
    /// A force at `r` that turns with the section of the gradients; none where they span no section at coordinates `q`.
    #[must_use]
    pub fn new(
        r: Interpolation,
        gradients: [Interpolation; 2],
        q: &[f64],
        support: Support,
    ) -> Option<Self> {
        let [y, z] = gradients.each_ref().map(|g| vector(g.at(q)));
        let start = section_axes(y, z)?;
        Some(Self { r, gradients, start, support })
    }

    fn components(&self, value: [f64; 3]) -> [f64; 3] {
        self.start.map(|axis| axis.dot(&vector(value)))
    }
}

fn unit<T: Real>(x: Vec3<T>) -> Vec3<T> {
    x.times(x.dot(x).sqrt().recip())
}

/// `sum_k p_k a_k`
fn followed<T: Real>(p: [f64; 3], y: Vec3<T>, z: Vec3<T>) -> Vec3<T> {
    let normal = unit(y.cross(z));
    let across = unit(y + z.cross(normal));
    normal.scale(p[0]).add_scaled(p[1], across).add_scaled(p[2], normal.cross(across))
}

impl Load for SectionForce {
    fn add_force(
        &self,
        _now: Moment<'_>,
        value: [f64; 3],
        q: &[f64],
        factor: f64,
        force: &mut [f64],
    ) {
        let [y, z] = self.gradients.each_ref().map(|g| Vec3::from(g.at(q)));
        let f = followed(self.components(value), y, z).array();
        self.r.add_force(f.map(|f| f * factor), force);
    }

    fn supports(&self) -> &[Support] {
        std::slice::from_ref(&self.support)
    }

    fn jacobian(&self, _part: usize, value: [f64; 3], q: &[f64], factor: f64, out: &mut [f64]) {
        out.fill(0.0);
        let p = self.components(value);
        let at = self.gradients.each_ref().map(|g| g.at(q));
        for (number, gradient) in self.gradients.iter().enumerate() {
            let mut k = Matrix3::zeros();
            for c in 0..3 {
                let mut x = at.map(|x| x.map(|x| Dual::new(x, 0.0)));
                x[number][c].derivative = 1.0;
                let [y, z] = x.map(|[a, b, c]| Vec3::new(a, b, c));
                for (r, f) in followed(p, y, z).array().into_iter().enumerate() {
                    k[(r, c)] = f.derivative;
                }
            }
            add_outer(&self.support, &self.r, gradient, &(k * factor), out);
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use pliant_math::check::{central_difference, relative_error};

    /// r, y and z, sheared and stretched.
    const Q: [f64; 9] = [0.3, -0.2, 0.5, 0.1, 1.1, 0.2, -0.3, 0.2, 0.9];
    const VALUE: [f64; 3] = [0.7, -1.3, 2.1];

    fn at(offset: usize) -> Interpolation {
        Interpolation::weighted([(offset, 1.0)])
    }

    fn support() -> Support {
        Support { groups: Vec::new(), unknowns: (0..9).collect() }
    }

    fn check(load: &dyn Load) {
        let force = |q: &[f64]| {
            let mut force = vec![0.0; 9];
            load.add_force(Moment::at(0.0), VALUE, q, 2.0, &mut force);
            force
        };
        let mut out = vec![0.0; 81];
        load.jacobian(0, VALUE, &Q, 2.0, &mut out);
        let jacobian: Vec<Vec<f64>> = out.chunks(9).map(<[f64]>::to_vec).collect();
        // Second order: 1e-10 of the third derivative.
        assert!(relative_error(&jacobian, &central_difference(&Q, 1e-5, force)) < 1e-8);
    }

    #[test]
    fn tangents_are_the_derivatives() {
        check(&SectionMoment::new([at(3), at(6)], support()));
        let start = [0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
        check(&SectionForce::new(at(0), [at(3), at(6)], &start, support()).unwrap());
    }

    #[test]
    fn moment_does_the_work_of_a_rotation_and_none_on_strains() {
        let load = SectionMoment::new([at(3), at(6)], support());
        let mut force = vec![0.0; 9];
        load.add_force(Moment::at(0.0), VALUE, &Q, 1.0, &mut force);
        let vector = |x: &[f64], k: usize| Vector3::new(x[k], x[k + 1], x[k + 2]);
        let moment: Vector3<f64> =
            [3, 6].map(|k| vector(&Q, k).cross(&vector(&force, k))).iter().sum();
        assert!((moment - Vector3::from(VALUE)).norm() < 1e-14);
        // Of a section that is square: y.dz + z.dy and y.dy take no work.
        let square = [0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
        let mut force = vec![0.0; 9];
        load.add_force(Moment::at(0.0), VALUE, &square, 1.0, &mut force);
        assert!((force[5] + force[7]).abs() < 1e-15 && force[4].abs() < 1e-15);
    }

    #[test]
    fn force_turns_with_the_section() {
        let start = [0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
        let load = SectionForce::new(at(0), [at(3), at(6)], &start, support()).unwrap();
        // A quarter turn about z: x to y, y to -x.
        let turned = [0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 1.0];
        let mut force = vec![0.0; 9];
        load.add_force(Moment::at(0.0), VALUE, &turned, 1.0, &mut force);
        let expected = [1.3, 0.7, 2.1];
        for k in 0..3 {
            assert!((force[k] - expected[k]).abs() < 1e-15, "{force:?}");
        }
    }
}
