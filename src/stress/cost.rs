//! What a ray–ellipsoid test costs on each kernel.

use serde::Serialize;

use super::rays;
use crate::gpu::{Error, Gpu, Kernel, Prober, Question};
use crate::random::Random;
use crate::report::Timings;

/// Time of one ray–ellipsoid test.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Cost {
    /// The kernel.
    pub kernel: &'static str,
    /// The runs, in ns a test; dispatches by wall clock, from submission to completion.
    pub ns: Timings,
    /// Median over that of the schoolbook formula.
    pub ratio: f64,
}

/// Measures `kernels` and the schoolbook formula in turn, `runs` times each after one warm-up, on the rays of class 2.
pub fn cost(gpu: &Gpu, kernels: &[Kernel], count: usize, seed: u64, runs: usize) -> Result<Vec<Cost>, Error> {
    let batch = rays::secondary(&mut Random::new(seed, 2 << 8), count);
    let tests: f64 = batch.rays.iter().map(|ray| f64::from(ray.end - ray.first)).sum();
    let mut probers = Vec::new();
    for kernel in std::iter::once(&Kernel::Schoolbook).chain(kernels.iter().filter(|&&k| k != Kernel::Schoolbook)) {
        match Prober::new(gpu, *kernel) {
            Ok(mut prober) => {
                prober.ask(Question::Nearest, &batch)?;
                probers.push((kernel.name(), prober, Timings::default()));
            }
            Err(Error::ArithmeticRefused { .. }) => {}
            Err(error) => return Err(error),
        }
    }
    for _ in 0..runs {
        for (_, prober, timings) in &mut probers {
            let before = prober.busy();
            prober.ask(Question::Nearest, &batch)?;
            timings.push(prober.busy().saturating_sub(before).as_secs_f64() * 1e9 / tests);
        }
    }
    let base = probers.first().map_or(f64::NAN, |(.., sample)| sample.median());
    // By the name asked for: without f64 another kernel stands in for `double`.
    let cost = |(kernel, _, ns): (&'static str, Prober, Timings)| Cost { kernel, ratio: ns.median() / base, ns };
    Ok(probers.into_iter().map(cost).collect())
}
