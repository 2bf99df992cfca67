//! The shader text: plain WGSL files, joined, with a map from the joined lines back to the files.

use std::fmt::Write as _;

use super::compose::{Part, compose};
use super::variant::{Kernel, Storage, Tables, Variant};
use crate::precision::Tier;
use crate::sampling::Fill;

/// A composed module.
#[derive(Debug, Clone)]
pub struct Module {
    /// The joined text.
    pub text: String,
    pub(super) parts: Vec<Part>,
}

impl Module {
    /// The module that renders like this.
    pub fn render(variant: &Variant) -> Self {
        let slots = if variant.keeps_paths() { &["slots", "walk"][..] } else { &["slots"] };
        let files: Vec<_> = slots.iter().map(|slot| variant.file(slot)).collect();
        Self::of(&files.iter().map(String::as_str).collect::<Vec<_>>(), variant)
    }

    /// The module that goes from one bounce to the next.
    pub fn between_bounces() -> Self {
        Self::of(&["bounce"], &Variant::of_ranges(Kernel::Tier(Tier::Fast)))
    }

    /// The module that makes pixels of samples.
    pub fn resolve(kernel: Kernel) -> Self {
        Self::of(&["resolve"], &Variant::of_ranges(kernel))
    }

    /// The module that finds each pixel's nearest sample.
    pub fn flood() -> Self {
        Self::of(&["jump"], &Variant::of_ranges(Kernel::Tier(Tier::Fast)))
    }

    /// The module that fills pixels without a sample.
    pub fn fill(fill: Fill) -> Self {
        let filled = match fill {
            Fill::Nearest => "filled_nearest",
            Fill::Smooth => "filled_smooth",
        };
        Self::of(&[filled], &Variant::of_ranges(Kernel::Tier(Tier::Fast)))
    }

    /// The module that tries error-free transforms.
    pub fn selftest() -> Self {
        Self::of(&["selftest"], &Variant::of_ranges(Kernel::Tier(Tier::Robust)))
    }

    /// The module that divides and takes square roots in the numbers of `kernel`.
    pub fn quotients(kernel: Kernel) -> Self {
        Self::of(&["quotients"], &Variant::of_ranges(kernel))
    }

    /// The module that writes back what it reads.
    pub fn echo(kernel: Kernel, tables: Tables) -> Self {
        Self::of(&["echo"], &Variant { storage: Storage::Tables(tables), ..Variant::of_ranges(kernel) })
    }

    /// The module that sends batches of rays through `kernel`.
    pub fn probe(kernel: Kernel) -> Self {
        Self::of(&["probe"], &Variant::of_ranges(kernel))
    }

    /// These files with all that they need.
    fn of(files: &[&str], variant: &Variant) -> Self {
        let parts = compose(files, variant);
        Self { text: parts.iter().map(|part| part.text.as_ref()).collect(), parts }
    }

    /// The paths of its files in the project, in their order.
    pub fn files(&self) -> impl Iterator<Item = String> {
        self.parts.iter().map(Part::path)
    }

    /// The file and line, both as a person counts, of line `line` (from 1) of the joined text.
    pub fn place(&self, line: u32) -> (String, u32) {
        let mut rest = line;
        for part in &self.parts {
            let lines = part.text.lines().count() as u32;
            if rest <= lines {
                return (part.path(), rest);
            }
            rest -= lines;
        }
        ("the end of the joined shaders".into(), rest)
    }

    /// Parses the module with naga; an error names the file and line.
    pub fn parse(&self) -> Result<naga::Module, String> {
        naga::front::wgsl::parse_str(&self.text).map_err(|error| {
            let mut message = error.message().to_string();
            if let Some(location) = error.location(&self.text) {
                let (file, line) = self.place(location.line_number);
                let _ = write!(message, " at {file}:{line}:{}", location.line_position);
            }
            message
        })
    }
}
