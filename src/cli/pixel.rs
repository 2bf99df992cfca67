//! `trueray pixel`.

use std::collections::BTreeMap;
use std::path::PathBuf;

use serde::Serialize;

use super::failure::{Failure, USAGE};
use super::files::json;
use super::input::Input;
use super::options::PictureOptions;
use super::output::{out, outln};
use super::particles::Reading;
use crate::area::Area;
use crate::brightness::Scalar;
use crate::cpu::{Decision, Finding, Inspector, MOST_RAYS, PixelRecord, Reference};
use crate::effects::Effects;
use crate::engine::{Backend, Engine, Options, device_name};
use crate::gpu::{Choice, Error, Gpu};
use crate::linear::Linear;
use crate::misuse::check_picture;
use crate::precision::Tier;
use crate::report::{Labels, numbers, pixel_table};
use crate::scene::Names;
use crate::settings::Settings;
use crate::viewed::ViewedScene;
use crate::words::visible;

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

/// What `--json` prints.
#[derive(Debug, Serialize)]
struct Report<'a> {
    scene: &'a str,
    x: u32,
    y: u32,
    width: u32,
    height: u32,
    settings: Settings,
    depth: u32,
    /// The labels of the spheres and lights that are mentioned, by index.
    sphere_names: BTreeMap<usize, &'a str>,
    light_names: BTreeMap<usize, &'a str>,
    reference: PixelRecord,
    single: Single,
    /// The Vulkan device; null where the CPU is alone.
    device: Option<String>,
    /// Why it is alone.
    no_device: Option<String>,
    tiers: Vec<TierPixel>,
}

/// The reference's source in `f32`.
#[derive(Debug, Serialize)]
struct Single {
    color: [f64; 3],
    /// How far that is from the reference's colour, in units in the last place of `f32`.
    ulps: [f64; 3],
}

/// What a tier of the device shows.
#[derive(Debug, Serialize)]
struct TierPixel {
    tier: Tier,
    /// Unclamped, before it becomes levels.
    color: [f64; 3],
    /// How far that is from the reference's colour, in units in the last place of `f32`;
    ulps: [f64; 3],
    /// and of `f64`, where the tier calculates in it.
    ulps_f64: Option<[f64; 3]>,
    /// Whether the reference has calculated it, since rounding on the device could decide what it shows.
    by_reference: bool,
    levels: [u8; 3],
    /// Its levels less the reference's.
    difference: [i16; 3],
    verdict: Verdict,
    /// The decision that explains a difference.
    decision: Option<Decision>,
}

/// Whether rounding explains a tier's pixel.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
enum Verdict {
    Same,
    Explained,
    Unexplained,
    Undecided,
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
    let (gpu, no_device) = open(&args.device)?;
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
    let tiers = match &gpu {
        Some(gpu) => gpu
            .ladder()
            .iter()
            .map(|&tier| {
                let reference = (inspector.reference(), &record);
                tier_pixel((gpu, tier), scene.viewed(&settings), &effects, reference, (x, y))
            })
            .collect::<Result<Vec<_>, _>>()?,
        None => Vec::new(),
    };
    let (spheres, lights) = mentioned(&record);
    let report = Report {
        scene: &loaded.name,
        x,
        y,
        width: scene.width,
        height: scene.height,
        settings,
        depth: effects.depth,
        sphere_names: named(&scene.sphere_names, spheres),
        light_names: named(&scene.light_names, lights),
        single: single(&viewed, &effects, &record, (x, y)),
        reference: record,
        device: gpu.as_ref().map(|gpu| device_name(Some(gpu))),
        no_device,
        tiers,
    };
    if args.json {
        out!("{}", json(&report)?);
    } else {
        print(&report, Labels::of(scene, settings.specular));
    }
    Ok(())
}

/// The device, or why there is none.
fn open(choice: &Choice) -> Result<(Option<Gpu>, Option<String>), Error> {
    match choice {
        Choice::Cpu => Ok((None, Some("--device cpu asks for none".into()))),
        Choice::Auto => match Gpu::open(&Choice::Auto) {
            Err(Error::NoneFound(why)) => Ok((None, Some(why))),
            opened => Ok((Some(opened?), None)),
        },
        choice => Ok((Some(Gpu::open(choice)?), None)),
    }
}

fn tier_pixel(
    (gpu, tier): (&Gpu, Tier),
    viewed: ViewedScene,
    effects: &Effects,
    (reference, record): (&Reference<f64>, &PixelRecord),
    (x, y): (u32, u32),
) -> Result<TierPixel, Error> {
    let backend = Backend::Device(gpu, tier);
    let alone = viewed.of_part(Area { left: x, top: y, width: 1, height: 1 });
    let options = Options { linear: true, ..Options::default() };
    let mut engine = Engine::with(backend, alone, effects, &options)?;
    let (mut levels, mut linear) = ([0; 3], [Linear::default()]);
    engine.linear_rows(0, &mut levels, &mut linear)?;
    let by_reference = engine.by_reference() > 0;
    let (verdict, decision) = if levels == record.levels {
        (Verdict::Same, None)
    } else {
        match backend.judge().trial(reference).explain(x, y, levels) {
            Finding::Explained(decision) => (Verdict::Explained, Some(decision)),
            Finding::Unexplained => (Verdict::Unexplained, None),
            Finding::Undecided => (Verdict::Undecided, None),
        }
    };
    let difference = std::array::from_fn(|c| i16::from(levels[c]) - i16::from(record.levels[c]));
    let color = linear[0].color.to_array();
    let off = |scalar| ulps(color, record.color, scalar);
    let ulps_f64 = gpu.kernel(tier)?.is_double().then(|| off(Scalar::Double));
    Ok(TierPixel {
        tier,
        color,
        ulps: off(Scalar::Single),
        ulps_f64,
        by_reference,
        levels,
        difference,
        verdict,
        decision,
    })
}

fn single(viewed: &ViewedScene, effects: &Effects, record: &PixelRecord, (x, y): (u32, u32)) -> Single {
    let color = Reference::<f32>::new(viewed, effects).color(x, y).unwrap_or_default().to_array();
    Single { color, ulps: ulps(color, record.color, Scalar::Single) }
}

/// How far a colour is from the one that is expected, in units in the last place of the latter.
fn ulps(color: [f64; 3], expected: [f64; 3], scalar: Scalar) -> [f64; 3] {
    let ulp = |value: f64| match scalar {
        Scalar::Single => {
            let value = (value.abs() as f32).max(f32::MIN_POSITIVE);
            f64::from(value.next_up() - value)
        }
        Scalar::Double => {
            let value = value.abs().max(f64::MIN_POSITIVE);
            value.next_up() - value
        }
    };
    std::array::from_fn(|c| (color[c] - expected[c]) / ulp(expected[c]))
}

/// The spheres and lights that a record mentions.
fn mentioned(record: &PixelRecord) -> (Vec<usize>, Vec<usize>) {
    let (mut spheres, mut lights) = (Vec::new(), Vec::new());
    for ray in record.samples.iter().flat_map(|sample| &sample.rays) {
        let shadows = ray.hit.iter().flat_map(|hit| &hit.lights);
        lights.extend(shadows.clone().map(|light| light.light));
        let tests = shadows.filter_map(|light| light.shadow.as_ref()).flat_map(|shadow| &shadow.tests);
        spheres.extend(ray.tests.iter().chain(tests).map(|test| test.sphere));
        spheres.extend(ray.hit.iter().map(|hit| hit.sphere));
        spheres.extend(ray.decisions.iter().filter_map(|margin| margin.sphere));
    }
    (spheres, lights)
}

fn named(names: &Names, indices: Vec<usize>) -> BTreeMap<usize, &str> {
    indices.into_iter().map(|index| (index, names.get(index))).collect()
}

fn print(report: &Report, labels: Labels) {
    let Report { scene, x, y, width, height, reference, single, .. } = report;
    outln!("pixel             x {x}, y {y} of {width}x{height} of {}, on the CPU reference in f64", visible(scene));
    out!("{}", pixel_table(reference, labels));
    outln!("f32 on the CPU    {}", numbers(&single.color));
    outln!("                  off by {}", in_last_places(&single.ulps, "f32"));
    match (&report.device, &report.no_device) {
        (Some(device), _) => outln!("device            {device}"),
        (None, why) => outln!("device            none, the CPU alone: {}", why.as_deref().unwrap_or_default()),
    }
    for TierPixel { tier, color, ulps, ulps_f64, by_reference, levels, difference, verdict, decision } in &report.tiers
    {
        let words = match (verdict, decision) {
            (Verdict::Same, _) => "the same".to_owned(),
            (Verdict::Explained, Some(decision)) => format!("explained: {}", decision.name()),
            (Verdict::Explained, None) => "explained".to_owned(),
            (Verdict::Unexplained, _) => "unexplained".to_owned(),
            (Verdict::Undecided, _) => "unexplained so far: more paths than are tried".to_owned(),
        };
        let [red, green, blue] = levels;
        let [dr, dg, db] = difference;
        outln!("  {tier:<15} {red}, {green}, {blue}; off by {dr}, {dg}, {db} levels: {words}");
        let (ulps, scalar) = ulps_f64.as_ref().map_or((ulps, "f32"), |ulps| (ulps, "f64"));
        outln!("    colour        {}; off by {}", numbers(color), in_last_places(ulps, scalar));
        if *by_reference {
            outln!("                  by the CPU reference: rounding on the device could decide what it shows");
        }
    }
}

fn in_last_places(ulps: &[f64; 3], scalar: &str) -> String {
    // What is 0 has tiny last places.
    let each = ulps.map(|x| if x.abs() < 1e6 { format!("{x:.1}") } else { format!("{x:.1e}") });
    format!("{} units in the last place of {scalar}", each.join(", "))
}
