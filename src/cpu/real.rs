//! The scalar of the reference: the same source renders in `f64` (the answer) and in `f32` (the shader's precision).

use std::fmt::Debug;
use std::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub};

use crate::accel::Rounding;
use crate::brightness::Scalar;

/// A real number type that the reference can be run in.
pub trait Real:
    Copy
    + Debug
    + PartialOrd
    + Send
    + Sync
    + 'static
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + MulAssign
{
    /// 0.
    const ZERO: Self;
    /// 1.
    const ONE: Self;
    /// A number beyond every accepted distance; greater ones and infinity are never a hit.
    const FAR: Self;

    /// The greatest weight of a ray.
    const MAX_THROUGHPUT: Self;

    /// Unit roundoff of its operations.
    const UNIT: f64;

    /// Whether a picture in this type proves each of its decisions.
    const PROVES: bool;

    /// What is in doubt and lies within so much of a tie, in object space or as a part of what it is compared with, is taken for one; 0 for
    /// a type that does not have the last word.
    const TIE: f64 = 0.0;

    /// How the type rounds.
    const ROUNDING: Rounding;

    /// The nearest value of this type.
    fn from_f64(x: f64) -> Self;
    /// The nearest `f64`.
    fn to_f64(self) -> f64;
    /// |x|.
    fn abs(self) -> Self;
    /// √x.
    fn sqrt(self) -> Self;
    /// eˣ.
    fn exp(self) -> Self;
    /// ln(1 + x), accurate for small x.
    fn log1p(self) -> Self;
    /// Whether this is neither infinite nor NaN.
    fn is_finite(self) -> bool;

    /// The weight of a ray that `coefficient` of what has this weight follows.
    fn weakened(self, coefficient: Self) -> Self {
        let product = self * coefficient;
        if product > Self::MAX_THROUGHPUT {
            Self::MAX_THROUGHPUT
        } else if product < -Self::MAX_THROUGHPUT {
            -Self::MAX_THROUGHPUT
        } else {
            product
        }
    }
}

/// A type with more bits than `f64`.
pub(crate) trait Wide: Real {
    /// So many `f64`s add up to any of its numbers, but for a unit.
    const PARTS: usize;

    /// x·2ᵏ for |k| ≤ 2000, exactly while nothing leaves the range.
    fn times_power_of_two(self, k: i32) -> Self;
}

macro_rules! impl_real {
    ($t:ty, $scalar:expr, $rounding:expr, $proves:expr) => {
        impl Real for $t {
            const ZERO: Self = 0.0;
            const ONE: Self = 1.0;
            const FAR: Self = 3e38;
            const MAX_THROUGHPUT: Self = $scalar.max_throughput() as $t;
            const UNIT: f64 = $scalar.unit();
            const PROVES: bool = $proves;
            const ROUNDING: Rounding = $rounding;

            fn from_f64(x: f64) -> Self {
                x as $t
            }
            fn to_f64(self) -> f64 {
                self as f64
            }
            fn abs(self) -> Self {
                self.abs()
            }
            fn sqrt(self) -> Self {
                self.sqrt()
            }
            fn exp(self) -> Self {
                self.exp()
            }
            fn log1p(self) -> Self {
                self.ln_1p()
            }
            fn is_finite(self) -> bool {
                self.is_finite()
            }
        }
    };
}

impl_real!(f32, Scalar::Single, Rounding::SINGLE, false);
impl_real!(f64, Scalar::Double, Rounding::DOUBLE, true);
