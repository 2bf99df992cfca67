//! Which known mistake, or which other convention, makes the picture that somebody has of a scene?
//!
//! A small renderer whose every rule can be broken ([`CAUSES`]) makes the picture with each mistake, alone and in pairs. A cause is
//! named by the part of the differing pixels that it gives, less those that it would change and that are right.

mod case;
mod catalogue;
mod fit;
mod limit;
mod rules;
mod search;
mod simplex;
mod textbook;
mod tree;
mod variant;
mod world;

use std::time::Duration;

use rayon::prelude::*;
use serde::Serialize;

use crate::effects::Effects;
use crate::film::Picture;
use crate::viewed::ViewedScene;
use crate::words::count;
use case::{Case, Sample};
use catalogue::{Right, Way, ways};
use limit::Limit;
use search::{Part, search};
use variant::{Stage, Variant};

pub use catalogue::{CAUSES, Known};

/// Fewer differing pixels, all of which rounding explains, say nothing.
const LEAST_ROUNDED: usize = 3;
/// Causes that are listed besides those that explain the picture.
const OTHERS: usize = 3;

/// What is said of a search that did not come to its end.
pub(crate) const CUT_SHORT: &str = "the time for the search was over before all causes were tried";

/// What explains a picture that is not the reference's.
///
/// Serialised, the field names are a stable interface.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Diagnosis {
    /// The causes, the likelier first; empty where nothing known explains the picture, or nothing has to be explained.
    pub causes: Vec<Cause>,
    /// Pixels that are to be explained.
    pub to_explain: u64,
    /// Pixels that differ from a picture with the causes whose role is [`Role::Cause`].
    pub left: u64,
    /// Whether the time was over before all causes were tried: these are the best until then.
    pub cut_short: bool,
}

/// A known cause, as it shows in a picture.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Cause {
    /// The name, one of [`CAUSES`].
    pub name: &'static str,
    /// Part of the differing pixels that it explains, 0 to 1: of two causes together, what would be left without it.
    pub share: f64,
    /// What it has to do with the others.
    pub role: Role,
    /// The cause in words, with what the pixels say of it.
    pub detail: String,
    /// Differing pixels that show it.
    pub examples: Vec<Example>,
}

/// What a cause has to do with the others in the list.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Role {
    /// It explains the picture, together with the others of this role.
    Cause,
    /// It would explain just as many pixels in place of the causes.
    Equal,
    /// It would explain fewer.
    Lesser,
}

/// A pixel with what explains it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Example {
    /// Column.
    pub x: u32,
    /// Row.
    pub y: u32,
    /// The picture's value.
    pub value: [u8; 3],
    /// The right value.
    pub reference: [u8; 3],
    /// The value with the causes.
    pub explained: [u8; 3],
}

/// Explains `picture`, which somebody has of `viewed`, beside `expected`, the reference's picture of the same size; `unexplained` are the
/// pixels, by column and row, that rounding does not explain. The search takes no longer than `time`.
pub fn diagnose(
    picture: &Picture,
    expected: &Picture,
    viewed: &ViewedScene,
    effects: &Effects,
    unexplained: &[[u32; 2]],
    time: Option<Duration>,
) -> Diagnosis {
    let limit = Limit::new(time);
    if is_plain(picture) {
        return Diagnosis::nothing(unexplained.len());
    }
    let right = Variant::new(viewed, effects);
    let stage = Stage::new(viewed, right.size);
    let pixels = all_pixels(picture);
    let differs = |&[i, j]: &[u32; 2]| picture.pixel(i, j) != expected.pixel(i, j);
    // The small renderer has no say where it is not the reference.
    let is_right = |&[i, j]: &[u32; 2]| !limit.is_over() && right.shows(&stage, [i, j], expected.pixel(i, j), true);
    let is_near = |&[i, j]: &[u32; 2]| right.shows(&stage, [i, j], picture.pixel(i, j), false);
    let equal: Vec<_> = pixels.par_iter().copied().filter(|pixel| !differs(pixel) && is_right(pixel)).collect();
    let far = unexplained.par_iter().copied().filter(|pixel| is_right(pixel) && !is_near(pixel));
    let mut differing: Vec<_> = far.collect();
    // Where rounding may be the whole difference only a cause that gives the picture to the last bit is better.
    let exactly = differing.is_empty();
    if exactly {
        differing = pixels.par_iter().copied().filter(|pixel| differs(pixel) && is_right(pixel)).collect();
        if differing.len() < LEAST_ROUNDED && !limit.has_cut() {
            return Diagnosis::nothing(unexplained.len());
        }
    }
    if limit.has_cut() {
        return Diagnosis { cut_short: true, ..Diagnosis::nothing(unexplained.len()) };
    }
    let case = Case { stage, theirs: picture, all: Sample { differing, equal }, exactly, limit };
    let pixels = if exactly { unexplained.len() } else { case.all.differing.len() };
    diagnosed(&case, (viewed, effects), &right, None, pixels)
}

/// Explains why `picture`, which somebody has of `viewed`, has another size than the scene's: all of its pixels are to be explained.
/// The search takes no longer than `time`.
pub fn diagnose_size(picture: &Picture, viewed: &ViewedScene, effects: &Effects, time: Option<Duration>) -> Diagnosis {
    let limit = Limit::new(time);
    if is_plain(picture) {
        return Diagnosis::nothing(picture.pixels().len());
    }
    let right = Variant::new(viewed, effects);
    let shown = [picture.width(), picture.height()];
    let all = Sample { differing: all_pixels(picture), equal: Vec::new() };
    let case = Case { stage: Stage::new(viewed, shown), theirs: picture, all, exactly: false, limit };
    diagnosed(&case, (viewed, effects), &right, Some(shown), case.all.differing.len())
}

/// Whether a picture is of one colour all over, which says nothing of how it came about.
fn is_plain(picture: &Picture) -> bool {
    picture.pixels().windows(2).all(|pair| pair[0] == pair[1])
}

/// Column and row of every pixel.
fn all_pixels(picture: &Picture) -> Vec<[u32; 2]> {
    let [width, height] = [picture.width(), picture.height()];
    (0..height).flat_map(|j| (0..width).map(move |i| [i, j])).collect()
}

/// What the search finds; where that is nothing, so many pixels are left.
fn diagnosed(
    case: &Case,
    (viewed, effects): (&ViewedScene, &Effects),
    right: &Variant,
    other_size: Option<[u32; 2]>,
    pixels: usize,
) -> Diagnosis {
    let (unit, scene) = (case.stage.unit, viewed.in_file().0);
    let left_out = Variant::with_left_out(viewed, effects);
    let found = search(case, &Right { scene, variant: right, left_out: &left_out, other_size, unit });
    let cut_short = case.limit.has_cut();
    let Some(found) = found else { return Diagnosis { cut_short, ..Diagnosis::nothing(pixels) } };
    let cause = |part: Part, role| Cause {
        name: part.name,
        share: part.share,
        role,
        detail: in_words(part.name, &part.detail),
        examples: if role == Role::Cause { examples(case, right, &part.variant) } else { Vec::new() },
    };
    let mut causes: Vec<Cause> = found.best.into_iter().map(|part| cause(part, Role::Cause)).collect();
    let others = found.others.into_iter().take(OTHERS);
    causes.extend(others.map(|part| {
        let role = if part.is_equal { Role::Equal } else { Role::Lesser };
        cause(part, role)
    }));
    Diagnosis { causes, to_explain: case.before(), left: found.left.round() as u64, cut_short }
}

/// The ways in which the causes that need no fitting change the picture of `viewed`: name and detail of each.
#[doc(hidden)]
pub fn plants(viewed: &ViewedScene, effects: &Effects) -> Vec<(&'static str, String)> {
    with_ways(viewed, effects, |_, ways| ways.into_iter().map(|way| (way.name, way.detail)).collect())
}

/// The picture of `viewed` with these of the ways.
#[doc(hidden)]
pub fn planted(viewed: &ViewedScene, effects: &Effects, chosen: &[usize]) -> Picture {
    with_ways(viewed, effects, |right, ways| {
        let mut variant = right.clone();
        for &index in chosen {
            (ways[index].apply)(&mut variant);
        }
        let stage = Stage::new(viewed, right.size);
        let [width, height] = right.size;
        let pixels = (0..height).flat_map(|j| (0..width).map(move |i| [i, j]));
        Picture::assemble(width, height, pixels.flat_map(|pixel| variant.levels(&stage, pixel)).collect())
    })
}

fn with_ways<T>(viewed: &ViewedScene, effects: &Effects, use_them: impl FnOnce(&Variant, Vec<Way>) -> T) -> T {
    let right = Variant::new(viewed, effects);
    let left_out = Variant::with_left_out(viewed, effects);
    let (scene, unit) = (viewed.in_file().0, viewed.factor());
    let known = Right { scene, variant: &right, left_out: &left_out, other_size: None, unit };
    use_them(&right, ways(&known))
}

/// The line of a cause with what the pixels say.
fn in_words(name: &str, detail: &str) -> String {
    let line = CAUSES.iter().find(|known| known.name == name).map_or(name, |known| known.line);
    if detail.is_empty() { line.to_owned() } else { format!("{line} ({detail})") }
}

/// Two differing pixels that a variant gives.
fn examples(case: &Case, right: &Variant, variant: &Variant) -> Vec<Example> {
    let explained = case.sample(64).differing.into_iter().filter(|&pixel| case.off(variant, pixel) == 0);
    explained
        .map(|[x, y]| Example {
            x,
            y,
            value: case.levels([x, y]),
            reference: right.levels(&case.stage, [x, y]),
            explained: variant.levels(&case.stage, [x, y]),
        })
        .step_by(5)
        .take(2)
        .collect()
}

impl Diagnosis {
    /// Nothing known explains so many pixels.
    fn nothing(pixels: usize) -> Self {
        Self { causes: Vec::new(), to_explain: pixels as u64, left: pixels as u64, cut_short: false }
    }

    /// A list for people.
    pub fn report(&self) -> String {
        use std::fmt::Write as _;
        let Self { causes, to_explain, left, cut_short } = self;
        if causes.is_empty() {
            return format!("cause             {}\n", self.without_causes());
        }
        let mut text = String::new();
        for Cause { name, share, role, detail, examples } in causes {
            let label = match role {
                Role::Cause => "cause",
                Role::Equal => "just as well",
                Role::Lesser => "less well",
            };
            let _ = writeln!(text, "{label:<17} {name}, {:.1} %: {detail}", 100.0 * share);
            for Example { x, y, value, reference, explained } in examples {
                let [value, reference, explained] = [value, reference, explained].map(|value| format!("{value:?}"));
                let _ = writeln!(text, "            x {x}, y {y}: {value}, reference {reference}, with it {explained}");
            }
        }
        let _ = writeln!(text, "left              {left} of {}", count(*to_explain, "pixel"));
        if *cut_short {
            let _ = writeln!(text, "search            {CUT_SHORT}");
        }
        text
    }

    /// Why there are no causes, in words.
    pub fn without_causes(&self) -> String {
        match (self.cut_short, count(self.to_explain, "pixel")) {
            (true, _) => format!("none was found: {CUT_SHORT}"),
            (_, _) if self.to_explain == 0 => "nothing has to be explained".into(),
            (_, pixels) => format!("nothing known explains the {pixels}"),
        }
    }
}
