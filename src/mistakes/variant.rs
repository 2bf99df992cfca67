//! A picture under rules that may be wrong ones: rendered, turned, moved and written with other levels.

use std::sync::Arc;

use glam::DVec3;

use super::rules::{
    AmbientCount, Behind, Clamp, Fading, Mirror, Near, NegativeCosine, Normal, Rules, Shadow, SpecularFactor, ToLight,
    ToViewer, Winner,
};
use super::textbook::{Ray, Textbook};
use super::world::World;
use crate::camera::Camera;
use crate::effects::{Effect, EffectSet, Effects};
use crate::viewed::ViewedScene;

/// How far a renderer's colours may be off that calculates in `f32`.
const TOLERANCE: f64 = 4e-5;

/// From linear colours to other ones.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Curve {
    Linear,
    Srgb,
    /// c to one over this.
    Gamma(f64),
}

impl Curve {
    fn of(self, c: f64) -> f64 {
        match self {
            Self::Linear => c,
            Self::Srgb if c <= 0.003_130_8 => 12.92 * c,
            Self::Srgb => 1.055 * c.powf(1.0 / 2.4) - 0.055,
            Self::Gamma(gamma) => c.max(0.0).powf(1.0 / gamma),
        }
    }
}

/// What becomes of colours beyond 0..=1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Beyond {
    Clamped,
    /// Levels modulo 256.
    Wrapped,
    /// Above 1 to 0.
    Black,
    /// A colour is divided by its greatest channel, if that is above 1.
    Divided,
    /// Where one channel is above 1 all are 1.
    White,
}

/// From colours to levels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Encoding {
    pub curve: Curve,
    pub scale: f64,
    pub bias: f64,
    pub beyond: Beyond,
    /// Where the curve is applied to finished levels: what is added before their fraction is cut off.
    pub curve_on_levels: Option<f64>,
    /// Where each channel comes from.
    pub channels: [usize; 3],
}

impl Encoding {
    /// The levels of an unclamped colour.
    pub(super) fn levels(&self, color: DVec3) -> [u8; 3] {
        let greatest = color.max_element();
        let color = match self.beyond {
            Beyond::Divided if greatest > 1.0 => color / greatest,
            Beyond::White if greatest > 1.0 => DVec3::ONE,
            _ => color,
        };
        self.channels.map(|channel| self.level(color[channel]))
    }

    fn level(&self, c: f64) -> u8 {
        let c = match self.beyond {
            Beyond::Wrapped => c,
            Beyond::Black if c > 1.0 => 0.0,
            _ => c.clamp(0.0, 1.0),
        };
        let c = if self.curve_on_levels.is_some() { c } else { self.curve.of(c) };
        let level = self.scale * c + self.bias;
        let level = if self.beyond == Beyond::Wrapped { level as i64 as u8 } else { level as u8 };
        self.curve_on_levels.map_or(level, |bias| (255.0 * self.curve.of(f64::from(level) / 255.0) + bias) as u8)
    }

    /// Whether `levels` may be those of a colour, in arithmetic that rounds.
    fn gives(&self, color: DVec3, levels: [u8; 3], tolerance: f64) -> bool {
        let middle = self.levels(color);
        middle == levels
            || tolerance > 0.0 && {
                let slack = tolerance * (1.0 + color.abs().max_element());
                // A colour of just 1, such as a white background, is not above it.
                let above = color.map(|c| if c <= 1.0 { (c + slack).min(1.0) } else { c + slack });
                let ends = [self.levels(color - slack), self.levels(above)];
                (0..3).all(|c| levels[c] == middle[c] || ends.iter().any(|end| levels[c] == end[c]))
            }
    }

    /// The middle of the colours with these levels, each NaN where there is no telling.
    pub(super) fn color(&self, levels: [u8; 3]) -> DVec3 {
        let mut color = DVec3::NAN;
        for (place, channel) in self.channels.into_iter().enumerate() {
            let is_open =
                self.beyond == Beyond::Wrapped || self.curve != Curve::Linear || [0, 255].contains(&levels[place]);
            if !is_open {
                color[channel] = (f64::from(levels[place]) + 0.5 - self.bias) / self.scale;
            }
        }
        color
    }
}

/// What a moved picture shows beyond the edge of the one that it was made of.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Border {
    /// What the scene has there.
    Rendered,
    Black,
    /// The outermost row or column again.
    Repeated,
    /// The other side of the picture.
    Wrapped,
}

impl Border {
    /// In words.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Rendered => "what the scene has there",
            Self::Black => "black",
            Self::Repeated => "the outermost pixels again",
            Self::Wrapped => "the other side",
        }
    }
}

/// Where the pixels of a picture come from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Layout {
    /// Rows and columns are exchanged,
    pub transposed: bool,
    /// then columns are written from right to left,
    pub mirrored: bool,
    /// and rows from bottom to top.
    pub upside_down: bool,
    /// Then the picture moves to the right and down.
    pub shift: [i64; 2],
    pub border: Border,
    /// Written column after column.
    pub by_columns: bool,
}

impl Layout {
    pub(super) const PLAIN: Self = Self {
        transposed: false,
        mirrored: false,
        upside_down: false,
        shift: [0; 2],
        border: Border::Rendered,
        by_columns: false,
    };

    /// Column and row of the rendered picture, of `size`, that pixel (`i`, `j`) of the one of `shown` columns and rows shows.
    fn source(&self, [i, j]: [i64; 2], shown: [i64; 2], size: [i64; 2]) -> [i64; 2] {
        let [mut x, mut y] = [i - self.shift[0], j - self.shift[1]];
        if self.by_columns {
            let index = y * shown[0] + x;
            return [index.div_euclid(size[1]), index.rem_euclid(size[1])];
        }
        let [width, height] = if self.transposed { [size[1], size[0]] } else { size };
        if self.mirrored {
            x = width - 1 - x;
        }
        if self.upside_down {
            y = height - 1 - y;
        }
        if self.transposed { [y, x] } else { [x, y] }
    }
}

/// What every variant of a picture has in common.
#[derive(Debug, Clone)]
pub(super) struct Stage {
    camera: Camera,
    /// Power of two by which the file's lengths are multiplied.
    pub unit: f64,
    /// Where the eye is in the file's coordinates.
    pub eye: DVec3,
    /// Columns and rows of the picture that is to be explained.
    pub shown: [u32; 2],
}

impl Stage {
    pub(super) fn new(viewed: &ViewedScene, shown: [u32; 2]) -> Self {
        let eye = viewed.in_file().1.view.eye;
        Self { camera: Camera::new(viewed), unit: viewed.factor(), eye, shown }
    }
}

/// A picture.
#[derive(Debug, Clone)]
pub(super) struct Variant {
    pub world: Arc<World>,
    pub rules: Rules,
    pub encoding: Encoding,
    pub layout: Layout,
    /// Columns and rows that are rendered.
    pub size: [u32; 2],
    /// Whether any lights may be missing in any point that the eye sees.
    pub specks: bool,
}

impl Variant {
    /// The right picture of `viewed`.
    pub(super) fn new(viewed: &ViewedScene, effects: &Effects) -> Self {
        let settings = viewed.settings();
        // What the scene does not need changes nothing, but a mistake may bring it out.
        let needed = Effects::of(viewed);
        let mut simulated = effects.clone();
        for effect in Effect::ALL {
            let on = effects.set.has(effect) || !needed.set.has(effect);
            simulated.set = simulated.set.with(effect, on);
        }
        let on = |effect| simulated.set.has(effect);
        let rules = Rules {
            offset: settings.sampling.offset(),
            edge_to_edge: false,
            near_is_one: false,
            near: if on(Effect::Shells) { Near::Beyond } else { Near::Ignored },
            far_root: on(Effect::Shells),
            cut_spheres: true,
            winner: Winner::Nearest,
            normal: Normal::InverseTranspose,
            flipped_inside: true,
            to_light: ToLight::Unit,
            to_viewer: ToViewer::AgainstRay,
            behind: Behind::Dark,
            specular: settings.specular,
            negative_cosine: NegativeCosine::Clamped,
            specular_factor: SpecularFactor::One,
            specular_takes_light: true,
            exponent: (1.0, 0.0),
            diffuse: 1.0,
            highlights: 1.0,
            ambient: AmbientCount::Times(1.0),
            ambient_takes_ka: true,
            ambient_takes_color: true,
            fading: Fading::None,
            shadow: if on(Effect::Shadows) { Shadow::OwnLight } else { Shadow::None },
            own_blocks: true,
            own_from_outside: false,
            far_root_blocks: true,
            cut_part_blocks: true,
            shadow_range: (settings.secondary.shadow, 1.0),
            shadow_distance: None,
            shadows_in_mirrors: true,
            mirror: Mirror::Added,
            depth: if effects.depth == needed.depth { settings.max_depth } else { effects.depth },
            reflection_epsilon: settings.secondary.reflection,
            back_in_mirrors: false,
            clamp: Clamp::None,
            darkened: 0,
        };
        let encoding = Encoding {
            curve: Curve::Linear,
            scale: settings.quantize.scale(),
            bias: settings.quantize.bias(),
            beyond: Beyond::Clamped,
            curve_on_levels: None,
            channels: [0, 1, 2],
        };
        let scene = viewed.scene();
        let world = Arc::new(World::new(viewed, &simulated));
        Self { world, rules, encoding, layout: Layout::PLAIN, size: [scene.width, scene.height], specks: false }
    }

    /// The right pictures of `viewed` with effects that it needs and `effects` leave out: each of them alone and, if there are several,
    /// all; with their names.
    pub(super) fn with_left_out(viewed: &ViewedScene, effects: &Effects) -> Vec<(String, Self)> {
        let needed = Effects::of(viewed);
        let left_out: EffectSet = needed.set.iter().filter(|&effect| !effects.set.has(effect)).collect();
        let mut sets: Vec<EffectSet> = left_out.iter().map(|effect| EffectSet::NONE.with(effect, true)).collect();
        if sets.len() > 1 {
            sets.push(left_out);
        }
        let with = |set: EffectSet| {
            let mut with = effects.clone();
            with.set = with.set.iter().chain(set.iter()).collect();
            if set.has(Effect::Reflections) || set.has(Effect::Refraction) {
                with.depth = needed.depth;
            }
            (set.to_string(), Self::new(viewed, &with))
        };
        sets.into_iter().map(with).collect()
    }

    /// Simulates what `whole` simulates.
    pub(super) fn simulate(&mut self, whole: &Self) {
        let Rules { near, far_root, shadow, depth, .. } = whole.rules;
        self.world = Arc::clone(&whole.world);
        self.rules = Rules { near, far_root, shadow, depth, ..self.rules };
    }

    fn textbook<'a>(&'a self, stage: &Stage) -> Textbook<'a> {
        let [_, _, back] = stage.camera.axes();
        let Self { world, rules, .. } = self;
        Textbook {
            world,
            rules,
            plane: 1.0 / stage.camera.stretch(),
            back,
            near: stage.camera.near(),
            unit: stage.unit,
        }
    }

    /// The ray through a place of the rendered picture, in samples from its top left corner.
    fn ray(&self, stage: &Stage, [x, y]: [f64; 2]) -> Ray {
        let camera = &stage.camera;
        let [right, up, back] = camera.axes();
        let across = |at: f64, size: u32, count: u32| {
            // Camera counts in its own pixels.
            let steps = if self.rules.edge_to_edge { f64::from(size.max(2)) - 1.0 } else { f64::from(size) };
            at * f64::from(count) / steps
        };
        let x = camera.x_at(across(x, self.size[0], camera.width()));
        let y = camera.y_at(across(y, self.size[1], camera.height()));
        let near = if self.rules.near_is_one { stage.unit } else { camera.near() };
        let (point, ahead) = (right * x + up * y, back * near);
        if camera.is_parallel() {
            return Ray { origin: point, direction: -ahead * camera.stretch() };
        }
        Ray { origin: DVec3::ZERO, direction: (point - ahead) * camera.stretch() }
    }

    /// The unclamped colour that pixel (`i`, `j`) of the rendered picture has.
    fn rendered(&self, stage: &Stage, [i, j]: [i64; 2]) -> DVec3 {
        let pattern = stage.camera.pattern();
        let textbook = self.textbook(stage);
        let ticks = pattern.ticks(self.rules.offset);
        let sample = |s: u32| {
            let [across, down] = pattern.sample_place(s);
            let place = [i as f64 + ticks[0].place(across), j as f64 + ticks[1].place(down)];
            textbook.color(&self.ray(stage, place))
        };
        // As the reference takes the mean: exact where all samples are equal.
        let first = sample(0);
        first + (1..pattern.count()).map(|s| sample(s) - first).sum::<DVec3>() / f64::from(pattern.count())
    }

    /// The pixel of the rendered picture that pixel (`i`, `j`) shows; `None` where it shows none.
    fn source(&self, stage: &Stage, pixel: [u32; 2]) -> Option<[i64; 2]> {
        let size = self.size.map(i64::from);
        let source = self.layout.source(pixel.map(i64::from), stage.shown.map(i64::from), size);
        if (0..2).all(|axis| (0..size[axis]).contains(&source[axis])) {
            return Some(source);
        }
        match self.layout.border {
            Border::Rendered => Some(source),
            Border::Black => None,
            Border::Repeated => Some([0, 1].map(|axis| source[axis].clamp(0, size[axis] - 1))),
            Border::Wrapped => Some([0, 1].map(|axis| source[axis].rem_euclid(size[axis]))),
        }
    }

    /// The unclamped colour that pixel (`i`, `j`) shows.
    pub(super) fn color(&self, stage: &Stage, pixel: [u32; 2]) -> DVec3 {
        self.source(stage, pixel).map_or(DVec3::ZERO, |source| self.rendered(stage, source))
    }

    /// The sphere that pixel (`i`, `j`) shows.
    pub(super) fn seen(&self, stage: &Stage, pixel: [u32; 2]) -> Option<usize> {
        let [x, y] = self.source(stage, pixel)?.map(|place| place as f64);
        let (dx, dy) = self.rules.offset;
        self.textbook(stage).seen(&self.ray(stage, [x + dx, y + dy]))
    }

    /// Whether `levels` may be what pixel (`i`, `j`) shows: but for rounding, or to the last bit.
    pub(super) fn shows(&self, stage: &Stage, pixel: [u32; 2], levels: [u8; 3], exactly: bool) -> bool {
        self.encoding.gives(self.color(stage, pixel), levels, if exactly { 0.0 } else { TOLERANCE })
            || self.specks && self.speckled(stage, pixel).any(|color| self.encoding.gives(color, levels, TOLERANCE))
    }

    /// The levels that pixel (`i`, `j`) shows.
    pub(super) fn levels(&self, stage: &Stage, pixel: [u32; 2]) -> [u8; 3] {
        self.encoding.levels(self.color(stage, pixel))
    }

    /// The colours of a pixel with some lights missing: all, each, and of few lights any.
    fn speckled(&self, stage: &Stage, pixel: [u32; 2]) -> impl Iterator<Item = DVec3> {
        let count = self.world.lights.len().min(32) as u32;
        let every = (1..1_u32 << count.min(4)).filter(move |_| count <= 4);
        let each = (0..count).map(|light| 1 << light).chain([u32::MAX]).filter(move |_| count > 4);
        let mut variant = Self { specks: false, ..self.clone() };
        every.chain(each).map(move |darkened| {
            variant.rules.darkened = darkened;
            variant.color(stage, pixel)
        })
    }
}
