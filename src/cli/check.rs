//! `trueray check`.

use std::path::{Path, PathBuf};

use glam::DVec3;
use serde::Serialize;

use super::failure::{Failure, OK, SCENE};
use super::files::{check_place, json};
use super::input::{Input, check_stdin, print_doubts};
use super::linear::FileFormat;
use super::named::check_named;
use super::options::PictureOptions;
use super::output::{out, outln};
use super::particles::ParticleOptions;
use super::render::{explanation, precision_explanation};
use crate::effects::Effects;
use crate::limits;
use crate::precision::{self, Selection, Tier};
use crate::scene::{Diagnostic, Scene};
use crate::settings::Settings;
use crate::words::{count, number, visible};

/// Arguments of `trueray check`.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// Scene files; `-` is standard input
    #[arg(required = true, value_name = "SCENE", help_heading = "Scene")]
    scenes: Vec<PathBuf>,
    #[command(flatten)]
    picture: PictureOptions,
    #[command(flatten)]
    particles: ParticleOptions,
    /// Print JSON
    #[arg(long, help_heading = "Output")]
    json: bool,
}

/// What is known of a scene without rendering it.
#[derive(Debug, Serialize)]
struct Summary {
    scene: String,
    ok: bool,
    errors: usize,
    warnings: usize,
    messages: Vec<Diagnostic>,
    /// What of a scene without errors can hardly be meant; counted with the warnings.
    doubts: Vec<String>,
    /// Why the file could not be read at all, if so.
    unread: Option<String>,
    #[serde(flatten)]
    contents: Option<Contents>,
}

impl Summary {
    fn of_unread(path: &Path, failure: Failure) -> Self {
        Self {
            scene: path.display().to_string(),
            ok: false,
            errors: 1,
            warnings: 0,
            messages: Vec::new(),
            doubts: Vec::new(),
            unread: Some(failure.message),
            contents: None,
        }
    }
}

/// What a scene without errors holds.
#[derive(Debug, Serialize)]
struct Contents {
    width: u32,
    height: u32,
    spheres: usize,
    lights: usize,
    /// Corners of the box around all spheres; absent without spheres.
    extent: Option<[DVec3Json; 2]>,
    /// Least and greatest semi-axis; absent without spheres.
    semi_axes: Option<[f64; 2]>,
    /// Spheres with Kt > 0.
    refractive_spheres: usize,
    output: Option<String>,
    /// Why it cannot be rendered all the same, if so.
    refused: Option<String>,
    effects: Effects,
    precision: Selection,
}

type DVec3Json = [f64; 3];

impl Contents {
    fn new(scene: &Scene, picture: &PictureOptions, settings: &Settings) -> Self {
        let viewed = scene.viewed(settings);
        let effects = picture.effects(&viewed);
        let bounds = scene.spheres.iter().map(|s| (s.center - s.scale.abs(), s.center + s.scale.abs()));
        let extent = bounds.reduce(|(a, b), (c, d)| (a.min(c), b.max(d)));
        let axes = scene.spheres.iter().map(|s| (s.scale.abs().min_element(), s.scale.abs().max_element()));
        Self {
            width: scene.width,
            height: scene.height,
            spheres: scene.spheres.len(),
            lights: scene.lights.len(),
            extent: extent.map(|(low, high)| [low, high].map(|corner: DVec3| corner.to_array())),
            semi_axes: axes.reduce(|(a, b), (c, d)| (a.min(c), b.max(d))).map(|(low, high)| [low, high]),
            refractive_spheres: scene.spheres.iter().filter(|sphere| sphere.kt != 0.0).count(),
            output: scene.output.clone(),
            refused: limits::problem(&viewed, &effects),
            precision: Selection::of(&viewed, &effects, precision::Request::default(), &Tier::ALL),
            effects,
        }
    }

    fn print(&self, name: &str) {
        let (spheres, lights) = (count(self.spheres as u64, "sphere"), count(self.lights as u64, "light"));
        outln!("{}: {} × {}, {spheres}, {lights}", visible(name), self.width, self.height);
        let corner = |corner: DVec3Json| format!("({})", corner.map(number).join(", "));
        if let (Some([low, high]), Some([least, greatest])) = (self.extent, self.semi_axes) {
            outln!("  extent       {} to {}", corner(low), corner(high));
            outln!("  semi-axes    {} to {}", number(least), number(greatest));
        }
        if let Some(output) = &self.output {
            outln!("  output       {}", visible(output));
        }
        if self.refractive_spheres > 0 {
            outln!("  glass        {} with Kt > 0", count(self.refractive_spheres as u64, "sphere"));
        }
        if let Some(why) = &self.refused {
            outln!("  refused      the scene cannot be rendered: {why}");
        }
        out!("{}{}", explanation(name, &self.effects), precision_explanation(&self.precision));
    }
}

/// What `render` would say of the file that OUTPUT names, run in this folder.
fn named_doubt(scene: &Scene) -> Option<String> {
    let path = Path::new(scene.output.as_ref()?);
    let refused = check_named(path)
        .and_then(|()| check_place(path))
        .and_then(|()| FileFormat::by_ending(path).map(drop))
        .err()?;
    Some(format!("without -o there is no picture: {}", refused.message.lines().next()?))
}

pub(super) fn run(args: &Args) -> Result<u8, Failure> {
    check_stdin(&args.scenes)?;
    let settings = args.picture.settings()?;
    let reading = args.particles.one_frame(&args.picture)?;
    let mut summaries = Vec::new();
    let mut code = OK;
    for path in &args.scenes {
        let mut input = match Input::read(path, &reading) {
            Ok(input) => input,
            Err(failure) => {
                code = failure.code;
                if args.json {
                    summaries.push(Summary::of_unread(path, failure));
                } else {
                    failure.report();
                }
                continue;
            }
        };
        let mut doubts = Vec::new();
        if let Some(scene) = &mut input.parsed.scene {
            doubts = args.picture.frame_with_doubts(scene, &settings)?;
            // What `render` would say, run in this folder.
            doubts.extend(named_doubt(scene));
        }
        let warnings = input.parsed.warnings + doubts.len();
        let contents = input.parsed.scene.as_ref().map(|scene| Contents::new(scene, &args.picture, &settings));
        let ok = contents.as_ref().is_some_and(|contents| contents.refused.is_none());
        if !ok {
            code = SCENE;
        }
        if !args.json {
            input.print_diagnostics(false);
            print_doubts(&input.name, &doubts);
            if let Some(contents) = &contents {
                contents.print(&input.name);
                let warnings = if warnings == 0 { "no warnings".into() } else { count(warnings as u64, "warning") };
                outln!("  {warnings}");
            }
        }
        summaries.push(Summary {
            ok,
            errors: input.parsed.errors,
            warnings,
            doubts,
            unread: None,
            messages: input.parsed.diagnostics,
            scene: input.name,
            contents,
        });
    }
    if args.json {
        out!("{}", json(&summaries)?);
    }
    Ok(code)
}
