//! A pixel by the CPU reference, and beside it what each tier of a device shows: for `trueray pixel` and the live view.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use serde::Serialize;

use crate::area::Area;
use crate::brightness::Scalar;
use crate::cpu::{Decision, Finding, PixelRecord, Reference};
use crate::effects::Effects;
use crate::engine::{Backend, Engine, Options, device_name};
use crate::gpu::{Error, Gpu, Kernel};
use crate::linear::Linear;
use crate::precision::Tier;
use crate::report::{Labels, numbers, pixel_table};
use crate::scene::Names;
use crate::settings::Settings;
use crate::viewed::ViewedScene;
use crate::words::visible;

/// All that is told of a pixel; `trueray pixel --json` prints it.
#[derive(Debug, Serialize)]
pub struct PixelReport {
    scene: String,
    x: u32,
    y: u32,
    width: u32,
    height: u32,
    settings: Settings,
    depth: u32,
    /// The labels of the spheres and lights that are mentioned, by index.
    sphere_names: BTreeMap<usize, String>,
    light_names: BTreeMap<usize, String>,
    reference: PixelRecord,
    #[serde(flatten)]
    beside: Beside,
}

/// What stands beside the reference.
#[derive(Debug, Serialize)]
pub struct Beside {
    single: Single,
    /// The Vulkan device; null where the CPU is alone.
    device: Option<String>,
    /// Why it is alone.
    no_device: Option<String>,
    tiers: Vec<TierPixel>,
    /// Tiers at which the device does not render this scene.
    lacking: Vec<Lacking>,
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
    /// Whether pairs of `f32` stand for `f64`, which the device lacks.
    pairs: bool,
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

/// A tier that shows nothing.
#[derive(Debug, Serialize)]
struct Lacking {
    tier: Tier,
    why: String,
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

impl PixelReport {
    /// Of the pixel in column `x` and row `y`, of which the reference has this `record`; `gpu` is the device whose tiers are still to be
    /// added, or why there is none.
    pub(crate) fn new(
        scene: &str,
        (viewed, effects): (&ViewedScene, &Effects),
        record: PixelRecord,
        (x, y): (u32, u32),
        gpu: Result<&Gpu, &String>,
    ) -> Self {
        let (file, settings) = viewed.in_file();
        let (spheres, lights) = mentioned(&record);
        let color = Reference::<f32>::new(viewed, effects).color(x, y).unwrap_or_default().to_array();
        let single = Single { color, ulps: ulps(color, record.color, Scalar::Single) };
        let (device, no_device) = (gpu.ok().map(|gpu| device_name(Some(gpu))), gpu.err().cloned());
        Self {
            scene: scene.to_owned(),
            x,
            y,
            width: file.width,
            height: file.height,
            settings: *settings,
            depth: effects.depth,
            sphere_names: named(&file.sphere_names, spheres),
            light_names: named(&file.light_names, lights),
            reference: record,
            beside: Beside { single, device, no_device, tiers: Vec::new(), lacking: Vec::new() },
        }
    }

    /// The tier of `gpu` that is to be added next.
    pub(crate) fn next_tier(&self, gpu: &Gpu) -> Option<Tier> {
        let Beside { tiers, lacking, .. } = &self.beside;
        gpu.ladder().get(tiers.len() + lacking.len()).copied()
    }

    /// Adds what a tier shows, or why it shows nothing, of the scene that it is all about.
    ///
    /// # Errors
    ///
    /// Whatever is not this tier's alone.
    pub(crate) fn add_tier(
        &mut self,
        (gpu, tier): (&Gpu, Tier),
        viewed: ViewedScene,
        effects: &Effects,
        reference: &Reference<f64>,
    ) -> Result<(), Error> {
        match tier_pixel((gpu, tier), viewed, effects, (reference, &self.reference), (self.x, self.y)) {
            Ok(pixel) => self.beside.tiers.push(pixel),
            Err(error) if error.is_refusal() => self.beside.lacking.push(Lacking { tier, why: error.to_string() }),
            Err(error) => return Err(error),
        }
        Ok(())
    }

    /// What stands beside the reference.
    #[cfg(feature = "view")]
    pub(crate) fn beside(&self) -> &Beside {
        &self.beside
    }

    /// What the reference has.
    #[cfg(feature = "view")]
    pub(crate) fn record(&self) -> &PixelRecord {
        &self.reference
    }

    /// For people: a table of all rays, and below it what stands beside the reference.
    pub(crate) fn text(&self, labels: Labels) -> String {
        let Self { scene, x, y, width, height, reference, beside, .. } = self;
        let mut text = format!(
            "pixel             x {x}, y {y} of {width}x{height} of {}, on the CPU reference in f64\n",
            visible(scene)
        );
        text += &pixel_table(reference, labels);
        beside.push_text(&mut text);
        text
    }
}

impl Beside {
    fn push_text(&self, text: &mut String) {
        let Self { single, device, no_device, tiers, lacking } = self;
        let _ = writeln!(text, "f32 on the CPU    {}", numbers(&single.color));
        let _ = writeln!(text, "                  off by {}", in_last_places(&single.ulps, "f32"));
        let _ = match (device, no_device) {
            (Some(device), _) => writeln!(text, "device            {device}"),
            (None, why) => {
                writeln!(text, "device            none, the CPU alone: {}", why.as_deref().unwrap_or_default())
            }
        };
        for tier in tiers {
            tier.push_text(text);
        }
        for Lacking { tier, why } in lacking {
            let _ = writeln!(text, "  {tier:<15} not on this device: {}", why.replace('\n', "\n                  "));
        }
    }
}

impl TierPixel {
    fn push_text(&self, text: &mut String) {
        let Self { tier, pairs, color, ulps, ulps_f64, by_reference, levels, difference, verdict, decision } = self;
        let words = match (verdict, decision) {
            (Verdict::Same, _) => "the same".to_owned(),
            (Verdict::Explained, Some(decision)) => format!("explained: {}", decision.name()),
            (Verdict::Explained, None) => "explained".to_owned(),
            (Verdict::Unexplained, _) => "unexplained".to_owned(),
            (Verdict::Undecided, _) => "unexplained so far: more paths than are tried".to_owned(),
        };
        let [red, green, blue] = levels;
        let [dr, dg, db] = difference;
        let _ = writeln!(text, "  {tier:<15} {red}, {green}, {blue}; off by {dr}, {dg}, {db} levels: {words}");
        let (ulps, scalar) = ulps_f64.as_ref().map_or((ulps, "f32"), |ulps| (ulps, "f64"));
        let _ = writeln!(text, "    colour        {}; off by {}", numbers(color), in_last_places(ulps, scalar));
        if *pairs {
            let _ = writeln!(text, "                  by pairs of f32: the device has no f64");
        }
        if *by_reference {
            let why = "rounding on the device could decide what it shows";
            let _ = writeln!(text, "                  by the CPU reference: {why}");
        }
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
    let kernel = gpu.kernel(tier)?;
    let ulps_f64 = kernel.is_double().then(|| off(Scalar::Double));
    Ok(TierPixel {
        tier,
        pairs: kernel == Kernel::Pairs,
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

fn named(names: &Names, indices: Vec<usize>) -> BTreeMap<usize, String> {
    indices.into_iter().map(|index| (index, names.get(index).to_owned())).collect()
}

fn in_last_places(ulps: &[f64; 3], scalar: &str) -> String {
    // What is 0 has tiny last places.
    let each = ulps.map(|x| if x.abs() < 1e6 { format!("{x:.1}") } else { format!("{x:.1e}") });
    format!("{} units in the last place of {scalar}", each.join(", "))
}
