//! The shader text: plain WGSL files, joined, with a map from the joined lines back to the files.

use std::borrow::Cow;
use std::fmt::Write as _;
use std::num::NonZeroU32;

use crate::accel::Rounding;
use crate::precision::Tier;
use crate::sampling::Fill;

/// One file of `shaders/`, or a line from the host.
#[derive(Debug, Clone)]
struct Part {
    /// Name below `shaders/`.
    pub name: &'static str,
    /// Its text.
    pub text: Cow<'static, str>,
}

macro_rules! part {
    ($name:literal) => {
        Part { name: $name, text: Cow::Borrowed(include_str!(concat!("../../../shaders/", $name))) }
    };
}

/// What intersects rays with spheres: a tier, or what goes wrong without its care.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Kernel {
    /// The kernel of a tier, which renders.
    Tier(Tier),
    /// The kernel of [`Tier::Double`] where the device has no `f64`: pairs of `f32` up to the roots.
    Pairs,
    /// The schoolbook formula in `f32`: for study only.
    Schoolbook,
    /// The robust kernel whose error-free transforms are left to the compiler, without barriers and free to be contracted: for study
    /// only.
    NoBarrier,
}

impl Kernel {
    /// The name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Tier(tier) => tier.name(),
            Self::Pairs => "pairs",
            Self::Schoolbook => "schoolbook",
            Self::NoBarrier => "no-barrier",
        }
    }

    /// Whether numbers carry what rounding took from them.
    pub fn carries_low(self) -> bool {
        matches!(self, Self::Tier(Tier::Robust) | Self::Pairs | Self::NoBarrier)
    }

    /// How it rounds.
    pub fn rounding(self) -> Rounding {
        if self.is_double() {
            Rounding::DOUBLE
        } else if self.carries_low() {
            Rounding::COMPENSATED
        } else {
            Rounding::SINGLE
        }
    }

    /// Whether its pixels say where rounding could decide whether a primary ray touches a sphere.
    pub fn tells_tangents(self) -> bool {
        self.is_double() || self.carries_low()
    }

    /// Whether it calculates in `f64`.
    pub fn is_double(self) -> bool {
        self == Self::Tier(Tier::Double)
    }
}

/// Where the spheres are that secondary rays look for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Places {
    /// All in the cells of the grid.
    Grid,
    /// All too large for the cells of the grid, or so few.
    Large,
    /// Some of each.
    Both,
}

/// How kernels read the textures that hold a scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Textures {
    /// As storage textures.
    Stored,
    /// As sampled textures.
    Sampled,
}

/// How spheres and lights reach the kernel.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Storage {
    /// In textures, with lists of those that a ray can meet.
    Tables(Textures),
    /// In storage buffers, a range of spheres for each ray of a batch.
    Ranges,
}

/// How paths are walked.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Walk {
    /// To the end, by the invocation that casts the primary ray.
    InPlace,
    /// A bounce at a time: one an invocation, which also shades what it meets.
    AtOnce,
    /// A bounce at a time: so many an invocation, one after another; then a kernel shades what they have met.
    InTurn(NonZeroU32),
}

/// Which pixels a dispatch renders.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Slots {
    /// All of each tile.
    Tiles,
    /// Those of a list.
    List,
}

/// What decides which text renders.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Variant {
    /// What intersects rays with spheres.
    pub kernel: Kernel,
    /// How spheres and lights reach it.
    pub storage: Storage,
    /// Where the spheres are that secondary rays look for.
    pub places: Places,
    /// Whether a pixel has several samples.
    pub samples: bool,
    /// Where something refracts, how many rays wait at the most.
    pub refraction: Option<NonZeroU32>,
    /// Which pixels a dispatch renders.
    pub slots: Slots,
    /// How paths are walked, where nothing refracts.
    pub walk: Walk,
}

impl Variant {
    /// Whether walks read copies of the spheres in the order of the grid's lists.
    pub fn copies(&self) -> bool {
        self.refraction.is_none() && matches!(self.walk, Walk::InTurn(_)) && !self.kernel.carries_low()
    }
}

/// The scalar of the kernel and what the host packs.
fn data_parts(kernel: Kernel, storage: Storage) -> Vec<Part> {
    let barrier = if kernel == Kernel::NoBarrier { part!("barrier_none.wgsl") } else { part!("barrier.wgsl") };
    let mut parts =
        vec![if kernel.is_double() { part!("real_f64.wgsl") } else { part!("real_f32.wgsl") }, part!("types.wgsl")];
    match storage {
        Storage::Tables(textures) => parts.extend([
            match textures {
                Textures::Stored => part!("tables_stored.wgsl"),
                Textures::Sampled => part!("tables_sampled.wgsl"),
            },
            if kernel.is_double() { part!("vectors_f64.wgsl") } else { part!("vectors_f32.wgsl") },
            part!("tables.wgsl"),
            part!("many.wgsl"),
        ]),
        Storage::Ranges => parts.push(part!("ranges.wgsl")),
    }
    if !kernel.is_double() {
        parts.push(barrier);
    }
    parts
}

/// The parts that intersect rays with spheres, in order.
fn intersection_parts(kernel: Kernel, storage: Storage) -> Vec<Part> {
    let mut parts = vec![part!("effects.wgsl")];
    parts.extend(data_parts(kernel, storage));
    let [real, pair] = [part!("distance_real.wgsl"), part!("distance_pair.wgsl")];
    let [single_roots, pair_roots] = [part!("roots_single.wgsl"), part!("roots_pair.wgsl")];
    let plain_ray = part!("ray_plain.wgsl");
    let (eft, robust) = (part!("eft.wgsl"), part!("kernel_robust.wgsl"));
    parts.extend(match kernel {
        Kernel::Tier(Tier::Fast | Tier::Double) => vec![real, plain_ray, part!("kernel_plain.wgsl")],
        Kernel::Tier(Tier::Robust) | Kernel::NoBarrier => vec![real, eft, single_roots, robust],
        Kernel::Pairs => vec![eft, pair, pair_roots, robust],
        Kernel::Schoolbook => vec![real, plain_ray, part!("kernel_schoolbook.wgsl")],
    });
    parts.push(part!("intersect.wgsl"));
    parts.push(match storage {
        Storage::Tables(_) => part!("lists.wgsl"),
        Storage::Ranges => part!("every.wgsl"),
    });
    parts
}

/// The parts that refract rays, in order.
fn refract_parts(kernel: Kernel) -> [Part; 2] {
    let bent = if kernel.carries_low() { part!("refract_robust.wgsl") } else { part!("refract_plain.wgsl") };
    [bent, part!("refract.wgsl")]
}

/// A composed module.
#[derive(Debug, Clone)]
pub struct Module {
    /// The joined text.
    pub text: String,
    parts: Vec<Part>,
}

impl Module {
    /// The module that renders like this.
    pub fn render(variant: &Variant) -> Self {
        let Variant { kernel, storage, places, samples, refraction, slots, walk } = *variant;
        let mut parts = intersection_parts(kernel, storage);
        let bodies = if variant.copies() { part!("bodies_copied.wgsl") } else { part!("bodies_shared.wgsl") };
        parts.extend(match places {
            Places::Grid => vec![bodies, part!("grid.wgsl"), part!("secondary_grid.wgsl")],
            Places::Large => vec![part!("secondary_large.wgsl")],
            Places::Both => vec![bodies, part!("grid.wgsl"), part!("secondary_both.wgsl")],
        });
        parts.extend([part!("film.wgsl"), part!("quantize.wgsl")]);
        parts.push(if samples { part!("film_samples.wgsl") } else { part!("film_pixels.wgsl") });
        parts.extend([part!("shade.wgsl"), part!("reflect.wgsl")]);
        if let Some(waiting) = refraction {
            // Only workgroup arrays may take their size from a constant of the pipeline.
            let text = format!("const MAX_WAITING: u32 = {waiting}u;\n").into();
            parts.extend(refract_parts(kernel));
            parts.extend([Part { name: "(the host)", text }, part!("trees.wgsl")]);
        } else {
            parts.extend(match walk {
                Walk::InPlace => vec![part!("walk_in_place.wgsl")],
                Walk::AtOnce => vec![part!("paths.wgsl"), part!("walk_at_once.wgsl")],
                Walk::InTurn(_) => vec![part!("paths.wgsl"), part!("walk_in_turn.wgsl")],
            });
        }
        parts.push(part!("stages.wgsl"));
        parts.push(match slots {
            Slots::Tiles => part!("slots_tiles.wgsl"),
            Slots::List => part!("slots_list.wgsl"),
        });
        Self::join(parts)
    }

    /// The module that goes from one stage to the next.
    pub fn between_stages() -> Self {
        Self::join(vec![part!("stage.wgsl")])
    }

    /// The module that makes pixels of samples.
    pub fn resolve(kernel: Kernel) -> Self {
        let mut parts = vec![part!("effects.wgsl")];
        parts.extend(data_parts(kernel, Storage::Ranges));
        parts.extend([part!("quantize.wgsl"), part!("resolve.wgsl")]);
        Self::join(parts)
    }

    /// The module that finds each pixel's nearest sample.
    pub fn flood() -> Self {
        Self::join(vec![part!("flood.wgsl"), part!("flood_jump.wgsl")])
    }

    /// The module that fills pixels without a sample.
    pub fn fill(fill: Fill) -> Self {
        let filled = match fill {
            Fill::Nearest => part!("fill_nearest.wgsl"),
            Fill::Smooth => part!("fill_smooth.wgsl"),
        };
        Self::join(vec![part!("flood.wgsl"), part!("fill.wgsl"), filled])
    }

    /// The module that tries error-free transforms.
    pub fn selftest() -> Self {
        Self::join(vec![
            part!("real_f32.wgsl"),
            part!("types.wgsl"),
            part!("barrier.wgsl"),
            part!("eft.wgsl"),
            part!("selftest.wgsl"),
        ])
    }

    /// The module that writes back what it reads.
    pub fn echo(kernel: Kernel, textures: Textures) -> Self {
        let mut parts = data_parts(kernel, Storage::Tables(textures));
        parts.push(part!("echo.wgsl"));
        Self::join(parts)
    }

    /// The module that sends batches of rays through `kernel`.
    pub fn probe(kernel: Kernel) -> Self {
        let mut parts = intersection_parts(kernel, Storage::Ranges);
        parts.extend([part!("film.wgsl"), part!("shade.wgsl"), part!("reflect.wgsl")]);
        parts.extend(refract_parts(kernel));
        parts.push(part!("probe.wgsl"));
        parts.push(if kernel.carries_low() { part!("probe_robust.wgsl") } else { part!("probe_plain.wgsl") });
        Self::join(parts)
    }

    fn join(parts: Vec<Part>) -> Self {
        Self { text: parts.iter().map(|part| part.text.as_ref()).collect(), parts }
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
