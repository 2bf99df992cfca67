//! Doubts about a scene that has no errors: what can hardly be meant, such as a picture in which nothing is seen.

use glam::DVec3;

use crate::scene::{Scene, Sphere, Window};
use crate::settings::Settings;

/// Each doubt about the picture of `scene` in a sentence; `size` is the picture's if it is not the scene's own.
///
/// Names of the file are not in them. None of it keeps a picture from being rendered.
pub fn doubts(scene: &Scene, settings: &Settings, size: Option<(u32, u32)>) -> Vec<String> {
    let stretched = size.and_then(|size| stretched(scene, size));
    [unseen(scene, settings), unlit(scene), stretched].into_iter().flatten().collect()
}

/// Why no sphere can be in the picture.
fn unseen(scene: &Scene, settings: &Settings) -> Option<String> {
    if scene.spheres.is_empty() {
        return Some("nothing can be seen: there is no SPHERE".into());
    }
    let [right, up, back] = settings.view.axes();
    let eye = settings.view.eye;
    // How far a sphere reaches in a direction of any length.
    let reach =
        |sphere: &Sphere, direction: DVec3| direction.dot(sphere.center - eye) + (direction * sphere.scale).length();
    let Window { near, left, right: end, bottom, top } = scene.window;
    // What overflows is no reason for a doubt: the comparisons are such that NaN passes.
    let is_ahead = |sphere: &&Sphere| !(reach(sphere, -back) <= 0.0);
    let is_beyond = |sphere: &&Sphere| !(reach(sphere, -back) < near);
    // Inwards from each edge of the window, whichever of two edges is the greater.
    let edges = [(right, left.min(end)), (-right, -left.max(end)), (up, bottom.min(top)), (-up, -bottom.max(top))];
    let is_inwards = |sphere: &Sphere, (axis, edge): (DVec3, f64)| {
        if settings.view.is_parallel() {
            !(reach(sphere, axis) < edge)
        } else {
            !(reach(sphere, axis * near + back * edge) < 0.0)
        }
    };
    let is_within = |sphere: &&Sphere| edges.iter().all(|&edge| is_inwards(sphere, edge));
    let spheres = || scene.spheres.iter();
    let why = if !spheres().any(|sphere| is_ahead(&sphere)) {
        "every sphere is behind the eye; it looks along -Z where no --look-at turns it"
    } else if !spheres().any(|sphere| is_beyond(&sphere)) {
        "every sphere lies before the image plane, nearer than NEAR"
    } else if !spheres().any(|sphere| is_beyond(&sphere) && is_within(&sphere)) {
        "every sphere lies beside the window"
    } else {
        return None;
    };
    Some(format!("nothing can be seen: {why}"))
}

/// Whether spheres ask for light where there is none.
fn unlit(scene: &Scene) -> Option<String> {
    let asks = scene.spheres.iter().any(|sphere| sphere.kd != 0.0 || sphere.ks != 0.0);
    let dark = scene.lights.iter().all(|light| light.intensity == DVec3::ZERO);
    (asks && dark).then(|| {
        let lights = if scene.lights.is_empty() { "there is no LIGHT" } else { "every LIGHT has intensity 0" };
        format!("{lights} for spheres with Kd or Ks: they show AMBIENT and reflections alone")
    })
}

/// Whether another size gives the picture another shape without making its pixels square.
fn stretched(scene: &Scene, (width, height): (u32, u32)) -> Option<String> {
    let own = f64::from(scene.width) / f64::from(scene.height);
    let Window { left, right, bottom, top, .. } = scene.window;
    let window = ((right - left) / (top - bottom)).abs();
    // A side is off by less than a pixel of what the shape asks for.
    let fits = |shape: f64| {
        let (width, height) = (f64::from(width), f64::from(height));
        (width - height * shape).abs() < 1.0 || (height - width / shape).abs() < 1.0
    };
    if fits(own) || fits(window) {
        return None;
    }
    let rows = (f64::from(width) / own).round().max(1.0);
    Some(format!(
        "--res {width}x{height} distorts the picture: the scene's is {} × {}; {width}x{rows} keeps its shape",
        scene.width, scene.height
    ))
}
