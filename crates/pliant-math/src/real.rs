//! Numbers that element kernels are written in: plain `f64`, lanes of a vector register, dual numbers.

use std::ops::{Add, Div, Mul, Neg, Sub};

use pulp::Simd;

/// A real number, or several at once.
///
/// A kernel written over `Real` is compiled for scalars, for every vector width and for dual numbers from one source.
/// Constants are made from a number at hand, because vector lanes carry the proof that the instruction set exists.
pub trait Real:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// The constant `c` as a number of the same kind as `self`.
    fn constant(self, c: f64) -> Self;
    /// Square root.
    fn sqrt(self) -> Self;
    /// `self * b + c`, fused only where the hardware does it in one instruction.
    fn mul_add(self, b: Self, c: Self) -> Self;
    /// The larger one.
    fn max(self, other: Self) -> Self;
    /// `yes` where `self > 0`, else `no`.
    fn select_positive(self, yes: Self, no: Self) -> Self;
    /// Inverse hyperbolic sine; a slow path for vector lanes, meant for energies.
    fn asinh(self) -> Self;
    /// Natural logarithm; a slow path for vector lanes, meant for energies.
    fn ln(self) -> Self;

    /// Zero.
    #[inline(always)]
    fn zero(self) -> Self {
        self.constant(0.0)
    }

    /// `c - self * b`, fused only where the hardware does it in one instruction.
    #[inline(always)]
    fn negate_mul_add(self, b: Self, c: Self) -> Self {
        (-self).mul_add(b, c)
    }

    /// `c self` for a plain number `c`.
    #[inline(always)]
    fn scale(self, c: f64) -> Self {
        self * self.constant(c)
    }

    /// Absolute value.
    #[inline(always)]
    fn abs(self) -> Self {
        self.select_positive(self, -self)
    }

    /// Square.
    #[inline(always)]
    fn square(self) -> Self {
        self * self
    }

    /// Reciprocal.
    #[inline(always)]
    fn recip(self) -> Self {
        self.constant(1.0) / self
    }
}

impl Real for f64 {
    #[inline(always)]
    fn constant(self, c: f64) -> Self {
        c
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        f64::sqrt(self)
    }
    #[inline(always)]
    fn mul_add(self, b: Self, c: Self) -> Self {
        // Without hardware support a fused operation is a slow library call.
        if cfg!(target_feature = "fma") { f64::mul_add(self, b, c) } else { self * b + c }
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        f64::max(self, other)
    }
    #[inline(always)]
    fn select_positive(self, yes: Self, no: Self) -> Self {
        if self > 0.0 { yes } else { no }
    }
    #[inline(always)]
    fn asinh(self) -> Self {
        f64::asinh(self)
    }
    #[inline(always)]
    fn ln(self) -> Self {
        f64::ln(self)
    }
}

/// The lanes of one vector register of the instruction set `S`.
#[derive(Clone, Copy, Debug)]
pub struct Lanes<S: Simd> {
    simd: S,
    value: S::f64s,
}

impl<S: Simd> Lanes<S> {
    /// Number of lanes.
    pub const COUNT: usize = S::F64_LANES;

    /// All lanes equal to `c`.
    #[inline(always)]
    pub fn splat(simd: S, c: f64) -> Self {
        Self { simd, value: simd.splat_f64s(c) }
    }

    /// Lanes from the first [`Self::COUNT`] entries of `from`, which must have so many.
    #[inline(always)]
    pub fn load(simd: S, from: &[f64]) -> Self {
        Self { simd, value: S::as_simd_f64s(from).0[0] }
    }

    /// Writes the lanes to the first [`Self::COUNT`] entries of `to`, which must have so many.
    #[inline(always)]
    pub fn store(self, to: &mut [f64]) {
        S::as_mut_simd_f64s(to).0[0] = self.value;
    }

    #[inline(always)]
    fn with(self, value: S::f64s) -> Self {
        Self { simd: self.simd, value }
    }

    /// One lane after the other.
    #[inline(always)]
    fn each(self, function: impl Fn(f64) -> f64) -> Self {
        let mut lanes = [0.0; 8];
        self.store(&mut lanes[..Self::COUNT]);
        for x in &mut lanes {
            *x = function(*x);
        }
        Self::load(self.simd, &lanes[..Self::COUNT])
    }
}

impl<S: Simd> Add for Lanes<S> {
    type Output = Self;
    #[inline(always)]
    fn add(self, b: Self) -> Self {
        self.with(self.simd.add_f64s(self.value, b.value))
    }
}

impl<S: Simd> Sub for Lanes<S> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, b: Self) -> Self {
        self.with(self.simd.sub_f64s(self.value, b.value))
    }
}

impl<S: Simd> Mul for Lanes<S> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, b: Self) -> Self {
        self.with(self.simd.mul_f64s(self.value, b.value))
    }
}

impl<S: Simd> Div for Lanes<S> {
    type Output = Self;
    #[inline(always)]
    fn div(self, b: Self) -> Self {
        self.with(self.simd.div_f64s(self.value, b.value))
    }
}

impl<S: Simd> Neg for Lanes<S> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        // -0 - x is the exact negation, and compilers fold it into fused operations.
        self.with(self.simd.sub_f64s(self.simd.splat_f64s(-0.0), self.value))
    }
}

impl<S: Simd> Real for Lanes<S> {
    #[inline(always)]
    fn constant(self, c: f64) -> Self {
        Self::splat(self.simd, c)
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        self.with(self.simd.sqrt_f64s(self.value))
    }
    #[inline(always)]
    fn mul_add(self, b: Self, c: Self) -> Self {
        self.with(self.simd.mul_add_e_f64s(self.value, b.value, c.value))
    }
    #[inline(always)]
    fn negate_mul_add(self, b: Self, c: Self) -> Self {
        self.with(self.simd.negate_mul_add_e_f64s(self.value, b.value, c.value))
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        self.with(self.simd.max_f64s(self.value, other.value))
    }
    #[inline(always)]
    fn select_positive(self, yes: Self, no: Self) -> Self {
        let positive = self.simd.greater_than_f64s(self.value, self.simd.splat_f64s(0.0));
        self.with(self.simd.select_f64s(positive, yes.value, no.value))
    }
    #[inline(always)]
    fn asinh(self) -> Self {
        self.each(f64::asinh)
    }
    #[inline(always)]
    fn ln(self) -> Self {
        self.each(f64::ln)
    }
}
