//! `trueray import`.

use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

use super::failure::{Failure, SCENE, USAGE};
use super::files::check_place;
use super::guard::Guard;
use super::input::{Opened, print_parsed};
use super::output::errln;
use super::particles::ParticleOptions;
use crate::film::{Target, save_by};
use crate::import::{Import, Imported};
use crate::scene::{Scene, resolution};
use crate::words::{count, visible};

/// Arguments of `trueray import`.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// File of particles: XYZ, LAMMPS dump, PDB, mmCIF, CSV or TSV, PLY; `-` is standard input
    #[arg(value_name = "FILE", help_heading = "Scene")]
    file: PathBuf,
    #[command(flatten)]
    particles: ParticleOptions,
    /// Picture size
    #[arg(long, value_name = "WxH", value_parser = resolution, help_heading = "Picture")]
    res: Option<(u32, u32)>,
    /// Scene file, for several frames with %d or %04d in its name; `-`, the default, is standard output
    #[arg(short, long, value_name = "FILE", default_value = "-", help_heading = "Output")]
    output: PathBuf,
    /// Print errors only
    #[arg(short, long, help_heading = "Output")]
    quiet: bool,
}

/// The least bytes of a sphere in a scene file.
const LEAST_BYTES: u64 = 40;

pub(super) fn run(args: &Args) -> Result<(), Failure> {
    let reading = args.particles.frames(args.res)?;
    let name = Numbered::of(&args.output)?;
    if !reading.options.frames.is_one() && name.number.is_none() {
        return Err(Failure::new(
            USAGE,
            "several frames need a number in the name of their scenes, such as -o scene_%04d.txt",
        ));
    }
    let mut guard = Guard::new([&args.file]);
    if name.number.is_none() {
        guard.options([("--output", &Some(args.output.clone()))])?;
    }
    let opened = Opened::open(&args.file)?;
    let Some(format) = opened.format else {
        let message = format!("{}: this holds no particles of a known format", visible(&opened.name));
        let help = "help: XYZ, LAMMPS dumps, PDB, mmCIF, CSV or TSV with a line of names, and PLY are told by what they begin with";
        return Err(Failure::new(SCENE, format!("{message}\n  {help}")));
    };
    let file = opened.name.clone();
    let is_one = reading.options.frames.is_one();
    let mut is_empty = true;
    for Imported { number, mut parsed, notes, .. } in Import::new(&file, format, opened.into_reader(), reading.options)
    {
        let scene = parsed.scene.take();
        let notes: Vec<_> =
            notes.into_iter().map(|note| if is_one { note } else { format!("frame {number}: {note}") }).collect();
        print_parsed(&parsed, &notes, &file, args.quiet);
        let Some(scene) = scene else {
            if parsed.errors == 0 {
                continue;
            }
            return Err(Failure::new(SCENE, ""));
        };
        is_empty = false;
        let path = name.path(number);
        if name.number.is_some() {
            check_place(&path)?;
            guard.output(&format!("frame {number}"), &path)?;
        }
        save(&path, &scene, &format!("frame {number} of {}", visible(&file)))?;
        if !args.quiet && path != Path::new("-") {
            errln!("trueray: {}: frame {number}, {}", path.display(), count(scene.spheres.len() as u64, "sphere"));
        }
    }
    if is_empty {
        return Err(Failure::new(SCENE, format!("{}: no frame has particles", visible(&file))));
    }
    Ok(())
}

/// Writes a scene as it is made, complete or not at all.
fn save(path: &Path, scene: &Scene, title: &str) -> Result<(), Failure> {
    let bytes = scene.spheres.len() as u64 * LEAST_BYTES;
    let target = Target::from_argument(path.as_os_str());
    Ok(save_by(&target, bytes, |output| {
        let mut output = BufWriter::with_capacity(1 << 18, output);
        write!(output, "# {title}\n{scene}")?;
        output.flush()
    })?)
}

/// A path with the number of a frame in it, or without.
struct Numbered {
    before: String,
    /// The least digits of the number.
    number: Option<usize>,
    after: String,
}

impl Numbered {
    /// Of a path with `%d` or `%04d` once, or never; `%%` is a percent sign.
    fn of(path: &Path) -> Result<Self, Failure> {
        let refused = |why: &str| Failure::new(USAGE, format!("-o {}: {why}", path.display()));
        // A name that is no text has no number.
        let Some(text) = path.to_str() else { return Err(refused("a name in UTF-8 is needed")) };
        let mut parts = [String::new(), String::new()];
        let mut number = None;
        let mut rest = text;
        while let Some((plain, after)) = rest.split_once('%') {
            let part = &mut parts[usize::from(number.is_some())];
            part.push_str(plain);
            if let Some(after) = after.strip_prefix('%') {
                part.push('%');
                rest = after;
                continue;
            }
            let digits = after.len() - after.trim_start_matches(|c: char| c.is_ascii_digit()).len();
            let width = match &after[..digits] {
                "" => Some(1),
                width => width.strip_prefix('0').and_then(|width| width.parse().ok()).filter(|width| *width <= 20),
            };
            let after = after[digits..].strip_prefix('d');
            let (Some(width), Some(after)) = (width, after) else {
                return Err(refused("expected %d, %04d or %% for a percent sign"));
            };
            if number.replace(width).is_some() {
                return Err(refused("the number of the frame is there twice"));
            }
            rest = after;
        }
        parts[usize::from(number.is_some())].push_str(rest);
        let [before, after] = parts;
        Ok(Self { before, number, after })
    }

    fn path(&self, frame: usize) -> PathBuf {
        let number = self.number.map_or_else(String::new, |width| format!("{frame:0width$}"));
        format!("{}{number}{}", self.before, self.after).into()
    }
}
