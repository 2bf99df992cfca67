//! From the records of all pixels to layers.

use std::fmt;

use rayon::prelude::*;

use super::Aov;
use crate::cpu::{Decision, Inspector, PixelRecord, RayRecord};
use crate::settings::Quantize;

/// Pixels of a picture at the most, since all layers are kept.
pub const MAX_PIXELS: u64 = 1 << 25;
/// Layers of [`Aov::Bounce`] at the most.
pub const MAX_BOUNCES: usize = 64;

/// Numbers of all pixels.
#[derive(Debug, Clone, PartialEq)]
pub struct Layer {
    /// What they are.
    pub aov: Aov,
    /// `normal`; where there are several `diffuse-0`, with the index of the light, or `bounce-1`, with that of the ray.
    pub name: String,
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Pixels in reading order, each with one number or three.
    pub values: Vec<f32>,
}

impl Layer {
    /// Numbers of a pixel.
    pub fn channels(&self) -> usize {
        self.aov.channels().len()
    }

    /// The names of its channels: `t`, or `normal.X` and so on; of [`Aov::Color`] `R`, `G` and `B`.
    pub fn channel_names(&self) -> Vec<String> {
        let name = |channel: &&str| match (self.aov, *channel) {
            (Aov::Color, channel) => channel.to_owned(),
            (_, "") => self.name.clone(),
            (_, channel) => format!("{}.{channel}", self.name),
        };
        self.aov.channels().iter().map(name).collect()
    }
}

/// Why there are no layers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TooMany {
    /// More than [`MAX_PIXELS`].
    Pixels,
    /// A pixel has so many reflected and refracted rays, more than [`MAX_BOUNCES`].
    Bounces(usize),
}

impl fmt::Display for TooMany {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Pixels => write!(f, "--aov keeps whole pictures, of {MAX_PIXELS} pixels at the most"),
            Self::Bounces(rays) => write!(
                f,
                "--aov bounce: a pixel has {rays} reflected and refracted rays, and {MAX_BOUNCES} layers are the most\n  help: \
                 --max-depth makes them fewer"
            ),
        }
    }
}

/// A layer, or all bounces, before there are values.
#[derive(Debug, Clone, Copy)]
pub(super) struct Plane {
    pub(super) aov: Aov,
    /// The index of its light or the number of its ray, from 1 on, where there is a layer for each.
    pub(super) number: Option<usize>,
}

/// The planes of these kinds, in the order of [`Aov`].
pub(super) fn planes(wanted: &[Aov], lights: usize) -> Vec<Plane> {
    let mut sorted = wanted.to_vec();
    sorted.sort_unstable();
    sorted.dedup();
    let of_lights =
        |aov: Aov| -> Vec<Option<usize>> { if aov.per_light() { (0..lights).map(Some).collect() } else { vec![None] } };
    sorted.iter().flat_map(|&aov| of_lights(aov).into_iter().map(move |number| Plane { aov, number })).collect()
}

/// The names of the layers of these kinds; of bounces, whose number the picture tells, of as many as there may be.
pub fn names(wanted: &[Aov], lights: usize) -> Vec<String> {
    let numbered = |plane: Plane| match plane.aov {
        Aov::Bounce => (1..=MAX_BOUNCES).map(|number| Plane { number: Some(number), ..plane }).collect(),
        _ => vec![plane],
    };
    planes(wanted, lights).into_iter().flat_map(numbered).map(Plane::name).collect()
}

/// One row of pixels.
struct Row {
    /// Of each plane the values of all pixels.
    planes: Vec<Vec<f32>>,
    /// Of each pixel what its reflected and refracted rays add.
    bounces: Vec<Vec<[f64; 3]>>,
}

/// The layers of a picture with so many lights, in the order of [`Aov`]; `picture` is the device's, for [`Aov::Error`].
///
/// Of several samples a pixel has the mean of colours, the sum of rays and tests, the least margin, and of all else the first
/// sample's.
///
/// # Errors
///
/// [`TooMany`] pixels or bounces.
pub fn layers(
    inspector: &Inspector,
    lights: usize,
    quantize: Quantize,
    wanted: &[Aov],
    picture: Option<&[u8]>,
) -> Result<Vec<Layer>, TooMany> {
    let (width, height) = inspector.reference().size();
    if u64::from(width) * u64::from(height) > MAX_PIXELS {
        return Err(TooMany::Pixels);
    }
    if wanted.is_empty() {
        return Ok(Vec::new());
    }
    let planes = planes(wanted, lights);
    let margins = wanted.contains(&Aov::Margin);
    let row = |y: u32| {
        let mut row = Row { planes: vec![Vec::new(); planes.len()], bounces: Vec::new() };
        for x in 0..width {
            let record = inspector.brief(x, y, margins);
            let shown = picture.map(|rgb| pixel_of(rgb, y as usize * width as usize + x as usize));
            for (plane, values) in planes.iter().zip(&mut row.planes) {
                match plane.aov {
                    Aov::Bounce => row.bounces.push(bounces(&record)),
                    _ => plane.push(&record, quantize, shown, values),
                }
            }
        }
        row
    };
    let rows: Vec<Row> = (0..height).into_par_iter().map(row).collect();
    let most = rows.iter().flat_map(|row| &row.bounces).map(Vec::len).max().unwrap_or(0);
    if most > MAX_BOUNCES {
        return Err(TooMany::Bounces(most));
    }
    let mut layers = Vec::new();
    for (index, plane) in planes.iter().enumerate() {
        if plane.aov == Aov::Bounce {
            layers.extend((0..most).map(|bounce| {
                let of = |rays: &Vec<[f64; 3]>| rays.get(bounce).copied().unwrap_or_default().map(|x| x as f32);
                let values = rows.iter().flat_map(|row| &row.bounces).flat_map(of).collect();
                Layer { values, ..Plane { number: Some(bounce + 1), ..*plane }.layer((width, height)) }
            }));
            continue;
        }
        let values = rows.iter().flat_map(|row| &row.planes[index]).copied().collect();
        layers.push(Layer { values, ..plane.layer((width, height)) });
    }
    Ok(layers)
}

fn pixel_of(rgb: &[u8], index: usize) -> [u8; 3] {
    rgb.as_chunks::<3>().0[index]
}

impl Plane {
    fn name(self) -> String {
        self.number.map_or_else(|| self.aov.name(), |number| format!("{}-{number}", self.aov))
    }

    /// The layer before there are values.
    pub(super) fn layer(self, (width, height): (u32, u32)) -> Layer {
        Layer { aov: self.aov, name: self.name(), width, height, values: Vec::new() }
    }

    /// Appends a pixel's values; `shown` is what the device shows.
    pub(super) fn push(self, record: &PixelRecord, quantize: Quantize, shown: Option<[u8; 3]>, values: &mut Vec<f32>) {
        let first = record.samples.first().and_then(|sample| sample.rays.first());
        let hit = first.and_then(|ray| ray.hit.as_ref());
        let light = self.number.and_then(|light| hit.and_then(|hit| hit.lights.get(light)));
        let rays = || record.samples.iter().flat_map(|sample| &sample.rays);
        let shadows = || rays().flat_map(|ray| &ray.hit).flat_map(|hit| &hit.lights).flat_map(|light| &light.shadow);
        let of_lights = |term: fn(&crate::cpu::LightRecord) -> [f64; 3]| {
            mean(record, |ray| {
                let light = ray.hit.as_ref().and_then(|hit| hit.lights.get(self.number?));
                light.map_or([0.0; 3], term)
            })
        };
        let triple = match self.aov {
            Aov::Color => record.color,
            Aov::Position => hit.map_or([0.0; 3], |hit| hit.position),
            Aov::Normal => hit.map_or([0.0; 3], |hit| hit.normal),
            Aov::Background => mean(record, |ray| ray.background.unwrap_or_default()),
            Aov::Ambient => mean(record, |ray| ray.hit.as_ref().map_or([0.0; 3], |hit| hit.ambient)),
            Aov::Diffuse => of_lights(|light| light.diffuse),
            Aov::Specular => of_lights(|light| light.specular),
            Aov::Bounce => {
                let number = self.number.and_then(|number| number.checked_sub(1));
                number.and_then(|at| bounces(record).get(at).copied()).unwrap_or_default()
            }
            Aov::Error => shown
                .map_or([0.0; 3], |shown| std::array::from_fn(|c| f64::from(shown[c]) - f64::from(record.levels[c]))),
            Aov::T
            | Aov::Sphere
            | Aov::Inside
            | Aov::NDotL
            | Aov::Shadow
            | Aov::Rays
            | Aov::Tests
            | Aov::Margin
            | Aov::Step => {
                values.push(match self.aov {
                    Aov::T => hit.map_or(f64::INFINITY, |hit| hit.t),
                    Aov::Sphere => hit.map_or(-1.0, |hit| hit.sphere as f64),
                    Aov::Inside => f64::from(u8::from(hit.is_some_and(|hit| hit.inside))),
                    Aov::NDotL => light.map_or(0.0, |light| light.n_dot_l),
                    Aov::Shadow => {
                        let shadow = light.and_then(|light| light.shadow.as_ref());
                        f64::from(u8::from(shadow.is_some_and(|shadow| shadow.blocked)))
                    }
                    Aov::Rays => (rays().count() + shadows().count()) as f64,
                    Aov::Tests => {
                        let tests = rays().map(|ray| ray.test_count).chain(shadows().map(|shadow| shadow.test_count));
                        tests.sum::<u64>() as f64
                    }
                    Aov::Margin => nearest(record, |decision| decision != Decision::QuantisationStep),
                    _ => quantize.scale() * nearest(record, |decision| decision == Decision::QuantisationStep),
                } as f32);
                return;
            }
        };
        values.extend(triple.map(|x| x as f32));
    }
}

/// The least margin of these decisions; infinite where there is none.
fn nearest(record: &PixelRecord, of: impl Fn(Decision) -> bool) -> f64 {
    let margins = record.decisions.iter().filter(|margin| of(margin.decision)).map(|margin| margin.margin);
    margins.fold(f64::INFINITY, f64::min)
}

/// The mean of a colour of each sample's ray from the eye.
fn mean(record: &PixelRecord, of: impl Fn(&RayRecord) -> [f64; 3]) -> [f64; 3] {
    let colors = record.samples.iter().filter_map(|sample| sample.rays.first()).map(of);
    averaged(colors, record.samples.len())
}

fn averaged(colors: impl Iterator<Item = [f64; 3]>, count: usize) -> [f64; 3] {
    let sum = colors.fold([0.0; 3], |sum: [f64; 3], color| std::array::from_fn(|c| sum[c] + color[c]));
    sum.map(|x| x / count as f64)
}

/// What each reflected or refracted ray adds, in the order in which the tracer follows them.
fn bounces(record: &PixelRecord) -> Vec<[f64; 3]> {
    let most = record.samples.iter().map(|sample| sample.rays.len()).max().unwrap_or(0);
    let of = |index: usize| {
        let rays = record.samples.iter().filter_map(|sample| sample.rays.get(index));
        averaged(rays.map(|ray| ray.contribution), record.samples.len())
    };
    (1..most).map(of).collect()
}
