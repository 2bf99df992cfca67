//! Double-double numbers: the unevaluated sum of two `f64`s, about 106 significant bits.
//!
//! The reference runs in this type where tests need the truth. u = 2⁻⁵³ is the unit roundoff of `f64`. Every operation
//! cites its algorithm and a proven bound of its relative error:
//!
//! | operation | algorithm | bound |
//! |---|---|---|
//! | + − | `AccurateDWPlusDW` \[1, algorithm 6\] | 3u² + 13u³ |
//! | × | `DWTimesDW1` \[1, algorithm 10\] | 5u² \[2\] |
//! | ÷ | `DWDivDW2` \[1, algorithm 17\] | 15u² + 56u³ |
//! | √ | `SQRTDWtoDW` \[3, algorithm 8\] | 25/8 u² |
//!
//! 1. Joldes, Muller, Popescu, "Tight and Rigorous Error Bounds for Basic Building Blocks of Double-Word Arithmetic",
//!    ACM Transactions on Mathematical Software 44(2), 2017.
//! 2. Muller, Rideau, "Formalization of Double-Word Arithmetic, and Comments on \[1\]", the same journal, 48(1), 2022.
//! 3. Lefèvre, Louvet, Muller, Picot, Rideau, "Accurate Calculation of Euclidean Norms Using Double-Word Arithmetic", the
//!    same journal, 49(1), 2023.
//!
//! The bounds hold while operands and results (for ÷ and √ that includes the operand on the left) lie between 2⁻⁹⁶⁰ and
//! 2¹⁰²⁰, about 1e-289 and 1e307, or are 0: below, the low part has not enough bits left. A sum needs no lower limit.
//!
//! Products are split by Veltkamp and Dekker rather than with a fused multiply-add: targets without that instruction
//! compiled in (x86-64 by default) would pay for a function call three times as long as the whole product.

use std::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub};

use super::real::{Real, Wide};
use crate::accel::Rounding;
use crate::brightness::Scalar;

/// ln 2 as the sum of three `f64`s, to 2⁻¹⁶⁰.
const LN_2: [f64; 3] = [std::f64::consts::LN_2, 2.319_046_813_846_299_6e-17, 5.707_708_438_416_212e-34];

/// A number hi + lo with hi the `f64` nearest to the sum, so |lo| ≤ ½ ulp(hi).
///
/// Infinities and NaN are those of `f64` in hi, with lo = 0; division by zero and roots of negative numbers give what
/// they give in `f64`. Values are compared exactly.
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd)]
pub struct Dd {
    hi: f64,
    lo: f64,
}

impl Dd {
    /// a + b, exactly.
    pub fn from_sum(a: f64, b: f64) -> Self {
        let (hi, lo) = two_sum(a, b);
        if lo.is_finite() { Self { hi, lo } } else { Self::from(hi) }
    }

    /// a·b, exactly while it lies between 2⁻⁹⁶⁰ and 2¹⁰²⁰.
    pub fn from_product(a: f64, b: f64) -> Self {
        let (hi, lo) = two_product(a, b);
        if lo.is_finite() { Self { hi, lo } } else { Self::from(hi) }
    }

    /// The nearest `f64`.
    pub fn hi(self) -> f64 {
        self.hi
    }

    /// What `hi` leaves over: at most half a unit in its last place.
    pub fn lo(self) -> f64 {
        self.lo
    }

    /// |x|.
    pub fn abs(self) -> Self {
        if self.hi.is_sign_negative() { -self } else { self }
    }

    /// hi + lo for |hi| ≥ |lo| or hi = 0; only hi where it is at overflow or beyond.
    #[inline]
    fn renormalized(hi: f64, lo: f64) -> Self {
        let (sum, error) = fast_two_sum(hi, lo);
        if error.is_finite() { Self { hi: sum, lo: error } } else { Self::from(hi) }
    }

    /// `AccurateDWPlusDW`.
    #[inline]
    fn plus(self, other: Self) -> Self {
        let (high, high_error) = two_sum(self.hi, other.hi);
        if !high.is_finite() {
            return Self::from(high);
        }
        let (low, low_error) = two_sum(self.lo, other.lo);
        let (sum, error) = fast_two_sum(high, high_error + low);
        Self::renormalized(sum, low_error + error)
    }

    /// `DWTimesDW1`.
    #[inline]
    fn times(self, other: Self) -> Self {
        let (product, error) = two_product(self.hi, other.hi);
        if !product.is_finite() {
            return Self::from(product);
        }
        let cross = self.hi * other.lo + self.lo * other.hi;
        Self::renormalized(product, error + cross)
    }

    /// `DWTimesFP1`: relative error at most 3/2 u² + 4u³.
    #[inline]
    fn times_f64(self, factor: f64) -> Self {
        let (product, error) = two_product(self.hi, factor);
        let (sum, sum_error) = fast_two_sum(product, self.lo * factor);
        Self::renormalized(sum, sum_error + error)
    }

    /// `DWDivDW2`.
    #[inline]
    fn over(self, divisor: Self) -> Self {
        let quotient = self.hi / divisor.hi;
        if !quotient.is_finite() || quotient == 0.0 || !divisor.hi.is_finite() {
            return Self::from(quotient);
        }
        let product = divisor.times_f64(quotient);
        let remainder = (self.hi - product.hi) + (self.lo - product.lo);
        Self::renormalized(quotient, remainder / divisor.hi)
    }

    /// eˣ − 1 for |x| ≤ 0.7, with a relative error below 1e-30.
    ///
    /// The Taylor polynomial at x/2⁷ (its first omitted term is below 1e-35 of the sum), then seven times
    /// e²ʸ − 1 = (eʸ − 1)(eʸ + 1), each of which multiplies the error by at most 1 + 8u² beside what it amplifies.
    fn exp_m1(self) -> Self {
        const DOUBLINGS: i32 = 7;
        const DEGREE: u32 = 12;
        let y = self.times_power_of_two(-DOUBLINGS);
        let factor = |sum: Self, n: u32| Self::ONE + y * sum / Self::from(f64::from(n));
        let mut power = y * (2..=DEGREE).rev().fold(Self::ONE, factor);
        for _ in 0..DOUBLINGS {
            power *= power + Self::from(2.0);
        }
        power
    }

    /// y + ln(1 + δ) for a y near the logarithm and the tiny δ that it lacks.
    fn corrected_logarithm(y: f64, delta: Self) -> Self {
        Self::from(y) + (delta - delta * delta * Self::from(0.5))
    }
}

impl From<f64> for Dd {
    #[inline]
    fn from(x: f64) -> Self {
        Self { hi: x, lo: 0.0 }
    }
}

impl Real for Dd {
    const ZERO: Self = Self { hi: 0.0, lo: 0.0 };
    const ONE: Self = Self { hi: 1.0, lo: 0.0 };
    const FAR: Self = Self { hi: 3e38, lo: 0.0 };
    const MAX_THROUGHPUT: Self = Self { hi: Scalar::Double.max_throughput(), lo: 0.0 };
    const UNIT: f64 = 2e-31;
    const PROVES: bool = false;
    const ROUNDING: Rounding = Rounding::DOUBLE;

    #[inline]
    fn from_f64(x: f64) -> Self {
        Self::from(x)
    }

    #[inline]
    fn to_f64(self) -> f64 {
        self.hi
    }

    #[inline]
    fn abs(self) -> Self {
        if self.hi < 0.0 { -self } else { self }
    }

    /// `SQRTDWtoDW`.
    fn sqrt(self) -> Self {
        let root = self.hi.sqrt();
        if !root.is_finite() || root == 0.0 {
            return Self::from(root);
        }
        let (square, error) = two_product(root, root);
        let remainder = self.lo + ((self.hi - square) - error);
        Self::renormalized(root, remainder / (2.0 * root))
    }

    /// Relative error below 1e-30 (1e-31 measured) where the result is greater than 1e-270.
    fn exp(self) -> Self {
        // Beyond ±746 the result is 0 or infinite, and a NaN passes through.
        if !(self.hi.abs() < 746.0) {
            return Self::from(self.hi.exp());
        }
        let k = (self.hi * std::f64::consts::LOG2_E).round();
        let rest = LN_2.iter().fold(self, |rest, &part| rest - Self::from_product(k, part));
        (rest.exp_m1() + Self::ONE).times_power_of_two(k as i32)
    }

    /// Relative error below 1e-30 (1e-31 measured) where 1 + x lies between 1e-270 and 1e308.
    ///
    /// One step from the logarithm y in `f64`: ln w = y + ln(1 + δ) with δ = w·e⁻ʸ − 1 of about 1e-16.
    fn log1p(self) -> Self {
        let w = self + Self::ONE;
        if !(w.hi > 0.0 && w.hi.is_finite()) {
            return Self::from(w.hi.ln());
        }
        if self.hi.abs() < 0.5 {
            let y = self.hi.ln_1p();
            let power = Self::from(y).exp_m1();
            Self::corrected_logarithm(y, (self - power) / (power + Self::ONE))
        } else {
            let y = w.hi.ln();
            let power = Self::from(y).exp();
            Self::corrected_logarithm(y, (w - power) / power)
        }
    }

    #[inline]
    fn is_finite(self) -> bool {
        self.hi.is_finite()
    }
}

impl Wide for Dd {
    const PARTS: usize = 2;

    fn times_power_of_two(self, k: i32) -> Self {
        let half = power_of_two(k / 2);
        let rest = power_of_two(k - k / 2);
        Self::renormalized(self.hi * half * rest, self.lo * half * rest)
    }
}

impl Add for Dd {
    type Output = Self;
    #[inline]
    fn add(self, other: Self) -> Self {
        self.plus(other)
    }
}

impl Sub for Dd {
    type Output = Self;
    #[inline]
    fn sub(self, other: Self) -> Self {
        self.plus(other.neg())
    }
}

impl Mul for Dd {
    type Output = Self;
    #[inline]
    fn mul(self, other: Self) -> Self {
        self.times(other)
    }
}

impl Div for Dd {
    type Output = Self;
    #[inline]
    fn div(self, other: Self) -> Self {
        self.over(other)
    }
}

impl Neg for Dd {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        Self { hi: -self.hi, lo: -self.lo }
    }
}

impl AddAssign for Dd {
    #[inline]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl MulAssign for Dd {
    #[inline]
    fn mul_assign(&mut self, other: Self) {
        *self = *self * other;
    }
}

/// a + b and its rounding error, exactly (Knuth, Møller).
#[inline]
fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let b_part = sum - a;
    let a_part = sum - b_part;
    (sum, (a - a_part) + (b - b_part))
}

/// a + b and its rounding error, exactly, for |a| ≥ |b| or a = 0 (Dekker).
#[inline]
fn fast_two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    (sum, b - (sum - a))
}

/// a·b and its rounding error, exactly (Dekker, Veltkamp).
#[inline]
fn two_product(a: f64, b: f64) -> (f64, f64) {
    let product = a * b;
    let (a_high, a_low) = split(a);
    let (b_high, b_low) = split(b);
    let high_error = a_high * b_high - product;
    (product, (high_error + a_high * b_low + a_low * b_high) + a_low * b_low)
}

/// A part with the leading 26 bits and the rest, which fits in 26 bits and a sign.
#[inline]
fn split(x: f64) -> (f64, f64) {
    const SPLITTER: f64 = (1_u64 << 27) as f64 + 1.0;
    /// 2⁹⁹⁵, beyond which the product with the splitter overflows.
    const LIMIT: f64 = f64::from_bits((1023 + 995) << 52);
    let split = |x: f64| {
        let product = SPLITTER * x;
        let high = product - (product - x);
        (high, x - high)
    };
    if x.abs() <= LIMIT {
        return split(x);
    }
    let (high, low) = split(x * power_of_two(-28));
    (high * power_of_two(28), low * power_of_two(28))
}

/// 2ᵏ for a normal result.
#[inline]
const fn power_of_two(k: i32) -> f64 {
    f64::from_bits(((1023 + k) as u64) << 52)
}
