//! Values with their first three time derivatives: what constraints that move in time are made of.

use nalgebra::Vector3;

/// A number and its first three time derivatives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jet(pub [f64; 4]);

/// A vector and its first three time derivatives.
pub type VectorJet = [Vector3<f64>; 4];

/// Binomial coefficients.
const BINOMIAL: [[f64; 4]; 4] =
    [[1.0, 0.0, 0.0, 0.0], [1.0, 1.0, 0.0, 0.0], [1.0, 2.0, 1.0, 0.0], [1.0, 3.0, 3.0, 1.0]];

/// Derivatives of a product by the rule of Leibniz.
pub fn leibniz<A: Copy, B: Copy, C: std::ops::Add<Output = C>>(
    a: &[A; 4],
    b: &[B; 4],
    times: impl Fn(f64, A, B) -> C,
) -> [C; 4] {
    std::array::from_fn(|n| {
        let mut sum = times(BINOMIAL[n][0], a[0], b[n]);
        for k in 1..=n {
            sum = sum + times(BINOMIAL[n][k], a[k], b[n - k]);
        }
        sum
    })
}

impl Jet {
    /// A constant.
    #[must_use]
    pub fn constant(x: f64) -> Self {
        Self([x, 0.0, 0.0, 0.0])
    }

    /// Sum.
    #[must_use]
    pub fn plus(self, other: Self) -> Self {
        Self(std::array::from_fn(|k| self.0[k] + other.0[k]))
    }

    /// Product.
    #[must_use]
    pub fn times(self, other: Self) -> Self {
        Self(leibniz(&self.0, &other.0, |c, a: f64, b: f64| c * a * b))
    }

    /// f(x), with f and its first three derivatives at x.
    #[must_use]
    pub fn chain(self, [f, f1, f2, f3]: [f64; 4]) -> Self {
        let [_, x1, x2, x3] = self.0;
        let second = f2 * x1 * x1 + f1 * x2;
        Self([f, f1 * x1, second, f3 * x1.powi(3) + 3.0 * f2 * x1 * x2 + f1 * x3])
    }

    /// 1/x.
    #[must_use]
    pub fn inverse(self) -> Self {
        let y = 1.0 / self.0[0];
        self.chain([y, -y * y, 2.0 * y.powi(3), -6.0 * y.powi(4)])
    }

    /// x^(-1/2).
    #[must_use]
    pub fn inverse_root(self) -> Self {
        let x = self.0[0];
        let y = 1.0 / x.sqrt();
        self.chain([y, -0.5 * y / x, 0.75 * y / (x * x), -1.875 * y / (x * x * x)])
    }
}

/// `a.b`
#[must_use]
pub fn dot(a: &VectorJet, b: &VectorJet) -> Jet {
    Jet(leibniz(a, b, |c, a: Vector3<f64>, b: Vector3<f64>| c * a.dot(&b)))
}

/// `f a`
#[must_use]
pub fn scaled(f: Jet, a: &VectorJet) -> VectorJet {
    leibniz(&f.0, a, |c, f: f64, a: Vector3<f64>| a * (c * f))
}

/// A vector that does not move.
#[must_use]
pub fn fixed(a: Vector3<f64>) -> VectorJet {
    [a, Vector3::zeros(), Vector3::zeros(), Vector3::zeros()]
}

/// `a/|a|`
#[must_use]
pub fn unit(a: &VectorJet) -> VectorJet {
    scaled(dot(a, a).inverse_root(), a)
}

/// The vector p, normal to the unit vector d_0, carried along as d_0 turns to the unit vector d on the shortest way:
/// `p - (d.p)/(1 + d_0.d) (d_0 + d)`.
#[must_use]
pub fn carried(p: Vector3<f64>, d_0: Vector3<f64>, d: &VectorJet) -> VectorJet {
    let (p, d_0) = (fixed(p), fixed(d_0));
    let one = Jet::constant(1.0);
    let f = dot(d, &p).times(one.plus(dot(&d_0, d)).inverse());
    let sum: VectorJet = std::array::from_fn(|k| d_0[k] + d[k]);
    let part = scaled(f, &sum);
    std::array::from_fn(|k| p[k] - part[k])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A vector that turns and grows, as a polynomial of time about 0.
    fn course(t: f64) -> Vector3<f64> {
        Vector3::new(1.0 + 0.3 * t - 0.2 * t * t, 0.5 * t + 0.4 * t * t * t, 0.2 + 0.1 * t * t)
    }

    #[test]
    fn derivatives_agree_with_differences() {
        let jet = [
            course(0.0),
            Vector3::new(0.3, 0.5, 0.0),
            Vector3::new(-0.4, 0.0, 0.2),
            Vector3::new(0.0, 2.4, 0.0),
        ];
        let start = course(-0.5).normalize();
        let p = start.cross(&Vector3::z());
        let found = carried(p, start, &unit(&jet));
        let value = |t: f64| carried(p, start, &fixed(course(t).normalize()))[0];
        let h = 1e-2;
        let f: Vec<Vector3<f64>> = (-3..=3).map(|k| value(f64::from(k) * h)).collect();
        let first = (f[4] - f[2]) * 0.75 - (f[5] - f[1]) * 0.15 + (f[6] - f[0]) / 60.0;
        let second = (f[4] + f[2]) * 1.5 - (f[5] + f[1]) * 0.15 + (f[6] + f[0]) / 90.0
            - f[3] * (49.0 / 18.0);
        let third = (f[4] - f[2]) * (-13.0 / 8.0) + (f[5] - f[1]) - (f[6] - f[0]) / 8.0;
        // Errors of differences: h^6, h^6 and h^4 times higher derivatives.
        for (k, difference, tolerance) in
            [(1, first / h, 1e-9), (2, second / (h * h), 1e-8), (3, third / h.powi(3), 1e-5)]
        {
            assert!((found[k] - difference).norm() < tolerance, "{k}: {} {difference}", found[k]);
        }
        // Carried along: as long as before, and normal to the direction.
        assert!((found[0].norm() - p.norm()).abs() < 1e-14);
        assert!(found[0].dot(&course(0.0)).abs() < 1e-14);
    }
}
