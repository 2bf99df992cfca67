//! `trueray verify`: is a finished picture the one of its scene, pixel by pixel?

use std::path::PathBuf;

use serde::Serialize;

use super::compare::open;
use super::failure::{DIFFERENT, Failure, OK, USAGE};
use super::files::report_json;
use super::input::Input;
use super::options::{DeviceOptions, PictureOptions};
use super::output::{out, outln};
use super::particles::Reading;
use crate::certificate::{Bits, PictureHash, PictureHasher, SceneHash, Subject};
use crate::engine::{Backend, Engine, Options, Stages, device_name, render_bands};
use crate::film::{Encoded, Leniency};
use crate::gpu::{Choice, Gpu};
use crate::precision::{Request, Selection};
use crate::settings::Quantize;
use crate::words::{count, visible};

/// Arguments of `trueray verify`.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// The picture (PPM or PNG); `-` is standard input
    #[arg(value_name = "PICTURE", help_heading = "Picture file")]
    picture: PathBuf,
    /// The scene that it is of
    #[arg(long, value_name = "SCENE", help_heading = "Scene")]
    scene: PathBuf,
    /// Its certificate, which must be of this scene, these settings and this picture
    #[arg(long, value_name = "FILE", help_heading = "Picture file")]
    certificate: Option<PathBuf>,
    #[command(flatten)]
    options: PictureOptions,
    /// What calculates the right picture: auto, cpu for the reference itself, or a device, whose picture is certified
    #[arg(long, value_name = "DEVICE", default_value = "auto", help_heading = "Device")]
    device: Choice,
    /// Print JSON
    #[arg(long, help_heading = "Output")]
    json: bool,
}

/// What `--json` prints.
#[derive(Debug, Serialize)]
struct Report {
    verdict: Verdict,
    picture: String,
    scene: String,
    pixels: u64,
    /// Pixels that are not what the reference has.
    wrong_pixels: u64,
    /// The first of them, in reading order.
    first: Option<WrongPixel>,
    /// Of what else the certificate is, where one was given that does not fit.
    certificate_mismatch: Option<String>,
    /// What calculated the right picture.
    device: String,
    stages: Option<Stages>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
enum Verdict {
    Right,
    Wrong,
}

/// A pixel with both its values.
#[derive(Debug, Serialize)]
struct WrongPixel {
    x: u32,
    y: u32,
    picture: [u16; 3],
    reference: [u16; 3],
}

/// What `--json` prints where nothing could be verified.
#[derive(Debug, Serialize)]
struct Trouble<'a> {
    verdict: &'static str,
    error: &'a str,
}

pub(super) fn run(args: &Args) -> u8 {
    match verify(args) {
        Ok(code) => code,
        // One code for every trouble, as of compare.
        Err(failure) => {
            match serde_json::to_string_pretty(&Trouble { verdict: "trouble", error: &failure.message }) {
                Ok(json) if args.json => outln!("{json}"),
                _ => _ = failure.report(),
            }
            USAGE
        }
    }
}

fn verify(args: &Args) -> Result<u8, Failure> {
    let input = Input::read(&args.scene, &Reading::usual(&args.options)?)?;
    if args.json && input.parsed.scene.is_none() {
        return Err(Failure::new(USAGE, input.parsed.report(false).trim_end()));
    }
    let mut loaded = input.into_renderable(args.json)?;
    args.options.frame(&mut loaded.scene)?;
    let scene = &loaded.scene;
    let (name, encoded) = open(&args.picture)?;
    let (width, height) = encoded.size().map_err(unreadable)?;
    if (width, height) != (scene.width, scene.height) {
        let name = visible(&name);
        let message = format!("{name} has {width} × {height} pixels, the scene {} × {}", scene.width, scene.height);
        return Err(Failure::new(USAGE, message));
    }
    let levels = Levels::of(encoded)?;

    let settings = args.options.settings()?;
    let viewed = scene.viewed(&settings);
    let effects = args.options.renderable_effects(&viewed)?;
    let certificate_mismatch = match &args.certificate {
        None => None,
        Some(path) => {
            let refused = |why: String| Failure::new(USAGE, format!("the certificate {}: {why}", path.display()));
            let text = std::fs::read_to_string(path).map_err(|error| refused(error.to_string()))?;
            let subject = Subject::new(SceneHash::of(scene), &settings, &effects, levels.hash((width, height)));
            subject.mismatch(&text).map_err(refused)?
        }
    };

    let options = DeviceOptions { device: args.device.clone(), precision: Request::Certified };
    let gpu = options.open_with(args.json)?;
    let linear = matches!(levels, Levels::Sixteen(_));
    let selection = options.selection(gpu.as_ref(), &viewed, &effects).with_colors(linear);
    let wanted = Options { linear, ..Options::default() };
    let mut engine = Engine::with(Backend::of(gpu.as_ref(), &selection), viewed, &effects, &wanted)?;
    let (wrong_pixels, first) = wrong(&levels, settings.quantize, &mut engine)?;
    let is_right = wrong_pixels == 0 && certificate_mismatch.is_none();
    let report = Report {
        verdict: if is_right { Verdict::Right } else { Verdict::Wrong },
        picture: name,
        scene: loaded.name.clone(),
        pixels: u64::from(width) * u64::from(height),
        wrong_pixels,
        first,
        certificate_mismatch,
        device: device_name(gpu.as_ref()),
        stages: engine.stages(),
    };
    if args.json {
        out!("{}", report_json(&report)?);
    } else {
        report.print(args.certificate.is_some(), gpu.as_ref(), &selection);
    }
    Ok(if is_right { OK } else { DIFFERENT })
}

fn unreadable(error: impl std::fmt::Display) -> Failure {
    Failure::new(USAGE, error.to_string())
}

/// The levels of a picture, 3 a pixel.
enum Levels {
    Eight(Vec<u8>),
    Sixteen(Vec<u16>),
}

impl Levels {
    fn of(encoded: Encoded) -> Result<Self, Failure> {
        if encoded.is_deep() {
            return encoded.decode_deep().map(Self::Sixteen).map_err(unreadable);
        }
        Ok(Self::Eight(encoded.decode(Leniency::Strict).map_err(unreadable)?.picture.into_rgb()))
    }

    /// Of pixel `at`, in reading order.
    fn pixel(&self, at: usize) -> [u16; 3] {
        match self {
            Self::Eight(levels) => levels.as_chunks::<3>().0[at].map(u16::from),
            Self::Sixteen(levels) => levels.as_chunks::<3>().0[at],
        }
    }

    fn hash(&self, (width, height): (u32, u32)) -> PictureHash {
        match self {
            Self::Eight(levels) => {
                let mut hasher = PictureHasher::new(width, height, Bits::Eight);
                hasher.add(levels);
                hasher.finish()
            }
            Self::Sixteen(levels) => {
                let mut hasher = PictureHasher::new(width, height, Bits::Sixteen);
                levels.as_chunks::<3>().0.iter().for_each(|&pixel| hasher.add_deep(pixel));
                hasher.finish()
            }
        }
    }
}

/// How many pixels of a picture are not what `engine` has, and the first of them.
fn wrong(levels: &Levels, quantize: Quantize, engine: &mut Engine) -> Result<(u64, Option<WrongPixel>), Failure> {
    let width = engine.size().0;
    let (mut wrong, mut first) = (0, None);
    render_bands(engine, |band| {
        let start = band.first as usize * width as usize;
        for (at, &eight) in (start..).zip(band.rgb.as_chunks::<3>().0) {
            let reference = match band.linear.get(at - start) {
                Some(pixel) => quantize.levels16(pixel.color),
                None => eight.map(u16::from),
            };
            let picture = levels.pixel(at);
            if picture != reference {
                wrong += 1;
                let [x, y] = [at % width as usize, at / width as usize].map(|at| at as u32);
                first.get_or_insert(WrongPixel { x, y, picture, reference });
            }
        }
        Ok::<_, Failure>(())
    })?;
    Ok((wrong, first))
}

impl Report {
    fn print(&self, has_certificate: bool, gpu: Option<&Gpu>, selection: &Selection) {
        outln!("picture           {}", visible(&self.picture));
        outln!("reference of      {}", visible(&self.scene));
        outln!("calculated by     {}", visible(&self.device));
        if let Some(stages) = self.stages {
            let words = if gpu.is_some() { stages.in_words(selection.tier) } else { stages.decisions_in_words() };
            outln!("                  {words}");
        }
        match &self.certificate_mismatch {
            Some(mismatch) => outln!("certificate       of something else: {}", visible(mismatch)),
            None if has_certificate => {
                outln!("certificate       of this scene, these settings and this picture; the rest of it is a claim");
            }
            None => {}
        }
        if let Some(WrongPixel { x, y, picture, reference }) = self.first {
            outln!("wrong             {} of {}", count(self.wrong_pixels, "pixel"), self.pixels);
            outln!("first             x {x}, y {y}: {picture:?}, and the reference has {reference:?}");
        }
        outln!("verdict           {}", if self.verdict == Verdict::Right { "right" } else { "wrong" });
    }
}
