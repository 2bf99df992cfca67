//! Whether error-free transforms survive this device's compiler and arithmetic: WGSL guarantees nothing, so it is tried.

use serde::Serialize;

use super::compute::Job;
use super::record::Record;
use crate::gpu::device::error::Error;
use crate::gpu::facade::Gpu;
use crate::gpu::kernel::module::Module;
use crate::gpu::kernel::variant::Kernel;
use crate::gpu::shared::SMALL_GROUP;
use crate::gpu::table::layout::single::Params;
use crate::precision::Tier;
use crate::random::Random;

/// Pairs that are transformed.
const PAIRS: usize = 1 << 18;

/// How the device's error-free transforms compare with exact arithmetic.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct SelfTest {
    /// Pairs of operands.
    pub pairs: usize,
    /// Pairs whose sum or its error has other bits than the exact ones.
    pub sum_mismatches: usize,
    /// Pairs whose product or its error has other bits than the exact ones.
    pub product_mismatches: usize,
}

impl SelfTest {
    /// Transforms pairs on the device and compares bit for bit.
    pub fn run(gpu: &Gpu) -> Result<Self, Error> {
        let operands = operands();
        let results = transform(gpu, &operands)?;
        let mut test = Self { pairs: PAIRS, sum_mismatches: 0, product_mismatches: 0 };
        for (&[a, b], result) in operands.iter().zip(results.as_chunks::<4>().0) {
            let [sum, sum_error, product, product_error] = result.map(f32::from_bits);
            test.sum_mismatches += usize::from((sum, sum_error) != two_sum(a, b));
            test.product_mismatches += usize::from((product, product_error) != two_product(a, b));
        }
        Ok(test)
    }

    /// Whether every result is exact.
    pub fn passed(&self) -> bool {
        self.sum_mismatches == 0 && self.product_mismatches == 0
    }

    /// Refuses a device that fails; a device that passed with this driver and shader is not asked again.
    fn require(gpu: &Gpu) -> Result<(), Error> {
        let record = Record::of(gpu, "transforms", &Module::selftest());
        if record.has_passed() {
            return Ok(());
        }
        let test = Self::run(gpu)?;
        if !test.passed() {
            let Self { pairs, sum_mismatches: sums, product_mismatches: products } = test;
            let why = format!(
                "it does not keep error-free transforms: of {pairs} pairs, {sums} sums and {products} products are off. Precision \
                 `robust` needs them, and `double` where a device has no f64"
            );
            return Err(Error::ArithmeticRefused { device: gpu.device.info.to_string(), why });
        }
        record.keep();
        Ok(())
    }
}

impl Gpu {
    /// The kernel that keeps the promise of `tier` on this device; a refusal says why there is none.
    pub fn kernel(&self, tier: Tier) -> Result<Kernel, Error> {
        let kernel = match tier {
            Tier::Fast => Kernel::Tier(tier),
            Tier::Robust => SelfTest::require(self).map(|()| Kernel::Tier(tier))?,
            Tier::Double if self.device.info.f64 => Kernel::Tier(tier),
            Tier::Double => SelfTest::require(self).map(|()| Kernel::Pairs)?,
        };
        self.settle_quotients(kernel)?;
        Ok(kernel)
    }
}

/// Operands of all signs whose exponents differ by up to 40.
fn operands() -> Vec<[f32; 2]> {
    let mut random = Random::new(0, 0);
    let mut operand = || {
        let bits = random.bits();
        let exponent = 107 + (bits >> 32) as u32 % 41;
        f32::from_bits((bits as u32 & 0x807f_ffff) | (exponent << 23))
    };
    (0..PAIRS).map(|_| [operand(), operand()]).collect()
}

/// Knuth's transform; Rust's arithmetic is that of IEEE 754.
fn two_sum(a: f32, b: f32) -> (f32, f32) {
    let sum = a + b;
    let b_part = sum - a;
    (sum, (a - (sum - b_part)) + (b - b_part))
}

/// The product of two `f32` is exact in `f64`.
fn two_product(a: f32, b: f32) -> (f32, f32) {
    let product = a * b;
    (product, (f64::from(a) * f64::from(b) - f64::from(product)) as f32)
}

fn transform(gpu: &Gpu, operands: &[[f32; 2]]) -> Result<Vec<u32>, Error> {
    let params: Params = bytemuck::Zeroable::zeroed();
    let job = Job {
        what: "the self-test of error-free transforms",
        module: &Module::selftest(),
        entry_point: "transform_pairs",
        inputs: &[("given_params", bytemuck::bytes_of(&params)), ("operands", bytemuck::cast_slice(operands))],
        output: "results",
        output_len: operands.len() * 4,
        groups: PAIRS as u32 / SMALL_GROUP,
    };
    job.run(gpu.compiler())
}
