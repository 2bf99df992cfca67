//! Numbers of 237 bits, binary256 of IEEE 754: each operation is rounded correctly.
//!
//! Hundreds of times as slow as `f64`, for the few samples with a decision that double-double leaves open.

use std::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub};

use f256::f256;

use super::real::{Real, Wide};
use crate::accel::Rounding;
use crate::brightness::Scalar;
use crate::roundings::TIE;

/// Bits of the fraction in the upper half of the encoding, and what is added to exponents.
const HIGH_BITS: u32 = 108;
const BIAS: i32 = 0x3_ffff;

/// A number of 237 bits.
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd)]
pub(crate) struct Octuple(f256);

impl Octuple {
    /// The same number as `x`, which is normal and positive.
    const fn of_normal(x: f64) -> Self {
        let (exponent, fraction) = (x.to_bits() >> 52, x.to_bits() & ((1 << 52) - 1));
        let exponent = (exponent as i32 - 1023 + BIAS) as u128;
        Self(f256::from_bits((exponent << HIGH_BITS | (fraction as u128) << (HIGH_BITS - 52), 0)))
    }
}

impl Real for Octuple {
    const ZERO: Self = Self(f256::ZERO);
    const ONE: Self = Self(f256::ONE);
    const FAR: Self = Self::of_normal(3e38);
    const MAX_THROUGHPUT: Self = Self::of_normal(Scalar::Double.max_throughput());
    /// 2⁻²³⁷, for all that decides.
    const UNIT: f64 = f64::from_bits((1023 - 237) << 52);
    const PROVES: bool = false;
    const TIE: f64 = TIE;
    const ROUNDING: Rounding = Rounding::DOUBLE;

    fn from_f64(x: f64) -> Self {
        Self(f256::from(x))
    }

    fn to_f64(self) -> f64 {
        if self.0.is_nan() {
            return f64::NAN;
        }
        let (high, low) = self.0.to_bits();
        let exponent = (high >> HIGH_BITS) as i32 & (2 * BIAS + 1);
        let fraction = high & ((1 << HIGH_BITS) - 1);
        // What is below these bits only says that they are not all: enough to round correctly.
        let significand = 1 << HIGH_BITS | fraction | u128::from(low != 0);
        // Beyond this nothing but 0 and infinity is left of it.
        let power = (exponent - BIAS).clamp(-1200, 1200) - HIGH_BITS.cast_signed();
        let half = f64::from(power / 2).exp2();
        let size = significand as f64 * half * f64::from(power - power / 2).exp2();
        if self.0.is_sign_negative() { -size } else { size }
    }

    fn abs(self) -> Self {
        Self(self.0.abs())
    }

    /// Off by no more than a unit in the last place: Heron's steps, each of which doubles the digits of `f64`'s root. The correctly rounded
    /// one of `f256` finds bit by bit.
    fn sqrt(self) -> Self {
        let root = self.to_f64().sqrt();
        if !root.is_normal() {
            return Self(self.0.sqrt());
        }
        Self((0..3).fold(f256::from(root), |root, _| (root + self.0 / root).div2()))
    }

    /// With the bits of `f64`: no decision depends on powers, whose other bits would take most of the time.
    fn exp(self) -> Self {
        Self::from_f64(self.to_f64().exp())
    }

    /// Likewise.
    fn log1p(self) -> Self {
        Self::from_f64(self.to_f64().ln_1p())
    }

    fn is_finite(self) -> bool {
        self.0.is_finite()
    }
}

impl Wide for Octuple {
    const PARTS: usize = 5;

    fn times_power_of_two(self, k: i32) -> Self {
        let places = k.unsigned_abs();
        Self(if k < 0 { self.0.div_pow2(places) } else { self.0.mul_pow2(places) })
    }
}

impl Neg for Octuple {
    type Output = Self;
    fn neg(self) -> Self {
        Self(-self.0)
    }
}

macro_rules! operation {
    ($($trait:ident $method:ident),*) => {
        $(impl $trait for Octuple {
            type Output = Self;
            fn $method(self, other: Self) -> Self {
                Self(self.0.$method(other.0))
            }
        })*
    };
}

operation! { Add add, Sub sub, Mul mul, Div div }

impl AddAssign for Octuple {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl MulAssign for Octuple {
    fn mul_assign(&mut self, other: Self) {
        *self = *self * other;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    #[test]
    fn numbers_of_f64_come_back() {
        let mut random = Random::new(7, 7);
        for _ in 0..10_000 {
            let x = f64::from_bits(random.bits());
            let [x, found] = [x, Octuple::from_f64(x).to_f64()];
            assert!(found.to_bits() == x.to_bits() || (x.is_nan() && found.is_nan()), "{x:e}: {found:e}");
        }
        for x in [0.0, f64::INFINITY, f64::MIN_POSITIVE, 5e-324, f64::MAX, 1.0] {
            assert_eq!([x, -x].map(|x| Octuple::from_f64(x).to_f64().to_bits()), [x, -x].map(f64::to_bits));
        }
        assert_eq!(Octuple::FAR, Octuple::from_f64(3e38));
        assert_eq!(Octuple::MAX_THROUGHPUT, Octuple::from_f64(Scalar::Double.max_throughput()));
    }

    /// To the nearest, by the last of all bits.
    #[test]
    fn conversions_round_to_the_nearest() {
        let [one, unit] = [Octuple::ONE, Octuple::from_f64(2.0 * Octuple::UNIT)];
        let half = Octuple::from_f64(0.5 * f64::EPSILON);
        assert_eq!((one + half).to_f64(), 1.0);
        assert_eq!((one + half + unit).to_f64(), 1.0 + f64::EPSILON);
        assert_eq!((one + half - unit).to_f64(), 1.0);
        assert_eq!((one + Octuple::from_f64(Octuple::UNIT)), one);
    }

    #[test]
    fn roots_have_all_bits() {
        let two = Octuple::from_f64(2.0);
        let mut random = Random::new(7, 8);
        for _ in 0..1000 {
            let x = Octuple::from_f64(random.magnitude(-300.0, 300.0)) / Octuple::from_f64(3.0);
            let [root, exact] = [x.sqrt(), Octuple(x.0.sqrt())];
            assert!((root - exact).abs() <= exact * Octuple::from_f64(2.0 * Octuple::UNIT), "{x:?}");
        }
        // Beyond the range of f64.
        let tiny = Octuple::from_f64(1e-200);
        assert_eq!((tiny * tiny).sqrt(), tiny);
        assert_eq!(Octuple::ZERO.sqrt(), Octuple::ZERO);
        assert!(!(-two).sqrt().is_finite());
        assert_eq!(two.times_power_of_two(-700).times_power_of_two(701), two + two);
    }
}
