//! The shader text: plain WGSL files, joined, with a map from the joined lines back to the files.

use std::fmt::Write as _;

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

/// The parts of the render module, in order.
fn render_parts(few: bool) -> Vec<Part> {
    vec![
        part!("effects.wgsl"),
        part!("real_f32.wgsl"),
        part!("types.wgsl"),
        if few { part!("few.wgsl") } else { part!("many.wgsl") },
        part!("intersect.wgsl"),
        part!("shade.wgsl"),
        part!("trace.wgsl"),
        part!("main.wgsl"),
    ]
}

/// A composed module.
#[derive(Debug, Clone)]
pub struct Module {
    /// The joined text.
    pub text: String,
    parts: Vec<Part>,
}

impl Module {
    /// The module that renders tiles, for few spheres and lights or for any number.
    pub fn render(few: bool) -> Self {
        Self::join(render_parts(few))
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
