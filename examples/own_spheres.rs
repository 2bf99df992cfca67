//! A thousand spheres that no file says, on a spiral: `cargo run --release --example own_spheres`.

#![allow(clippy::print_stdout, clippy::print_stderr, reason = "an example says what it does")]

use trueray::{DVec3, Error, Light, Renderer, Scene, Settings, Sphere, Window};

fn main() -> Result<(), Error> {
    let sphere = |index: u32| {
        let turn = f64::from(index) * 2.4;
        let radius = 0.05 * f64::from(index).sqrt();
        let center = DVec3::new(radius * turn.cos(), radius * turn.sin(), -3.0);
        Sphere { ks: 0.4, n: 40.0, ..Sphere::new(center, 0.06, [0.9, f64::from(index) / 1e3, 0.2]) }
    };
    let scene = Scene {
        spheres: (0..1000).map(sphere).collect(),
        lights: vec![Light { position: DVec3::new(2.0, 3.0, 0.0), intensity: DVec3::splat(0.9) }],
        background: DVec3::splat(0.1),
        ambient: DVec3::splat(0.1),
        ..Scene::new(Window::default(), 600, 600)
    };
    Renderer::on("auto")?.render(&scene, &Settings::exact())?.write("own_spheres.png")?;
    println!("own_spheres.png: {} spheres", scene.spheres.len());
    Ok(())
}
