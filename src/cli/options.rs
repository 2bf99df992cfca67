//! Options that several subcommands share.

use super::failure::{Failure, SCENE, USAGE};
use super::output::errln;
use clap::Args;
use glam::DVec3;

use crate::doubts::doubts;
use crate::effects::{Effects, Request};
use crate::gpu::{Choice, Error, Gpu};
use crate::limits;
use crate::pattern::{Filter, Pattern, Placing};
use crate::precision::{self, Selection, Tier};
use crate::scene::{Fov, Scene, resolution};
use crate::settings::{Convention, Quantize, SampleOffset, Secondary, Settings, Specular};
use crate::view::Projection;
#[cfg(feature = "view")]
use crate::view::View;
use crate::viewed::ViewedScene;
#[cfg(feature = "view")]
use crate::viewer::{FlightScale, Pose, ViewState};
use crate::views::Placement;

/// What decides the picture besides the scene.
#[derive(Debug, Args)]
#[command(next_help_heading = "Picture")]
pub(super) struct PictureOptions {
    /// Rendering rules: `classic` is what the assignment's official pictures pin, `exact` what the physics says
    #[arg(long, value_enum, default_value_t = Convention::Classic)]
    convention: Convention,
    /// Where in its pixel the sample lies
    #[arg(long, value_enum)]
    sampling: Option<SampleOffset>,
    /// How a colour becomes an 8-bit level
    #[arg(long, value_enum)]
    quantize: Option<Quantize>,
    /// Least distance of shadow and reflection hits: 0 in the exact convention, there also called `skip-self`
    #[arg(long, value_name = "T", value_parser = secondary)]
    secondary_epsilon: Option<Secondary>,
    /// Specular term
    #[arg(long, value_enum)]
    specular: Option<Specular>,
    /// Greatest number of bounces, reflected or refracted
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = clap::value_parser!(u32).range(0..=i64::from(Settings::MAX_DEPTH)))]
    max_depth: u32,
    /// Samples of each pixel, up to 256; on a regular grid a square number
    #[arg(long = "spp", value_name = "N", default_value = "1", value_parser = samples)]
    samples: u32,
    /// How the samples of a pixel are placed
    #[arg(long, value_enum, default_value_t = Placing::Grid)]
    pattern: Placing,
    /// How samples are spread over the pixel and around it, with `--pattern fibonacci`
    #[arg(long, value_enum, default_value_t = Filter::Box)]
    filter: Filter,
    /// Picture size in place of the scene's RES
    #[arg(long, value_name = "WxH", value_parser = resolution)]
    res: Option<(u32, u32)>,
    /// What to simulate: auto, all, none, a list such as `ambient,diffuse` (exactly those), or changes such as `-shadows,+shells`
    #[arg(long, value_name = "LIST", default_value = "auto", allow_hyphen_values = true)]
    effects: Request,
    #[command(flatten)]
    camera: CameraOptions,
}

/// The camera in place of the file's; without --fov the window stays the file's.
#[derive(Debug, Args)]
#[command(next_help_heading = "Camera")]
struct CameraOptions {
    /// The eye
    #[arg(long, value_name = "X,Y,Z", default_value = "0,0,0", allow_hyphen_values = true, value_parser = vector)]
    eye: DVec3,
    /// The point in the middle of the view; without it the eye looks along -Z
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = vector)]
    look_at: Option<DVec3>,
    /// The direction that is upwards in the picture
    #[arg(long, value_name = "X,Y,Z", default_value = "0,1,0", allow_hyphen_values = true, value_parser = vector)]
    up: DVec3,
    /// The vertical field of view, from the bottom to the top of the picture: a symmetric window at NEAR with square pixels in place of
    /// LEFT, RIGHT, BOTTOM and TOP
    #[arg(long, value_name = "DEGREES", allow_negative_numbers = true)]
    fov: Option<Fov>,
    /// Whether rays come from the eye or are parallel: an orthographic picture shows the window's own width and height of the world
    #[arg(long, value_enum, default_value_t = Projection::Perspective)]
    projection: Projection,
}

impl PictureOptions {
    /// Where the eye is.
    pub(super) fn placement(&self) -> Placement {
        let CameraOptions { eye, look_at, up, fov, projection } = self.camera;
        Placement { eye, look_at, up, fov, projection }
    }

    /// Fails where the camera options define no view.
    pub(super) fn settings(&self) -> Result<Settings, Failure> {
        let base = self.convention.settings();
        Ok(Settings {
            view: self.placement().view().map_err(|error| Failure::new(USAGE, error.to_string()))?,
            sampling: self.sampling.unwrap_or(base.sampling),
            quantize: self.quantize.unwrap_or(base.quantize),
            secondary: self.secondary_epsilon.unwrap_or(base.secondary),
            specular: self.specular.unwrap_or(base.specular),
            max_depth: self.max_depth,
            pattern: self.pattern("--spp", self.samples)?,
        })
    }

    /// The pattern with so many samples, which `option` asks for.
    pub(super) fn pattern(&self, option: &str, count: u32) -> Result<Pattern, Failure> {
        let pattern = Pattern::one_of(self.pattern, self.filter).ok_or_else(|| {
            Failure::new(USAGE, "a regular grid has no --filter but the box\n  help: --pattern fibonacci")
        })?;
        pattern.with_count(count).map_err(|why| {
            let help = if pattern == Pattern::ONE { "\n  help: --pattern fibonacci takes any number" } else { "" };
            Failure::new(USAGE, format!("{option} {count}: {why}{help}"))
        })
    }

    /// What a page of `trueray view` starts with.
    #[cfg(feature = "view")]
    pub(super) fn view_state(&self, scene: &Scene, precision: precision::Request) -> Result<ViewState, Failure> {
        let settings = self.settings()?;
        let CameraOptions { eye, look_at, up, fov, projection } = self.camera;
        if projection == Projection::Orthographic {
            return Err(Failure::new(
                USAGE,
                "the live view is perspective only\n  help: trueray render --projection orthographic",
            ));
        }
        let pose =
            look_at.map_or_else(|| Pose::ahead(eye, up, FlightScale::of(scene)), |look_at| Pose { eye, look_at, up });
        let pose = (settings.view != View::FILE).then_some(pose);
        Ok(ViewState { pose, settings, effects: self.effects.clone(), precision, res: self.res, fov })
    }

    pub(super) fn effects(&self, viewed: &ViewedScene) -> Effects {
        Effects::requested(viewed, &self.effects)
    }

    /// The size that `--res` asks for.
    pub(super) fn resolution(&self) -> Option<(u32, u32)> {
        self.res
    }

    /// The same, or a refusal where so deep a tree of rays would never end, or where not even `f64` renders the scene.
    pub(super) fn renderable_effects(&self, viewed: &ViewedScene) -> Result<Effects, Failure> {
        let effects = self.effects(viewed);
        if let Some(why) = effects.too_deep(viewed.scene()) {
            let help = format!("help: --max-depth {} is the most for this scene", Effects::MAX_WAITING);
            return Err(Failure::new(USAGE, format!("{why}\n  {help}")));
        }
        if let Some(why) = limits::problem(viewed, &effects) {
            return Err(Failure::new(SCENE, format!("the scene cannot be rendered: {why}")));
        }
        Ok(effects)
    }

    /// Refuses `--fov`, where scenes are built in.
    pub(super) fn check_window(&self) -> Result<(), Failure> {
        match self.camera.fov {
            Some(_) => Err(Failure::new(USAGE, "built-in scenes have windows of their own: --fov is for scene files")),
            None => Ok(()),
        }
    }

    /// Applies `--res` and `--fov`.
    pub(super) fn frame(&self, scene: &mut Scene) -> Result<(), Failure> {
        (scene.width, scene.height) = self.res.unwrap_or((scene.width, scene.height));
        let framed = self.camera.fov.map_or(Ok(()), |fov| scene.set_fov(fov));
        framed.map_err(|error| Failure::new(USAGE, format!("--fov: {error}")))
    }

    /// Likewise; returns doubts about the picture.
    pub(super) fn frame_with_doubts(&self, scene: &mut Scene, settings: &Settings) -> Result<Vec<String>, Failure> {
        if self.camera.fov.is_some() {
            self.frame(scene)?;
            // Its pixels are square, whatever the size.
            return Ok(doubts(scene, settings, None));
        }
        let found = doubts(scene, settings, self.res);
        self.frame(scene)?;
        Ok(found)
    }
}

/// Which device renders.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Device")]
pub(super) struct DeviceOptions {
    /// auto, cpu, gpu (never falls back), an index of `trueray devices`, part of a device's name or driver, or its PCI id
    #[arg(long, value_name = "DEVICE", default_value = "auto")]
    pub device: Choice,
    /// Tier of the kernel: fast, robust, double, or auto for the cheapest that covers the scene; or certified: every pixel is the CPU
    /// reference's
    #[arg(long, value_name = "TIER", default_value = "auto")]
    pub precision: precision::Request,
}

/// Which device renders, or which two.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Device")]
pub(super) struct SeveralDevices {
    /// auto, cpu, gpu (never falls back), an index of `trueray devices`, part of a device's name or driver, or its PCI id; twice to
    /// compare the pictures of two devices
    #[arg(long, value_name = "DEVICE", default_value = "auto")]
    device: Vec<Choice>,
    /// Tier of the kernel: fast, robust, double, or auto for the cheapest that covers the scene; or certified: every pixel is the CPU
    /// reference's
    #[arg(long, value_name = "TIER", default_value = "auto")]
    precision: precision::Request,
}

impl SeveralDevices {
    /// The first of them.
    pub(super) fn first(&self) -> DeviceOptions {
        self.with(self.device.first().unwrap_or(&Choice::Auto))
    }

    /// Both of them, if there are two.
    pub(super) fn pair(&self) -> Result<Option<[DeviceOptions; 2]>, Failure> {
        match &self.device[..] {
            [a, b] => Ok(Some([self.with(a), self.with(b)])),
            [_, _, ..] => Err(Failure::new(USAGE, "compare takes two devices at most")),
            _ => Ok(None),
        }
    }

    fn with(&self, device: &Choice) -> DeviceOptions {
        DeviceOptions { device: device.clone(), precision: self.precision }
    }
}

impl DeviceOptions {
    /// The Vulkan device, or `None` for the CPU reference. `auto` takes the reference where no device can be used at all, and says
    /// why.
    pub(super) fn open(&self) -> Result<Option<Gpu>, Error> {
        self.open_with(false)
    }

    /// Likewise; where it is to be `quiet`, nothing is said but that.
    pub(super) fn open_with(&self, quiet: bool) -> Result<Option<Gpu>, Error> {
        let gpu = match &self.device {
            Choice::Cpu => return Ok(None),
            Choice::Auto => match Gpu::open(&Choice::Auto) {
                Err(Error::NoneFound(why)) => {
                    errln!("trueray: rendering on the CPU reference: {why}");
                    return Ok(None);
                }
                result => result?,
            },
            choice => Gpu::open(choice)?,
        };
        if !quiet {
            warn_of_tuning(&gpu);
        }
        Ok(Some(gpu))
    }
}

/// Opens a Vulkan device, and says where a tuning that is kept for it cannot be used.
pub(super) fn open_device(choice: &Choice) -> Result<Gpu, Error> {
    let gpu = Gpu::open(choice)?;
    warn_of_tuning(&gpu);
    Ok(gpu)
}

fn warn_of_tuning(gpu: &Gpu) {
    if let Some(warning) = &gpu.tuned().warning {
        errln!("trueray: {warning}");
    }
}

impl DeviceOptions {
    /// Whether a Vulkan device is asked for, or any that there is.
    pub(super) fn uses_vulkan(&self) -> bool {
        self.device != Choice::Cpu
    }

    /// Refuses what is no tier, where the kernels of tiers are measured.
    pub(super) fn check_tier(&self) -> Result<(), Failure> {
        let message = "--precision certified is no tier: several kernels render a certified picture\n  help: --precision auto, \
                       fast, robust or double";
        if self.precision == precision::Request::Certified { Err(Failure::new(USAGE, message)) } else { Ok(()) }
    }

    /// The tier that renders `viewed` on `gpu`, or would on hardware where there is none.
    pub(super) fn selection(&self, gpu: Option<&Gpu>, viewed: &ViewedScene, effects: &Effects) -> Selection {
        Selection::of(viewed, effects, self.precision, gpu.map_or(&Tier::ALL, Gpu::ladder))
    }
}

fn secondary(text: &str) -> Result<Secondary, String> {
    if text == "skip-self" {
        return Ok(Secondary::EXACT);
    }
    match text.parse::<f64>() {
        Ok(epsilon) if (0.0..1.0).contains(&epsilon) => Ok(Secondary { shadow: epsilon, reflection: epsilon }),
        _ => Err("expected a number from 0 to below 1, or `skip-self`".into()),
    }
}

/// A number of samples.
pub(super) fn samples(text: &str) -> Result<u32, String> {
    let count = text.parse().ok().filter(|count| (1..=Pattern::MAX_COUNT).contains(count));
    count.ok_or_else(|| format!("expected a number from 1 to {}, of a grid a square number", Pattern::MAX_COUNT))
}

/// Three coordinates.
fn vector(text: &str) -> Result<DVec3, String> {
    let numbers: Option<Vec<f64>> = text.split(',').map(|number| number.trim().parse().ok()).collect();
    match numbers.as_deref() {
        Some(&[x, y, z]) if [x, y, z].iter().all(|number| number.is_finite()) => Ok(DVec3::new(x, y, z)),
        _ => Err("expected three finite numbers X,Y,Z such as 0,1.5,-2".into()),
    }
}
