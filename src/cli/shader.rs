//! `trueray shader`.

use std::path::PathBuf;

use super::failure::{Failure, USAGE};
use super::input::Loaded;
use super::options::{DeviceOptions, PictureOptions, open_device};
use super::output::out;
use super::particles::Reading;
use super::sampling::SamplingOptions;
use crate::gpu::{Error, GpuRenderer, Options, Pixels, Rows, Specialisation};
use crate::words::visible;

/// Arguments of `trueray shader`.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// Scene file; `-` is standard input
    #[arg(value_name = "SCENE", help_heading = "Scene")]
    scene: PathBuf,
    /// The kernel, by its entry point; without it the one that casts the primary rays
    #[arg(long, value_name = "NAME", help_heading = "Output")]
    entry: Option<String>,
    /// Print the SPIR-V that the driver gets, disassembled; the WGSL's bindings are numbered anew there, in their order
    #[arg(long, help_heading = "Output")]
    spirv: bool,
    #[command(flatten)]
    picture: PictureOptions,
    #[command(flatten)]
    sampling: SamplingOptions,
    #[command(flatten)]
    device: DeviceOptions,
}

pub(super) fn run(args: &Args) -> Result<(), Failure> {
    if !args.device.uses_vulkan() {
        return Err(Failure::new(USAGE, "the CPU reference runs no shader: `--device cpu` has none to print"));
    }
    let settings = args.picture.settings()?;
    let mut loaded = Loaded::read(&args.scene, &Reading::usual(&args.picture)?, false)?;
    args.picture.frame(&mut loaded.scene)?;
    let scene = &loaded.scene;
    let is_in_part = args.sampling.choice((scene.width, scene.height))?.is_some();
    let viewed = scene.viewed(&settings);
    let effects = args.picture.renderable_effects(&viewed)?;
    let gpu = open_device(&args.device.device)?;
    let selection = args.device.selection(Some(&gpu), &viewed, &effects);
    let (tier, options) = (selection.tier, Options { certified: selection.certified, ..Options::default() });
    let kernels = if is_in_part {
        *GpuRenderer::<Pixels>::with(&gpu, &viewed, &effects, tier, &options)?.specialisation()
    } else {
        *GpuRenderer::<Rows>::with(&gpu, &viewed, &effects, tier, &options)?.specialisation()
    };
    let entry = chosen(args.entry.as_deref(), &kernels)?;
    let comment = if args.spirv { ";" } else { "//" };
    let names = kernels.entry_points();
    let which = if names.len() == 1 { "the kernel".into() } else { format!("one of the kernels {}", names.join(", ")) };
    let text = if args.spirv { kernels.disassembly(entry).map_err(Error::Shader)? } else { kernels.listing(entry) };
    out!(
        "{comment} {entry}, {which} of {} at {selection} on {}\n{text}",
        visible(&loaded.name),
        visible(&gpu.device.info.to_string())
    );
    Ok(())
}

/// The entry point that is asked for.
fn chosen(name: Option<&str>, kernels: &Specialisation) -> Result<&'static str, Failure> {
    let names = kernels.entry_points();
    let found = name.map_or(names.first(), |name| names.iter().find(|known| **known == name));
    found.copied().ok_or_else(|| {
        let (name, names) = (visible(name.unwrap_or_default()), names.join(", "));
        Failure::new(USAGE, format!("this picture has no kernel `{name}`\n  help: it has {names}"))
    })
}
