//! Vectors of space over any kind of number.

use std::ops::{Add, Neg, Sub};

use crate::real::Real;

/// A vector with three components.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vec3<T> {
    /// First component.
    pub x: T,
    /// Second component.
    pub y: T,
    /// Third component.
    pub z: T,
}

impl<T: Real> Vec3<T> {
    /// From components.
    #[inline(always)]
    pub fn new(x: T, y: T, z: T) -> Self {
        Self { x, y, z }
    }

    /// The zero vector, of the kind of `like`.
    #[inline(always)]
    pub fn zero(like: T) -> Self {
        Self::new(like.zero(), like.zero(), like.zero())
    }

    /// The components.
    #[inline(always)]
    pub fn array(self) -> [T; 3] {
        [self.x, self.y, self.z]
    }

    /// Scalar product.
    #[inline(always)]
    pub fn dot(self, b: Self) -> T {
        self.z.mul_add(b.z, self.y.mul_add(b.y, self.x * b.x))
    }

    /// Scalar product plus `c`.
    #[inline(always)]
    pub fn dot_add(self, b: Self, c: T) -> T {
        self.z.mul_add(b.z, self.y.mul_add(b.y, self.x.mul_add(b.x, c)))
    }

    /// Vector product.
    #[inline(always)]
    pub fn cross(self, b: Self) -> Self {
        Self::new(
            self.z.negate_mul_add(b.y, self.y * b.z),
            self.x.negate_mul_add(b.z, self.z * b.x),
            self.y.negate_mul_add(b.x, self.x * b.y),
        )
    }

    /// `s self`.
    #[inline(always)]
    pub fn times(self, s: T) -> Self {
        Self::new(self.x * s, self.y * s, self.z * s)
    }

    /// `c self` for a plain number.
    #[inline(always)]
    pub fn scale(self, c: f64) -> Self {
        self.times(self.x.constant(c))
    }

    /// `self + s b`.
    #[inline(always)]
    pub fn add_times(self, s: T, b: Self) -> Self {
        Self::new(b.x.mul_add(s, self.x), b.y.mul_add(s, self.y), b.z.mul_add(s, self.z))
    }

    /// `self + c b` for a plain number `c`.
    #[inline(always)]
    pub fn add_scaled(self, c: f64, b: Self) -> Self {
        self.add_times(self.x.constant(c), b)
    }
}

impl<T: Real> Add for Vec3<T> {
    type Output = Self;
    #[inline(always)]
    fn add(self, b: Self) -> Self {
        Self::new(self.x + b.x, self.y + b.y, self.z + b.z)
    }
}

impl<T: Real> Sub for Vec3<T> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, b: Self) -> Self {
        Self::new(self.x - b.x, self.y - b.y, self.z - b.z)
    }
}

impl<T: Real> Neg for Vec3<T> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self::new(-self.x, -self.y, -self.z)
    }
}

impl From<[f64; 3]> for Vec3<f64> {
    fn from(c: [f64; 3]) -> Self {
        Self::new(c[0], c[1], c[2])
    }
}
