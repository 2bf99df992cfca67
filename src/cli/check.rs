//! `trueray check`.

use std::path::PathBuf;

use glam::DVec3;
use serde::Serialize;

use super::failure::{Failure, OK, OUTPUT, SCENE};
use super::input::Input;
use super::options::PictureOptions;
use super::output::{out, outln};
use super::render::{explanation, precision_explanation};
use crate::effects::Effects;
use crate::limits;
use crate::precision::{self, Selection, Tier};
use crate::scene::{Diagnostic, Scene, Severity};
use crate::settings::Settings;

/// Arguments of `trueray check`.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// Scene files; `-` is standard input
    #[arg(required = true, value_name = "SCENE")]
    scenes: Vec<PathBuf>,
    /// Print JSON
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    picture: PictureOptions,
}

/// What is known of a scene without rendering it.
#[derive(Debug, Serialize)]
struct Summary {
    scene: String,
    ok: bool,
    errors: usize,
    warnings: usize,
    messages: Vec<Message>,
    #[serde(flatten)]
    contents: Option<Contents>,
}

/// One error or warning.
#[derive(Debug, Serialize)]
struct Message {
    severity: String,
    line: usize,
    column: usize,
    token: String,
    message: String,
    expected: String,
    help: Option<String>,
}

impl Message {
    fn new(diagnostic: &Diagnostic) -> Self {
        let Diagnostic { severity, line, column, token, message, expected, help, .. } = diagnostic.clone();
        Self { severity: severity.to_string(), line, column, token, message, expected, help }
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
        let effects = picture.effects(scene, settings);
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
            refused: limits::problem(scene, settings, &effects),
            precision: Selection::of(scene, settings, &effects, precision::Request::default(), &Tier::ALL),
            effects,
        }
    }

    fn print(&self, name: &str) {
        outln!("{name}: {} × {}, {} spheres, {} lights", self.width, self.height, self.spheres, self.lights);
        let corner = |[x, y, z]: DVec3Json| format!("({x}, {y}, {z})");
        if let (Some([low, high]), Some([least, greatest])) = (self.extent, self.semi_axes) {
            outln!("  extent       {} to {}", corner(low), corner(high));
            outln!("  semi-axes    {least} to {greatest}");
        }
        if let Some(output) = &self.output {
            outln!("  output       {output}");
        }
        if self.refractive_spheres > 0 {
            outln!("  glass        {} spheres with Kt > 0", self.refractive_spheres);
        }
        if let Some(why) = &self.refused {
            outln!("  refused      the scene cannot be rendered: {why}");
        }
        out!("{}{}", explanation(name, &self.effects), precision_explanation(&self.precision));
    }
}

pub(super) fn run(args: &Args) -> u8 {
    match check_all(args) {
        Ok(code) => code,
        Err(failure) => failure.report(),
    }
}

fn check_all(args: &Args) -> Result<u8, Failure> {
    let settings = args.picture.settings()?;
    let mut summaries = Vec::new();
    let mut code = OK;
    for path in &args.scenes {
        let mut input = match Input::read(path) {
            Ok(input) => input,
            Err(failure) => {
                code = failure.report();
                continue;
            }
        };
        if let Some(scene) = &mut input.parsed.scene {
            args.picture.resize(scene);
        }
        let contents = input.parsed.scene.as_ref().map(|scene| Contents::new(scene, &args.picture, &settings));
        let ok = contents.as_ref().is_some_and(|contents| contents.refused.is_none());
        if !ok {
            code = SCENE;
        }
        if !args.json {
            input.print_diagnostics(false);
            if let Some(contents) = &contents {
                contents.print(&input.name);
                let warnings = input.parsed.diagnostics.iter().filter(|d| d.severity == Severity::Warning).count();
                outln!(
                    "  {}",
                    if warnings == 0 { "no warnings".into() } else { format!("{} warnings", input.parsed.warnings) }
                );
            }
        }
        summaries.push(Summary {
            ok,
            errors: input.parsed.errors,
            warnings: input.parsed.warnings,
            messages: input.parsed.diagnostics.iter().map(Message::new).collect(),
            scene: input.name,
            contents,
        });
    }
    if args.json {
        let json = serde_json::to_string_pretty(&summaries).map_err(|e| Failure::new(OUTPUT, e.to_string()))?;
        outln!("{json}");
    }
    Ok(code)
}
