//! `trueray view`.

use std::net::SocketAddr;
use std::path::PathBuf;
use std::sync::Arc;

use super::failure::{Failure, NO_THREAD, OUTPUT, USAGE};
use super::input::Loaded;
use super::options::{DeviceOptions, PictureOptions};
use super::output::{errln, outln};
use super::particles::ParticleOptions;
use crate::gpu;
use crate::gpu::USUAL_KERNELS;
use crate::threads::{at_once, is_alone};
use crate::viewer::{ReadScene, RenderLoop, SceneFile, Server, watch};

/// Arguments of `trueray view`.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// Scene file; it is read again whenever it changes
    #[arg(value_name = "SCENE", help_heading = "Scene")]
    scene: PathBuf,
    #[command(flatten)]
    picture: PictureOptions,
    #[command(flatten)]
    particles: ParticleOptions,
    #[command(flatten)]
    device: DeviceOptions,
    /// Where the page is served; port 0 is any free one
    #[arg(long, value_name = "ADDRESS:PORT", default_value = "127.0.0.1:0", help_heading = "Device")]
    listen: SocketAddr,
    /// Print errors only, the address, and whether it is served to the network
    #[arg(short, long, help_heading = "Output")]
    quiet: bool,
}

pub(super) fn run(args: &Args) -> Result<(), Failure> {
    if args.scene.as_os_str() == "-" {
        return Err(Failure::new(USAGE, "a scene that is to be watched must be a file"));
    }
    args.picture.settings()?;
    let reading = args.particles.one_frame(&args.picture)?;
    if is_alone() {
        return Err(Failure::new(
            NO_THREAD,
            "the system gives no thread for the pictures: `ulimit -u` says how many there may be",
        ));
    }
    // Opening a device takes longer than reading most scenes: both at once. A page may come before either.
    let server = Server::bind(args.listen)
        .map_err(|error| Failure::new(OUTPUT, format!("cannot listen at {}: {error}", args.listen)))?;
    let (gpu, loaded) =
        at_once(|| args.device.open_with(args.quiet), || Loaded::read(&args.scene, &reading, args.quiet));
    let (loaded, gpu) = (loaded?, gpu?);
    // Whoever is quiet wants to know this all the same.
    if !args.listen.ip().is_loopback() {
        errln!("trueray: the page is served to the network, without encryption");
    }
    let view = args.picture.view_state(&loaded.scene, args.device.precision)?;
    let read = ReadScene { scene: loaded.scene, lamps: loaded.lamps };
    let render_loop = Arc::new(RenderLoop::new(SceneFile::new(&args.scene, read, reading.options), view));
    let no_thread = |error: std::io::Error| Failure::new(NO_THREAD, format!("the system gives no thread: {error}"));
    watch(Arc::clone(&render_loop.scene_file), Arc::clone(&render_loop.wake), Arc::clone(&render_loop.quit))
        .map_err(no_thread)?;
    let rendering = Arc::clone(&render_loop);
    let device = args.device.clone();
    let mut opened = Some(gpu);
    let mut open = move || -> Result<_, gpu::Error> {
        let gpu = opened.take().map_or_else(|| device.open_with(true), Ok)?;
        Ok(gpu.map(|gpu| Arc::new(gpu.keeping_kernels(USUAL_KERNELS).interactive())))
    };
    std::thread::Builder::new().name("render".into()).spawn(move || rendering.run(&mut open)).map_err(no_thread)?;
    // All is there that can be refused: who reads this may open it.
    outln!("{}", server.url());
    server.serve(render_loop).map_err(|error| Failure::new(OUTPUT, error.to_string()))
}
