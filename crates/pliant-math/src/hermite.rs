//! Cubic Hermite shape functions for `(r1, t1, r2, t2)`, t = dr/dx, on an element of length `length`, xi = x / length.

/// `N(xi)`: `r = N1 r1 + N2 t1 + N3 r2 + N4 t2`.
#[must_use]
pub fn shape(xi: f64, length: f64) -> [f64; 4] {
    let (x2, x3) = (xi * xi, xi * xi * xi);
    [
        1.0 - 3.0 * x2 + 2.0 * x3,
        length * (xi - 2.0 * x2 + x3),
        3.0 * x2 - 2.0 * x3,
        length * (x3 - x2),
    ]
}

/// `dN/dx`.
#[must_use]
pub fn shape_derivative(xi: f64, length: f64) -> [f64; 4] {
    let x2 = xi * xi;
    let d = 6.0 * (xi - x2) / length;
    [-d, 1.0 - 4.0 * xi + 3.0 * x2, d, 3.0 * x2 - 2.0 * xi]
}

/// `d^2N/dx^2`.
#[must_use]
pub fn shape_second_derivative(xi: f64, length: f64) -> [f64; 4] {
    let d = 6.0 * (1.0 - 2.0 * xi) / (length * length);
    [-d, (6.0 * xi - 4.0) / length, d, (6.0 * xi - 2.0) / length]
}

/// `sum_k N_k values_k`, one component after the other.
#[must_use]
pub fn interpolate(shape: &[f64; 4], values: &[[f64; 3]; 4]) -> [f64; 3] {
    std::array::from_fn(|c| (0..4).map(|k| shape[k] * values[k][c]).sum())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reproduces_a_cubic_and_its_derivatives() {
        let (length, c) = (0.7, [0.3, -1.1, 2.0, 0.9]);
        let p = |x: f64| c[0] + x * (c[1] + x * (c[2] + x * c[3]));
        let d = |x: f64| c[1] + x * (2.0 * c[2] + x * 3.0 * c[3]);
        let dd = |x: f64| 2.0 * c[2] + 6.0 * c[3] * x;
        let nodal = [p(0.0), d(0.0), p(length), d(length)];
        let sum = |n: [f64; 4]| (0..4).map(|k| n[k] * nodal[k]).sum::<f64>();
        for xi in [0.0, 0.2, 0.5, 0.9, 1.0] {
            let x = xi * length;
            assert!((sum(shape(xi, length)) - p(x)).abs() < 1e-14);
            assert!((sum(shape_derivative(xi, length)) - d(x)).abs() < 1e-14);
            assert!((sum(shape_second_derivative(xi, length)) - dd(x)).abs() < 1e-13);
        }
    }
}
