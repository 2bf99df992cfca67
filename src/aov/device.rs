//! Layers from a device: what the very shaders that render calculate on the way to a pixel.

use glam::DVec3;

use super::Aov;
use super::layers::{Layer, MAX_BOUNCES, Plane, TooMany, planes};
use crate::camera::Camera;
use crate::cpu::Inspector;
use crate::effects::{Effect, Effects};
use crate::gpu::{Error, Gpu, GpuRenderer, Options, Rendered, Term};
use crate::linear::Linear;
use crate::precision::Tier;
use crate::settings::Quantize;
use crate::viewed::ViewedScene;

/// Pixels that are asked for at once.
const PIXELS_AT_ONCE: usize = 1 << 18;

/// A device that renders a picture, asked for what it has calculated on the way.
#[derive(Debug)]
pub struct DeviceLayers<'a> {
    name: String,
    /// What it tells of what is wanted, in the order of [`Aov`].
    planes: Vec<Plane>,
    /// Of [`Aov::Color`], by the picture's kernel.
    colors: Option<GpuRenderer<'a>>,
    /// Of what primary rays hit.
    terms: Option<GpuRenderer<'a>>,
    /// Of [`Aov::Bounce`].
    bounces: Option<GpuRenderer<'a>>,
    /// Of [`Aov::Rays`] and of [`Aov::Tests`], by the picture's kernel with counters; the former also say how many bounces there are.
    rays: Option<GpuRenderer<'a>>,
    tests: Option<GpuRenderer<'a>>,
    samples: u32,
    /// Whether any term needs lights.
    is_lit: bool,
    quantize: Quantize,
    /// From the kernels' units to those of the file.
    eye: DVec3,
    factor: f64,
    stretch: f64,
}

impl<'a> DeviceLayers<'a> {
    /// Those of the layers `wanted` that a kernel tells: of `viewed` with `effects`, at `tier`.
    ///
    /// # Errors
    ///
    /// Whatever keeps the device from rendering it.
    pub fn new(
        gpu: &'a Gpu,
        tier: Tier,
        viewed: &ViewedScene,
        effects: &Effects,
        wanted: &[Aov],
    ) -> Result<Self, Error> {
        let linear = Options { linear: true, ..Options::default() };
        let terms = Options { terms: true, ..linear };
        // No ray goes on from what it hits.
        let set = effects.set.with(Effect::Reflections, false).with(Effect::Refraction, false);
        let of_hit = Effects { set, depth: 0, ..effects.clone() };
        let settings = viewed.settings();
        let samples = settings.pattern.count();
        let is_lit = [Effect::Diffuse, Effect::Specular].iter().any(|&term| effects.set.has(term));
        let told: Vec<Aov> = wanted.iter().copied().filter(|aov| aov.is_told(samples, is_lit)).collect();
        let renderer = |is_of: fn(Aov) -> bool, effects: &Effects, options: &Options| {
            let is_wanted = told.iter().any(|&aov| is_of(aov));
            is_wanted.then(|| GpuRenderer::with(gpu, viewed, effects, tier, options)).transpose()
        };
        let is_term = |aov| !matches!(aov, Aov::Color | Aov::Bounce | Aov::Rays | Aov::Tests);
        let [one_ray, count_rays, count_tests] = [
            Options { one_ray: true, ..linear },
            Options { count_rays: true, ..Options::default() },
            Options { count_tests: true, ..Options::default() },
        ];
        Ok(Self {
            name: format!("{} at {tier}", gpu.device.info),
            colors: renderer(|aov| aov == Aov::Color, effects, &linear)?,
            terms: renderer(is_term, &of_hit, &terms)?,
            bounces: renderer(|aov| aov == Aov::Bounce, effects, &one_ray)?,
            rays: renderer(|aov| matches!(aov, Aov::Rays | Aov::Bounce), effects, &count_rays)?,
            tests: renderer(|aov| aov == Aov::Tests, effects, &count_tests)?,
            planes: planes(&told, viewed.scene().lights.len()),
            samples,
            is_lit,
            quantize: settings.quantize,
            eye: viewed.in_file().1.view.eye,
            factor: viewed.factor(),
            stretch: Camera::new(viewed).stretch(),
        })
    }

    /// The device and the tier.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Whether a kernel tells it.
    pub fn tells(&self, aov: Aov) -> bool {
        aov.is_told(self.samples, self.is_lit)
    }

    /// The layers, in the order of [`Aov`]. The reference calculates the pixels of which rounding could decide what they show, as it does in
    /// the picture.
    ///
    /// # Errors
    ///
    /// Whatever keeps the device from rendering them, or [`TooMany::Bounces`].
    pub fn layers(&mut self, inspector: &Inspector) -> Result<Result<Vec<Layer>, TooMany>, Error> {
        let mut layers = Vec::new();
        for plane in self.planes.clone() {
            if plane.aov != Aov::Bounce {
                layers.push(self.layer(inspector, plane)?);
                continue;
            }
            let most = self.most_bounces(inspector)?;
            if most > MAX_BOUNCES {
                return Ok(Err(TooMany::Bounces(most)));
            }
            for number in 1..=most {
                layers.push(self.layer(inspector, Plane { number: Some(number), ..plane })?);
            }
        }
        Ok(Ok(layers))
    }

    /// Mirrored and refracted rays of a pixel at the most.
    fn most_bounces(&mut self, inspector: &Inspector) -> Result<usize, Error> {
        let Some(rays) = &mut self.rays else { return Ok(0) };
        let mut most = 0;
        for (first, rows) in portions(rays.size()) {
            let (counts, Rendered { unsure, cut, .. }) = rays.counts(first, rows)?;
            let of_device = counts.into_iter().map(|[_, others]| others as usize).max().unwrap_or(0);
            let decided = unsure.into_iter().chain(cut).flat_map(|[x, y]| inspector.brief(x, y, false).samples);
            most = decided.map(|sample| sample.rays.len() - 1).fold(most.max(of_device), usize::max);
        }
        Ok(most)
    }

    fn layer(&mut self, inspector: &Inspector, plane: Plane) -> Result<Layer, Error> {
        let (width, height) = inspector.reference().size();
        let mut layer = plane.layer((width, height));
        let channels = layer.channels();
        for (first, rows) in portions((width, height)) {
            let (values, Rendered { unsure, cut, .. }) = self.numbers(plane, first, rows * width)?;
            layer.values.extend(values.into_iter().map(|x| x as f32));
            for [x, y] in unsure.into_iter().chain(cut) {
                let mut decided = Vec::new();
                plane.push(&inspector.brief(x, y, false), self.quantize, None, &mut decided);
                let at = (y as usize * width as usize + x as usize) * channels;
                layer.values[at..at + channels].copy_from_slice(&decided);
            }
        }
        Ok(layer)
    }

    /// What the kernels say of so many pixels from row `first` on.
    fn numbers(&mut self, plane: Plane, first: u32, pixels: u32) -> Result<(Vec<f64>, Rendered), Error> {
        let Self { colors, terms, bounces, rays, tests, samples, .. } = self;
        let renderer = match plane.aov {
            Aov::Color => colors,
            Aov::Bounce => bounces,
            Aov::Rays => rays,
            Aov::Tests => tests,
            _ => terms,
        };
        let renderer = renderer.as_mut().expect("there is one for each plane");
        let number = plane.number.unwrap_or(0) as u32;
        let term = match plane.aov {
            Aov::Rays | Aov::Tests => {
                // Beside those from the eye.
                let primary = if plane.aov == Aov::Rays { u64::from(*samples) } else { 0 };
                let (counts, rendered) = renderer.counts(first, pixels / renderer.size().0)?;
                let sum = |[shadow, other]: [u64; 2]| (primary + shadow + other) as f64;
                return Ok((counts.into_iter().map(sum).collect(), rendered));
            }
            Aov::T | Aov::Sphere | Aov::Inside => Some(Term::Hit),
            Aov::Position => Some(Term::Position),
            Aov::Normal => Some(Term::Normal),
            Aov::Background => Some(Term::Background),
            Aov::Ambient => Some(Term::Ambient),
            Aov::NDotL | Aov::Shadow => Some(Term::Incidence(number)),
            Aov::Diffuse => Some(Term::Diffuse(number)),
            Aov::Specular => Some(Term::Specular(number)),
            _ => None,
        };
        let mut values = vec![Linear::default(); pixels as usize];
        let rendered = match term {
            Some(term) => renderer.terms(term, first, &mut values)?,
            None if plane.aov == Aov::Bounce => renderer.ray(number, first, &mut values)?,
            None => renderer.linear_rows(first, &mut vec![0; 3 * values.len()], &mut values)?,
        };
        Ok((values.iter().flat_map(|value| self.of_file(plane.aov, value)).collect(), rendered))
    }

    /// The numbers of a layer, from what its kernel says of a pixel.
    fn of_file(&self, aov: Aov, Linear { color, coverage }: &Linear) -> Vec<f64> {
        let is_hit = *coverage > 0.0;
        match aov {
            Aov::T => vec![if is_hit { color.x * self.stretch } else { f64::INFINITY }],
            Aov::Sphere => vec![if is_hit { color.y } else { -1.0 }],
            Aov::Inside => vec![color.z],
            Aov::NDotL => vec![color.x],
            Aov::Shadow => vec![color.y],
            Aov::Position if is_hit => (self.eye + *color / self.factor).to_array().to_vec(),
            _ => color.to_array().to_vec(),
        }
    }
}

/// The first row and the number of rows of each portion that is asked for at once.
fn portions((width, height): (u32, u32)) -> impl Iterator<Item = (u32, u32)> {
    let rows = (PIXELS_AT_ONCE / width as usize).clamp(1, height as usize) as u32;
    (0..height).step_by(rows as usize).map(move |first| (first, rows.min(height - first)))
}
