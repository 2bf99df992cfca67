//! The shader text: plain WGSL files, joined, with a map from the joined lines back to the files.

use std::fmt::Write as _;

use crate::precision::Tier;

/// One file of `shaders/`.
#[derive(Debug, Clone, Copy)]
struct Part {
    /// Name below `shaders/`.
    pub name: &'static str,
    /// Its text.
    pub text: &'static str,
}

macro_rules! part {
    ($name:literal) => {
        Part { name: $name, text: include_str!(concat!("../../shaders/", $name)) }
    };
}

/// The scalar of `tier` and what the host packs.
fn data_parts(tier: Tier, few: bool) -> Vec<Part> {
    vec![
        if tier == Tier::Double { part!("real_f64.wgsl") } else { part!("real_f32.wgsl") },
        part!("types.wgsl"),
        if few { part!("few.wgsl") } else { part!("many.wgsl") },
    ]
}

/// The parts that intersect rays with spheres, in order.
fn intersection_parts(tier: Tier, few: bool) -> Vec<Part> {
    let mut parts = vec![part!("effects.wgsl")];
    parts.extend(data_parts(tier, few));
    match tier {
        Tier::Fast | Tier::Double => parts.push(part!("kernel_plain.wgsl")),
        Tier::Robust => parts.extend([part!("eft.wgsl"), part!("kernel_robust.wgsl")]),
    }
    parts.push(part!("intersect.wgsl"));
    parts
}

/// A composed module.
#[derive(Debug, Clone)]
pub struct Module {
    /// The joined text.
    pub text: String,
    parts: Vec<Part>,
}

impl Module {
    /// The module that renders tiles at `tier`, for few spheres and lights or for any number.
    pub fn render(tier: Tier, few: bool) -> Self {
        let mut parts = intersection_parts(tier, few);
        parts.extend([part!("shade.wgsl"), part!("trace.wgsl"), part!("main.wgsl")]);
        Self::join(parts)
    }

    /// The module that tries error-free transforms.
    pub fn selftest() -> Self {
        Self::join(vec![part!("real_f32.wgsl"), part!("types.wgsl"), part!("eft.wgsl"), part!("selftest.wgsl")])
    }

    /// The module that writes back what it reads.
    pub fn echo(tier: Tier) -> Self {
        let mut parts = data_parts(tier, false);
        parts.push(part!("echo.wgsl"));
        Self::join(parts)
    }

    fn join(parts: Vec<Part>) -> Self {
        Self { text: parts.iter().map(|part| part.text).collect(), parts }
    }

    /// The file and line, both as a person counts, of line `line` (from 1) of the joined text.
    pub fn place(&self, line: u32) -> (String, u32) {
        let mut rest = line;
        for part in &self.parts {
            let lines = part.text.lines().count() as u32;
            if rest <= lines {
                return (format!("shaders/{}", part.name), rest);
            }
            rest -= lines;
        }
        ("the end of the joined shaders".into(), rest)
    }

    /// Parses and validates the module with naga; an error names the file and line.
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
