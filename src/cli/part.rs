//! `--crop`, `--tile` and `--resume` of `trueray render`.

use std::path::Path;
use std::str::FromStr;

use super::failure::{Failure, OUTPUT, USAGE};
use super::output::errln;
use crate::area::Area;
use crate::certificate::SceneHash;
use crate::effects::Effects;
use crate::engine::device_name;
use crate::film::{Format, ProblemKind, RowReader, Target};
use crate::gpu::Gpu;
use crate::misuse::Misuse;
use crate::part::{Claim, Identity};
use crate::precision::Selection;
use crate::scene::Scene;
use crate::settings::Settings;
use crate::words::visible_path;

/// Which part of a picture is rendered, and whether it may be there.
#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Picture")]
pub(super) struct PartOptions {
    /// Render no more than these pixels, columns X0 to X1 and rows Y0 to Y1 from the top left, the last ones exclusive; the file has
    /// this size and says what it is of. `trueray merge` puts parts together
    #[arg(long, value_name = "X0,X1,Y0,Y1", allow_hyphen_values = true, conflicts_with = "tile", conflicts_with_all = WHOLE)]
    crop: Option<Area>,
    /// Render no more than part I of N, from 0: whole rows
    #[arg(long, value_name = "I/N", conflicts_with_all = WHOLE)]
    tile: Option<Tile>,
    /// Leave a file as it is that is complete and says that it is this very picture or part; files say so that --resume, --crop or
    /// --tile have written. One of something else is an error
    #[arg(long, conflicts_with_all = WHOLE, help_heading = "Output")]
    resume: bool,
}

/// What takes all pixels of a picture that is being rendered.
const WHOLE: [&str; 5] = ["aov", "show", "certificate", "foveate", "sparse"];

/// Part `index` of `count`.
#[derive(Debug, Clone, Copy)]
struct Tile {
    index: u32,
    count: u32,
}

impl FromStr for Tile {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let numbers = text.split_once('/').and_then(|(index, count)| Some((index.parse().ok()?, count.parse().ok()?)));
        match numbers {
            Some((index, count)) if index < count => Ok(Self { index, count }),
            Some((index, count)) => Err(Misuse::Tile { index, count, height: 0 }.to_string()),
            None => Err("expected two numbers I/N such as 0/8".into()),
        }
    }
}

impl PartOptions {
    /// Whether no more than a part is rendered.
    pub(super) fn is_part(&self) -> bool {
        self.crop.is_some() || self.tile.is_some()
    }

    /// Whether the file has to say what it is of.
    pub(super) fn is_given(&self) -> bool {
        self.is_part() || self.resume
    }

    /// Refuses what has no place for a part.
    pub(super) fn check(&self, scenes: usize, output: Option<&Path>) -> Result<(), Failure> {
        let is_part = self.is_part();
        let why = match output {
            _ if is_part && scenes > 1 => "--crop and --tile take one scene",
            None if is_part => "--crop and --tile need -o: a part is not the picture that OUTPUT names",
            Some(output) if is_part && output.is_dir() => "--crop and --tile need a file for -o, no folder",
            Some(output) if self.resume && output == Path::new("-") => "--resume needs a file, no standard output",
            _ => return Ok(()),
        };
        Err(Failure::new(USAGE, why))
    }

    /// The part of a picture of this size.
    pub(super) fn area(&self, size: (u32, u32)) -> Result<Area, Misuse> {
        match (self.crop, self.tile) {
            (Some(area), _) if area.is_of(size) => Ok(area),
            (Some(area), _) => Err(Misuse::Area { area, size }),
            (None, Some(Tile { index, count })) => Area::tile(index, count, size),
            (None, None) => Ok(Area::whole(size)),
        }
    }

    /// What the file of a picture of `scene` has to say of itself; none where it is a plain picture.
    pub(super) fn note(
        &self,
        scene: &Scene,
        area: Area,
        (settings, effects): (&Settings, &Effects),
        (gpu, selection): (Option<&Gpu>, &Selection),
        format: Format,
    ) -> Result<Option<Note>, Failure> {
        if !self.is_given() {
            return Ok(None);
        }
        if format == Format::P3 {
            return Err(Failure::new(USAGE, "--crop, --tile and --resume write p6 or png, no p3"));
        }
        let tier = gpu.filter(|_| !selection.certified).map(|_| selection.tier.name());
        let made = (effects.set, effects.depth);
        let of = ((scene.width, scene.height), area);
        let line = Identity::new(SceneHash::of(scene), settings, made, tier, device_name(gpu), of).to_line();
        Ok(Some(Note { line, size: area.size(), resumes: self.resume }))
    }
}

/// What a file says of itself.
#[derive(Debug)]
pub(super) struct Note {
    pub(super) line: String,
    size: (u32, u32),
    resumes: bool,
}

impl Note {
    /// Whether the file is there already, and whole; unless it is to be `quiet`, that is said.
    ///
    /// # Errors
    /// Where there is one of something else under its name.
    pub(super) fn is_done(&self, target: &Target, quiet: bool) -> Result<bool, Failure> {
        let Target::File(path) = target else { return Ok(false) };
        // What is no regular file keeps nothing.
        if !self.resumes || !path.is_file() {
            return Ok(false);
        }
        let refused = |why: String| {
            let help = "help: remove it, or leave out --resume to replace it";
            Err(Failure::new(OUTPUT, format!("{} is another picture: {why}\n  {help}", visible_path(path))))
        };
        let reader = match RowReader::begin(path) {
            Ok(reader) => reader,
            // What a crash of the system can leave of a file: nothing, or its beginning, without what it is of.
            Err(error) if error.problem().kind() == ProblemKind::CutOff => return Ok(false),
            Err(error) => return refused(error.problem().to_string()),
        };
        let Some(note) = reader.note() else { return refused("it does not say of what it is".into()) };
        let claims =
            Claim::parse(note, reader.size()).and_then(|there| Ok((there, Claim::parse(&self.line, self.size)?)));
        match claims {
            Err(why) => refused(why),
            Ok((there, own)) => match own.difference(&there) {
                Some([field, own, there]) => refused(format!("{field} is {there} there and {own} here")),
                None if there.area != own.area => refused(format!("it is part {}, not {}", there.area, own.area)),
                None if !own.rounds_like(&there) => refused(format!("{} has rendered it", there.device)),
                None => {
                    let is_done = reader.check().is_ok();
                    if is_done && !quiet {
                        errln!("{target} is there already");
                    }
                    Ok(is_done)
                }
            },
        }
    }
}
