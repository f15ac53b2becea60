//! The angle between two sheets along a crease: a freedom of three vectors affine in the coordinates.
//!
//! With t along the crease, u out of the first sheet and w into the second, both across it,
//! `theta = atan2(|t| t.(u x w), |t|^2 u.w - (u.t)(w.t))`: zero where the second continues the first, positive where w
//! has turned from u about t. What u and w have along t does not count, nor do lengths.
//!
//! With `p_x = t x x` and `h(p) = p/|p|^2` the gradient is `theta_w = |t| h(p_w)`, `theta_u = -|t| h(p_u)` and, as rigid
//! rotation leaves theta, `theta_t = ((t.u) h(p_u) - (t.w) h(p_w))/|t|`. Its derivative along a direction follows by
//! `dh = dp/|p|^2 - 2 p (p.dp)/|p|^4`.

use crate::jet::{Jet, VectorJet, dot, leibniz, unit};
use crate::joints::arm::Arm;
use crate::point::{Interpolation, Support};
use nalgebra::Vector3;
use std::f64::consts::TAU;

/// The angle of a fold.
#[derive(Clone, Debug, PartialEq)]
pub struct Fold {
    /// Along the crease.
    pub t: Arm,
    /// Out of the first sheet, across the crease.
    pub u: Arm,
    /// Into the second sheet, across the crease.
    pub w: Arm,
    /// Of the angles that differ by whole turns the one nearest to this is meant.
    pub near: f64,
}

type Triple = [Vector3<f64>; 3];

/// h(p) and its change with p.
fn inverse(p: Vector3<f64>, dp: Vector3<f64>) -> (Vector3<f64>, Vector3<f64>) {
    let square = p.norm_squared();
    (p / square, dp / square - p * (2.0 * p.dot(&dp) / (square * square)))
}

/// Gradient by (t, u, w), and its derivative along a direction.
fn gradient([t, u, w]: Triple, [dt, du, dw]: Triple) -> (Triple, Triple) {
    let length = t.norm();
    let d_length = t.dot(&dt) / length;
    let (h_u, dh_u) = inverse(t.cross(&u), dt.cross(&u) + t.cross(&du));
    let (h_w, dh_w) = inverse(t.cross(&w), dt.cross(&w) + t.cross(&dw));
    let (along_u, along_w) = (t.dot(&u), t.dot(&w));
    let (d_along_u, d_along_w) = (dt.dot(&u) + t.dot(&du), dt.dot(&w) + t.dot(&dw));
    let by_t = (h_u * along_u - h_w * along_w) / length;
    let d_by_t =
        (h_u * d_along_u + dh_u * along_u - h_w * d_along_w - dh_w * along_w - by_t * d_length)
            / length;
    (
        [by_t, -h_u * length, h_w * length],
        [d_by_t, -h_u * d_length - dh_u * length, h_w * d_length + dh_w * length],
    )
}

impl Fold {
    pub(crate) fn arms(&self) -> [&Arm; 3] {
        [&self.t, &self.u, &self.w]
    }

    pub(crate) fn interpolations(&self) -> Vec<&Interpolation> {
        self.arms().map(Arm::affine).to_vec()
    }

    pub(crate) fn placed(&self, support: &Support) -> Self {
        let local = |arm: &Arm| arm.placed(support);
        Self { t: local(&self.t), u: local(&self.u), w: local(&self.w), near: self.near }
    }

    fn vectors(&self, x: &[f64]) -> Triple {
        self.arms().map(|arm| arm.at(x))
    }

    /// Cosine and sine of the angle, times the lengths of what u and w have across t, with three time derivatives at
    /// zero jerk.
    pub(crate) fn pair(&self, x: &[f64], v: &[f64], a: &[f64]) -> (Jet, Jet) {
        let jet = |arm: &Arm| -> VectorJet {
            [arm.at(x), arm.rate(x, v), arm.rate(x, a), Vector3::zeros()]
        };
        let (t, u, w) = (unit(&jet(&self.t)), jet(&self.u), jet(&self.w));
        let cross: VectorJet =
            leibniz(&u, &w, |c, a: Vector3<f64>, b: Vector3<f64>| a.cross(&b) * c);
        let along = dot(&u, &t).times(dot(&w, &t));
        let across = dot(&u, &w);
        (Jet(std::array::from_fn(|k| across.0[k] - along.0[k])), dot(&t, &cross))
    }

    /// The angle.
    pub(crate) fn value(&self, x: &[f64]) -> f64 {
        let [t, u, w] = self.vectors(x);
        let sine = t.norm() * t.dot(&u.cross(&w));
        self.meant(sine.atan2(t.norm_squared() * u.dot(&w) - u.dot(&t) * w.dot(&t)))
    }

    pub(crate) fn meant(&self, angle: f64) -> f64 {
        angle + TAU * ((self.near - angle) / TAU).round()
    }

    pub(crate) fn gradient(&self, x: &[f64]) -> Triple {
        gradient(self.vectors(x), [Vector3::zeros(); 3]).0
    }

    /// `out += factor dy/dx`
    pub(crate) fn add_gradient(&self, x: &[f64], factor: f64, out: &mut [f64]) {
        for (arm, g) in self.arms().into_iter().zip(self.gradient(x)) {
            arm.add_force(x, g * factor, out);
        }
    }

    /// `out += factor d2y/dx2`, n x n row by row.
    pub(crate) fn add_hessian(&self, x: &[f64], factor: f64, out: &mut [f64]) {
        let (vectors, n) = (self.vectors(x), x.len());
        for (number, by) in self.arms().into_iter().enumerate() {
            for b in 0..3 {
                let mut direction = [Vector3::zeros(); 3];
                direction[number][b] = 1.0;
                let (_, change) = gradient(vectors, direction);
                for (arm, change) in self.arms().into_iter().zip(change) {
                    for &(i, w_i) in &arm.affine().terms {
                        for &(j, w_j) in &by.affine().terms {
                            for k in 0..3 {
                                out[(i + k) * n + j + b] += factor * w_i * w_j * change[k];
                            }
                        }
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::freedom::Freedom;
    use crate::joints::arm::Role;

    fn fold() -> Freedom {
        let arm = |terms: &[(usize, f64)]| {
            Arm::new(Interpolation::weighted(terms.iter().copied()), Role::Other)
        };
        Freedom::Fold(Fold {
            t: arm(&[(0, 0.7), (3, -0.4)]),
            u: arm(&[(6, 1.2)]),
            w: arm(&[(9, 0.8), (0, 0.1)]),
            near: 0.0,
        })
    }

    fn noise(seed: f64) -> Vec<f64> {
        (1..=12).map(|i| (1.7 * f64::from(i) + 12.3 * seed).sin()).collect()
    }

    fn moved(x: &[f64], v: &[f64], a: &[f64], t: f64) -> Vec<f64> {
        (0..x.len()).map(|i| x[i] + t * v[i] + 0.5 * t * t * a[i]).collect()
    }

    #[test]
    fn derivatives_agree_with_differences() {
        let (y, x, v, a) = (fold(), noise(1.0), noise(2.0), noise(3.0));
        let gradient = |x: &[f64]| {
            let mut g = vec![0.0; 12];
            y.add_gradient(x, 1.0, &mut g);
            g
        };
        let mut hessian = vec![0.0; 144];
        y.add_hessian(&x, 1.0, &mut hessian);
        let (h, still) = (1e-5, vec![0.0; 12]);
        let (plus, minus) = (moved(&x, &v, &still, h), moved(&x, &v, &still, -h));
        let slope = (y.value(&plus) - y.value(&minus)) / (2.0 * h);
        let along: f64 = gradient(&x).iter().zip(&v).map(|(g, v)| g * v).sum();
        // h^2 times third derivatives of some tens.
        assert!((slope - along).abs() < 1e-8, "{slope} {along}");
        for (i, (p, m)) in gradient(&plus).iter().zip(gradient(&minus)).enumerate() {
            let row: f64 = hessian[12 * i..12 * i + 12].iter().zip(&v).map(|(h, v)| h * v).sum();
            let slope = (p - m) / (2.0 * h);
            assert!((slope - row).abs() < 1e-7, "row {i}: {slope} {row}");
        }
        // Time derivatives, at zero jerk.
        let f = |t: f64| y.value(&moved(&x, &v, &a, t));
        let s = 2e-3;
        let f: Vec<f64> = (-3..=3).map(|k| f(f64::from(k) * s)).collect();
        let first = (f[4] - f[2]) * 0.75 - (f[5] - f[1]) * 0.15 + (f[6] - f[0]) / 60.0;
        let second = (f[4] + f[2]) * 1.5 - (f[5] + f[1]) * 0.15 + (f[6] + f[0]) / 90.0
            - f[3] * (49.0 / 18.0);
        let third = (f[4] - f[2]) * (-13.0 / 8.0) + (f[5] - f[1]) - (f[6] - f[0]) / 8.0;
        let found = y.motion(&x, &v, &a);
        for (k, difference, tolerance) in
            [(1, first / s, 1e-9), (2, second / (s * s), 1e-7), (3, third / s.powi(3), 1e-3)]
        {
            assert!((found[k] - difference).abs() < tolerance, "{k}: {} {difference}", found[k]);
        }
    }

    #[test]
    fn turns_of_the_second_sheet_are_the_angle() {
        let y = fold();
        for angle in [-2.5_f64, -0.4, 0.0, 1.0, 3.0] {
            let (s, c) = angle.sin_cos();
            let mut x = vec![0.0; 12];
            // t along z, u along x and w turned about z; both lean along t.
            x[2] = 2.0;
            (x[6], x[8]) = (0.5, 0.3);
            (x[9], x[10], x[11]) = (3.0 * c, 3.0 * s, -0.7);
            assert!((y.value(&x) - angle).abs() < 1e-14, "{} {angle}", y.value(&x));
        }
    }
}
