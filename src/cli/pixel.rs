//! `trueray pixel`.

use std::path::PathBuf;

use super::failure::{Failure, USAGE};
use super::files::json;
use super::input::Input;
use super::options::PictureOptions;
use super::output::out;
use super::particles::Reading;
use crate::cpu::{Inspector, MOST_RAYS};
use crate::gpu::{Choice, Error, Gpu};
use crate::misuse::check_picture;
use crate::pixel::PixelReport;
use crate::report::Labels;

/// Arguments of `trueray pixel`.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// Scene file; `-` is standard input
    #[arg(value_name = "SCENE", help_heading = "Scene")]
    scene: PathBuf,
    /// Column, 0 is the leftmost
    #[arg(value_name = "X", allow_negative_numbers = true, help_heading = "Scene")]
    x: i64,
    /// Row, 0 is the topmost
    #[arg(value_name = "Y", allow_negative_numbers = true, help_heading = "Scene")]
    y: i64,
    #[command(flatten)]
    picture: PictureOptions,
    /// Device whose tiers are shown beside the reference: auto, cpu (none), gpu, an index of `trueray devices`, part of a name or driver,
    /// or a PCI id
    #[arg(long, value_name = "DEVICE", default_value = "auto", help_heading = "Device")]
    device: Choice,
    /// Print JSON
    #[arg(long, help_heading = "Output")]
    json: bool,
}

pub(super) fn run(args: &Args) -> Result<(), Failure> {
    let mut loaded = Input::read(&args.scene, &Reading::usual(&args.picture)?)?.into_renderable(args.json)?;
    args.picture.frame(&mut loaded.scene)?;
    let (scene, settings) = (&loaded.scene, args.picture.settings()?);
    let within = |at: i64, size: u32| u32::try_from(at).ok().filter(|&at| at < size);
    let (Some(x), Some(y)) = (within(args.x, scene.width), within(args.y, scene.height)) else {
        let (Args { x, y, .. }, columns, rows) = (args, scene.width - 1, scene.height - 1);
        let message = format!("there is no pixel {x} {y}: x is from 0 to {columns}, y from 0 to {rows}");
        return Err(Failure::new(USAGE, message));
    };
    let viewed = scene.viewed(&settings);
    let effects = args.picture.renderable_effects(&viewed)?;
    let gpu = open(&args.device)?;
    check_picture(&viewed)?;
    let inspector = Inspector::new(&viewed, &effects);
    let rays = inspector.rays(x, y);
    if rays > MOST_RAYS {
        let help = "help: --max-depth and --spp show fewer of them";
        return Err(Failure::new(
            USAGE,
            format!("the pixel has {rays} rays, and a table {MOST_RAYS} at the most\n  {help}"),
        ));
    }
    let Some(record) = inspector.pixel(x, y) else { return Ok(()) };
    let mut report = PixelReport::new(&loaded.name, (&viewed, &effects), record, (x, y), gpu.as_ref());
    if let Ok(gpu) = &gpu {
        while let Some(tier) = report.next_tier(gpu) {
            report.add_tier((gpu, tier), scene.viewed(&settings), &effects, inspector.reference())?;
        }
    }
    if args.json {
        out!("{}", json(&report)?);
    } else {
        out!("{}", report.text(Labels::of(scene, settings.specular)));
    }
    Ok(())
}

/// The device, or why there is none.
fn open(choice: &Choice) -> Result<Result<Gpu, String>, Error> {
    match choice {
        Choice::Cpu => Ok(Err("--device cpu asks for none".into())),
        Choice::Auto => match Gpu::open(&Choice::Auto) {
            Err(Error::NoneFound(why)) => Ok(Err(why)),
            opened => opened.map(Ok),
        },
        choice => Gpu::open(choice).map(Ok),
    }
}
