//! Forward-mode dual numbers: derivatives to rounding, to check hand-written ones against.

use std::ops::{Add, Div, Mul, Neg, Sub};

use crate::real::Real;

/// `value + derivative e` with `e^2 = 0`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dual {
    /// Value.
    pub value: f64,
    /// Derivative along the chosen direction.
    pub derivative: f64,
}

impl Dual {
    /// A dual number.
    #[must_use]
    pub const fn new(value: f64, derivative: f64) -> Self {
        Self { value, derivative }
    }
}

impl Add for Dual {
    type Output = Self;
    fn add(self, b: Self) -> Self {
        Self::new(self.value + b.value, self.derivative + b.derivative)
    }
}

impl Sub for Dual {
    type Output = Self;
    fn sub(self, b: Self) -> Self {
        Self::new(self.value - b.value, self.derivative - b.derivative)
    }
}

impl Mul for Dual {
    type Output = Self;
    fn mul(self, b: Self) -> Self {
        Self::new(self.value * b.value, self.value * b.derivative + self.derivative * b.value)
    }
}

impl Div for Dual {
    type Output = Self;
    fn div(self, b: Self) -> Self {
        let value = self.value / b.value;
        Self::new(value, (self.derivative - value * b.derivative) / b.value)
    }
}

impl Neg for Dual {
    type Output = Self;
    fn neg(self) -> Self {
        Self::new(-self.value, -self.derivative)
    }
}

impl Real for Dual {
    fn constant(self, c: f64) -> Self {
        Self::new(c, 0.0)
    }
    fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        Self::new(root, 0.5 * self.derivative / root)
    }
    fn mul_add(self, b: Self, c: Self) -> Self {
        self * b + c
    }
    fn max(self, other: Self) -> Self {
        if self.value >= other.value { self } else { other }
    }
    fn select_positive(self, yes: Self, no: Self) -> Self {
        if self.value > 0.0 { yes } else { no }
    }
    fn ln(self) -> Self {
        Self::new(self.value.ln(), self.derivative / self.value)
    }
    fn asinh(self) -> Self {
        let slope = 1.0 / (1.0 + self.value * self.value).sqrt();
        Self::new(self.value.asinh(), slope * self.derivative)
    }
}
