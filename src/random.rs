//! Seeded random numbers that are the same on every platform.

use glam::DVec3;

/// `SplitMix64` (Steele, Lea, Flood, "Fast splittable pseudorandom number generators", OOPSLA 2014).
#[derive(Debug, Clone)]
pub struct Random(u64);

impl Random {
    /// The stream `stream` of `seed`.
    pub fn new(seed: u64, stream: u64) -> Self {
        let mut random = Self(seed);
        random.0 = random.bits() ^ stream.wrapping_mul(0x9e37_79b9_7f4a_7c15);
        random.bits();
        random
    }

    /// 64 random bits.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Uniform between `low` and `high`.
    pub fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * ((self.bits() >> 11) as f64 / (1_u64 << 53) as f64)
    }

    /// 10 to a uniform power between `low` and `high`.
    pub fn magnitude(&mut self, low: f64, high: f64) -> f64 {
        10_f64.powf(self.within(low, high))
    }

    /// 1 or −1.
    pub fn sign(&mut self) -> f64 {
        if self.bits() & 1 == 0 { 1.0 } else { -1.0 }
    }

    /// Uniform in the unit ball.
    pub fn in_ball(&mut self) -> DVec3 {
        loop {
            let v = self.in_box(1.0);
            if v.length_squared() <= 1.0 {
                return v;
            }
        }
    }

    /// Uniform in the cube of half-width `half`.
    pub fn in_box(&mut self, half: f64) -> DVec3 {
        DVec3::new(self.within(-half, half), self.within(-half, half), self.within(-half, half))
    }

    /// Uniform on the unit sphere.
    pub fn unit(&mut self) -> DVec3 {
        loop {
            let v = self.in_ball();
            if v.length_squared() > 1e-3 {
                return v.normalize();
            }
        }
    }

    /// A unit vector perpendicular to the unit vector `axis`.
    pub fn perpendicular(&mut self, axis: DVec3) -> DVec3 {
        loop {
            let v = self.unit();
            let v = v - axis * v.dot(axis);
            if v.length_squared() > 1e-2 {
                return v.normalize();
            }
        }
    }
}
