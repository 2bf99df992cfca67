//! A camera on its way round a scene, on a device that keeps its kernels and what it has prepared: `cargo run --release --example frame_loop SCENE.txt`.

#![allow(clippy::print_stdout, clippy::print_stderr, reason = "an example says what it does")]

use std::time::Instant;

use trueray::{DVec3, Renderer, Scene, Settings, View};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let path = std::env::args().nth(1).ok_or("usage: frame_loop SCENE.txt")?;
    let scene = Scene::read(path)?;
    let renderer = Renderer::on("auto")?;
    let views = renderer.views(&scene, &Settings::default())?;
    for frame in 0..8 {
        let start = Instant::now();
        let eye = DVec3::new(0.25 * f64::from(frame), 0.0, 0.0);
        let view = View::new(eye, Some(DVec3::new(0.0, 0.0, -10.0)), DVec3::Y)?;
        let picture = views.render(&view)?;
        picture.write(format!("frame_{frame}.png"))?;
        println!("frame {frame}: {:.0} ms", start.elapsed().as_secs_f64() * 1e3);
    }
    Ok(())
}
