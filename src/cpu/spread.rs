//! The colours that a cone of rays spreads over.

use glam::DVec3;

use super::constants::Constants;
use super::margin::Roundoff;
use super::render::Levels;
use super::scene::{Material, PointLight, World};
use super::vec3::Vec3;
use crate::settings::Quantize;

/// Roundings of a term of the colour: four inputs and three products of them, less what is rounded in fact.
const TERM: f64 = 6.0;
/// Units in the last place by which a product of a few `f64` may miss that of the decimals that they stand for.
const DECIMAL: f64 = 4.0;

/// The least and the greatest colour of something.
#[derive(Debug, Clone, Copy)]
pub(super) struct Extent {
    pub low: DVec3,
    pub high: DVec3,
}

impl Extent {
    const NONE: Self = Self { low: DVec3::ZERO, high: DVec3::ZERO };

    /// Of what has this colour at the most, or none of it.
    pub(super) fn up_to(color: DVec3) -> Self {
        Self { low: color.min(DVec3::ZERO), high: color.max(DVec3::ZERO) }
    }

    fn plus(self, other: Self) -> Self {
        Self { low: self.low + other.low, high: self.high + other.high }
    }

    fn hull(self, other: Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.max(other.high) }
    }
}

/// The colours that anything in a world may have.
#[derive(Debug, Clone)]
pub(super) struct Gamut {
    /// Of what a ray may see that so many bounces follow.
    after: Vec<Extent>,
}

impl Gamut {
    pub(super) fn of(world: &World<f64>) -> Self {
        let mut surface = Extent::NONE;
        let (mut mirrored, mut refracted) = (0.0_f64, 0.0_f64);
        for material in world.materials.all() {
            let ambient = Extent::up_to((world.ambient * material.color).to_f64() * material.ka);
            let lights = world.lights.iter().map(|light| Self::of_light(material, light));
            surface = surface.hull(lights.fold(ambient, Extent::plus));
            mirrored = mirrored.max(material.kr.abs());
        }
        for glass in world.glasses.all() {
            refracted = refracted.max(glass.kt.abs());
        }
        let background = Extent::up_to(world.background.to_f64());
        let mut after: Vec<Extent> = vec![surface.hull(background)];
        for _ in 0..world.max_depth {
            let last = after[after.len() - 1];
            let weight = mirrored + refracted;
            let more = Extent { low: last.low * weight, high: last.high * weight };
            after.push(surface.plus(more).hull(background));
        }
        Self { after }
    }

    /// Of what one light may add to a surface.
    pub(super) fn of_light(material: &Material<f64>, light: &PointLight<f64>) -> Extent {
        let intensity = light.intensity.to_f64();
        Extent::up_to(intensity * material.color.to_f64() * material.kd).plus(Extent::up_to(intensity * material.ks))
    }

    /// Of what a ray may see that so many bounces follow.
    pub(super) fn after(&self, bounces: u32) -> Extent {
        self.after[(bounces as usize).min(self.after.len() - 1)]
    }
}

/// How far the colour at the end of a cone may be off.
#[derive(Debug, Clone)]
pub(super) struct Spread {
    roundoff: Roundoff,
    /// How far the geometry may move the colour down and up.
    below: DVec3,
    above: DVec3,
    /// Sum of the sizes of all terms, and their number.
    sizes: DVec3,
    terms: f64,
    constants: Constants,
    /// Whether nothing but constants has been added.
    is_constant: bool,
    /// Of the ray in hand.
    throughput: f64,
}

impl Spread {
    pub(super) fn new(roundoff: Roundoff) -> Self {
        let zero = DVec3::ZERO;
        Self {
            roundoff,
            below: zero,
            above: zero,
            sizes: zero,
            terms: 0.0,
            constants: Constants::new(roundoff.is_single()),
            is_constant: true,
            throughput: 1.0,
        }
    }

    /// Goes on with a ray of this weight, which counts for `coefficient` in the colour of an earlier one; returns its index.
    pub(super) fn follow(&mut self, throughput: f64, parent: usize, coefficient: f64) -> usize {
        self.throughput = throughput;
        self.constants.follow(parent, coefficient)
    }

    /// Adds a product of constants.
    pub(super) fn add_constant(&mut self, factors: [Vec3<f64>; 3]) {
        self.constants.set(factors);
        self.add_size((factors[0] * factors[1] * factors[2]).to_f64());
    }

    /// Adds a light's term, `coefficient` times what is `value` for the middle of the cone and lies in `range`.
    pub(super) fn add_term(&mut self, coefficient: DVec3, value: f64, range: [f64; 2]) {
        if coefficient == DVec3::ZERO {
            return;
        }
        let ends = range.map(|end| coefficient * (end - value) * self.throughput);
        self.below -= ends[0].min(ends[1]).min(DVec3::ZERO);
        self.above += ends[0].max(ends[1]).max(DVec3::ZERO);
        self.add_size(coefficient * value);
        self.is_constant = false;
    }

    /// Adds anything within `extent`, where the middle of the cone adds nothing.
    pub(super) fn add_any(&mut self, extent: Extent) {
        let ends = [extent.low * self.throughput, extent.high * self.throughput];
        self.below -= ends[0].min(ends[1]);
        self.above += ends[0].max(ends[1]);
        self.add_size(extent.high - extent.low);
        self.is_constant = false;
    }

    fn add_size(&mut self, term: DVec3) {
        if term != DVec3::ZERO {
            self.sizes += (term * self.throughput).abs();
            self.terms += 1.0;
        }
    }

    /// The colours around `color`, that of the middle of the cone.
    pub(super) fn around(self, color: DVec3) -> Shade {
        if self.is_constant {
            let [low, high] = self.constants.ends();
            return Shade { low: color.min(low), high: color.max(high), constant: Some(color) };
        }
        // Each addition rounds a sum that is no greater than that of all sizes.
        let rounding = self.sizes * ((TERM + self.terms) * self.roundoff.shading);
        Shade { low: color - self.below - rounding, high: color + self.above + rounding, constant: None }
    }
}

/// Colours that lie close together: what one cone of rays may show.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Shade {
    pub low: DVec3,
    pub high: DVec3,
    /// The reference's colour where it is known but for the order of its products: other renderers have the ends.
    pub constant: Option<DVec3>,
}

impl Shade {
    /// The least and the greatest levels of the shade.
    pub(super) fn levels(&self, quantize: Quantize, roundoff: Roundoff) -> [[u8; 3]; 2] {
        if let Some(color) = self.constant {
            // What has one value has one level, but that of the file's decimals may be a step that the nearest numbers miss.
            let own = |color: DVec3| {
                if roundoff.is_single() {
                    Levels::<f32>::new(quantize).levels(Vec3::from_f64(color))
                } else {
                    quantize.levels(color)
                }
            };
            let decimal = quantize.levels(color * (1.0 + DECIMAL * f64::EPSILON));
            let all = [quantize.levels(color), decimal, own(self.low), own(self.high)];
            let each = |pick: fn(u8, u8) -> u8| [0, 1, 2].map(|c| all.iter().fold(all[0][c], |a, b| pick(a, b[c])));
            return [each(u8::min), each(u8::max)];
        }
        // The product and the sum are rounded.
        let rounding = |color: DVec3| 2.0 * roundoff.shading * (color.abs() + quantize.bias() / quantize.scale());
        [quantize.levels(self.low - rounding(self.low)), quantize.levels(self.high + rounding(self.high))]
    }
}
