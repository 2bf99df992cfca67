//! The order in which pixels are sampled as the density grows.

/// 2³² over ρ and over ρ², ρ being the real root of x³ = x + 1, to the nearest odd number: multiples of both, modulo 2³², lie
/// evenly in the square (M. Roberts, "The Unreasonable Effectiveness of Quasirandom Sequences", 2018).
const STEPS: [u32; 2] = [0xC13F_A9A9, 0x91E1_0DA5];

/// All ranks: a pixel is sampled where its rank is below the density times this.
const RANKS: f64 = 4_294_967_296.0;

/// The rank of the pixel in column `x` and row `y`. Pixels with ranks below any bound lie evenly on the picture, in the manner
/// of a lattice, and (0, 0) has the least rank, so that no picture is without a sample.
pub fn rank(x: u32, y: u32) -> u32 {
    x.wrapping_mul(STEPS[0]).wrapping_add(y.wrapping_mul(STEPS[1]))
}

/// Whether a pixel of this rank is sampled at `density`, in 0..=1; whatever is sampled at one density is at every greater one.
pub fn is_sampled(rank: u32, density: f64) -> bool {
    f64::from(rank) < (density * RANKS).max(1.0)
}
