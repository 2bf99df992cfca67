//! Layers from a device: what the very shaders that render calculate on the way to a pixel.

use glam::DVec3;

use super::Aov;
use super::layers::{Layer, Plane, planes};
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
    /// Of [`Aov::Color`], by the picture's kernel.
    colors: GpuRenderer<'a>,
    /// Of what primary rays hit.
    terms: GpuRenderer<'a>,
    lights: usize,
    has_samples: bool,
    quantize: Quantize,
    /// From the kernels' units to those of the file.
    eye: DVec3,
    factor: f64,
    stretch: f64,
}

impl<'a> DeviceLayers<'a> {
    /// Of `viewed` with `effects` by the kernel of `tier`.
    ///
    /// # Errors
    ///
    /// Whatever keeps the device from rendering it.
    pub fn new(gpu: &'a Gpu, tier: Tier, viewed: &ViewedScene, effects: &Effects) -> Result<Self, Error> {
        let linear = Options { linear: true, ..Options::default() };
        let terms = Options { terms: true, ..linear };
        // No ray goes on from what it hits.
        let set = effects.set.with(Effect::Reflections, false).with(Effect::Refraction, false);
        let of_hit = Effects { set, depth: 0, ..effects.clone() };
        let settings = viewed.settings();
        Ok(Self {
            name: format!("{} at {tier}", gpu.device.info),
            colors: GpuRenderer::with(gpu, viewed, effects, tier, &linear)?,
            terms: GpuRenderer::with(gpu, viewed, &of_hit, tier, &terms)?,
            lights: viewed.scene().lights.len(),
            has_samples: settings.pattern.count() > 1,
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

    /// Whether a kernel tells it; of several samples it tells means alone.
    pub fn tells(&self, aov: Aov) -> bool {
        aov.is_of_kernels() && (aov.is_mean() || !self.has_samples)
    }

    /// Those of the layers that it tells, in the order of [`Aov`]. The reference calculates the pixels of which rounding could decide
    /// what they show, as it does in the picture.
    ///
    /// # Errors
    ///
    /// Whatever keeps the device from rendering them.
    pub fn layers(&mut self, inspector: &Inspector, wanted: &[Aov]) -> Result<Vec<Layer>, Error> {
        let told: Vec<Aov> = wanted.iter().copied().filter(|&aov| self.tells(aov)).collect();
        planes(&told, self.lights).into_iter().map(|plane| self.layer(inspector, plane)).collect()
    }

    fn layer(&mut self, inspector: &Inspector, plane: Plane) -> Result<Layer, Error> {
        let (width, height) = self.colors.size();
        let rows = (PIXELS_AT_ONCE / width as usize).clamp(1, height as usize) as u32;
        let mut layer = plane.layer((width, height));
        let channels = layer.channels();
        for first in (0..height).step_by(rows as usize) {
            let mut values = vec![Linear::default(); width as usize * rows.min(height - first) as usize];
            let Rendered { unsure, cut, .. } = self.numbers(plane, first, &mut values)?;
            layer.values.extend(values.iter().flat_map(|value| self.of_file(plane.aov, value)).map(|x| x as f32));
            for [x, y] in unsure.into_iter().chain(cut) {
                let mut decided = Vec::new();
                plane.push(&inspector.brief(x, y, false), self.quantize, None, &mut decided);
                let at = (y as usize * width as usize + x as usize) * channels;
                layer.values[at..at + channels].copy_from_slice(&decided);
            }
        }
        Ok(layer)
    }

    /// What the kernels say of rows `first` on.
    fn numbers(&mut self, plane: Plane, first: u32, values: &mut [Linear]) -> Result<Rendered, Error> {
        let light = plane.light.unwrap_or(0) as u32;
        let term = match plane.aov {
            Aov::T | Aov::Sphere | Aov::Inside => Term::Hit,
            Aov::Position => Term::Position,
            Aov::Normal => Term::Normal,
            Aov::Background => Term::Background,
            Aov::Ambient => Term::Ambient,
            Aov::NDotL | Aov::Shadow => Term::Incidence(light),
            Aov::Diffuse => Term::Diffuse(light),
            Aov::Specular => Term::Specular(light),
            _ => return self.colors.linear_rows(first, &mut vec![0; 3 * values.len()], values),
        };
        self.terms.terms(term, first, values)
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
