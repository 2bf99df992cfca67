//! An open device: its queue, what it reports, and how long it may take.

use std::sync::{Arc, Mutex, OnceLock};
use std::time::Duration;

use super::calls::{self, Call};
use super::choose::{Choice, chosen};
use super::error::Error;
use super::guard::guarded;
use super::info::{DeviceInfo, DeviceKind};
use super::mask::{Mask, Offer};
use crate::gpu::shared::{LEAST_BUFFERS, LEAST_UNIFORM, TILE_PIXELS};
use crate::threads::lock;

/// An open device.
#[derive(Debug)]
pub struct Device {
    /// What it is.
    pub info: DeviceInfo,
    pub(crate) raw: wgpu::Device,
    pub(crate) queue: wgpu::Queue,
    /// Whether host and device share memory, so that a storage buffer can be mapped.
    pub(crate) mappable: bool,
    /// Whether it takes SPIR-V, which alone says how to round.
    pub(crate) takes_spirv: bool,
    /// So many units in the last place its quotients and square roots are made too small.
    pub(crate) units_off: u32,
    /// Of which numbers they are known not to be rounded correctly.
    pub(crate) inexact: Inexact,
    failure: Arc<Mutex<Option<Failure>>>,
    /// Why nothing can be asked of it any more.
    end: OnceLock<String>,
}

/// Of which numbers quotients and square roots are not rounded correctly, as far as that is known.
#[derive(Debug, Default)]
pub(crate) struct Inexact {
    single: OnceLock<bool>,
    double: OnceLock<bool>,
}

impl Inexact {
    /// Whether those of numbers of so many bits are known to be.
    pub(crate) fn has(&self, bits: u32) -> bool {
        self.known(bits == 64).get() == Some(&true)
    }

    /// Whether those of any are.
    pub(crate) fn is_any(&self) -> bool {
        [false, true].map(|is_double| self.known(is_double).get()).contains(&Some(&true))
    }

    /// What is known of `f64`, or else of `f32`.
    pub(crate) fn known(&self, is_double: bool) -> &OnceLock<bool> {
        if is_double { &self.double } else { &self.single }
    }
}

/// What a device has reported.
#[derive(Debug)]
enum Failure {
    /// What is asked for exceeds one of its limits.
    Limit(String),
    /// Anything else.
    Broken(String),
}

impl Failure {
    fn new(error: &wgpu::Error) -> Self {
        let text = error.to_string();
        match error {
            // The last line names the limit, those before in which call of which object.
            wgpu::Error::Validation { .. } if text.contains(" limit") => {
                Self::Limit(text.lines().last().unwrap_or_default().trim().to_owned())
            }
            _ => Self::Broken(text),
        }
    }
}

impl Device {
    /// Opens the chosen device; [`Choice::Auto`] and [`Choice::Cpu`] mean the best one here.
    ///
    /// `WGPU_ADAPTER_NAME` and `WGPU_POWER_PREF` decide where the choice leaves it open.
    pub fn open(choice: &Choice) -> Result<Self, Error> {
        Self::masked(choice, &Mask::default())
    }

    /// The same, taken to offer less than it does or to calculate worse.
    pub fn masked(choice: &Choice, mask: &Mask) -> Result<Self, Error> {
        let (info, adapter) = chosen(choice)?;
        let offer = Offer::of(&adapter).masked(mask);
        let info = DeviceInfo::new(info.index, adapter.get_info(), info.vulkan, &offer);
        let opened = info.clone();
        let _call = Call::begin();
        guarded(|| Self::open_adapter(opened, &adapter, offer, mask.units_off))
            .unwrap_or_else(|why| Err(does_not_open(&info, &why)))
    }

    fn open_adapter(info: DeviceInfo, adapter: &wgpu::Adapter, offer: Offer, units_off: u32) -> Result<Self, Error> {
        let _span = tracing::info_span!("create device").entered();
        let shares_memory = matches!(info.kind, DeviceKind::Software | DeviceKind::Integrated);
        let mut features = wgpu::Features::SHADER_F64
            | wgpu::Features::SHADER_INT64
            | wgpu::Features::TIMESTAMP_QUERY
            | wgpu::Features::PASSTHROUGH_SHADERS
            | wgpu::Features::PIPELINE_CACHE;
        if shares_memory {
            features |= wgpu::Features::MAPPABLE_PRIMARY_BUFFERS;
        }
        let features = features & offer.features;
        for (limit, offered, needed) in [
            ("max_uniform_buffer_binding_size", info.max_uniform, LEAST_UNIFORM),
            ("max_compute_invocations_per_workgroup", info.max_invocations.into(), TILE_PIXELS.into()),
            ("max_storage_buffers_per_shader_stage", info.max_storage_buffers.into(), LEAST_BUFFERS.into()),
        ] {
            if offered < needed {
                return Err(Error::unsuitable(&info, format!("{limit} is {offered}, of {needed} that it needs")));
            }
        }
        let request = adapter.request_device(&wgpu::DeviceDescriptor {
            label: None,
            required_features: features,
            required_limits: offer.limits,
            memory_hints: wgpu::MemoryHints::MemoryUsage,
            ..wgpu::DeviceDescriptor::default()
        });
        let (device, queue) = pollster::block_on(request).map_err(|error| does_not_open(&info, &error.to_string()))?;

        let failure = Arc::new(Mutex::new(None));
        let slot = Arc::clone(&failure);
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| note(&slot, Failure::new(&error))));
        let slot = Arc::clone(&failure);
        device.set_device_lost_callback(move |_, message| note(&slot, Failure::Broken(message)));
        let mappable = features.contains(wgpu::Features::MAPPABLE_PRIMARY_BUFFERS);
        let takes_spirv = features.contains(wgpu::Features::PASSTHROUGH_SHADERS);
        Ok(Self {
            info,
            raw: device,
            queue,
            mappable,
            takes_spirv,
            units_off,
            inexact: Inexact::default(),
            failure,
            end: OnceLock::new(),
        })
    }

    /// Gives the device up: whatever is still asked of it fails as lost.
    pub fn destroy(&self) {
        self.raw.destroy();
    }

    /// Runs `action` and turns what the device reported meanwhile into an error.
    pub(crate) fn checked<T>(&self, what: &str, action: impl FnOnce() -> T) -> Result<T, Error> {
        let call = Call::begin();
        let value = action();
        drop(call);
        match lock(&self.failure).take() {
            None => Ok(value),
            Some(Failure::Limit(why)) => Err(Error::too_large(&self.info, what, why)),
            Some(Failure::Broken(why)) => Err(Error::Lost(format!("{what} on {}: {why}", self.info))),
        }
    }

    /// Runs `action` unless the device has come to its end; where a library on the way to the driver panics, it has.
    pub(crate) fn guarded<T>(&self, action: impl FnOnce() -> Result<T, Error>) -> Result<T, Error> {
        match self.end.get() {
            Some(why) => Err(Error::Lost(why.clone())),
            None => guarded(action).unwrap_or_else(|said| Err(self.ends(format!("{}: {said}", self.info)))),
        }
    }

    fn ends(&self, why: String) -> Error {
        // Closing it would wait for what it still does, or panic once more.
        std::mem::forget((self.raw.clone(), self.queue.clone()));
        Error::Lost(self.end.get_or_init(|| why).clone())
    }

    /// Waits until everything submitted is done.
    pub(crate) fn wait(&self) -> Result<(), Error> {
        self.wait_until(None)
    }

    /// Waits until this submission is done, or all of them.
    pub(crate) fn wait_until(&self, submission: Option<&wgpu::SubmissionIndex>) -> Result<(), Error> {
        let patience = calls::patience().as_secs();
        // Of a process that is stopped no more than one second counts.
        for _ in 0..patience {
            let wait =
                wgpu::PollType::Wait { submission_index: submission.cloned(), timeout: Some(Duration::from_secs(1)) };
            match self.checked("waiting for a dispatch", || self.raw.poll(wait))? {
                Ok(_) => return Ok(()),
                Err(wgpu::PollError::Timeout) => {}
                Err(error) => return Err(Error::Lost(format!("{} stopped answering: {error}", self.info))),
            }
        }
        let limit = calls::PATIENCE;
        let planned = "where a dispatch is to take a fraction of one";
        let why = format!("{} has not answered for {patience} s, {planned}; {limit} sets the limit", self.info);
        Err(self.ends(why))
    }

    /// Hands commands to the driver, which may wait for earlier ones.
    pub(crate) fn submit(&self, commands: Option<wgpu::CommandBuffer>) -> wgpu::SubmissionIndex {
        let _call = Call::begin();
        self.queue.submit(commands)
    }
}

fn does_not_open(info: &DeviceInfo, why: &str) -> Error {
    Error::unsuitable(info, format!("it does not open: {why}"))
}

fn note(slot: &Mutex<Option<Failure>>, failure: Failure) {
    lock(slot).get_or_insert(failure);
}
