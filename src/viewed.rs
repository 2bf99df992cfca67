//! A scene as one eye sees it: the only one that renderers, and what decides for them, take.

use std::borrow::Cow;
use std::sync::{Arc, OnceLock};

use glam::DVec3;
use rayon::prelude::*;

use crate::area::Area;
use crate::brightness::Scalar;
use crate::census::{CHUNK, Census, Extents};
use crate::geometry::{self, COMMON_EXTENT, extent, reciprocal_power_of_two};
use crate::kept::Kept;
use crate::misuse::Misuse;
use crate::scene::{Light, Scene, Sphere, Window};
use crate::settings::{Secondary, Settings};

/// A scene under settings, with the eye at the origin and in the units of kernels, and what it was made of.
///
/// The scene is moved in `f64`, so that what is near the eye stays exact to single precision wherever the eye is; its axes stay
/// those of the world. The units change neither a digit nor a root nor a pixel. Where neither moves anything, nothing is copied.
#[derive(Debug)]
pub struct ViewedScene<'a> {
    scene: Moved<'a>,
    settings: Settings,
    file_scene: &'a Scene,
    file_settings: Settings,
    units: Units,
    extents: Extents,
    census: OnceLock<Arc<Census>>,
    area: Area,
}

/// The scene where the eye is at the origin; what is a copy goes to the next eye, where there may be one.
#[derive(Debug)]
struct Moved<'a> {
    scene: Cow<'a, Scene>,
    kept: Option<&'a Kept>,
}

impl Drop for Moved<'_> {
    fn drop(&mut self) {
        if let (Some(kept), Cow::Owned(scene)) = (self.kept, &mut self.scene) {
            kept.leave_moved(std::mem::take(scene));
        }
    }
}

impl Scene {
    /// The scene as the eye of `settings` sees it.
    #[doc(hidden)]
    pub fn viewed(&self, settings: &Settings) -> ViewedScene<'_> {
        self.viewed_by(settings, None)
    }

    /// The same, where other eyes have looked at the same spheres and left in `kept` what serves all; lights may have moved.
    #[doc(hidden)]
    pub fn viewed_again<'a>(&'a self, settings: &Settings, kept: &'a Kept) -> ViewedScene<'a> {
        self.viewed_by(settings, Some(kept))
    }

    /// Either, as there is something kept or not.
    pub(crate) fn viewed_by<'a>(&'a self, settings: &Settings, kept: Option<&'a Kept>) -> ViewedScene<'a> {
        let _span = tracing::info_span!("move scene").entered();
        let (moved, extents) = moved(self, settings.view.eye, kept);
        let units = Units::of(extents.greatest, &moved.lights, settings.secondary);
        let secondary = Secondary { reflection: settings.secondary.reflection * units.factor, ..settings.secondary };
        let scene = units.applied_to(moved);
        let extents = if units.factor == 1.0 { extents } else { Extents::of(&scene.spheres) };
        // A light that comes nearer along its direction is elsewhere for each eye.
        let stays = |light: &Light| extent(light.position - settings.view.eye) <= units.farthest / units.factor;
        let kept = kept.filter(|_| self.lights.iter().all(stays));
        ViewedScene {
            scene: Moved { scene, kept },
            settings: Settings { view: settings.view.at_origin(), secondary, ..*settings },
            file_scene: self,
            file_settings: *settings,
            units,
            extents,
            census: OnceLock::new(),
            area: Area::whole((self.width, self.height)),
        }
    }
}

impl<'a> ViewedScene<'a> {
    /// The scene with the eye at the origin, in the units of kernels, in which no square of a length overflows or underflows.
    pub fn scene(&self) -> &Scene {
        &self.scene.scene
    }

    /// The settings that belong to it: the eye is at the origin, and distances are in the same units.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// The same for a renderer of no more than this part of the picture, each pixel of which is what it is in the whole one.
    ///
    /// # Errors
    ///
    /// [`Misuse::Area`] where it is no part of it.
    pub fn within(self, area: Area) -> Result<Self, Misuse> {
        let size = (self.file_scene.width, self.file_scene.height);
        if area.is_of(size) { Ok(self.of_part(area)) } else { Err(Misuse::Area { area, size }) }
    }

    /// Likewise of what is a part for sure.
    pub(crate) fn of_part(self, area: Area) -> Self {
        Self { area, ..self }
    }

    /// The part of the picture that is rendered.
    pub fn area(&self) -> Area {
        self.area
    }

    /// The scene in the coordinates of its file, with the settings that belong to it.
    pub fn in_file(&self) -> (&'a Scene, &Settings) {
        (self.file_scene, &self.file_settings)
    }

    /// Likewise, for whoever needs no more: where the other scene is a copy, it goes.
    pub fn into_file(self) -> (&'a Scene, Settings) {
        (self.file_scene, self.file_settings)
    }

    /// What other eyes have left.
    pub(crate) fn kept(&self) -> Option<&'a Kept> {
        self.scene.kept
    }

    /// How far the spheres reach.
    pub(crate) fn extents(&self) -> Extents {
        self.extents
    }

    /// What no eye changes.
    pub(crate) fn census(&self) -> &Census {
        self.census.get_or_init(|| match self.kept() {
            Some(kept) => kept.census(self.scene(), self.factor()),
            None => Arc::new(Census::of(self.scene())),
        })
    }

    /// Which spheres share a surface, as [`geometry::shape_indices`] has it.
    pub(crate) fn shape_indices(&self, true_axes: bool) -> Option<Vec<u32>> {
        let (moved, file) = (&self.scene().spheres, &self.file_scene.spheres);
        let Some(kept) = self.kept() else { return geometry::shape_indices(moved, true_axes) };
        let reach = self.greatest() / self.factor() + extent(self.file_settings.view.eye);
        kept.shape_indices([moved, file], reach, true_axes)
    }

    /// The power of two by which the file's coordinates are multiplied.
    pub fn factor(&self) -> f64 {
        self.units.factor
    }

    /// The greatest coordinate or semi-axis of a sphere.
    pub fn greatest(&self) -> f64 {
        self.extents.greatest
    }

    /// How far the eye is from the file's origin.
    pub fn eye_distance(&self) -> f64 {
        self.file_settings.view.eye.length() * self.units.factor
    }

    /// How far rounding may have moved a place when the eye moved to the origin, in the units of kernels: two roundings of the way from
    /// the file's origin to the eye, beside those of the way from the eye to the place.
    pub fn moved_by(&self) -> f64 {
        2.0 * Scalar::Double.unit() * self.eye_distance()
    }
}

/// `scene` with `eye` at the origin, and how far its spheres reach then.
fn moved<'a>(scene: &'a Scene, eye: DVec3, kept: Option<&Kept>) -> (Cow<'a, Scene>, Extents) {
    if eye == DVec3::ZERO {
        return (Cow::Borrowed(scene), Extents::of(&scene.spheres));
    }
    let (lights, light_names, output) = (scene.lights.clone(), scene.light_names.clone(), scene.output.clone());
    let (mut spheres, sphere_names) = match kept.and_then(Kept::take_moved) {
        Some(Scene { spheres, sphere_names, .. }) => (spheres, sphere_names),
        None => (scene.spheres.par_iter().copied().collect(), scene.sphere_names.clone()),
    };
    // All but the place and the size is as it was: what other eyes leave may be in other units.
    let chunk = |(spheres, in_file): (&mut [Sphere], &[Sphere])| {
        spheres.iter_mut().zip(in_file).fold(Extents::NONE, |extents, (sphere, in_file)| {
            (sphere.center, sphere.scale) = (in_file.center - eye, in_file.scale);
            extents.with(sphere)
        })
    };
    let chunks = spheres.par_chunks_mut(CHUNK).zip(scene.spheres.par_chunks(CHUNK));
    let extents = chunks.map(chunk).reduce(|| Extents::NONE, Extents::and);
    let mut scene = Scene { spheres, sphere_names, lights, light_names, output, ..*scene };
    scene.lights.iter_mut().for_each(|light| light.position -= eye);
    (Cow::Owned(scene), extents)
}

/// Lights are no farther away than this many times the extent of the spheres, 2⁵⁶: already the rays to them are parallel to
/// less than `f64` can tell.
const FARTHEST_LIGHT: f64 = (1_u64 << 56) as f64;

/// The units in which the kernels read a scene whose eye is at the origin.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Units {
    /// A power of two by which all coordinates are multiplied.
    factor: f64,
    /// The greatest coordinate of a light, in the new units; beyond it lights come nearer along their direction.
    farthest: f64,
}

impl Units {
    /// Those in which squared lengths neither overflow nor underflow in `f32`. They go by the greatest coordinate
    /// of the spheres: a light in the distance does not make these small.
    fn of(spheres: f64, lights: &[Light], secondary: Secondary) -> Self {
        let lights = lights.iter().map(|light| extent(light.position)).fold(0.0, f64::max);
        // The epsilon of shadow rays is a part of the way to the light: where a nearer light would bring it down to the size of
        // the spheres, the light has to stay.
        let may_move = secondary.shadow == 0.0 || secondary.shadow * FARTHEST_LIGHT > 64.0;
        let greatest = if may_move { spheres } else { spheres.max(lights) };
        let is_common = greatest == 0.0 || COMMON_EXTENT.contains(&greatest) && lights <= *COMMON_EXTENT.end();
        let factor = if is_common { 1.0 } else { reciprocal_power_of_two(greatest) };
        let farthest = if may_move && greatest > 0.0 { FARTHEST_LIGHT * (greatest * factor) } else { f64::INFINITY };
        Self { factor, farthest }
    }

    /// Where a light is in these units.
    fn light(&self, position: DVec3) -> DVec3 {
        let greatest = extent(position);
        // Quotients, since products may leave the range.
        if greatest <= self.farthest / self.factor {
            return position * self.factor;
        }
        // Powers of two again, which leave the direction as it is to the last bit.
        position * reciprocal_power_of_two(greatest) / reciprocal_power_of_two(self.farthest)
    }

    /// `scene` in these units.
    fn applied_to<'a>(&self, scene: Cow<'a, Scene>) -> Cow<'a, Scene> {
        if self.factor == 1.0 && scene.lights.iter().all(|light| self.light(light.position) == light.position) {
            return scene;
        }
        let mut scene = scene.into_owned();
        let Window { near, left, right, bottom, top } = scene.window;
        let [near, left, right, bottom, top] = [near, left, right, bottom, top].map(|x| x * self.factor);
        scene.window = Window { near, left, right, bottom, top };
        for sphere in &mut scene.spheres {
            sphere.center *= self.factor;
            sphere.scale *= self.factor;
        }
        for light in &mut scene.lights {
            light.position = self.light(light.position);
        }
        Cow::Owned(scene)
    }
}
