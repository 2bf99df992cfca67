//! Somebody's pictures of scenes beside the reference: a verdict, a score and a likely cause for each.

mod folder;
mod page;
mod score;
mod table;

use std::fmt;
use std::fs;
use std::path::Path;
use std::time::Duration;

use serde::Serialize;

use crate::compare::{BySphere, Comparison, Difference, Differing, Explanation, SizeMismatch};
use crate::cpu::{Judge, Reference};
use crate::effects::Effects;
use crate::engine::{Backend, Engine, render_picture};
use crate::film::{Encoded, Leniency, Picture, ProblemKind, ReadError};
use crate::gpu;
use crate::mistakes::{Cause, Diagnosis, Role, diagnose, diagnose_size};
use crate::scene::Scene;
use crate::settings::Settings;
use crate::words::{visible, visible_path};

use folder::what_instead;
pub use folder::{Extra, Folder, Sought, Submission};
pub use page::{Pages, overview};
pub use score::{FULL, RULE, score};
pub use table::{COLUMNS, csv, table};

/// A file with more bytes for each pixel of the scene than this is no picture of it, and is not read.
const MOST_BYTES_A_PIXEL: u64 = 64;
/// Likewise with more bytes than this besides, for comments and metadata.
const MOST_BYTES_BESIDE: u64 = 16 << 20;

/// What a picture comes to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// Every pixel is the reference's.
    Same,
    /// Rounding explains every pixel that is not.
    Explained,
    /// Pixels are unexplained.
    Different,
    /// There is no picture.
    Missing,
    /// The file ends before its picture does.
    Truncated,
    /// The picture has another size than the scene.
    WrongSize,
    /// The file breaks the rules of its format, or cannot be read.
    Damaged,
    /// Another format than PPM and PNG, or pixels that are not 8 bits a channel and opaque.
    Unsupported,
}

impl Verdict {
    /// The verdict in words.
    pub fn name(self) -> &'static str {
        match self {
            Self::Same => "same",
            Self::Explained => "explained by rounding",
            Self::Different => "different",
            Self::Missing => "missing",
            Self::Truncated => "truncated",
            Self::WrongSize => "wrong size",
            Self::Damaged => "damaged",
            Self::Unsupported => "unsupported format",
        }
    }
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.pad(self.name())
    }
}

/// A scene's picture of somebody, graded.
///
/// Serialised, the field names are a stable interface.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Row {
    /// The student: the name of the folder within the folder of pictures, if there are such.
    pub student: Option<String>,
    /// The scene: its file's name without the ending.
    pub scene: String,
    /// The picture's file.
    pub picture: Option<String>,
    /// What it comes to.
    pub verdict: Verdict,
    /// 0 to 100: see [`RULE`].
    pub score: u8,
    /// Pixels of the scene.
    pub pixels: u64,
    /// Pixels that differ, by more than so many levels; `None` where nothing could be compared, like what follows.
    pub differing: Option<Differing>,
    /// The greatest level difference.
    pub max_level: Option<u8>,
    /// Differing pixels that rounding explains.
    pub explained: Option<u64>,
    /// Those that it does not.
    pub unexplained: Option<u64>,
    /// What may have happened, the likelier first.
    pub causes: Vec<Cause>,
    /// Whether the time for seeking causes was over before all were tried.
    pub cut_short: bool,
    /// Why the causes are not known, or why nothing could be compared.
    pub detail: Option<String>,
    /// What had to be got over in reading the picture.
    pub warnings: Vec<String>,
    /// The page that shows it, beside the overview.
    pub page: Option<String>,
}

impl Row {
    fn new(student: Option<&str>, assignment: &Assignment, picture: Option<&Path>) -> Self {
        Self {
            student: student.map(str::to_owned),
            scene: assignment.name.clone(),
            picture: picture.map(visible_path),
            verdict: Verdict::Missing,
            score: 0,
            pixels: assignment.expected.pixel_count(),
            differing: None,
            max_level: None,
            explained: None,
            unexplained: None,
            causes: Vec::new(),
            cut_short: false,
            detail: None,
            warnings: Vec::new(),
            page: None,
        }
    }

    fn note(&mut self, diagnosis: &Diagnosis) {
        self.causes.clone_from(&diagnosis.causes);
        self.cut_short = diagnosis.cut_short;
    }

    fn refuse(&mut self, error: &ReadError) {
        self.verdict = match error.problem().kind() {
            ProblemKind::CutOff => Verdict::Truncated,
            ProblemKind::Unsupported => Verdict::Unsupported,
            ProblemKind::Damaged => Verdict::Damaged,
        };
        self.detail = Some(visible(&error.problem().to_string()));
    }

    /// The causes that explain the picture, or why they are not known, in a few words.
    pub fn why(&self) -> String {
        let causes = self.causes.iter().filter(|cause| cause.role == Role::Cause);
        let names: Vec<_> = causes.map(|cause| cause.name).collect();
        if names.is_empty() { self.detail.clone().unwrap_or_default() } else { names.join(" + ") }
    }
}

/// A student's score over all scenes.
///
/// Serialised, the field names are a stable interface.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Student {
    /// The student.
    pub student: String,
    /// Mean of the scores, 0 to 100.
    pub score: f64,
}

/// The students of `rows`, in their order.
pub fn students(rows: &[Row]) -> Vec<Student> {
    let mut sums: Vec<(&str, u64, u64)> = Vec::new();
    for row in rows {
        let Some(student) = row.student.as_deref() else { continue };
        let score = u64::from(row.score);
        match sums.iter_mut().find(|(known, ..)| *known == student) {
            Some((_, sum, number)) => (*sum, *number) = (*sum + score, *number + 1),
            None => sums.push((student, score, 1)),
        }
    }
    let mean = |(student, sum, number): (&str, u64, u64)| Student {
        student: student.to_owned(),
        score: sum as f64 / number as f64,
    };
    sums.into_iter().map(mean).collect()
}

/// How pictures are looked at.
#[derive(Debug, Clone, Copy)]
pub struct Manner {
    /// Whether malformed pictures are repaired.
    pub leniency: Leniency,
    /// How long causes are sought of a picture at the most; `None` where they are not.
    pub explain: Option<Duration>,
    /// Whether there will be pages.
    pub pages: bool,
}

/// A scene with its reference, which pictures are held beside.
pub struct Assignment {
    name: String,
    scene: Scene,
    settings: Settings,
    effects: Effects,
    expected: Picture,
    reference: Reference<f64>,
    judge: Judge,
}

impl Assignment {
    /// Renders the reference of a scene that can be rendered. Pictures are judged by `judge`.
    ///
    /// # Errors
    /// Requests that make no sense.
    pub fn new(
        name: String,
        scene: Scene,
        settings: Settings,
        effects: Effects,
        judge: Judge,
    ) -> Result<Self, gpu::Error> {
        let (rgb, _) = render_picture(&mut Engine::new(Backend::Reference, scene.viewed(&settings), &effects)?)?;
        let expected = Picture::assemble(scene.width, scene.height, rgb);
        let reference = Reference::new(&scene.viewed(&settings), &effects);
        Ok(Self { name, scene, settings, effects, expected, reference, judge })
    }

    /// Grades the picture of a student in a file, or that there is none. Whatever is wrong with it is the row's.
    pub fn grade(&self, student: Option<&str>, picture: Option<&Path>, manner: Manner) -> Graded {
        let mut row = Row::new(student, self, picture);
        let Some(path) = picture else { return Graded { row, shown: None } };
        let shown = match self.read(path, manner, &mut row) {
            // Sizes are the same from here on.
            Ok(picture) => self.judged(picture, manner, &mut row).ok().filter(|_| manner.pages),
            Err(error) => {
                if let Some(error) = error {
                    row.refuse(&error);
                }
                None
            }
        };
        Graded { row, shown }
    }

    /// The picture, if it has the scene's size; without an error the row says what it is otherwise.
    fn read(&self, path: &Path, manner: Manner, row: &mut Row) -> Result<Picture, Option<ReadError>> {
        if let Some(what) = what_instead(path) {
            row.verdict = Verdict::Damaged;
            row.detail = Some(what);
            return Err(None);
        }
        let most = row.pixels.saturating_mul(MOST_BYTES_A_PIXEL).saturating_add(MOST_BYTES_BESIDE);
        let bytes = fs::metadata(path).map_or(0, |found| found.len());
        if bytes > most {
            row.verdict = Verdict::Damaged;
            row.detail = Some(format!("{bytes} bytes are more than any picture of this scene has"));
            return Err(None);
        }
        let encoded = Encoded::open(path)?;
        let (size, wanted) = (encoded.size()?, (self.scene.width, self.scene.height));
        if size != wanted {
            row.verdict = Verdict::WrongSize;
            row.detail = Some(format!("{} × {} pixels, the scene has {} × {}", size.0, size.1, wanted.0, wanted.1));
            // A picture that can have no pixel of the scene is not worth its memory.
            let is_near = u64::from(size.0) * u64::from(size.1) <= row.pixels.saturating_mul(4);
            if let Some(time) = manner.explain
                && is_near
                && let Ok(reading) = encoded.decode(manner.leniency)
            {
                let viewed = self.scene.viewed(&self.settings);
                row.note(&diagnose_size(&reading.picture, &viewed, &self.effects, Some(time)));
            }
            return Err(None);
        }
        let reading = encoded.decode(manner.leniency)?;
        row.warnings = reading.warnings.iter().map(ToString::to_string).collect();
        Ok(reading.picture)
    }

    fn judged(&self, picture: Picture, manner: Manner, row: &mut Row) -> Result<Shown, SizeMismatch> {
        let viewed = self.scene.viewed(&self.settings);
        let difference = Difference::between(&picture, &self.expected)?;
        let explanation = Explanation::of(&picture, &self.expected, &self.reference, &self.judge);
        row.verdict = match (explanation.differing, explanation.unexplained) {
            (0, _) => Verdict::Same,
            (_, 0) => Verdict::Explained,
            _ => Verdict::Different,
        };
        row.score = score(&picture, &self.expected, &explanation.places);
        row.differing = Some(difference.differing);
        row.max_level = Some(difference.max_level);
        row.explained = Some(explanation.differing - explanation.unexplained);
        row.unexplained = Some(explanation.unexplained);
        let time = manner.explain.filter(|_| row.verdict == Verdict::Different);
        let diagnosis = time
            .map(|time| diagnose(&picture, &self.expected, &viewed, &self.effects, &explanation.places, Some(time)));
        if let Some(diagnosis) = &diagnosis {
            row.note(diagnosis);
            if row.causes.is_empty() {
                row.detail = Some(diagnosis.without_causes());
            }
        }
        let by_sphere = || BySphere::of(&picture, &self.expected, &viewed, &explanation.places);
        let spheres = if manner.pages { Some(by_sphere()?) } else { None };
        Ok(Shown { picture, difference, explanation, diagnosis, spheres })
    }
}

/// A graded picture.
pub struct Graded {
    /// What it comes to.
    pub row: Row,
    /// What a page shows of it, if pages are wanted and it could be compared.
    pub shown: Option<Shown>,
}

/// What a page shows of a picture.
pub struct Shown {
    picture: Picture,
    difference: Difference,
    explanation: Explanation,
    diagnosis: Option<Diagnosis>,
    spheres: Option<BySphere>,
}

impl Shown {
    /// The page of `row`, a picture of `assignment`.
    ///
    /// # Errors
    /// Never, since the sizes are the same.
    pub fn html(&self, row: &Row, assignment: &Assignment, command: &str) -> Result<String, SizeMismatch> {
        let whose = row.student.as_ref().map(|student| format!(", {}", visible(student))).unwrap_or_default();
        let comparison = Comparison {
            title: &format!("{}{whose}", visible(&row.scene)),
            names: [row.picture.as_deref().unwrap_or_default(), &format!("reference of {}", row.scene)],
            pictures: [&self.picture, &assignment.expected],
            difference: &self.difference,
            verdict: &format!("{}, score {} of {FULL}", row.verdict, row.score),
            explanation: Some(&self.explanation),
            diagnosis: self.diagnosis.as_ref(),
            spheres: self.spheres.as_ref().map(|spheres| (spheres, &assignment.scene.sphere_names)),
            remarks: &row.warnings,
        };
        comparison.html(command)
    }
}
