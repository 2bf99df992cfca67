//! Scenes of which not even `f64` gives a sound picture: they are refused.

use rayon::prelude::*;

use crate::brightness::{Brightness, Scalar};
use crate::effects::Effects;
use crate::geometry::Units;
use crate::scene::{Scene, Sphere, Window};
use crate::settings::Settings;

/// How many times larger than any semi-axis the whole scene may be, so that squares of the way to a light in semi-axes stay within
/// `f64`.
const MAX_WORLD: f64 = 1e120;
/// How many times larger than NEAR the window may be.
const MAX_WINDOW: f64 = 1e50;
/// How many times larger or smaller than the scene the window may be.
const MAX_PLANE: f64 = 1e250;

/// Why `scene` cannot be rendered; `None` where it can.
pub fn problem(scene: &Scene, settings: &Settings, effects: &Effects) -> Option<String> {
    sizes(scene, settings).or_else(|| Brightness::of(scene, effects).problem(scene, Scalar::Double))
}

/// What is too large or too small beside the rest.
fn sizes(scene: &Scene, settings: &Settings) -> Option<String> {
    let world = settings.view.relative(scene);
    let sphere = |index: usize| format!("sphere '{}'", scene.sphere_names.get(index));
    let light = |index: usize| format!("light '{}'", scene.light_names.get(index));
    let Units { factor, greatest, .. } = Units::of(&world, settings.secondary);

    let far_sphere = || world.spheres.par_iter().position_first(|s| !s.center.is_finite()).map(sphere);
    let far_light = world.lights.iter().position(|light| !light.position.is_finite()).map(light);
    if let Some(name) = far_light.or_else(|| if greatest.is_finite() { None } else { far_sphere() }) {
        return Some(format!("{name} is so far from the eye that f64 cannot hold the distance"));
    }
    let is_small = |s: &Sphere| s.scale.abs().min_element() * factor * MAX_WORLD < greatest;
    if let Some(name) = world.spheres.par_iter().position_first(is_small).map(sphere) {
        return Some(format!("the scene is more than {MAX_WORLD:.0e} times larger than the least semi-axis of {name}"));
    }

    let Window { near, left, right, bottom, top } = scene.window;
    let window = [left, right, bottom, top].iter().fold(near, |greatest, edge| greatest.max(edge.abs()));
    if window / near > MAX_WINDOW {
        return Some(format!("the window is more than {MAX_WINDOW:.0e} times larger than NEAR"));
    }
    let fits = |x: f64| x * factor <= greatest * MAX_PLANE && x * factor * MAX_PLANE >= greatest;
    (greatest > 0.0 && !(fits(window) && fits(near)))
        .then(|| format!("NEAR or the window is more than {MAX_PLANE:.0e} times larger or smaller than the scene"))
}
