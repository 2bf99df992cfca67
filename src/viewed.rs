//! A scene as one eye sees it: the only one that renderers, and what decides for them, take.

use std::borrow::Cow;

use glam::DVec3;
use rayon::prelude::*;

use crate::accel::KeptLists;
use crate::area::Area;
use crate::brightness::Scalar;
use crate::geometry::{COMMON_EXTENT, extent, reciprocal_power_of_two};
use crate::misuse::Misuse;
use crate::scene::{Light, Scene, Window};
use crate::settings::{Secondary, Settings};

/// A scene under settings, with the eye at the origin and in the units of kernels, and what it was made of.
///
/// The scene is moved in `f64`, so that what is near the eye stays exact to single precision wherever the eye is; its axes stay
/// those of the world. The units change neither a digit nor a root nor a pixel. Where neither moves anything, nothing is copied.
#[derive(Debug)]
pub struct ViewedScene<'a> {
    scene: Cow<'a, Scene>,
    settings: Settings,
    file_scene: &'a Scene,
    file_settings: Settings,
    units: Units,
    area: Area,
    kept: Option<&'a KeptLists>,
}

impl Scene {
    /// The scene as the eye of `settings` sees it.
    #[doc(hidden)]
    pub fn viewed(&self, settings: &Settings) -> ViewedScene<'_> {
        let _span = tracing::info_span!("move scene").entered();
        let moved = moved(self, settings.view.eye);
        let units = Units::of(&moved, settings.secondary);
        let secondary = Secondary { reflection: settings.secondary.reflection * units.factor, ..settings.secondary };
        ViewedScene {
            scene: units.applied_to(moved),
            settings: Settings { view: settings.view.at_origin(), secondary, ..*settings },
            file_scene: self,
            file_settings: *settings,
            units,
            area: Area::whole((self.width, self.height)),
            kept: None,
        }
    }

    /// The same, where other eyes have looked at the same spheres and left their lists in `kept`; lights may have moved.
    #[doc(hidden)]
    pub fn viewed_again<'a>(&'a self, settings: &Settings, kept: &'a KeptLists) -> ViewedScene<'a> {
        let viewed = self.viewed(settings);
        // A light that comes nearer along its direction is elsewhere for each eye.
        let stays =
            |light: &Light| extent(light.position - settings.view.eye) <= viewed.units.farthest / viewed.units.factor;
        let kept = self.lights.iter().all(stays).then_some(kept);
        ViewedScene { kept, ..viewed }
    }
}

impl<'a> ViewedScene<'a> {
    /// The scene with the eye at the origin, in the units of kernels, in which no square of a length overflows or underflows.
    pub fn scene(&self) -> &Scene {
        &self.scene
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
        let size = (self.scene.width, self.scene.height);
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

    /// What lists other eyes have left.
    pub(crate) fn kept_lists(&self) -> Option<&'a KeptLists> {
        self.kept
    }

    /// The power of two by which the file's coordinates are multiplied.
    pub fn factor(&self) -> f64 {
        self.units.factor
    }

    /// The greatest coordinate or semi-axis of a sphere.
    pub fn greatest(&self) -> f64 {
        self.units.greatest
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

/// `scene` with `eye` at the origin.
fn moved(scene: &Scene, eye: DVec3) -> Cow<'_, Scene> {
    if eye == DVec3::ZERO {
        return Cow::Borrowed(scene);
    }
    let mut scene = scene.clone();
    scene.spheres.par_iter_mut().for_each(|sphere| sphere.center -= eye);
    scene.lights.iter_mut().for_each(|light| light.position -= eye);
    Cow::Owned(scene)
}

/// Lights are no farther away than this many times the extent of the spheres, 2⁵⁶: already the rays to them are parallel to
/// less than `f64` can tell.
const FARTHEST_LIGHT: f64 = (1_u64 << 56) as f64;

/// The units in which the kernels read a scene whose eye is at the origin.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Units {
    /// A power of two by which all coordinates are multiplied.
    factor: f64,
    /// The greatest coordinate or semi-axis of a sphere, in the new units.
    greatest: f64,
    /// The greatest coordinate of a light, in the new units; beyond it lights come nearer along their direction.
    farthest: f64,
}

impl Units {
    /// Those in which squared lengths neither overflow nor underflow in `f32`. They go by the spheres: a light in the distance
    /// does not make the spheres small.
    fn of(scene: &Scene, secondary: Secondary) -> Self {
        let spheres = scene.spheres.par_iter().map(|s| extent(s.center).max(extent(s.scale))).reduce(|| 0.0, f64::max);
        let lights = scene.lights.iter().map(|light| extent(light.position)).fold(0.0, f64::max);
        // The epsilon of shadow rays is a part of the way to the light: where a nearer light would bring it down to the size of
        // the spheres, the light has to stay.
        let may_move = secondary.shadow == 0.0 || secondary.shadow * FARTHEST_LIGHT > 64.0;
        let greatest = if may_move { spheres } else { spheres.max(lights) };
        let is_common = greatest == 0.0 || COMMON_EXTENT.contains(&greatest) && lights <= *COMMON_EXTENT.end();
        let factor = if is_common { 1.0 } else { reciprocal_power_of_two(greatest) };
        let farthest = if may_move && greatest > 0.0 { FARTHEST_LIGHT * (greatest * factor) } else { f64::INFINITY };
        Self { factor, greatest: spheres * factor, farthest }
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
