//! Numerical derivatives for tests.

use crate::dual::Dual;

/// Jacobian of `f` at `x` by central differences of second order with step `h`: `jacobian[i][j] = df_i/dx_j`.
pub fn central_difference(
    x: &[f64],
    h: f64,
    mut f: impl FnMut(&[f64]) -> Vec<f64>,
) -> Vec<Vec<f64>> {
    let mut point = x.to_vec();
    let columns: Vec<Vec<f64>> = (0..x.len())
        .map(|j| {
            point[j] = x[j] + h;
            let plus = f(&point);
            point[j] = x[j] - h;
            let minus = f(&point);
            point[j] = x[j];
            plus.iter().zip(&minus).map(|(p, m)| (p - m) / (2.0 * h)).collect()
        })
        .collect();
    transpose(&columns)
}

/// Jacobian of `f` at `x` by dual numbers: `jacobian[i][j] = df_i/dx_j`, exact to rounding.
pub fn dual_jacobian(x: &[f64], mut f: impl FnMut(&[Dual]) -> Vec<Dual>) -> Vec<Vec<f64>> {
    let mut point: Vec<Dual> = x.iter().map(|&c| Dual::new(c, 0.0)).collect();
    let columns: Vec<Vec<f64>> = (0..x.len())
        .map(|j| {
            point[j].derivative = 1.0;
            let column = f(&point).iter().map(|d| d.derivative).collect();
            point[j].derivative = 0.0;
            column
        })
        .collect();
    transpose(&columns)
}

/// Largest absolute difference of two matrices over the largest absolute entry of the second.
#[must_use]
pub fn relative_error(a: &[Vec<f64>], b: &[Vec<f64>]) -> f64 {
    let size = b.iter().flatten().fold(0.0_f64, |m, c| m.max(c.abs()));
    let error =
        a.iter().flatten().zip(b.iter().flatten()).fold(0.0_f64, |m, (p, q)| m.max((p - q).abs()));
    error / size.max(f64::MIN_POSITIVE)
}

fn transpose(columns: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let rows = columns.first().map_or(0, Vec::len);
    (0..rows).map(|i| columns.iter().map(|c| c[i]).collect()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::real::Real;

    #[test]
    fn both_derivatives_agree_with_the_formula() {
        let x = [0.4, 1.7];
        let exact = vec![vec![
            (x[1] * x[0]).sqrt() * 0.5 / x[0] - 1.0 / x[1],
            (x[1] * x[0]).sqrt() * 0.5 / x[1] + x[0] / (x[1] * x[1]),
        ]];
        fn f<T: Real>(x: &[T]) -> Vec<T> {
            vec![(x[0] * x[1]).sqrt() - x[0] / x[1]]
        }
        assert!(relative_error(&dual_jacobian(&x, f::<Dual>), &exact) < 1e-15);
        assert!(relative_error(&central_difference(&x, 1e-6, f::<f64>), &exact) < 1e-9);
    }
}
