//! Passes over whole vectors, compiled for the vector registers of the processor at hand.

use pulp::{Arch, Simd, WithSimd};

/// Runs plain loops with the widest instructions of the processor. Nothing is fused or reordered: bits are the same
/// on every processor.
#[inline(always)]
pub(crate) fn vectorised<T>(pass: impl FnOnce() -> T) -> T {
    Arch::new().dispatch(Pass(pass))
}

struct Pass<F>(F);

impl<T, F: FnOnce() -> T> WithSimd for Pass<F> {
    type Output = T;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> T {
        (self.0)()
    }
}
