//! What share of a picture's pixels rounding changes, estimated from the scene alone.
//!
//! A renderer that rounds sees each point a little beside its place. Seen from the eye that shifts what is there by a part of
//! the window: by `w` = u (|c| + r + d) / d where the centre c, the semi-axis r and the distance d are what numbers of
//! precision u had to hold. A shift changes as many pixels as the picture has edges, times the shift, and shades: where
//! colours vary from 0 to 1 along a line, 255 levels in each of three channels are passed. So each sphere counts by the length
//! of its outline and what it shows, spheres out of the window or smaller than a pixel for next to nothing; shadows and mirror
//! images count by the length of theirs. Places on a surface are off by as much as the sphere's own size and distance cost,
//! which turns normals, and light from nearby. Of many spheres all but the largest are looked at in samples, and shadows and
//! images are counted among fewer of them still: choosing a tier must take next to no time beside preparing it.
//!
//! The constants, `PARTS`, are what pictures of more than a hundred families of scenes differ by, rounded up.

use std::f64::consts::PI;

use glam::DVec3;
use rayon::prelude::*;

use super::outline::{Frame, Outline};
use super::{Extreme, Tier};
use crate::effects::{Effect, Effects};
use crate::scene::{Scene, Sphere};
use crate::view::View;

/// Levels of all channels that a colour passes between black and white.
const LEVELS: f64 = 3.0 * 255.0;
/// Up to so many spheres are all looked at, and of more the largest and so many others.
const LARGEST: usize = 16;
const ALONE: usize = 1024;
/// Among so many shadows and images are counted.
const AMONG: usize = 128;
/// Spheres that one thread looks at in turn.
const CHUNK: usize = 256;

/// What each kind of error amounts to, of its bound.
struct Parts {
    /// An edge that moves.
    edge: f64,
    /// A colour that varies along a surface.
    shade: f64,
    /// Normals of ellipsoids, whose points move along the ray too.
    flat: f64,
    /// Light from nearby.
    light: f64,
    /// Rounding of the colour itself, and of what mirrors add, from outside and within.
    color: f64,
    mirrored: [f64; 2],
    /// The direction of mirrored and refracted rays.
    turn: f64,
    /// Images in an image: how many of those that there are room for.
    images: f64,
}

const PARTS: Parts = Parts {
    edge: 0.25,
    shade: 0.125,
    flat: 1.5,
    light: 0.7,
    color: 1.0,
    mirrored: [1.0, 9.0],
    turn: 0.45,
    images: 0.5,
};

/// Unit roundoff of a tier.
#[derive(Clone, Copy)]
struct Precision {
    /// Of places, with what the kernel's steps make of it.
    places: f64,
    /// Of distances along a ray, by which surfaces are ordered.
    order: f64,
    /// Of directions and colours.
    shading: f64,
}

impl Precision {
    fn of(tier: Tier) -> Self {
        let [places, order, shading] = match tier {
            Tier::Fast => [24, 24, 24],
            Tier::Robust => [40, 24, 24],
            Tier::Double => [53, 53, 53],
        }
        .map(|bits| 0.5_f64.powi(bits));
        Self { places, order, shading }
    }
}

/// One number for each tier.
type ByTier = [f64; 3];

/// For each tier the share that rounding changes, with the sphere that adds most to it.
pub(super) struct Shares<'a> {
    scene: &'a Scene,
    lights: Vec<(DVec3, f64)>,
    effects: Active,
    frame: Frame,
    precisions: [Precision; 3],
}

/// The effects that matter here.
#[derive(Clone, Copy)]
struct Active {
    ambient: f64,
    diffuse: f64,
    specular: f64,
    shadows: bool,
    reflections: f64,
    refraction: f64,
    depth: u32,
}

/// A visible sphere.
#[derive(Clone, Copy)]
struct Seen {
    outline: Outline,
    /// Greatest and least semi-axis.
    long: f64,
    short: f64,
    /// d, and |c| + r + d.
    depth: f64,
    reach: f64,
    /// Whether the eye is within.
    is_inside: bool,
}

impl Seen {
    /// How far its points are shifted on the window, over the unit roundoff.
    fn shift(&self) -> f64 {
        self.reach / self.outline.distance * self.outline.stretch
    }
}

/// What a number of spheres add up to.
#[derive(Clone)]
struct Sums {
    /// Of the parts of the window that they take.
    area: f64,
    /// The same times what they show by themselves, and times the part that they mirror.
    bright: f64,
    mirror: f64,
    /// Greatest semi-axes, and these times how much shading varies.
    size: f64,
    shaded: f64,
    /// What each tier changes, and the sphere that adds most.
    changed: ByTier,
    greatest: [Extreme; 3],
    /// Rounding of mirrored colours, over the unit roundoff and their brightness.
    mirrored: f64,
    /// The spheres that are largest by themselves, and in the window.
    large: Largest,
    wide: Largest,
}

/// The greatest of some values.
#[derive(Clone, Default)]
struct Largest {
    found: Vec<(f64, usize)>,
    /// The least of them, once there are enough.
    least: f64,
}

impl Largest {
    fn add(&mut self, value: f64, index: usize) {
        if self.found.len() < LARGEST / 2 {
            self.found.push((value, index));
        } else if value <= self.least {
            return;
        } else if let Some(place) = self.found.iter_mut().min_by(|a, b| a.0.total_cmp(&b.0)) {
            *place = (value, index);
        }
        if self.found.len() == LARGEST / 2 {
            self.least = self.found.iter().fold(f64::INFINITY, |least, &(value, _)| least.min(value));
        }
    }

    fn plus(mut self, other: Self) -> Self {
        other.found.into_iter().for_each(|(value, index)| self.add(value, index));
        self
    }
}

/// The spheres that are largest, and those that are so beside their distance.
#[derive(Default)]
pub(super) struct LargestSpheres {
    large: Largest,
    wide: Largest,
}

impl LargestSpheres {
    pub(super) fn add(&mut self, index: usize, sphere: &Sphere) {
        let size = sphere.scale.abs().max_element();
        self.large.add(size, index);
        self.wide.add(size * size / sphere.center.length_squared(), index);
    }

    pub(super) fn plus(self, other: Self) -> Self {
        Self { large: self.large.plus(other.large), wide: self.wide.plus(other.wide) }
    }
}

impl Sums {
    fn none() -> Self {
        Self {
            area: 0.0,
            bright: 0.0,
            mirror: 0.0,
            size: 0.0,
            shaded: 0.0,
            changed: [0.0; 3],
            greatest: [Extreme { value: 0.0, sphere: None }; 3],
            mirrored: 0.0,
            large: Largest::default(),
            wide: Largest::default(),
        }
    }

    fn change(&mut self, sphere: usize, weight: f64, by: ByTier) {
        for (tier, by) in by.into_iter().enumerate() {
            self.changed[tier] += weight * by;
            self.greatest[tier].raise(by, sphere);
        }
    }

    fn plus(mut self, other: Self) -> Self {
        self.area += other.area;
        self.bright += other.bright;
        self.mirror += other.mirror;
        self.size += other.size;
        self.shaded += other.shaded;
        self.mirrored += other.mirrored;
        for tier in 0..3 {
            self.changed[tier] += other.changed[tier];
            if let Extreme { value, sphere: Some(sphere) } = other.greatest[tier] {
                self.greatest[tier].raise(value, sphere);
            }
        }
        self.large = self.large.plus(other.large);
        self.wide = self.wide.plus(other.wide);
        self
    }
}

/// One of the spheres among which shadows and images are counted; it stands for `weight` of them.
struct WeightedSphere<'a> {
    index: usize,
    weight: f64,
    sphere: &'a Sphere,
    size: f64,
    seen: Option<Seen>,
}

/// What is seen on one sphere of others.
struct OnSphere {
    /// Length of the outlines of shadows, of images, and of these times their shift, by places and by turned directions; on the
    /// window.
    shadows: f64,
    images: f64,
    shifted: f64,
    turned: f64,
}

impl<'a> Shares<'a> {
    /// Of `scene`, whose eye is at the origin, in this view.
    pub(super) fn new(scene: &'a Scene, view: &View, effects: &Effects) -> Self {
        let on = |effect| if effects.set.has(effect) { 1.0 } else { 0.0 };
        let effects = Active {
            ambient: mean(scene.ambient) * on(Effect::Ambient),
            diffuse: on(Effect::Diffuse),
            specular: on(Effect::Specular),
            shadows: effects.set.has(Effect::Shadows),
            reflections: on(Effect::Reflections),
            refraction: on(Effect::Refraction),
            depth: effects.depth,
        };
        Self {
            scene,
            lights: scene.lights.iter().map(|light| (light.position, mean(light.intensity))).collect(),
            effects,
            frame: Frame::new(view, &scene.window),
            precisions: Tier::ALL.map(Precision::of),
        }
    }

    /// The shares, given the largest of its spheres; `nested` are those with another surface so many world units below their own.
    pub(super) fn estimate(&self, largest: &LargestSpheres, nested: &[(usize, f64)]) -> [Extreme; 3] {
        let chosen = chosen(self.scene.spheres.len(), ALONE, || indices(&largest.large, &largest.wide));
        let chunk = |chosen: &[(usize, f64)]| {
            let mut sums = Sums::none();
            for &(index, weight) in chosen {
                self.add_alone(index, weight, &mut sums);
            }
            sums
        };
        let mut sums = chosen.par_chunks(CHUNK).map(chunk).reduce(Sums::none, Sums::plus);
        self.add_others(&mut sums);
        self.add_nested(nested, &mut sums);
        // Where outlines lie over each other only so much of them is seen.
        let covered = sums.area / self.frame.area();
        let visible = visible_part(covered) / self.frame.area();
        Tier::ALL.map(|tier| Extreme { value: sums.changed[tier as usize] * visible, ..sums.greatest[tier as usize] })
    }

    fn seen(&self, sphere: &Sphere) -> Option<Seen> {
        let outline = self.frame.outline(sphere)?;
        let (long, short) = axes_of(sphere);
        let center = sphere.center.length();
        let depth = if self.frame.is_parallel() { center } else { outline.distance };
        Some(Seen {
            outline,
            long,
            short,
            reach: center + long + depth,
            depth,
            is_inside: !self.frame.is_parallel() && (sphere.center / sphere.scale).length() < 1.0,
        })
    }

    /// The part of what comes along a mirrored or refracted ray.
    fn mirror(&self, sphere: &Sphere) -> f64 {
        (sphere.kr.abs() * self.effects.reflections + sphere.kt.abs() * self.effects.refraction).min(1.0)
    }

    /// What diffuse and specular light of this intensity vary by; what is brighter than white is cut off.
    fn shading(&self, sphere: &Sphere, light: f64) -> f64 {
        // The narrower a highlight the shorter its outline.
        let specular = self.effects.specular * 0.7 * sphere.ks.abs() / (sphere.n + 1.0).sqrt();
        (light * (self.diffuse(sphere) + specular)).min(1.0)
    }

    fn diffuse(&self, sphere: &Sphere) -> f64 {
        self.effects.diffuse * sphere.kd.abs() * mean(sphere.color)
    }

    /// What a sphere changes by its own outline and shading.
    fn add_alone(&self, index: usize, weight: f64, sums: &mut Sums) {
        let sphere = &self.scene.spheres[index];
        let (long, _) = axes_of(sphere);
        let all_light: f64 = self.lights.iter().map(|light| light.1).sum();
        sums.size += weight * long;
        sums.shaded += weight * long * self.shading(sphere, all_light);
        sums.large.add(long, index);
        let Some(seen) = self.seen(sphere) else { return };
        let Seen { outline, short, reach, is_inside, .. } = seen;
        sums.wide.add(outline.perimeter * seen.shift(), index);

        let (mut light, mut near) = (0.0, 0.0);
        for &(position, intensity) in &self.lights {
            let height = ((position - sphere.center) / sphere.scale).length() - 1.0;
            // A wall is lit from its own side alone.
            if (height < 0.0) == is_inside {
                light += intensity;
                near += (intensity * self.diffuse(sphere)).min(1.0)
                    / (height.abs() * short + outline.area.sqrt() * outline.distance);
            }
        }
        let shading = self.shading(sphere, light);
        let by_outline = outline.perimeter * seen.shift();
        let by_normals = 2.0 * outline.area * reach / short;
        let off_surface = outline.area * reach / long * (1.0 - short / long);
        let shades = shading * (by_outline.min(by_normals) * PARTS.shade + off_surface * PARTS.flat);
        let places = outline.silhouette * seen.shift() * PARTS.edge
            + LEVELS * (shades + near * reach * outline.area * PARTS.light);
        let bright = (self.effects.ambient * sphere.ka.abs() * mean(sphere.color) + shading).min(1.0);
        let colors = LEVELS * outline.area * bright * PARTS.color;
        // The discriminant of flat bodies is a difference of what their distance is in short semi-axes.
        let rim = if long > short { outline.silhouette * long / outline.distance * outline.stretch } else { 0.0 };
        let axes_away = 2.0 * (sphere.center / sphere.scale).length();
        let by_tier = |p: Precision| {
            let off = axes_away * p.places;
            places * p.places + rim * off * off / 2.0 * PARTS.edge + colors * p.shading
        };
        sums.change(index, weight, self.precisions.map(by_tier));
        let (area, mirror) = (weight * outline.area, self.mirror(sphere));
        sums.area += area;
        sums.bright += area * bright;
        sums.mirror += area * mirror;
        sums.mirrored += LEVELS * area * mirror * PARTS.mirrored[usize::from(is_inside)];
    }

    /// What shadows and images of spheres on each other change.
    fn add_others(&self, sums: &mut Sums) {
        let samples = self.samples(sums);
        let depth = self.effects.depth;
        let on: Vec<Option<OnSphere>> = samples.par_iter().map(|sample| self.on(sample, &samples)).collect();
        let on = samples.iter().zip(&on).filter_map(|(sample, on)| Some((sample, sample.seen?, on.as_ref()?)));
        let (mut outlines, mut images, mut weighted) = (0.0, 0.0, 0.0);
        for (sample, seen, on) in on.clone() {
            let mirror = self.mirror(sample.sphere);
            outlines += sample.weight * seen.outline.perimeter;
            if mirror > 0.0 {
                images += sample.weight * on.images;
                weighted += sample.weight * on.images * mirror;
            }
        }
        // How much more there is to be seen after each bounce, by itself and by what is left of it.
        let chain = |gain: f64| (0..depth.min(64)).map(|bounce| gain.powi(bounce.cast_signed())).sum::<f64>().min(1e30);
        let [edges, shades] = [images, weighted].map(|sum| chain(if outlines > 0.0 { sum / outlines } else { 0.0 }));
        let shading = if sums.size > 0.0 { sums.shaded / sums.size } else { 0.0 };
        for (sample, seen, on) in on {
            let mirror = self.mirror(sample.sphere);
            let (edges, shades) = if mirror > 0.0 { (edges, LEVELS * mirror * shading * shades) } else { (0.0, 0.0) };
            let shadows = on.shadows * seen.shift() * PARTS.edge;
            let places = shadows + on.shifted * (edges * PARTS.edge + shades * PARTS.shade);
            let turned = 3.0 * on.turned * (edges + shades) * PARTS.turn;
            sums.change(sample.index, sample.weight, self.precisions.map(|p| places * p.places + turned * p.shading));
        }
        let bounces = chain(if sums.area > 0.0 { sums.mirror / sums.area } else { 0.0 });
        let bright = if sums.area > 0.0 { sums.bright / sums.area * bounces } else { 0.0 };
        for (tier, p) in self.precisions.iter().enumerate() {
            sums.changed[tier] += sums.mirrored * bright * p.shading;
        }
    }

    /// The spheres among which shadows and images are counted.
    fn samples(&self, sums: &Sums) -> Vec<WeightedSphere<'a>> {
        let spheres = &self.scene.spheres;
        let sample = |index: usize, weight: f64| {
            let sphere = &spheres[index];
            WeightedSphere { index, weight, sphere, size: axes_of(sphere).0, seen: self.seen(sphere) }
        };
        let chosen = chosen(spheres.len(), AMONG, || indices(&sums.large, &sums.wide));
        chosen.into_iter().map(|(index, weight)| sample(index, weight)).collect()
    }

    /// What is to be seen on one sphere of all others.
    fn on(&self, sample: &WeightedSphere, samples: &[WeightedSphere]) -> Option<OnSphere> {
        let seen = sample.seen?;
        let Outline { area, place, distance, stretch, perimeter, .. } = seen.outline;
        let patch = area.sqrt() * distance / stretch;
        let (mut shadows, mut images, mut shifted, mut turned, mut solid) = (0.0, 0.0, 0.0, 0.0, 0.0);
        for other in samples.iter().filter(|other| other.index != sample.index) {
            let size = other.size;
            let gap =
                ((place - other.sphere.center).length() - size).max(1e-3 * size.min(seen.long)).max(1e-12 * distance);
            let outline = 2.0 * PI * size.min(4.0 * gap);
            let falls_here = (patch + size) / (2.0 * (gap + size));
            shadows += other.weight * outline.min(4.0 * patch) / distance * (falls_here * falls_here).min(1.0);
            // The curvature of a mirror spreads rays: an image is so much smaller, and a place that is off by so much
            // turns normals.
            let bend = 1.0 + 2.0 * gap / seen.long;
            let spread = if seen.is_inside {
                (distance + gap - 2.0 * distance * gap / seen.long).abs().max(0.25 * (distance + gap))
            } else {
                distance * bend + gap
            };
            let image = other.weight * (outline / spread).min(4.0 * area.sqrt() / stretch);
            images += image;
            shifted += image * seen.reach * bend / spread;
            turned += image * (gap / spread).min(1.0);
            let angle = size / (gap + size);
            solid += other.weight * angle * angle / 4.0;
        }
        // Things hide each other around here, too; and a small flat mirror shows but a part of them.
        let visible = visible_part(solid);
        let spread = 1.0 + 2.0 * distance / seen.long;
        let shown = (8.0 * area / (stretch * stretch) * spread * spread / (4.0 * PI)).min(1.0);
        let images_here = PARTS.images * visible * shown * stretch;
        let lights = if self.effects.shadows { self.lights.len() as f64 } else { 0.0 };
        Some(OnSphere {
            shadows: (lights * shadows * visible * stretch).min(50.0 * perimeter),
            images: images * images_here,
            shifted: shifted * images_here * stretch,
            turned: turned * images_here,
        })
    }

    /// Surfaces so close below each other that their order is lost: all that is seen of them.
    fn add_nested(&self, nested: &[(usize, f64)], sums: &mut Sums) {
        for &(index, gap) in nested {
            let Some(seen) = self.seen(&self.scene.spheres[index]) else { continue };
            let is_lost = |p: Precision| gap < 4.0 * (p.places * seen.reach).max(0.25 * p.order * seen.depth);
            sums.change(index, 1.0, self.precisions.map(|p| if is_lost(p) { seen.outline.area } else { 0.0 }));
        }
    }
}

/// All of `count` spheres, or the largest and `most` of the others, evenly; each with the number of spheres that it stands for.
fn chosen(count: usize, most: usize, largest: impl Fn() -> Vec<usize>) -> Vec<(usize, f64)> {
    if count <= LARGEST + most {
        return (0..count).map(|index| (index, 1.0)).collect();
    }
    let largest = largest();
    let others = (0..most).map(|k| (2 * k + 1) * count / (2 * most));
    let others: Vec<usize> = others.filter(|index| largest.binary_search(index).is_err()).collect();
    let weight = (count - largest.len()) as f64 / others.len() as f64;
    largest.iter().map(|&index| (index, 1.0)).chain(others.iter().map(|&index| (index, weight))).collect()
}

/// The spheres of both, in order.
fn indices(large: &Largest, wide: &Largest) -> Vec<usize> {
    let mut indices: Vec<usize> = large.found.iter().chain(&wide.found).map(|&(_, index)| index).collect();
    indices.sort_unstable();
    indices.dedup();
    indices
}

fn mean(color: DVec3) -> f64 {
    color.abs().element_sum() / 3.0
}

/// Greatest and least semi-axis.
fn axes_of(sphere: &Sphere) -> (f64, f64) {
    let scale = sphere.scale.abs();
    (scale.max_element(), scale.min_element())
}

/// Of things that are thrown onto an area and cover it this many times, the part that is not hidden by others.
fn visible_part(covered: f64) -> f64 {
    if covered > 1e-9 { -(-covered).exp_m1() / covered } else { 1.0 }
}
