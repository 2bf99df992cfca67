//! What the next picture will cost, from what the last ones did.

/// Greatest step of a coarse picture.
const MAX_STEP: u32 = 64;

/// Measured speed of pictures like the last ones.
#[derive(Debug, Clone, Copy)]
pub(super) struct CostModel {
    /// From a view to a renderer, in ms.
    pub(super) prepare_ms: f64,
    /// A sample, in ms.
    pub(super) sample_ms: f64,
    /// Whether these are measured at all.
    pub(super) measured: bool,
}

impl Default for CostModel {
    /// Before anything is measured the first picture is a coarse one.
    fn default() -> Self {
        Self { prepare_ms: 2.0, sample_ms: 2e-3, measured: false }
    }
}

impl CostModel {
    /// From a picture of so many samples, whose stages took so long, in ms.
    pub(super) fn learn(&mut self, prepare: f64, render: f64, samples: f64) {
        let known = self.measured;
        let mean = |old: f64, new: f64| match known {
            false => new,
            true if new > old => new.midpoint(old),
            true => old.mul_add(0.7, new * 0.3),
        };
        self.prepare_ms = mean(self.prepare_ms, prepare);
        // Few samples say more of the way to the device and back than of themselves.
        if samples >= 4096.0 {
            self.sample_ms = mean(self.sample_ms, render / samples);
            self.measured = true;
        }
    }

    /// Time of a picture with this step, in ms.
    pub(super) fn forecast(&self, size: (u32, u32), step: u32) -> f64 {
        self.prepare_ms + self.sample_ms * f64::from(size.0.div_ceil(step)) * f64::from(size.1.div_ceil(step))
    }

    /// The least step whose picture takes no longer than `limit`, in ms.
    pub(super) fn step(&self, size: (u32, u32), limit: f64) -> u32 {
        // What is spent on preparing cannot be saved.
        let limit = limit.max(self.prepare_ms + 8.0);
        (1..MAX_STEP).find(|&step| self.forecast(size, step) <= limit).unwrap_or(MAX_STEP)
    }
}
