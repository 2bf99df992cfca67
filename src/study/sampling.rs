//! What sampling a part of the pixels saves, and what it costs: error against time, inside and outside the fovea.

use std::time::Instant;

use serde::Serialize;

use super::distance::Distance;
use super::measure::{StudyInput, StudyPlan};
use crate::engine::{Backend, Engine, Filler, Options, Pixels, render_picture};
use crate::gpu::Error;
use crate::report::Timings;
use crate::sampling::{Density, Fill, Fovea, Samples};

/// Densities of the sparse pictures, and the least ones of the foveated pictures.
const PARTS: [f64; 4] = [0.5, 0.25, 1.0 / 16.0, 1.0 / 64.0];
/// Radius and falloff of the fovea, in parts of the picture's shorter side: the defaults of the command line.
pub(crate) const FOVEA: [f64; 2] = [0.15, 0.15];

/// What has fewer samples than the full picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Manner {
    /// Nothing: all pixels are sampled.
    Full,
    /// All of the picture.
    Sparse,
    /// What lies away from its middle.
    Foveated,
}

impl Manner {
    /// The name in tables and plots.
    pub fn name(self) -> &'static str {
        match self {
            Self::Full => "full",
            Self::Sparse => "sparse",
            Self::Foveated => "foveated",
        }
    }
}

/// One way to sample a picture and to fill the rest.
#[derive(Debug, Clone, Serialize)]
pub struct PartialPoint {
    /// Where the samples are.
    pub manner: Manner,
    /// The least part of the pixels that is sampled anywhere.
    pub least: f64,
    /// How the others are filled.
    pub fill: Fill,
    /// Sampled pixels.
    pub pixels: u64,
    /// Times by the wall clock: rays and filling.
    pub wall: Timings,
    /// Times of the rays alone.
    pub rays: Timings,
    /// Distance from the full picture of the same renderer.
    pub error: Distance,
    /// The same of the pixels within the fovea.
    pub inside: Distance,
    /// The same of all others.
    pub outside: Distance,
}

/// Pictures of which a part was sampled, measured in turn.
#[derive(Debug, Clone, Serialize)]
pub struct PartialSeries {
    /// Counted runs of each point.
    pub runs: usize,
    /// Where all pixels are sampled of a foveated picture, in pixels.
    pub fovea: Fovea,
    /// The points, the full picture first; none where it is too large.
    pub points: Vec<PartialPoint>,
}

impl PartialSeries {
    /// Nothing measured of pictures of this size.
    pub(super) fn none(size: (u32, u32)) -> Self {
        let unit = f64::from(size.0.min(size.1));
        let center = [f64::from(size.0) / 2.0, f64::from(size.1) / 2.0];
        let fovea = Fovea { center, radius: FOVEA[0] * unit, falloff: FOVEA[1] * unit };
        Self { runs: 0, fovea, points: Vec::new() }
    }
}

/// A renderer of a point.
struct Runner<'a> {
    engine: Engine<'a, Pixels>,
    samples: Samples,
    colors: Vec<[u8; 3]>,
}

impl Runner<'_> {
    /// Renders and fills once; the picture, and the times of the rays and of all, in ms.
    fn run(&mut self, filler: &mut Filler, fill: Fill) -> Result<(Vec<u8>, [f64; 2]), Error> {
        let start = Instant::now();
        let compile = self.engine.times().compile_ms;
        self.engine.pixels(self.samples.pixels(), &mut self.colors)?;
        let rays = start.elapsed().as_secs_f64() * 1e3 - (self.engine.times().compile_ms - compile);
        let filling = Instant::now();
        let rgb = filler.filled(&self.samples, &self.colors, fill)?;
        Ok((rgb, [rays, rays + filling.elapsed().as_secs_f64() * 1e3]))
    }
}

/// Measures the full picture, sparse ones and foveated ones.
pub(super) fn partial_series(input: &StudyInput, plan: &StudyPlan) -> Result<PartialSeries, Error> {
    let StudyInput { scene, settings, gpu, selection, .. } = *input;
    let backend = Backend::of(gpu, selection);
    let viewed = scene.viewed(settings);
    let effects = (input.effects)(&viewed);
    let size = (scene.width, scene.height);
    let mut series = PartialSeries::none(size);
    let fovea = series.fovea;
    if Samples::obstacle(size).is_some() {
        return Ok(series);
    }

    let mut full = Engine::new(backend, viewed, &effects)?;
    let (truth, _) = render_picture(&mut full)?;
    let mut filler = Filler::fastest(backend)?;
    let foveated = |far| Density { fovea: Some(fovea), far };
    let mut runners = Vec::new();
    let mut round_ms = 0.0;
    for (manner, least) in [Manner::Sparse, Manner::Foveated].into_iter().flat_map(|m| PARTS.map(|least| (m, least))) {
        let density = if manner == Manner::Sparse { Density::sparse(least) } else { foveated(least) };
        let samples = Samples::new(size, &density)?;
        for fill in Fill::ALL {
            let engine = Engine::with(backend, scene.viewed(settings), &effects, &Options::default())?;
            let mut runner = Runner { engine, samples: samples.clone(), colors: vec![[0; 3]; samples.pixels().len()] };
            // The first run compiles.
            runner.run(&mut filler, fill)?;
            let (rgb, [_, all_ms]) = runner.run(&mut filler, fill)?;
            round_ms += all_ms;
            let point = point((manner, least, fill), &runner.samples, size, foveated(0.0), [&rgb, &truth]);
            runners.push((runner, point));
        }
    }
    let pixels = u64::from(size.0) * u64::from(size.1);
    let same = Distance::between(&truth, &truth);
    let mut full_point = PartialPoint {
        manner: Manner::Full,
        least: 1.0,
        fill: Fill::Nearest,
        pixels,
        wall: Timings::default(),
        rays: Timings::default(),
        error: same,
        inside: same,
        outside: same,
    };
    series.runs = plan.affordable(round_ms);
    let mut rgb = vec![0; truth.len()];
    for _ in 0..series.runs {
        let start = Instant::now();
        full.rows(0, &mut rgb)?;
        let ms = start.elapsed().as_secs_f64() * 1e3;
        full_point.wall.push(ms);
        full_point.rays.push(ms);
        for (runner, point) in &mut runners {
            let (_, [rays, all]) = runner.run(&mut filler, point.fill)?;
            point.rays.push(rays);
            point.wall.push(all);
        }
    }
    series.points.push(full_point);
    series.points.extend(runners.into_iter().map(|(_, point)| point));
    Ok(series)
}

/// A point without times, from its picture and the true one.
fn point(
    (manner, least, fill): (Manner, f64, Fill),
    samples: &Samples,
    (width, _): (u32, u32),
    fovea: Density,
    [rgb, truth]: [&[u8]; 2],
) -> PartialPoint {
    let part = |inside: bool| {
        let taken = |(index, _): &(usize, &[u8; 3])| {
            let index = *index as u32;
            fovea.is_inside(index % width, index / width) == inside
        };
        let of = |rgb: &[u8]| -> Vec<u8> {
            rgb.as_chunks::<3>().0.iter().enumerate().filter(taken).flat_map(|(_, color)| *color).collect()
        };
        Distance::between(&of(rgb), &of(truth))
    };
    PartialPoint {
        manner,
        least,
        fill,
        pixels: samples.pixels().len() as u64,
        wall: Timings::default(),
        rays: Timings::default(),
        error: Distance::between(rgb, truth),
        inside: part(true),
        outside: part(false),
    }
}
