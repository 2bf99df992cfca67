//! Whether every device of this machine shows the reference's picture: `cargo run --release --example compare_devices SCENE.txt`.

#![allow(clippy::print_stdout, clippy::print_stderr, reason = "an example says what it does")]

use trueray::{Difference, Error, Renderer, Scene, Settings};

fn main() -> Result<(), Error> {
    let Some(path) = std::env::args().nth(1) else {
        eprintln!("usage: compare_devices SCENE.txt");
        std::process::exit(2);
    };
    let (scene, settings) = (Scene::read(path)?, Settings::default());
    let expected = Renderer::reference().render(&scene, &settings)?;
    for (index, name) in Renderer::devices()?.iter().enumerate() {
        let renderer = Renderer::on(&index.to_string())?;
        let picture = renderer.render(&scene, &settings)?;
        let difference = Difference::between(&picture, &expected)?;
        let unexplained = renderer.explain(&picture, &scene, &settings)?.unexplained;
        println!("{name}: {} pixels differ, {unexplained} of them unexplained", difference.differing.over_0);
    }
    Ok(())
}
