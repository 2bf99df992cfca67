//! Which files of `shaders/` make up a module: each says in its head which slots it needs, and the variant says which file fills a
//! slot that has several.

use std::borrow::Cow;

use super::variant::{Kernel, Schedule, Secondary, Slots, Storage, Tables, Variant};
use crate::brightness::Scalar;
use crate::gpu::shared::declaration;
use crate::precision::Tier;

/// Where the declarations of the host stand in a module.
const HOST: &str = "(the host)";

macro_rules! files {
    ($($name:literal)*) => {
        /// The text of a file, by its name without the ending.
        fn text(name: &str) -> Option<Cow<'static, str>> {
            match name {
                $($name => Some(Cow::Borrowed(include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/", $name, ".wgsl")))),)*
                _ => None,
            }
        }
    };
}

files! {
    "barrier_bits" "barrier_none" "batch_plain" "batch_robust" "body_plain" "body_robust" "bounce" "bound_cone" "bound_none"
    "counters"
    "difference_f32" "difference_f64" "distance_pair" "distance_real" "echo" "effects" "eft" "elementary_f32"
    "elementary_f64" "entry_copied" "entry_shared" "fill" "filled_nearest" "filled_smooth" "film_pixels" "film_samples"
    "flood" "grid" "intersect" "jump" "kernel_plain" "kernel_robust" "kernel_schoolbook" "path_first" "path_in_place" "path_kept"
    "path_tree" "probe" "quantize" "queue" "quotients" "ray_plain" "ray_robust" "real_f32" "real_f64" "reflect" "refract" "resolve"
    "roots_pair" "roots_single" "scene_ranges" "scene_tables" "search_all" "search_lists" "secondary_both" "secondary_grid"
    "secondary_large" "selftest" "shade" "slots_list" "slots_tiles" "tables_buffers" "tables_textures" "texels"
    "texture_sampled" "texture_stored" "trace" "types" "vectors_f32" "vectors_f64" "waiting_cones" "waiting_none" "walk_at_once" "walk_in_turn"
}

/// One file of `shaders/`, or what the host declares.
#[derive(Debug, Clone)]
pub(super) struct Part {
    /// Its name without the ending, or [`HOST`].
    name: String,
    pub(super) text: Cow<'static, str>,
}

impl Part {
    /// Its path in the project.
    pub(super) fn path(&self) -> String {
        if self.name == HOST { self.name.clone() } else { format!("shaders/{}.wgsl", self.name) }
    }

    /// The slot that it fills, if it is a file.
    pub(super) fn slot(&self) -> Option<&str> {
        (self.name != HOST).then(|| slot_of(&self.name))
    }
}

/// Files are named after their slot, or `slot_variant` where there are several for it.
fn slot_of(name: &str) -> &str {
    name.split_once('_').map_or(name, |(slot, _)| slot)
}

/// These files with all that they need, each after what it needs, and before all what they take from the host.
pub(super) fn compose(files: &[&str], variant: &Variant) -> Vec<Part> {
    let (mut begun, mut parts) = (Vec::new(), Vec::new());
    for file in files {
        add(&mut begun, &mut parts, (*file).to_owned(), variant);
    }
    let mut names: Vec<_> = parts.iter().flat_map(|part| listed(&part.text, "host")).collect();
    names.sort_unstable();
    names.dedup();
    let text: String = names.iter().map(|name| variant.declaration(name)).collect();
    if !text.is_empty() {
        parts.insert(0, Part { name: HOST.into(), text: text.into() });
    }
    parts
}

/// Adds a file, and what it needs before it, where its slot is not filled or about to be.
fn add(begun: &mut Vec<String>, parts: &mut Vec<Part>, name: String, variant: &Variant) {
    let slot = slot_of(&name);
    if begun.iter().any(|begun| begun == slot) {
        return;
    }
    begun.push(slot.to_owned());
    let text = text(&name).unwrap_or_else(|| format!("there is no shaders/{name}.wgsl\n").into());
    for slot in listed(&text, "needs") {
        add(begun, parts, variant.file(slot), variant);
    }
    parts.push(Part { name, text });
}

/// The slots, or the constants of the host, in the line of a file's head that begins with `word`.
fn listed<'a>(text: &'a str, word: &str) -> impl Iterator<Item = &'a str> {
    let mut head = text.lines().take_while(|line| line.starts_with("//"));
    let line = head.find_map(|line| line.strip_prefix("// ")?.strip_prefix(word)?.strip_prefix(": "));
    line.into_iter().flat_map(|names| names.split(", "))
}

impl Variant {
    /// The file that fills a slot.
    pub(super) fn file(&self, slot: &str) -> String {
        self.of_slot(slot).map_or_else(|| slot.to_owned(), |variant| format!("{slot}_{variant}"))
    }

    /// Which file fills a slot that has several.
    fn of_slot(&self, slot: &str) -> Option<&'static str> {
        let Self { kernel, storage, refraction, schedule, .. } = *self;
        let either = |is_first, first, second| if is_first { first } else { second };
        Some(match slot {
            "real" | "vectors" | "difference" | "elementary" => either(kernel.is_double(), "f64", "f32"),
            "ray" | "body" | "batch" => either(kernel.carries_low(), "robust", "plain"),
            "barrier" => either(kernel == Kernel::NoBarrier, "none", "bits"),
            "distance" => either(kernel == Kernel::Pairs, "pair", "real"),
            "roots" => either(kernel == Kernel::Pairs, "pair", "single"),
            "kernel" => match kernel {
                Kernel::Tier(Tier::Fast | Tier::Double) => "plain",
                Kernel::Tier(Tier::Robust) | Kernel::Pairs | Kernel::NoBarrier => "robust",
                Kernel::Schoolbook => "schoolbook",
            },
            "bound" => either(self.certified && !kernel.carries_low(), "cone", "none"),
            "waiting" => either(self.certified && !kernel.carries_low(), "cones", "none"),
            "scene" => either(storage == Storage::Ranges, "ranges", "tables"),
            "search" => either(storage == Storage::Ranges, "all", "lists"),
            "tables" => either(storage == Storage::Tables(Tables::Buffers), "buffers", "textures"),
            "texture" => either(storage == Storage::Tables(Tables::Sampled), "sampled", "stored"),
            "secondary" => match self.secondary {
                Secondary::Grid => "grid",
                Secondary::Large => "large",
                Secondary::Both => "both",
            },
            "entry" => either(self.copies(), "copied", "shared"),
            "film" => either(self.samples, "samples", "pixels"),
            "slots" => either(self.slots == Slots::List, "list", "tiles"),
            "path" if refraction.is_some() => "tree",
            "path" => match schedule {
                Schedule::First => "first",
                Schedule::InPlace => "in_place",
                Schedule::AtOnce | Schedule::InTurn(_) => "kept",
            },
            "walk" => either(schedule == Schedule::AtOnce, "at_once", "in_turn"),
            _ => return None,
        })
    }

    /// The declaration of a constant of the host; of no other name, which then fails to parse.
    fn declaration(&self, name: &str) -> String {
        let value = match (name, self.refraction) {
            // Only workgroup arrays may take their size from a constant of the pipeline.
            ("MAX_WAITING", Some(waiting)) => Some(format!("u32 = {waiting}u")),
            ("DISPATCH_TILES", _) => Some(format!("u32 = {}u", self.dispatch_tiles)),
            _ => declaration(name, if self.kernel.is_double() { Scalar::Double } else { Scalar::Single }),
        };
        value.map_or_else(|| format!("the host has no {name}\n"), |value| format!("const {name}: {value};\n"))
    }
}
