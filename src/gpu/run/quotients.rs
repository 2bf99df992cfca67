//! How far a device's quotients and square roots are off: Vulkan lets them be, and the bounds of certified pictures count with what it
//! allows them.

use bytemuck::Pod;
use serde::Serialize;

use super::compute::Job;
use super::record::Record;
use crate::gpu::device::error::Error;
use crate::gpu::facade::Gpu;
use crate::gpu::kernel::module::Module;
use crate::gpu::kernel::variant::Kernel;
use crate::gpu::shared::SMALL_GROUP;
use crate::random::Random;
use crate::roundings::QUOTIENT_UNITS;

/// Half a unit, and what measuring it takes.
const HALF: f64 = 0.500_001;

/// Numbers that are divided.
const PAIRS: usize = 1 << 16;

/// The greatest errors of a device, in units in the last place of the exact value; half a unit where it is rounded correctly.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Quotients {
    /// Pairs of a dividend and a divisor.
    pub pairs: usize,
    /// Of their quotients.
    pub quotient: f64,
    /// Of the dividends' square roots.
    pub root: f64,
}

impl Quotients {
    /// Measures on the device, in the numbers of `kernel`.
    pub fn measure(gpu: &Gpu, kernel: Kernel) -> Result<Self, Error> {
        // Numbers of both types, whose quotients are in range.
        let mut random = Random::new(0, 1);
        let mut operand = || {
            let size = (random.bits() % 60) as f64 - 30.0;
            f64::from((random.within(1.0, 2.0) * size.exp2()) as f32)
        };
        let operands: Vec<[f64; 2]> = (0..PAIRS).map(|_| [operand(), operand()]).collect();
        let (results, digits) = if kernel.is_double() {
            (divided(gpu, kernel, &operands)?, f64::MANTISSA_DIGITS)
        } else {
            let single: Vec<[f32; 2]> = operands.iter().map(|pair| pair.map(|x| x as f32)).collect();
            (divided(gpu, kernel, &single)?.into_iter().map(|pair| pair.map(f64::from)).collect(), f32::MANTISSA_DIGITS)
        };
        let mut measured = Self { pairs: PAIRS, quotient: 0.0, root: 0.0 };
        for (&[a, b], [quotient, root]) in operands.iter().zip(results) {
            // A fused multiplication and addition leaves the exact rest.
            let quotient_error = (-quotient).mul_add(b, a) / b;
            let root_error = (-root).mul_add(root, a) / (2.0 * root);
            measured.quotient =
                greater(measured.quotient, quotient_error.abs() / unit_of(quotient + quotient_error, digits));
            measured.root = greater(measured.root, root_error.abs() / unit_of(root + root_error, digits));
        }
        Ok(measured)
    }

    /// Whether all are rounded correctly.
    pub fn are_exact(&self) -> bool {
        self.quotient <= HALF && self.root <= HALF
    }

    /// Whether the bounds of certified pictures count with errors so great.
    pub fn are_counted(&self) -> bool {
        self.quotient <= QUOTIENT_UNITS && self.root <= QUOTIENT_UNITS
    }
}

impl Gpu {
    /// Finds out whether the device rounds quotients and square roots in the numbers of `kernel` correctly; kernels that are compiled
    /// from then on correct what it does not. With one driver it is measured once.
    pub(super) fn settle_quotients(&self, kernel: Kernel) -> Result<(), Error> {
        let known = self.device.inexact.known(kernel.is_double());
        // What wgpu translates cannot be corrected.
        if known.get().is_some() || !self.device.takes_spirv {
            return Ok(());
        }
        let module = Module::quotients(kernel);
        let [exact, inexact] = ["exact-quotients", "inexact-quotients"].map(|name| Record::of(self, name, &module));
        let is_exact = if exact.has_passed() || inexact.has_passed() {
            exact.has_passed()
        } else {
            let is_exact = Quotients::measure(self, kernel)?.are_exact();
            if is_exact { exact } else { inexact }.keep();
            is_exact
        };
        let _ = known.set(!is_exact);
        Ok(())
    }

    /// Refuses certified pictures by `kernel` where this device calculates worse than their bounds count with; one that does not is not
    /// measured again with this driver.
    pub(crate) fn certifies(&self, kernel: Kernel) -> Result<(), Error> {
        let is_exact = self.device.inexact.known(kernel.is_double()).get() == Some(&false);
        let record = Record::of(self, "quotients", &Module::quotients(kernel));
        if is_exact || record.has_passed() {
            return Ok(());
        }
        let measured = Quotients::measure(self, kernel)?;
        if !measured.are_counted() {
            let Quotients { quotient, root, .. } = measured;
            let why = format!(
                "its quotients are off by up to {quotient:.1} units in the last place and its square roots by up to {root:.1}, of \
                 {QUOTIENT_UNITS} that Vulkan allows and the bounds of certified pictures count with. The other tiers render on it"
            );
            return Err(Error::ArithmeticRefused { device: self.device.info.to_string(), why });
        }
        record.keep();
        Ok(())
    }
}

/// The greater one; NaN is greater than any number.
fn greater(a: f64, b: f64) -> f64 {
    if b <= a { a } else { b }
}

/// A unit in the last place of numbers like this with so many digits.
fn unit_of(x: f64, digits: u32) -> f64 {
    let exponent = (x.abs().to_bits() >> 52) as i32 - 1023;
    f64::from(exponent + 1 - digits.cast_signed()).exp2()
}

/// Quotient and square root of each pair from the device.
fn divided<T: Pod>(gpu: &Gpu, kernel: Kernel, operands: &[[T; 2]]) -> Result<Vec<[T; 2]>, Error> {
    let bytes: &[u8] = bytemuck::cast_slice(operands);
    let job = Job {
        what: "measuring quotients and square roots",
        module: &Module::quotients(kernel),
        entry_point: "divide_pairs",
        inputs: &[("operands", bytes)],
        output: "results",
        output_len: bytes.len() / size_of::<u32>(),
        groups: PAIRS as u32 / SMALL_GROUP,
    };
    Ok(bytemuck::pod_collect_to_vec(&job.run(gpu.compiler())?))
}
