//! Renders a scene file to a PNG file: `cargo run --release --example render SCENE.txt PICTURE.png`.

#![allow(clippy::print_stdout, clippy::print_stderr, reason = "an example says what it does")]

use trueray::{Error, Renderer, Scene, Settings};

fn main() -> Result<(), Error> {
    let arguments: Vec<String> = std::env::args().collect();
    let [_, scene, picture] = arguments.as_slice() else {
        eprintln!("usage: render SCENE.txt PICTURE.png");
        std::process::exit(2);
    };
    let scene = Scene::read(scene)?;
    // A machine without a Vulkan device renders on its processor.
    let renderer = Renderer::on("auto")?;
    renderer.render(&scene, &Settings::default())?.write(picture).map_err(Error::from)
}
