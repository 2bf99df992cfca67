//! What the kernels of a picture are made of, for people to read.

use std::fmt::Write as _;

use rspirv::binary::Disassemble;
use rspirv::dr;

use super::compose::Part;
use super::entry::{BEGIN_BOUNCE, RESOLVE, SHADE_PATHS, TRACE_SAMPLES, TRACE_TILES, WALK_PATHS};
use super::module::Module;
use super::specialisation::Specialisation;
use super::spirv::ParsedModule;
use super::variant::{Schedule, Slots};

impl Module {
    /// The text with a line before each part that names its file and the slot that this fills.
    pub fn listing(&self) -> String {
        let listed = |part: &Part| {
            let slot = part.slot().map(|slot| format!(", slot `{slot}`")).unwrap_or_default();
            format!("\n// ==== {}{slot} ====\n{}", part.path(), part.text)
        };
        self.parts.iter().map(listed).collect()
    }
}

impl Specialisation {
    /// The entry points of a picture's kernels, in the order in which they run; those of a bounce run once for each.
    pub fn entry_points(&self) -> Vec<&'static str> {
        let mut names = vec![match self.slots {
            Slots::Tiles => TRACE_TILES,
            Slots::List => TRACE_SAMPLES,
        }];
        if self.keeps_paths() {
            names.extend([BEGIN_BOUNCE, WALK_PATHS]);
            names.extend(matches!(self.schedule, Schedule::InTurn(_)).then_some(SHADE_PATHS));
        }
        names.extend(self.keeps_colors().then_some(RESOLVE));
        names
    }

    /// The module of an entry point.
    pub fn module_of(&self, entry_point: &str) -> Module {
        match entry_point {
            BEGIN_BOUNCE => Module::between_bounces(),
            RESOLVE => Module::resolve(self.kernel),
            _ => self.module(),
        }
    }

    /// The WGSL of an entry point's module, and the constants that the pipeline sets.
    pub fn listing(&self, entry_point: &str) -> String {
        let mut text = String::new();
        for (name, value) in self.constants_of(entry_point) {
            let _ = writeln!(text, "// {name} = {value}");
        }
        text + &self.module_of(entry_point).listing()
    }

    /// The SPIR-V of an entry point, disassembled; the bindings of the WGSL are numbered anew, in their order.
    ///
    /// # Errors
    ///
    /// What the compiler says, with file and line.
    pub fn disassembly(&self, entry_point: &str) -> Result<String, String> {
        let module = ParsedModule::new(&self.module_of(entry_point))?;
        let specialised = module.specialised(entry_point, &self.constants_of(entry_point))?;
        let words = module.spirv(&specialised, entry_point)?;
        let module = dr::load_words(words).map_err(|error| error.to_string())?;
        Ok(module.disassemble() + "\n")
    }
}
