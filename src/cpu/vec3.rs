//! A three-vector over any [`Real`]; glam's vectors are `f32` and `f64` only.

use std::ops::{Add, AddAssign, Mul, Neg, Sub};

use glam::DVec3;

use super::real::Real;
use super::shade::max;

/// A vector of three [`Real`]s; `*` between two vectors is componentwise, as in WGSL.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Vec3<T> {
    /// First component.
    pub x: T,
    /// Second component.
    pub y: T,
    /// Third component.
    pub z: T,
}

impl<T: Real> Vec3<T> {
    /// (0, 0, 0).
    pub(crate) const ZERO: Self = Self { x: T::ZERO, y: T::ZERO, z: T::ZERO };

    /// The vector (x, y, z).
    pub(crate) fn new(x: T, y: T, z: T) -> Self {
        Self { x, y, z }
    }

    /// The nearest vector of this type.
    pub(crate) fn from_f64(v: DVec3) -> Self {
        Self::new(T::from_f64(v.x), T::from_f64(v.y), T::from_f64(v.z))
    }

    /// The nearest `f64` vector.
    pub(crate) fn to_f64(self) -> DVec3 {
        DVec3::new(self.x.to_f64(), self.y.to_f64(), self.z.to_f64())
    }

    /// Scalar product.
    pub(crate) fn dot(self, other: Self) -> T {
        self.x * other.x + self.y * other.y + self.z * other.z
    }

    /// This vector over its length.
    pub(crate) fn normalize(self) -> Self {
        self * (T::ONE / self.dot(self).sqrt())
    }
}

/// |v|.
pub(super) fn length<T: Real>(v: Vec3<T>) -> T {
    v.dot(v).sqrt()
}

/// The greatest component.
pub(super) fn largest<T: Real>(v: Vec3<T>) -> T {
    max(v.x, max(v.y, v.z))
}

impl<T: Real> Add for Vec3<T> {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self::new(self.x + other.x, self.y + other.y, self.z + other.z)
    }
}

impl<T: Real> AddAssign for Vec3<T> {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl<T: Real> Sub for Vec3<T> {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self::new(self.x - other.x, self.y - other.y, self.z - other.z)
    }
}

impl<T: Real> Neg for Vec3<T> {
    type Output = Self;
    fn neg(self) -> Self {
        Self::new(-self.x, -self.y, -self.z)
    }
}

impl<T: Real> Mul for Vec3<T> {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        Self::new(self.x * other.x, self.y * other.y, self.z * other.z)
    }
}

impl<T: Real> Mul<T> for Vec3<T> {
    type Output = Self;
    fn mul(self, factor: T) -> Self {
        Self::new(self.x * factor, self.y * factor, self.z * factor)
    }
}
