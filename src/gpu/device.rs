//! Finding and opening a Vulkan device.

use std::borrow::Cow;
use std::fmt;
use std::str::FromStr;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use std::time::Duration;

use serde::Serialize;

use super::ahead::Ahead;
use super::calls::{self, Call};
use super::error::Error;
use super::guard::guarded;
use super::kernel_cache::KernelCache;
use super::pipeline::{Specialisation, Stages, compile};
use super::selftest::SelfTest;
use super::shader::{Kernel, Textures};
use super::spirv::Parsed;
use super::stage::MAX_TEXTURES;
use super::tuned::DeviceTuning;
use crate::misuse::Misuse;
use crate::precision::Tier;
use crate::tuning::Tuning;

/// Which device renders.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum Choice {
    /// The best Vulkan device, or the CPU reference where there is none.
    #[default]
    Auto,
    /// The CPU reference.
    Cpu,
    /// The best Vulkan device; none is an error.
    Gpu,
    /// The Vulkan device with this index in the list.
    Index(usize),
    /// The only Vulkan device whose name or driver contains this text, or whose PCI id this is.
    Name(String),
}

impl FromStr for Choice {
    type Err = std::convert::Infallible;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        Ok(match text {
            "auto" => Self::Auto,
            "cpu" => Self::Cpu,
            "gpu" => Self::Gpu,
            _ => text.parse().map_or_else(|_| Self::Name(text.into()), Self::Index),
        })
    }
}

/// One Vulkan device as a user sees it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct DeviceInfo {
    /// Place in the list; stable as long as drivers and hardware are.
    pub index: usize,
    /// The device's name.
    pub name: String,
    /// Discrete, integrated, virtual or software.
    #[serde(rename = "type")]
    pub kind: &'static str,
    /// The driver with its version.
    pub driver: String,
    /// PCI id such as `0000:01:00.0`; empty for devices without one.
    pub pci: String,
    /// Whether shaders can calculate in `f64`, and read it from textures as pairs of integers.
    pub f64: bool,
    /// Greatest size of one storage buffer binding, in bytes.
    pub max_storage_binding: u64,
    /// Greatest size of one buffer, in bytes.
    pub max_buffer: u64,
    /// Greatest number of workgroups of a dispatch in one direction.
    pub max_workgroups: u32,
    /// Greatest number of invocations of a workgroup.
    pub max_invocations: u32,
    /// Greatest number of storage textures that a kernel reads and writes.
    pub max_storage_textures: u32,
}

impl DeviceInfo {
    fn new(index: usize, adapter: &wgpu::Adapter) -> Self {
        let info = adapter.get_info();
        let limits = adapter.limits();
        Self {
            index,
            name: info.name,
            kind: match info.device_type {
                wgpu::DeviceType::DiscreteGpu => "discrete",
                wgpu::DeviceType::IntegratedGpu => "integrated",
                wgpu::DeviceType::VirtualGpu => "virtual",
                wgpu::DeviceType::Cpu => "software",
                wgpu::DeviceType::Other => "other",
            },
            driver: format!("{} {}", info.driver, info.driver_info).trim().to_owned(),
            pci: info.device_pci_bus_id,
            f64: adapter.features().contains(wgpu::Features::SHADER_F64 | wgpu::Features::SHADER_INT64),
            max_storage_binding: limits.max_storage_buffer_binding_size,
            max_buffer: limits.max_buffer_size,
            max_workgroups: limits.max_compute_workgroups_per_dimension,
            max_invocations: limits.max_compute_invocations_per_workgroup,
            max_storage_textures: limits.max_storage_textures_per_shader_stage,
        }
    }

    /// Why the device cannot do with `tuning`; `None` where it can.
    pub fn problem_with(&self, tuning: &Tuning) -> Option<String> {
        let too_large = || {
            let (wanted, most) = (tuning.workgroup, self.max_invocations);
            (wanted > most).then(|| format!("workgroup is {wanted}, and the device has at most {most}"))
        };
        tuning.problem().or_else(too_large)
    }

    fn matches(&self, text: &str) -> bool {
        let text = text.to_lowercase();
        self.pci.to_lowercase() == text || [&self.name, &self.driver].iter().any(|s| s.to_lowercase().contains(&text))
    }

    /// Better devices first: real before virtual before software; the power preference swaps the first two.
    fn rank(&self, low_power: bool) -> u8 {
        match (self.kind, low_power) {
            ("discrete", false) | ("integrated", true) => 0,
            ("integrated", false) | ("discrete", true) => 1,
            ("virtual", _) => 2,
            ("software", _) => 4,
            _ => 3,
        }
    }
}

impl fmt::Display for DeviceInfo {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} ({}, {})", self.name, self.kind, self.driver)
    }
}

/// An open device.
#[derive(Debug)]
pub struct Gpu {
    /// What it is.
    pub info: DeviceInfo,
    tuned: DeviceTuning,
    pub(super) device: wgpu::Device,
    pub(super) queue: wgpu::Queue,
    /// Whether host and device share memory, so that a storage buffer can be mapped.
    pub(super) mappable: bool,
    failure: Arc<Mutex<Option<Failure>>>,
    /// Why nothing can be asked of it any more.
    end: OnceLock<String>,
    /// Those of earlier runs.
    pub(super) kernel_cache: Option<KernelCache>,
    /// What was done before the device was open.
    pub(super) ahead: Option<Ahead>,
    /// Compiled kernels that are used again; `None` where every renderer compiles its own.
    kept: Option<Mutex<Kept>>,
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

/// Bytes of a uniform that every device must be able to bind: `Tiles` of `shaders/slots_tiles.wgsl`.
const LEAST_UNIFORM: u64 = 1 << 16;

/// Compiled kernels, those used last at the end.
type Kept = Vec<(Specialisation, Arc<Stages>)>;

/// For so many specialisations compiled kernels are kept; one more drops the one that was not used for the longest time.
const MAX_KEPT: usize = 16;

/// Software devices calculate in `f64` at little more than the price of `f32`, far below that of error-free transforms; hardware
/// has few `f64` units.
pub(super) const SOFTWARE_LADDER: [Tier; 3] = [Tier::Fast, Tier::Double, Tier::Robust];

/// All Vulkan devices, in the driver's order.
pub fn list() -> Result<Vec<DeviceInfo>, Error> {
    Ok(guarded(adapters).map_err(|why| cannot_be_asked(&why))??.1.into_iter().map(|(info, _)| info).collect())
}

fn cannot_be_asked(why: &str) -> Error {
    Error::NoDevice(format!("the Vulkan drivers cannot be asked for their devices: {why}"))
}

type Adapters = Vec<(DeviceInfo, wgpu::Adapter)>;

fn adapters() -> Result<(wgpu::Instance, Adapters), Error> {
    if let Some(backends) = wgpu::Backends::from_env()
        && !backends.contains(wgpu::Backends::VULKAN)
    {
        return Err(Error::NoDevice("WGPU_BACKEND leaves out Vulkan, the only backend of this program".into()));
    }
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor {
        backends: wgpu::Backends::VULKAN,
        flags: wgpu::InstanceFlags::empty().with_env(),
        ..wgpu::InstanceDescriptor::new_without_display_handle()
    });
    let adapters = pollster::block_on(instance.enumerate_adapters(wgpu::Backends::VULKAN));
    let adapters =
        adapters.into_iter().enumerate().map(|(i, adapter)| (DeviceInfo::new(i, &adapter), adapter)).collect();
    Ok((instance, adapters))
}

impl Gpu {
    /// Opens the chosen device; [`Choice::Auto`] and [`Choice::Cpu`] mean the best one here.
    ///
    /// `WGPU_ADAPTER_NAME` and `WGPU_POWER_PREF` decide where the choice leaves it open.
    pub fn open(choice: &Choice) -> Result<Self, Error> {
        let (_instance, adapters) = guarded(adapters).map_err(|why| cannot_be_asked(&why))??;
        let index = choose(choice, adapters.iter().map(|(info, _)| info))?;
        let (info, adapter) = adapters.into_iter().nth(index).ok_or_else(Error::none_found)?;
        let name = info.to_string();
        guarded(|| Self::open_adapter(info, &adapter))
            .unwrap_or_else(|why| Err(Error::NoDevice(format!("{name} cannot be opened: {why}"))))
    }

    fn open_adapter(info: DeviceInfo, adapter: &wgpu::Adapter) -> Result<Self, Error> {
        let shares_memory = matches!(info.kind, "software" | "integrated");
        let mut features = wgpu::Features::SHADER_F64
            | wgpu::Features::SHADER_INT64
            | wgpu::Features::TIMESTAMP_QUERY
            | wgpu::Features::PASSTHROUGH_SHADERS;
        let keeps_kernels = KernelCache::is_wanted(info.kind);
        if keeps_kernels {
            features |= wgpu::Features::PIPELINE_CACHE;
        }
        if shares_memory {
            features |= wgpu::Features::MAPPABLE_PRIMARY_BUFFERS;
        }
        let features = features & adapter.features();
        if !features.contains(wgpu::Features::PASSTHROUGH_SHADERS) {
            return Err(Error::NoDevice(format!("{info} takes no SPIR-V, which alone says how to round")));
        }
        let uniform = adapter.limits().max_uniform_buffer_binding_size;
        if uniform < LEAST_UNIFORM {
            let limit = "max_uniform_buffer_binding_size (Vulkan's maxUniformBufferRange)";
            let why = format!("{limit} is {uniform} bytes, and the kernels need {LEAST_UNIFORM}");
            return Err(Error::NoDevice(format!("{info} cannot render: {why}")));
        }
        let request = adapter.request_device(&wgpu::DeviceDescriptor {
            label: None,
            required_features: features,
            required_limits: adapter.limits(),
            memory_hints: wgpu::MemoryHints::MemoryUsage,
            ..wgpu::DeviceDescriptor::default()
        });
        let (device, queue) =
            pollster::block_on(request).map_err(|e| Error::NoDevice(format!("{info} cannot be opened: {e}")))?;

        let failure = Arc::new(Mutex::new(None));
        let slot = Arc::clone(&failure);
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| note(&slot, Failure::new(&error))));
        let slot = Arc::clone(&failure);
        device.set_device_lost_callback(move |_, message| note(&slot, Failure::Broken(message)));
        let mappable = features.contains(wgpu::Features::MAPPABLE_PRIMARY_BUFFERS);
        let tuned = DeviceTuning::of(&info);
        let kernel_cache = keeps_kernels.then(|| KernelCache::open(&device, &adapter.get_info())).flatten();
        Ok(Self {
            info,
            tuned,
            device,
            queue,
            mappable,
            failure,
            end: OnceLock::new(),
            kernel_cache,
            ahead: None,
            kept: None,
        })
    }

    /// Why compiled kernels of earlier runs are not used, where they could be.
    pub fn kernel_cache_note(&self) -> Option<&str> {
        self.kernel_cache.as_ref()?.note()
    }

    /// How kernels read the textures that hold a scene.
    pub(super) fn textures(&self) -> Textures {
        if self.tuned.tuning.stored_tables && self.info.max_storage_textures >= MAX_TEXTURES {
            Textures::Stored
        } else {
            Textures::Sampled
        }
    }

    /// What is tuned to it.
    pub fn tuned(&self) -> &DeviceTuning {
        &self.tuned
    }

    /// Renders with `tuning` from now on.
    ///
    /// # Errors
    ///
    /// [`Misuse::Tuning`] where [`DeviceInfo::problem_with`] has an objection; then nothing changes.
    pub fn set_tuning(&mut self, tuning: Tuning) -> Result<(), Misuse> {
        match self.info.problem_with(&tuning) {
            None => self.tuned.tuning = tuning,
            Some(problem) => return Err(Misuse::Tuning(problem)),
        }
        Ok(())
    }

    /// Uses what was done before the device was open.
    #[must_use]
    pub fn having(self, ahead: Option<Ahead>) -> Self {
        Self { ahead, ..self }
    }

    /// From now on renderers share the kernels that they compile: for whoever renders many pictures and measures no
    /// compilation.
    #[must_use]
    pub fn keeping_kernels(self) -> Self {
        Self { kept: Some(Mutex::default()), ..self }
    }

    /// From now on no dispatch is long: for whoever may change their mind.
    #[must_use]
    pub fn interactive(self) -> Self {
        let mut tuned = self.tuned;
        tuned.tuning = tuned.tuning.interactive();
        Self { tuned, ..self }
    }

    /// The kernels of a picture, and whether another picture has used them before.
    pub(super) fn stages(&self, specialisation: &Specialisation) -> Result<(Arc<Stages>, bool), Error> {
        let kept = || self.kept.as_ref().map(|kept| kept.lock().unwrap_or_else(PoisonError::into_inner));
        if let Some(mut kept) = kept()
            && let Some(index) = kept.iter().position(|(key, _)| key == specialisation)
        {
            kept[index..].rotate_left(1);
            return Ok((Arc::clone(&kept[kept.len() - 1].1), true));
        }
        let stages = Arc::new(compile(self, specialisation)?);
        self.keep_compiled();
        if let Some(mut kept) = kept() {
            if kept.len() == MAX_KEPT {
                kept.remove(0);
            }
            kept.push((*specialisation, Arc::clone(&stages)));
        }
        Ok((stages, false))
    }

    /// The tiers that `auto` chooses from, cheapest first.
    pub fn ladder(&self) -> &'static [Tier] {
        match (self.info.kind, self.info.f64) {
            ("software", true) => &SOFTWARE_LADDER,
            _ => &Tier::ALL,
        }
    }

    /// Gives the device up: whatever is still asked of it fails as lost.
    pub fn destroy(&self) {
        self.device.destroy();
    }

    /// The kernel that keeps the promise of `tier` on this device; a refusal says why there is none.
    pub fn kernel(&self, tier: Tier) -> Result<Kernel, Error> {
        match tier {
            Tier::Fast => Ok(Kernel::Tier(tier)),
            Tier::Robust => SelfTest::require(self).map(|()| Kernel::Tier(tier)),
            Tier::Double if self.info.f64 => Ok(Kernel::Tier(tier)),
            Tier::Double => SelfTest::require(self).map(|()| Kernel::Pairs),
        }
    }

    /// Runs `action` and turns what the device reported meanwhile into an error.
    pub(super) fn checked<T>(&self, what: &str, action: impl FnOnce() -> T) -> Result<T, Error> {
        let value = action();
        match self.failure.lock().unwrap_or_else(PoisonError::into_inner).take() {
            None => Ok(value),
            Some(Failure::Limit(why)) => Err(Error::NoDevice(format!("{} is too small for {what}: {why}", self.info))),
            Some(Failure::Broken(why)) => Err(Error::Lost(format!("{what} on {}: {why}", self.info))),
        }
    }

    /// Runs `action` unless the device has come to its end; where a library on the way to the driver panics, it has.
    pub(super) fn guarded<T>(&self, action: impl FnOnce() -> Result<T, Error>) -> Result<T, Error> {
        match self.end.get() {
            Some(why) => Err(Error::Lost(why.clone())),
            None => guarded(action).unwrap_or_else(|said| Err(self.ends(format!("{}: {said}", self.info)))),
        }
    }

    fn ends(&self, why: String) -> Error {
        // Closing it would wait for what it still does, or panic once more.
        std::mem::forget((self.device.clone(), self.queue.clone()));
        Error::Lost(self.end.get_or_init(|| why).clone())
    }

    /// Waits until everything submitted is done.
    pub(super) fn wait(&self) -> Result<(), Error> {
        self.wait_until(None)
    }

    /// Waits until this submission is done, or all of them.
    pub(super) fn wait_until(&self, submission_index: Option<&wgpu::SubmissionIndex>) -> Result<(), Error> {
        let patience = calls::patience().as_secs();
        // Of a process that is stopped no more than one second counts.
        for _ in 0..patience {
            let wait = wgpu::PollType::Wait {
                submission_index: submission_index.cloned(),
                timeout: Some(Duration::from_secs(1)),
            };
            let call = Call::begin();
            let result = self.checked("waiting for a dispatch", || self.device.poll(wait))?;
            drop(call);
            match result {
                Ok(_) => return Ok(()),
                Err(wgpu::PollError::Timeout) => {}
                Err(error) => return Err(Error::Lost(format!("{} stopped answering: {error}", self.info))),
            }
        }
        let planned = self.tuned.tuning.dispatch_ms;
        let times = patience as f64 * 1e3 / planned;
        let why = format!(
            "{} has not answered for {patience} s, {times:.0} times what a dispatch is to take ({planned} ms); {} sets the limit",
            self.info,
            calls::PATIENCE
        );
        Err(self.ends(why))
    }

    /// Hands commands to the driver, which may wait for earlier ones.
    pub(super) fn submit(&self, commands: Option<wgpu::CommandBuffer>) -> wgpu::SubmissionIndex {
        let _call = Call::begin();
        self.queue.submit(commands)
    }

    /// The module of one kernel.
    pub(super) fn kernel_module(
        &self,
        module: &Parsed,
        entry_point: &str,
        constants: &[(&str, f64)],
        bindings: &[u32],
    ) -> Result<wgpu::ShaderModule, Error> {
        let words = module.spirv(entry_point, constants, bindings).map_err(Error::Lost)?;
        self.checked("reading the shader", || {
            #[allow(
                unsafe_code,
                reason = "naga has validated the module; in its SPIR-V, which has some decorations more, functions stand in the \
                          place of their calls and products and sums in that of dot and cross products: tests hold that it is \
                          well formed. It checks no index, for the reasons that Parsed::spirv gives"
            )]
            unsafe {
                self.device.create_shader_module_passthrough(wgpu::ShaderModuleDescriptorPassthrough {
                    entry_points: Cow::Owned(vec![wgpu::PassthroughShaderEntryPoint {
                        name: entry_point.into(),
                        // Read for Metal alone.
                        workgroup_size: (1, 1, 1),
                    }]),
                    spirv: Some(words.into()),
                    ..Default::default()
                })
            }
        })
    }
}

fn note(slot: &Mutex<Option<Failure>>, failure: Failure) {
    slot.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(failure);
}

/// The index of the device that `choice` and the environment mean.
fn choose<'a>(choice: &Choice, devices: impl Iterator<Item = &'a DeviceInfo>) -> Result<usize, Error> {
    let devices: Vec<_> = devices.collect();
    if devices.is_empty() {
        return Err(Error::none_found());
    }
    // The one that is meant may be left out.
    let hidden = || super::diagnosis::hidden().iter().map(|d| format!("\n  -: {d}")).collect::<String>();
    let listing = || devices.iter().map(|d| format!("\n  {}: {d}", d.index)).collect::<String>() + &hidden();
    let named = |name: &str, source: &str| -> Result<Vec<&DeviceInfo>, Error> {
        let found: Vec<_> = devices.iter().copied().filter(|device| device.matches(name)).collect();
        if found.is_empty() {
            let message = format!("{source} '{name}' matches no Vulkan device; there are:{}", listing());
            return Err(Error::NoDevice(message));
        }
        Ok(found)
    };
    match choice {
        Choice::Index(index) => devices
            .get(*index)
            .map(|device| device.index)
            .ok_or_else(|| Error::NoDevice(format!("there is no Vulkan device {index}; there are:{}", listing()))),
        Choice::Name(name) => match named(name, "--device")?[..] {
            [device] => Ok(device.index),
            _ => Err(Error::NoDevice(format!(
                "--device '{name}' matches several Vulkan devices; choose one by its index:{}",
                listing()
            ))),
        },
        Choice::Auto | Choice::Cpu | Choice::Gpu => {
            let candidates = match std::env::var("WGPU_ADAPTER_NAME") {
                Ok(name) if !name.is_empty() => named(&name, "WGPU_ADAPTER_NAME")?,
                _ => devices.clone(),
            };
            // Mesa's layer has put what the user has chosen first.
            if super::drivers::is_device_chosen(std::env::vars_os().map(|(name, _)| name)) {
                return candidates.first().map(|device| device.index).ok_or_else(Error::none_found);
            }
            let low_power = wgpu::PowerPreference::from_env() == Some(wgpu::PowerPreference::LowPower);
            let best = candidates.iter().min_by_key(|device| device.rank(low_power));
            best.map(|device| device.index).ok_or_else(Error::none_found)
        }
    }
}
