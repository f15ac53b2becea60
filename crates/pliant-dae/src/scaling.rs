//! Dimensionless norms.

use crate::passes::vectorised;

/// Absolute value as an integer: the order of the bits of non-negative floats is their order as numbers, with NaN
/// above infinity, so that a maximum over bits is associative and never loses a NaN.
#[inline(always)]
pub(crate) fn magnitude(x: f64) -> u64 {
    x.to_bits() & (u64::MAX >> 1)
}

/// `max |x_i| weight_i`; not finite if any of them is not.
pub(crate) fn weighted_max(x: &[f64], weight: &[f64]) -> f64 {
    let max = || x.iter().zip(weight).fold(0, |m, (x, w)| magnitude(x * w).max(m));
    f64::from_bits(vectorised(max))
}

/// `max |x_i|`; not finite if any of them is not.
pub(crate) fn largest(x: &[f64]) -> f64 {
    f64::from_bits(vectorised(|| x.iter().fold(0, |m, &x| magnitude(x).max(m))))
}

/// Number of the first entry of largest weighted size (NaN above all).
pub(crate) fn worst(x: &[f64], weight: &[f64]) -> usize {
    let mut best = (0, 0);
    for (i, (x, w)) in x.iter().zip(weight).enumerate() {
        let size = magnitude(x * w);
        if size > best.0 {
            best = (size, i);
        }
    }
    best.1
}

/// Number of the first entry that is not finite.
pub(crate) fn first_not_finite(x: &[f64]) -> Option<usize> {
    x.iter().position(|x| !x.is_finite())
}

/// Reciprocals.
pub(crate) fn inverse(scale: &[f64]) -> Vec<f64> {
    scale.iter().map(|s| s.recip()).collect()
}
