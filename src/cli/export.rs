//! `trueray export`.

use std::path::PathBuf;

use super::failure::{Failure, SCENE, USAGE};
use super::files::save;
use super::guard::Guard;
use super::input::Loaded;
use super::options::PictureOptions;
use super::output::errln;
use super::particles::ParticleOptions;
use crate::effects::Effects;
use crate::export::{Obstacle, Peer, export};

/// Arguments of `trueray export`.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// Scene file; `-` is standard input
    #[arg(value_name = "SCENE", help_heading = "Scene")]
    scene: PathBuf,
    #[command(flatten)]
    picture: PictureOptions,
    #[command(flatten)]
    particles: ParticleOptions,
    /// The renderer: povray (3.7) or tachyon (0.99)
    #[arg(long, value_name = "RENDERER", help_heading = "Output")]
    to: Peer,
    /// File for it; `-`, the default, is standard output
    #[arg(short, long, value_name = "FILE", default_value = "-", help_heading = "Output")]
    output: PathBuf,
}

pub(super) fn run(args: &Args) -> Result<(), Failure> {
    Guard::new([&args.scene]).options([("--output", &Some(args.output.clone()))])?;
    let reading = args.particles.one_frame(&args.picture)?;
    let mut loaded = Loaded::read(&args.scene, &reading, false)?;
    args.picture.frame(&mut loaded.scene)?;
    let (scene, settings) = (&loaded.scene, args.picture.settings()?);
    let viewed = scene.viewed(&settings);
    let effects = args.picture.effects(&viewed);
    if effects != Effects::of(&viewed) {
        return Err(Failure::new(USAGE, "a scene is exported with what it calls for: leave --effects out"));
    }
    drop(viewed);
    let export =
        export(scene, &settings, &effects, args.to).map_err(|obstacles| refusal(args.to, &loaded, &obstacles))?;
    for warning in &export.warnings {
        errln!("trueray: {}: warning: {warning}", crate::words::visible(&loaded.name));
    }
    save(&args.output, &export.text)
}

/// Names everything that stands in the way; what the settings ask for is a matter of usage.
fn refusal(peer: Peer, loaded: &Loaded, obstacles: &[Obstacle]) -> Failure {
    let in_scene = obstacles.iter().any(|obstacle| matches!(obstacle, Obstacle::Scene(_)));
    let list: String = obstacles.iter().map(|obstacle| format!("\n  {obstacle}")).collect();
    let (code, what) = if in_scene { (SCENE, "this scene") } else { (USAGE, "what the options ask for") };
    Failure::new(code, format!("{}: {peer} cannot express {what}:{list}", loaded.name))
}
