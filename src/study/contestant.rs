//! What is measured: every kernel and the CPU reference, run and timed alike.

use std::time::Instant;

use serde::{Serialize, Serializer};

use crate::cpu::{Judge, Reference};
use crate::effects::Effects;
use crate::engine::{Backend, Engine, Options};
use crate::gpu::{self, Gpu};
use crate::precision::{Request, Selection, Tier};
use crate::viewed::ViewedScene;

/// Something that renders the scene and is measured. Nothing but this file knows the list: a kernel that only the study
/// runs becomes another variant.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Contestant {
    /// The device with the kernel of a tier.
    Device(Tier),
    /// The device, and whatever it takes beside it so that each pixel is what the reference has.
    Certified,
    /// The CPU reference's formulas in `f32`.
    CpuSingle,
    /// The CPU reference.
    CpuDouble,
}

impl Contestant {
    /// All of them, in the order of the tables.
    pub const ALL: [Self; 6] = [
        Self::Device(Tier::Fast),
        Self::Device(Tier::Robust),
        Self::Device(Tier::Double),
        Self::Certified,
        Self::CpuSingle,
        Self::CpuDouble,
    ];

    /// The name in tables and plots.
    pub fn name(self) -> &'static str {
        match self {
            Self::Device(tier) => tier.name(),
            Self::Certified => "certified",
            Self::CpuSingle => "CPU f32",
            Self::CpuDouble => "CPU f64",
        }
    }

    /// Why it cannot run on `gpu`, where it cannot.
    pub(super) fn obstacle(self, gpu: Option<&Gpu>) -> Option<String> {
        match (self, gpu) {
            (Self::Device(_) | Self::Certified, None) => Some("no Vulkan device is used".into()),
            _ => None,
        }
    }

    /// Judges its pictures.
    pub(super) fn judge(self, gpu: Option<&Gpu>) -> Judge {
        match (self, gpu) {
            (Self::Device(tier), Some(gpu)) => Backend::Device(gpu, tier).judge(),
            (Self::Device(tier), None) => Judge::of(tier),
            (Self::CpuSingle, _) => Judge::of(Tier::Fast),
            (Self::Certified | Self::CpuDouble, _) => Backend::Reference.judge(),
        }
    }
}

impl Serialize for Contestant {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}

/// A contestant with a scene, ready to render it again and again.
#[derive(Debug)]
pub(super) struct Runner<'a> {
    renderer: Renderer<'a>,
    /// The last picture, 3 bytes a pixel.
    pub(super) rgb: Vec<u8>,
}

#[derive(Debug)]
enum Renderer<'a> {
    Engine(Box<Engine<'a>>),
    Single(Box<Reference<f32>>),
}

/// One run.
#[derive(Debug, Clone, Copy)]
pub(super) struct Run {
    /// From the prepared scene to rows in memory by the wall clock, in ms; without compiling.
    pub(super) wall_ms: f64,
    /// The dispatches by the device's own clock, in ms; `None` where there is none.
    pub(super) device_ms: Option<f64>,
    /// Pixels that are not finite.
    pub(super) not_finite: u64,
}

impl<'a> Runner<'a> {
    pub(super) fn new(
        contestant: Contestant,
        gpu: Option<&'a Gpu>,
        viewed: ViewedScene,
        effects: &Effects,
    ) -> Result<Self, gpu::Error> {
        let (width, height) = (viewed.scene().width, viewed.scene().height);
        let renderer = match (contestant, gpu) {
            (Contestant::CpuSingle, _) => Renderer::Single(Box::new(Reference::new(&viewed, effects))),
            (Contestant::Device(tier), Some(gpu)) => {
                let options = Options { device_clock: true, ..Options::default() };
                let backend = Backend::Device(gpu, tier);
                Renderer::Engine(Box::new(Engine::with(backend, viewed, effects, &options)?))
            }
            (Contestant::Certified, Some(gpu)) => {
                let selection = Selection::of(&viewed, effects, Request::Certified, gpu.ladder());
                Renderer::Engine(Box::new(Engine::new(Backend::of(Some(gpu), &selection), viewed, effects)?))
            }
            _ => Renderer::Engine(Box::new(Engine::new(Backend::Reference, viewed, effects)?)),
        };
        Ok(Self { renderer, rgb: vec![0; width as usize * height as usize * 3] })
    }

    /// Renders the whole picture once.
    pub(super) fn run(&mut self) -> Result<Run, gpu::Error> {
        let start = Instant::now();
        match &mut self.renderer {
            Renderer::Single(reference) => {
                let not_finite = reference.rows(0, &mut self.rgb)?.not_finite;
                Ok(Run { wall_ms: start.elapsed().as_secs_f64() * 1e3, device_ms: None, not_finite })
            }
            Renderer::Engine(engine) => {
                let before = (engine.times().compile_ms, engine.on_device_ms());
                let not_finite = engine.rows(0, &mut self.rgb)?;
                let wall_ms = start.elapsed().as_secs_f64() * 1e3 - (engine.times().compile_ms - before.0);
                let device_ms = engine.on_device_ms().zip(before.1).map(|(after, before)| after - before);
                Ok(Run { wall_ms, device_ms, not_finite })
            }
        }
    }
}
