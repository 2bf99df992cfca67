//! The classes that are about numbers, bit patterns and host code rather than about rays.

use glam::DVec3;

use super::metrics::Metrics;
use super::rays;
use crate::cpu::{Dd, Real};
use crate::geometry::Ellipsoid;
use crate::gpu::layout::ShapeValues;
use crate::gpu::{Batch, Error, Kernel, ProbeRay, Prober, Question, RawBatch};
use crate::precision::Tier;
use crate::random::Random;
use crate::scene::parse;

/// Class 13: a scale of zero is an error that names its line.
pub(super) fn zero_scale() -> Metrics {
    let head = "NEAR 1\nLEFT -1\nRIGHT 1\nBOTTOM -1\nTOP 1\nRES 8 8\n";
    let mut metrics = Metrics::default();
    let mut differing = 0;
    for scale in ["0 1 1", "1 0 1", "1 1 0", "0 0 0", "-0 1 1", "1 0.0 1", "1 1 0e9"] {
        let text = format!("{head}SPHERE s 0 0 -5 {scale} 1 1 1 1 1 1 0 1\n");
        let parsed = parse("zero scale", text.as_bytes());
        metrics.count += 1;
        let named = parsed.diagnostics.iter().any(|diagnostic| diagnostic.line == 7);
        differing += u64::from(parsed.scene.is_some() || !named);
    }
    metrics.differing = Some(differing);
    metrics.note = "of the scales with a zero, those without an error that names the line".into();
    metrics
}

/// Class 14: a negative scale is its absolute value, to the last bit.
pub(super) fn negative_scale(prober: &mut Prober, random: &mut Random, count: usize) -> Result<Metrics, Error> {
    let batch = rays::needle(random, count / 2);
    let mut mirrored = batch.clone();
    let mut differing = 0;
    for surface in &mut mirrored.surfaces {
        let bits = |scale| Ellipsoid::with_axes(surface.center, scale).bits();
        let signs = random.bits();
        let sign = |bit: u32| if signs >> bit & 1 == 0 { 1.0 } else { -1.0 };
        let scale = surface.scale * DVec3::new(sign(0), sign(1), sign(2));
        differing += u64::from(bits(scale) != bits(surface.scale));
        surface.scale = scale;
    }
    let answers = prober.ask(Question::Nearest, &batch)?;
    let again = prober.ask(Question::Nearest, &mirrored)?;
    let same = |(a, b): (&crate::gpu::Answer, &crate::gpu::Answer)| {
        a.words == b.words && a.value.to_bits() == b.value.to_bits()
    };
    differing += answers.iter().zip(&again).filter(|pair| !same(*pair)).count() as u64;
    Ok(Metrics { count: answers.len() as u64, differing: Some(differing), ..Metrics::default() })
}

/// A number with any bits: NaN, infinities, denormals, zeros, any exponent, and now and then an ordinary one.
fn any_number(random: &mut Random, double: bool) -> f64 {
    const SINGLE_EXPONENT: u32 = 0xff << 23;
    const DOUBLE_EXPONENT: u64 = 0x7ff << 52;
    let bits = random.bits();
    let pick = random.bits() % 8;
    if double {
        return f64::from_bits(match pick {
            0 => bits | DOUBLE_EXPONENT,
            1 => bits & !DOUBLE_EXPONENT,
            2 => (bits & 1 << 63) | DOUBLE_EXPONENT,
            3 => bits & 1 << 63,
            4 | 5 => bits,
            _ => return random.sign() * random.magnitude(-2.0, 2.0),
        });
    }
    let bits = bits as u32;
    f64::from(f32::from_bits(match pick {
        0 => bits | SINGLE_EXPONENT,
        1 => bits & !SINGLE_EXPONENT,
        2 => (bits & 1 << 31) | SINGLE_EXPONENT,
        3 => bits & 1 << 31,
        4 | 5 => bits,
        _ => return f64::from((random.sign() * random.magnitude(-2.0, 2.0)) as f32),
    }))
}

/// Class 15: any bits in every input of the kernel; only a finite root is a hit.
pub(super) fn bit_patterns(prober: &mut Prober, random: &mut Random, count: usize) -> Result<Metrics, Error> {
    let double = prober.kernel().is_double();
    let mut metrics = Metrics { count: count as u64, ..Metrics::default() };
    // In parts, since every ray has a shape of its own.
    for start in (0..count).step_by(1 << 18) {
        let mut batch = RawBatch::default();
        for index in 0..(count - start).min(1 << 18) {
            let wild = random.bits();
            let mut next = 0;
            // Three numbers in four are ordinary, so that the others reach deep into the kernel.
            let mut number = |ordinary: f64| {
                next += 2;
                if (wild >> next).is_multiple_of(4) { any_number(random, double) } else { ordinary }
            };
            let mut vector = |x: f64, y: f64, z: f64| [number(x), number(y), number(z)];
            let [ox, oy, oz] = vector(0.1, 0.2, 0.3);
            let [dx, dy, dz] = vector(0.1, -0.1, -1.0);
            let [cx, cy, cz] = vector(0.0, 0.0, -5.0);
            let [ix, iy, iz] = vector(1.0, 1.0, 1.0);
            let [radius, low, _] = vector(1.0, 0.0, 0.0);
            let shape = |center, radius, inv_scale| ShapeValues { center, radius, inv_scale, index: index as u32 };
            batch.rays.push([[ox, oy, oz, dx, dy, dz], [low; 6]]);
            batch.shapes.push([
                shape(DVec3::new(cx, cy, cz), radius, DVec3::new(ix, iy, iz)),
                shape(DVec3::splat(low), low, DVec3::splat(low)),
            ]);
        }
        let answers = prober.ask_raw(&batch)?;
        let limit = 3e38_f64;
        let odd = answers.iter().filter(|answer| answer.found && !(answer.value.abs() <= limit));
        metrics.not_finite += odd.count() as u64;
    }
    Ok(metrics)
}

fn numbers(values: &[[f64; 2]]) -> Batch {
    let ray = |&[x, y]: &[f64; 2]| ProbeRay {
        origin: DVec3::new(x, y, 0.0),
        direction: DVec3::ZERO,
        first: 0,
        end: 0,
        primary: false,
        own: None,
    };
    Batch { rays: values.iter().map(ray).collect(), ..Batch::default() }
}

/// Class 19: the specular power from 1 − cos, for every kind of exponent, R·V ≤ 0 included.
pub(super) fn power(prober: &mut Prober, random: &mut Random, count: usize) -> Result<Metrics, Error> {
    const EXPONENTS: [f64; 6] = [0.0, 0.5, 1.0, 50.0, 1e4, 1e5];
    let pair = |index: usize| {
        let n = EXPONENTS[index % EXPONENTS.len()];
        let d = match random.bits() % 8 {
            0 => random.within(1.0, 2.0),
            1 => 0.0,
            // Where the power falls from 1 to 0, and anywhere.
            2..=5 => (random.magnitude(-2.0, 1.3) / n.max(1.0)).min(2.0),
            _ => random.magnitude(-12.0, 0.0),
        };
        [f64::from(d as f32), n]
    };
    let pairs: Vec<_> = (0..count).map(pair).collect();
    let answers = prober.ask(Question::Power, &numbers(&pairs))?;
    let mut metrics = Metrics { count: count as u64, ..Metrics::default() };
    let mut worst = 0.0_f64;
    for (&[d, n], answer) in pairs.iter().zip(&answers) {
        let truth = if n == 0.0 {
            1.0
        } else if d < 1.0 {
            (Dd::from(n) * Dd::from(-d).log1p()).exp().hi()
        } else {
            0.0
        };
        metrics.not_finite += u64::from(!answer.value.is_finite() || !answer.finite);
        worst = worst.max((answer.value - truth).abs());
    }
    metrics.power_error = Some(worst);
    Ok(metrics)
}

/// Class 22: the residuals of error-free sums and products on the device.
pub(super) fn transforms(prober: &mut Prober, random: &mut Random) -> Result<Metrics, Error> {
    const PAIRS: usize = 262_144;
    let number = |random: &mut Random| {
        let exponent = random.within(-24.0, 24.0);
        f64::from((random.sign() * random.within(1.0, 2.0) * exponent.floor().exp2()) as f32)
    };
    let pairs: Vec<_> = (0..PAIRS).map(|_| [number(random), number(random)]).collect();
    let answers = prober.ask(Question::Transforms, &numbers(&pairs))?;
    let (mut sums, mut products) = (0, 0);
    for (&[a, b], answer) in pairs.iter().zip(&answers) {
        // Both are exact in f64: exponents differ by 48 at the most, and products have 48 bits.
        let (sum, product) = (a + b, a * b);
        let rounded = f64::from(a as f32 + b as f32);
        let exact_sum = if a.abs() >= b.abs() { b - (rounded - a) } else { a - (rounded - b) };
        debug_assert!((sum - rounded - exact_sum).abs() <= sum.abs() * 1e-15);
        sums += u64::from(f64::from(f32::from_bits(answer.words[0])) != exact_sum);
        let residual = product - f64::from(a as f32 * b as f32);
        products += u64::from(f64::from(f32::from_bits(answer.words[1])) != residual);
    }
    Ok(Metrics {
        count: 2 * PAIRS as u64,
        differing: Some(sums + products),
        note: format!("residuals lost: {sums} of sums, {products} of products"),
        ..Metrics::default()
    })
}

/// Class 21: between facing mirrors errors grow about tenfold a bounce; from which bounce on `f32` and `f64` paths differ by
/// 1e-3.
pub(super) fn facing_mirrors(prober: &mut Prober, random: &mut Random, count: usize) -> Result<Metrics, Error> {
    let count = count.min(20_000);
    let mut metrics = Metrics { count: count as u64, ..Metrics::default() };
    let mut double = match Prober::new(prober.gpu(), Kernel::Tier(Tier::Double)) {
        Ok(double) => double,
        Err(refusal @ Error::ArithmeticRefused { .. }) => {
            metrics.note = refusal.to_string();
            return Ok(metrics);
        }
        Err(error) => return Err(error),
    };
    let mut batch = rays::between_mirrors(random, count);
    metrics.note = "no path differs by 1e-3 up to bounce 16".into();
    for bounce in 1..=16 {
        batch.bounces = bounce;
        let answers = prober.ask(Question::Bounce, &batch)?;
        let truth = double.ask(Question::Bounce, &batch)?;
        let pairs = answers.iter().zip(&truth).filter(|(_, truth)| truth.found);
        let total = pairs.clone().count();
        let apart =
            pairs.filter(|(a, b)| !(a.found && a.surface == b.surface && (a.value - b.value).abs() <= 1e-3 * b.value));
        let apart = apart.count();
        // Half of them, so that no single grazing path decides.
        if total > 0 && 2 * apart > total {
            metrics.note = format!("half of the paths differ from f64 by 1e-3 from bounce {bounce} on");
            break;
        }
        if total == 0 {
            break;
        }
    }
    Ok(metrics)
}
