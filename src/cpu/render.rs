//! Rows of pixels from the reference, in parallel.

use std::sync::Arc;

use glam::DVec3;
use rayon::prelude::*;

use super::bound::Bound;
use super::decision::Decision;
use super::intersect::{Hit, Own, Primary, Range, Ray};
use super::proof::WideWorlds;
use super::real::Real;
use super::scene::World;
use super::trace::trace;
use super::vec3::Vec3;
use super::witness::Witness;
use crate::accel::{Acceleration, Rounding};
use crate::area::Area;
use crate::camera::Camera;
use crate::effects::Effects;
use crate::linear::Linear;
use crate::misuse::{Misuse, check_colors, check_pixels, check_rows};
use crate::settings::Quantize;
use crate::stop;
use crate::viewed::ViewedScene;

/// The CPU reference: the whole specification, in the scalar `T`.
#[derive(Debug, Clone)]
pub struct Reference<T> {
    pub(super) world: Arc<World<T>>,
    pub(super) wide_worlds: WideWorlds,
    pub(super) camera: Camera,
    pub(super) quantize: Quantize,
}

impl<T: Real> Reference<T> {
    /// Prepares `viewed` with `effects`, rounding its numbers once to `T`.
    pub fn new(viewed: &ViewedScene, effects: &Effects) -> Self {
        Self::with_rounding(viewed, effects, T::ROUNDING)
    }

    /// Likewise, with lists of spheres for a renderer that rounds like this, at least like `T`.
    pub fn with_rounding(viewed: &ViewedScene, effects: &Effects, rounding: Rounding) -> Self {
        let rounding = if T::PROVES { rounding.proven() } else { rounding };
        let accel = Acceleration::new(viewed, effects.set, rounding);
        Self::with_lists(viewed, effects, accel)
    }

    /// Likewise, with lists of spheres that were made for another renderer of this scene, which rounds at least like `T`.
    pub fn with_lists(viewed: &ViewedScene, effects: &Effects, accel: Acceleration) -> Self {
        let (world, camera) = (Arc::new(World::new(viewed, effects, accel)), Camera::new(viewed));
        Self { world, wide_worlds: WideWorlds::default(), camera, quantize: viewed.settings().quantize }
    }

    /// The ray of the sample in sample column `i` and sample row `j`.
    fn primary_ray(&self, [i, j]: [u32; 2]) -> Ray<T> {
        let sum = Vec3::from_f64(self.camera.column(i)) + Vec3::from_f64(self.camera.row(j));
        if self.camera.is_parallel() {
            return Ray { origin: sum, direction: Vec3::from_f64(self.camera.direction()) };
        }
        Ray { origin: Vec3::ZERO, direction: sum }
    }

    /// How far its origin may be off, and its direction as an angle.
    pub(super) fn errors(&self) -> [T; 2] {
        [self.camera.position_error(T::UNIT), self.camera.direction_error(T::UNIT)].map(T::from_f64)
    }

    /// How colours become levels.
    pub(crate) fn quantize(&self) -> Quantize {
        self.quantize
    }

    /// Width and height of the picture.
    pub fn size(&self) -> (u32, u32) {
        (self.camera.width(), self.camera.height())
    }

    /// The part of the picture that it renders.
    pub fn area(&self) -> Area {
        self.camera.area()
    }

    /// The unclamped colour of pixel (column `i`, row `j`); `None` where the picture has no such pixel.
    pub fn color(&self, i: u32, j: u32) -> Option<DVec3> {
        let (width, height) = self.size();
        (i < width && j < height).then(|| self.proven_color(i, j, &mut self.bound(), &mut Tally::default()).to_f64())
    }

    /// Pixel (column `i`, row `j`) of a picture with one sample a pixel, with the bound of its error, beside a renderer whose unit roundoff
    /// is `others` of this one's; `None` where the picture has no such pixel.
    #[doc(hidden)]
    pub fn bounded(&self, i: u32, j: u32, others: f64) -> Option<Bounded> {
        let (width, height) = self.size();
        let primary = (i < width && j < height).then(|| self.primaries(i, j).next()).flatten()?;
        let mut bound = Bound::<T, false>::new(&self.world);
        bound.begin(self.errors());
        let color = trace(&self.world, &primary, &mut bound);
        let levels = Levels::new(self.quantize);
        let is_step = !bound.has_sure_levels(color, &levels, T::from_f64(others));
        Some(Bounded {
            color: color.to_f64(),
            error: bound.error_of(color).to_f64(),
            levels: levels.levels(color),
            doubt: bound.unsure.or(is_step.then_some(Decision::QuantisationStep)),
        })
    }

    /// The rays of all samples of pixel (column `i`, row `j`), in the order of the pattern.
    pub(super) fn primaries(&self, i: u32, j: u32) -> impl Iterator<Item = Primary<'_, T>> {
        let pattern = self.camera.pattern();
        let (side, count) = (pattern.side(), pattern.count());
        let seen = self.world.accel.screen.at(i, j);
        (0..count).map(move |s| {
            let [column, row] = pattern.sample_place(s);
            let sample = [i * side + column, j * side + row];
            Primary { ray: self.primary_ray(sample), sample, seen }
        })
    }

    /// Renders whole rows from row `first` of its part of the picture on into `rgb`, 3 bytes a pixel, in parallel.
    ///
    /// # Errors
    ///
    /// [`Misuse::Rows`] where these are no rows of it.
    pub fn rows(&self, first: u32, rgb: &mut [u8]) -> Result<Tally, Misuse> {
        check_rows(self.area().size(), first, rgb.len())?;
        Ok(self.shown_rows(first, rgb.as_chunks_mut::<3>().0, |shown| shown.levels))
    }

    /// Likewise, with the colours of the same pixels before they are quantised.
    ///
    /// # Errors
    ///
    /// Also [`Misuse::Colors`] where there is not one colour for each pixel.
    pub fn linear_rows(&self, first: u32, rgb: &mut [u8], linear: &mut [Linear]) -> Result<Tally, Misuse> {
        check_rows(self.area().size(), first, rgb.len())?;
        check_colors(rgb.len() / 3, linear.len())?;
        let mut all = vec![Shown::default(); linear.len()];
        let tally = self.shown_rows(first, &mut all, |shown| shown);
        for ((shown, levels), linear) in all.iter().zip(rgb.as_chunks_mut::<3>().0).zip(linear) {
            (*levels, *linear) = (shown.levels, shown.linear);
        }
        Ok(tally)
    }

    /// Renders pixels of whole rows from row `first` on, each as `show` has it.
    fn shown_rows<P: Send>(&self, first: u32, pixels: &mut [P], show: impl Fn(Shown) -> P + Sync) -> Tally {
        // A few hundred pixels a task balance the load and keep the cost of a task invisible.
        const CHUNK: usize = 256;
        let Area { left, top, .. } = self.area();
        let width = self.area().width as usize;
        let chunk = |(chunk, pixels): (usize, &mut [P])| {
            let (mut tally, mut bound) = (Tally::default(), self.bound());
            // What is rendered after that is thrown away.
            if stop::is_asked() {
                return tally;
            }
            for (k, pixel) in pixels.iter_mut().enumerate() {
                let index = chunk * CHUNK + k;
                let (i, j) = (left + (index % width) as u32, top + first + (index / width) as u32);
                *pixel = show(self.shown(i, j, &mut bound, &mut tally));
            }
            tally
        };
        pixels.par_chunks_mut(CHUNK).enumerate().map(chunk).reduce(Tally::default, Tally::plus)
    }

    /// What a pixel shows.
    #[inline]
    fn shown(&self, i: u32, j: u32, bound: &mut Bound<T, true>, tally: &mut Tally) -> Shown {
        let samples = u64::from(self.camera.pattern().count());
        let before = tally.hits;
        let color = self.proven_color(i, j, bound, tally);
        let linear = Linear { color: color.to_f64(), coverage: (tally.hits - before) as f64 / samples as f64 };
        tally.primary += samples;
        tally.not_finite += u64::from(!linear.color.is_finite());
        Shown { levels: Levels::new(self.quantize).levels(color), linear }
    }

    /// Renders the pixels in these columns and rows, each with the value that it has in the full picture, in parallel.
    ///
    /// # Errors
    ///
    /// [`Misuse::Pixel`] where a pixel is not of the picture, [`Misuse::Colors`] where there is not one colour for each.
    pub fn pixels(&self, pixels: &[[u32; 2]], colors: &mut [[u8; 3]]) -> Result<Tally, Misuse> {
        check_pixels(self.area(), pixels, colors.len())?;
        Ok(self.shown_pixels(pixels, colors, |shown| shown.levels))
    }

    /// Likewise, all that they show.
    ///
    /// # Errors
    ///
    /// [`Misuse::Pixel`] where a pixel is not of the picture.
    pub(crate) fn all_of_pixels(&self, pixels: &[[u32; 2]]) -> Result<(Vec<Shown>, Tally), Misuse> {
        check_pixels(self.area(), pixels, pixels.len())?;
        let mut all = vec![Shown::default(); pixels.len()];
        let tally = self.shown_pixels(pixels, &mut all, |shown| shown);
        Ok((all, tally))
    }

    /// Renders pixels, each as `show` has it.
    fn shown_pixels<P: Send>(&self, pixels: &[[u32; 2]], targets: &mut [P], show: impl Fn(Shown) -> P + Sync) -> Tally {
        let each = |(&[i, j], target): (&[u32; 2], &mut P)| {
            let mut tally = Tally::default();
            *target = show(self.shown(i, j, &mut self.bound(), &mut tally));
            tally
        };
        pixels.par_iter().zip(targets).with_min_len(256).map(each).reduce(Tally::default, Tally::plus)
    }
}

/// The mean over a pixel's samples, `count` of them; read it beside `shaders/resolve.wgsl`. Taken from
/// differences to the first sample, it is exact where all are equal.
#[inline]
pub(super) fn resolve<T: Real>(mut samples: impl Iterator<Item = Vec3<T>>, count: u32) -> Vec3<T> {
    let Some(first) = samples.next() else { return Vec3::ZERO };
    let mut excess = Vec3::ZERO;
    for color in samples {
        excess += color - first;
    }
    if count == 1 {
        return first;
    }
    let count = T::from_f64(f64::from(count));
    first + Vec3::new(excess.x / count, excess.y / count, excess.z / count)
}

/// From colours to levels, calculated in `T`; read it beside `shaders/quantize.wgsl`.
#[derive(Debug, Clone, Copy)]
pub(super) struct Levels<T> {
    scale: T,
    bias: T,
}

impl<T: Real> Levels<T> {
    pub(super) fn new(quantize: Quantize) -> Self {
        Self { scale: T::from_f64(quantize.scale()), bias: T::from_f64(quantize.bias()) }
    }

    /// The 8-bit RGB of an unclamped colour; NaN becomes 0.
    pub(super) fn levels(&self, color: Vec3<T>) -> [u8; 3] {
        [color.x, color.y, color.z].map(|c| self.level(c))
    }

    fn level(&self, c: T) -> u8 {
        let low = if c > T::ZERO { c } else { T::ZERO };
        let clamped = if low > T::ONE { T::ONE } else { low };
        (self.scale * clamped + self.bias).to_f64() as u8
    }

    /// Whether all colours that are off by no more than `error` have the same levels, in arithmetic with the unit roundoff `u`.
    pub(super) fn are_equal(&self, color: Vec3<T>, error: T, u: T) -> bool {
        let error = error + T::from_f64(4.0) * u;
        let is_sure = |c: T| error.is_finite() && c.is_finite() && self.level(c - error) == self.level(c + error);
        is_sure(color.x) && is_sure(color.y) && is_sure(color.z)
    }
}

/// A pixel with the bound of its error.
#[doc(hidden)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounded {
    /// The unclamped colour.
    pub color: DVec3,
    /// How far each channel may be off, where no decision is in doubt but that of a quantisation step.
    pub error: f64,
    /// The levels.
    pub levels: [u8; 3],
    /// What leaves the levels in doubt.
    pub doubt: Option<Decision>,
}

/// What a pixel shows.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Shown {
    pub(crate) levels: [u8; 3],
    pub(crate) linear: Linear,
}

/// What rendering some rows came to.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Tally {
    /// Pixels whose colour is not finite.
    pub not_finite: u64,
    /// Rays from the eye.
    pub primary: u64,
    /// Those of them that have hit something.
    pub hits: u64,
    /// Rays towards lights.
    pub shadow: u64,
    /// Reflected and refracted rays.
    pub reflection: u64,
    /// Pixels with a decision that `f64` leaves open: double-double has taken it.
    pub more_bits: u64,
    /// Those of them with one that double-double leaves open, too: 237 bits have taken it.
    pub most_bits: u64,
    /// Those of them with one that these leave open, too: it was taken for a tie where it lies all but on one.
    pub undecided: u64,
}

impl Tally {
    /// The sum of two tallies.
    #[must_use]
    pub fn plus(self, other: Self) -> Self {
        Self {
            not_finite: self.not_finite + other.not_finite,
            primary: self.primary + other.primary,
            hits: self.hits + other.hits,
            shadow: self.shadow + other.shadow,
            reflection: self.reflection + other.reflection,
            more_bits: self.more_bits + other.more_bits,
            most_bits: self.most_bits + other.most_bits,
            undecided: self.undecided + other.undecided,
        }
    }
}

impl<T: Real> Witness<T> for Tally {
    fn nearest(
        &mut self,
        _world: &World<T>,
        _ray: &Ray<T>,
        own: Option<&Own<T>>,
        _range: &Range<T>,
        hit: Option<Hit<T>>,
    ) -> Option<Hit<T>> {
        self.hits += u64::from(own.is_none() && hit.is_some());
        hit
    }

    fn blocked(&mut self, _world: &World<T>, _ray: &Ray<T>, _own: &Own<T>, is_blocked: bool) -> bool {
        self.shadow += 1;
        is_blocked
    }

    fn reflected(&mut self, _throughput: T) {
        self.reflection += 1;
    }

    fn resumed(&mut self) {
        self.reflection += 1;
    }
}
