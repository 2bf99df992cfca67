//! Scenes whose numbers leave the range of those that render them: they are refused.

use rayon::prelude::*;

use crate::brightness::{Brightness, Scalar};
use crate::effects::{Effect, Effects};
use crate::geometry::extent;
use crate::viewed::ViewedScene;

/// How many times larger than any semi-axis the whole scene may be, so that squares of the way to a light in semi-axes stay within
/// `f64`.
const MAX_WORLD: f64 = 1e120;
/// Likewise, and the way to any light that casts shadows, so that such squares stay within `f32`.
const MAX_SINGLE: f64 = 5e18;
/// How many times larger than NEAR the window may be.
const MAX_WINDOW: f64 = 1e50;
/// How many times larger or smaller than the scene the window may be.
const MAX_PLANE: f64 = 1e250;

/// Why `viewed` cannot be rendered at all; `None` where it can.
pub fn problem(viewed: &ViewedScene, effects: &Effects) -> Option<String> {
    let scene = viewed.scene();
    sizes(viewed).or_else(|| Brightness::of(viewed, effects).problem(scene, Scalar::Double))
}

/// Why kernels of this scalar cannot render `viewed`, which can be rendered; `None` where they can.
pub fn problem_in(scalar: Scalar, viewed: &ViewedScene, effects: &Effects) -> Option<String> {
    let scene = viewed.scene();
    let world = || {
        let reach = reach(viewed, effects);
        let name = name_of_small(viewed, |axis| axis * MAX_SINGLE < reach)?;
        Some(format!("the scene is more than {MAX_SINGLE:.0e} times larger than the least semi-axis of {name}"))
    };
    let brightness = Brightness::of(viewed, effects).problem(scene, scalar);
    brightness.or_else(|| if scalar == Scalar::Single { world() } else { None })
}

/// The greatest coordinate of a sphere or of a light that casts shadows.
pub fn reach(viewed: &ViewedScene, effects: &Effects) -> f64 {
    let casts = effects.set.has(Effect::Shadows);
    let lights = viewed.scene().lights.iter().filter(|_| casts).map(|light| extent(light.position));
    lights.fold(viewed.greatest(), f64::max)
}

/// The first sphere whose least semi-axis is small, in words.
fn name_of_small(viewed: &ViewedScene, is_small: impl Fn(f64) -> bool) -> Option<String> {
    // Where the least one is not, none is.
    let scene = Some(viewed.scene()).filter(|_| is_small(viewed.census().least.value))?;
    let first = scene.spheres.iter().position(|s| is_small(s.scale.abs().min_element()))?;
    Some(scene.sphere_names.in_words("sphere", first))
}

/// What is too large or too small beside the rest.
fn sizes(viewed: &ViewedScene) -> Option<String> {
    let (scene, greatest) = (viewed.scene(), viewed.greatest());
    let sphere = |index: usize| scene.sphere_names.in_words("sphere", index);
    let light = |index: usize| scene.light_names.in_words("light", index);

    let far_sphere = || scene.spheres.par_iter().position_first(|s| !s.center.is_finite()).map(sphere);
    let far_light = scene.lights.iter().position(|light| !light.position.is_finite()).map(light);
    if let Some(name) = far_light.or_else(|| if greatest.is_finite() { None } else { far_sphere() }) {
        return Some(format!("{name} is so far from the eye that f64 cannot hold the distance"));
    }
    if let Some(name) = name_of_small(viewed, |axis| axis * MAX_WORLD < greatest) {
        return Some(format!("the scene is more than {MAX_WORLD:.0e} times larger than the least semi-axis of {name}"));
    }

    let in_file = viewed.in_file().0.window;
    if in_file.greatest() / in_file.near > MAX_WINDOW {
        return Some(format!("the window is more than {MAX_WINDOW:.0e} times larger than NEAR"));
    }
    let fits = |x: f64| x <= greatest * MAX_PLANE && x * MAX_PLANE >= greatest;
    (greatest > 0.0 && !(fits(scene.window.greatest()) && fits(scene.window.near)))
        .then(|| format!("NEAR or the window is more than {MAX_PLANE:.0e} times larger or smaller than the scene"))
}
