//! Vectors of joints: affine in the coordinates, or with a part along the normal of a section,
//! `u = A(q) + c B(q) x C(q)`, A, B and C affine.
//!
//! With `u'' = A'' + c (B'' x C + 2 B' x C' + B x C'')` and, at zero jerk, `u''' = 3 c (B'' x C' + B' x C'')`. A force f
//! on u is f on A, `c C x f` on B and `c f x B` on C.

use crate::point::{Interpolation, Support};
use crate::vector::vector;
use nalgebra::{Matrix3, Vector3};

/// How a vector of a joint moves with the joint's first body: what the reaction is read from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// From the second point to the first.
    Gap,
    /// Turns with the first body.
    OfFirst,
    /// Does neither.
    Other,
}

/// A vector of a joint.
#[derive(Clone, Debug, PartialEq)]
pub struct Arm {
    /// Its affine part A.
    value: Interpolation,
    /// The rest, c and B, C.
    cross: Option<Box<(f64, Interpolation, Interpolation)>>,
    /// How it moves.
    pub role: Role,
}

impl Arm {
    /// An affine vector.
    #[must_use]
    pub fn new(value: Interpolation, role: Role) -> Self {
        Self { value, cross: None, role }
    }

    /// `value + factor b x c`
    #[must_use]
    pub fn with_cross(
        value: Interpolation,
        (factor, b, c): (f64, Interpolation, Interpolation),
        role: Role,
    ) -> Self {
        let cross = (factor != 0.0).then(|| Box::new((factor, b, c)));
        Self { value, cross, role }
    }

    /// A vector fixed in the world.
    #[must_use]
    pub fn fixed(value: [f64; 3]) -> Self {
        Self::new(Interpolation::fixed(value), Role::Other)
    }

    /// Its affine part: all of it at nodes of surfaces.
    #[must_use]
    pub(crate) fn affine(&self) -> &Interpolation {
        &self.value
    }

    /// The affine vectors that it is made of.
    #[must_use]
    pub fn interpolations(&self) -> Vec<&Interpolation> {
        let mut all = vec![&self.value];
        if let Some(cross) = &self.cross {
            all.extend([&cross.1, &cross.2]);
        }
        all
    }

    /// The same over the coordinates of a support.
    #[must_use]
    pub fn placed(&self, support: &Support) -> Self {
        let place = |x: &Interpolation| support.localize(x);
        let cross = self.cross.as_ref().map(|x| Box::new((x.0, place(&x.1), place(&x.2))));
        Self { value: place(&self.value), cross, role: self.role }
    }

    /// Its value.
    #[must_use]
    pub fn at(&self, x: &[f64]) -> Vector3<f64> {
        let value = vector(self.value.at(x));
        match self.cross.as_deref() {
            Some((c, a, b)) => value + vector(a.at(x)).cross(&vector(b.at(x))) * *c,
            None => value,
        }
    }

    /// Its derivative along `v`.
    #[must_use]
    pub fn rate(&self, x: &[f64], v: &[f64]) -> Vector3<f64> {
        let value = vector(self.value.rate(v));
        match self.cross.as_deref() {
            Some((c, a, b)) => {
                let turning = vector(a.rate(v)).cross(&vector(b.at(x)));
                value + (turning + vector(a.at(x)).cross(&vector(b.rate(v)))) * *c
            }
            None => value,
        }
    }

    /// Its mixed second derivative along `v` and `w`.
    #[must_use]
    pub fn second(&self, v: &[f64], w: &[f64]) -> Vector3<f64> {
        match self.cross.as_deref() {
            Some((c, a, b)) => {
                let one = vector(a.rate(v)).cross(&vector(b.rate(w)));
                (one + vector(a.rate(w)).cross(&vector(b.rate(v)))) * *c
            }
            None => Vector3::zeros(),
        }
    }

    /// Adds the generalized force of `f` on it: `out += (du/dq)^T f`.
    pub fn add_force(&self, x: &[f64], f: Vector3<f64>, out: &mut [f64]) {
        self.value.add_force(f.into(), out);
        if let Some((c, a, b)) = self.cross.as_deref() {
            a.add_force((vector(b.at(x)).cross(&f) * *c).into(), out);
            b.add_force((f.cross(&vector(a.at(x))) * *c).into(), out);
        }
    }

    /// Its derivative by each vector of coordinates: offsets and matrices.
    fn gradient(&self, x: &[f64]) -> Vec<(usize, Matrix3<f64>)> {
        let terms = self.value.terms.iter();
        let mut all: Vec<_> = terms.map(|&(o, w)| (o, Matrix3::from_diagonal_element(w))).collect();
        if let Some((c, a, b)) = self.cross.as_deref() {
            let by_a = vector(b.at(x)).cross_matrix() * -*c;
            let by_b = vector(a.at(x)).cross_matrix() * *c;
            all.extend(a.terms.iter().map(|&(o, w)| (o, by_a * w)));
            all.extend(b.terms.iter().map(|&(o, w)| (o, by_b * w)));
        }
        all
    }

    /// `out += f.d2u/dx2`, n x n row by row.
    fn add_curvature(&self, f: Vector3<f64>, n: usize, out: &mut [f64]) {
        let Some((c, a, b)) = self.cross.as_deref() else { return };
        // f.(da x db) = da.(db x f)
        let k = f.cross_matrix() * -*c;
        for &(i, u) in &a.terms {
            for &(j, w) in &b.terms {
                add_block(out, n, i, j, &(k * (u * w)));
            }
        }
    }
}

/// Adds a block and its transpose.
fn add_block(out: &mut [f64], n: usize, i: usize, j: usize, block: &Matrix3<f64>) {
    for r in 0..3 {
        for s in 0..3 {
            out[(i + r) * n + j + s] += block[(r, s)];
            out[(j + s) * n + i + r] += block[(r, s)];
        }
    }
}

/// `out += factor d(u.w)/dx`
pub(crate) fn add_gradient(u: &Arm, w: &Arm, x: &[f64], factor: f64, out: &mut [f64]) {
    w.add_force(x, u.at(x) * factor, out);
    u.add_force(x, w.at(x) * factor, out);
}

/// `out += factor d2(u.w)/dx2`, n x n row by row.
pub(crate) fn add_hessian(u: &Arm, w: &Arm, x: &[f64], factor: f64, out: &mut [f64]) {
    let n = x.len();
    if u.cross.is_none() && w.cross.is_none() {
        for &(i, u_i) in &u.value.terms {
            for &(j, w_j) in &w.value.terms {
                let h = factor * u_i * w_j;
                for k in 0..3 {
                    out[(i + k) * n + j + k] += h;
                    out[(j + k) * n + i + k] += h;
                }
            }
        }
        return;
    }
    let on_w = w.gradient(x);
    for (i, by_i) in u.gradient(x) {
        for (j, by_j) in &on_w {
            add_block(out, n, i, *j, &(by_i.transpose() * by_j * factor));
        }
    }
    u.add_curvature(w.at(x) * factor, n, out);
    w.add_curvature(u.at(x) * factor, n, out);
}

/// Value of u.w and its first three time derivatives, the third at zero jerk.
pub(crate) fn motion(u: &Arm, w: &Arm, x: &[f64], v: &[f64], a: &[f64]) -> [f64; 4] {
    let jet = |u: &Arm| {
        let second = u.rate(x, a) + u.second(v, v);
        [u.at(x), u.rate(x, v), second, u.second(v, a) * 3.0]
    };
    let (u, w) = (jet(u), jet(w));
    [
        u[0].dot(&w[0]),
        u[1].dot(&w[0]) + u[0].dot(&w[1]),
        u[2].dot(&w[0]) + 2.0 * u[1].dot(&w[1]) + u[0].dot(&w[2]),
        u[3].dot(&w[0]) + 3.0 * (u[2].dot(&w[1]) + u[1].dot(&w[2])) + u[0].dot(&w[3]),
    ]
}
