//! Decimals of any length: sums and products that nothing rounds.

use std::cmp::Ordering;
use std::ops::{Add, Mul, Sub};

use dashu_int::ops::BitTest;
use dashu_int::{IBig, Sign, UBig};

use crate::cpu::Wide;

/// A whole number times a power of ten. Unlike a fraction it needs no common divisor, which takes most of a fraction's time.
#[derive(Debug, Clone, Default)]
pub(crate) struct Decimal {
    digits: IBig,
    exponent: i32,
}

impl Decimal {
    /// The shortest decimal that reads as `x`, which is finite.
    pub(crate) fn shortest(x: f64) -> Self {
        let text = format!("{x:e}");
        let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
        let places =
            mantissa.split_once('.').map_or(0, |(_, fraction)| i32::try_from(fraction.len()).unwrap_or_default());
        let digits: i64 = mantissa.replace('.', "").parse().unwrap_or_default();
        Self { digits: digits.into(), exponent: exponent.parse::<i32>().unwrap_or_default() - places }
    }

    /// Times 2ᵏ, to the nearest number of `T` but for a unit.
    pub(crate) fn rounded<T: Wide>(&self, k: i32) -> T {
        // More bits than a `T` has.
        let bits = 54 * (T::PARTS + 1);
        let power = UBig::from(10_u8).pow(self.exponent.unsigned_abs() as usize);
        // A whole number over 2ˢ.
        let (whole, shift) = if self.exponent >= 0 {
            (&self.digits * power, 0)
        } else {
            let shift = bits + power.bit_len();
            ((&self.digits << shift) / power, shift)
        };
        let excess = whole.bit_len().saturating_sub(bits);
        let places = i32::try_from(excess).unwrap_or(i32::MAX) - i32::try_from(shift).unwrap_or(i32::MAX);
        let mut rest = whole >> excess;
        let mut sum = T::ZERO;
        for _ in 0..T::PARTS {
            let part = rest.to_f64().value();
            rest -= IBig::try_from(part).unwrap_or_default();
            sum += T::from_f64(part);
        }
        sum.times_power_of_two(k + places)
    }

    /// Its sign.
    pub(crate) fn sign(&self) -> Ordering {
        match self.digits.sign() {
            _ if self.digits.is_zero() => Ordering::Equal,
            Sign::Negative => Ordering::Less,
            Sign::Positive => Ordering::Greater,
        }
    }

    /// Of both, their digits above the lesser of their exponents.
    fn aligned(&self, other: &Self, joined: impl FnOnce(IBig, IBig) -> IBig) -> Self {
        // The exponent of 0 says nothing.
        let exponent = match (self.digits.is_zero(), other.digits.is_zero()) {
            (true, _) => other.exponent,
            (_, true) => self.exponent,
            _ => self.exponent.min(other.exponent),
        };
        let above = |it: &Self| match (it.exponent - exponent).unsigned_abs() as usize {
            _ if it.digits.is_zero() => IBig::ZERO,
            0 => it.digits.clone(),
            places => &it.digits * UBig::from(10_u8).pow(places),
        };
        Self { digits: joined(above(self), above(other)), exponent }
    }
}

impl From<i64> for Decimal {
    fn from(x: i64) -> Self {
        Self { digits: x.into(), exponent: 0 }
    }
}

impl Add for &Decimal {
    type Output = Decimal;
    fn add(self, other: Self) -> Decimal {
        self.aligned(other, |a, b| a + b)
    }
}

impl Sub for &Decimal {
    type Output = Decimal;
    fn sub(self, other: Self) -> Decimal {
        self.aligned(other, |a, b| a - b)
    }
}

impl Mul for &Decimal {
    type Output = Decimal;
    fn mul(self, other: Self) -> Decimal {
        Decimal { digits: &self.digits * &other.digits, exponent: self.exponent + other.exponent }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_the_decimals_of_the_file() {
        for (x, digits, exponent) in [
            (0.1, 1, -1),
            (-1.1, -11, -1),
            (0.0, 0, 0),
            (-0.0, 0, 0),
            (3.0, 3, 0),
            (1e22, 1, 22),
            (-2.5e-7, -25, -8),
            (123_456.75, 12_345_675, -2),
            (f64::MAX, 17_976_931_348_623_157_i64, 292),
            (5e-324, 5, -324),
        ] {
            let Decimal { digits: found, exponent: power } = Decimal::shortest(x);
            assert_eq!((found, power), (IBig::from(digits), exponent), "{x}");
        }
    }

    #[test]
    fn sums_and_products_are_exact() {
        let [tenth, fifth, three_tenths] = [0.1, 0.2, 0.3].map(Decimal::shortest);
        assert_eq!((&(&tenth + &fifth) - &three_tenths).sign(), Ordering::Equal);
        assert_eq!((&(&tenth * &fifth) - &Decimal::shortest(0.02)).sign(), Ordering::Equal);
        let [most, least, zero] = [f64::MAX, -5e-324, 0.0].map(Decimal::shortest);
        // The least number is not lost beside the greatest.
        assert_eq!((&(&most + &least) - &most).sign(), Ordering::Less);
        assert_eq!((&(&most * &least) + &zero).sign(), Ordering::Less);
        assert_eq!((&zero - &least).sign(), Ordering::Greater);
    }
}
