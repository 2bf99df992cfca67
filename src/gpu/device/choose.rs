//! Which devices there are, and the one that is meant.

use std::str::FromStr;

use super::calls::Call;
use super::diagnosis::hidden;
use super::drivers::is_device_chosen;
use super::error::Error;
use super::guard::guarded;
use super::info::DeviceInfo;
use super::mask::Offer;
use super::vulkan::VulkanInfo;

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

/// All Vulkan devices, in the driver's order.
pub fn list() -> Result<Vec<DeviceInfo>, Error> {
    Ok(guarded(adapters).map_err(|why| cannot_be_asked(&why))??.1.into_iter().map(|(info, _)| info).collect())
}

fn cannot_be_asked(why: &str) -> Error {
    Error::NotFound(format!("the Vulkan drivers cannot be asked for their devices: {why}"))
}

/// The device that `choice` and the environment mean.
pub(super) fn chosen(choice: &Choice) -> Result<(DeviceInfo, wgpu::Adapter), Error> {
    let (_instance, adapters) = guarded(adapters).map_err(|why| cannot_be_asked(&why))??;
    let index = choose(choice, adapters.iter().map(|(info, _)| info))?;
    adapters.into_iter().nth(index).ok_or_else(Error::none_found)
}

type Adapters = Vec<(DeviceInfo, wgpu::Adapter)>;

fn adapters() -> Result<(wgpu::Instance, Adapters), Error> {
    if let Some(backends) = wgpu::Backends::from_env()
        && !backends.contains(wgpu::Backends::VULKAN)
    {
        return Err(Error::NotFound("WGPU_BACKEND leaves out Vulkan, the only backend of this program".into()));
    }
    let _span = tracing::info_span!("load drivers").entered();
    let _call = Call::begin();
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor {
        backends: wgpu::Backends::VULKAN,
        flags: wgpu::InstanceFlags::empty().with_env(),
        ..wgpu::InstanceDescriptor::new_without_display_handle()
    });
    let adapters = pollster::block_on(instance.enumerate_adapters(wgpu::Backends::VULKAN));
    let adapters = adapters
        .into_iter()
        .enumerate()
        .map(|(i, adapter)| {
            let info = DeviceInfo::new(i, adapter.get_info(), VulkanInfo::of(&adapter), &Offer::of(&adapter));
            (info, adapter)
        })
        .collect();
    Ok((instance, adapters))
}

/// The index of the device that `choice` and the environment mean.
fn choose<'a>(choice: &Choice, devices: impl Iterator<Item = &'a DeviceInfo>) -> Result<usize, Error> {
    let devices: Vec<_> = devices.collect();
    if devices.is_empty() {
        return Err(Error::none_found());
    }
    // The one that is meant may be left out.
    let hidden = || hidden().iter().map(|d| format!("\n  -: {d}")).collect::<String>();
    let listing = || devices.iter().map(|d| format!("\n  {}: {d}", d.index)).collect::<String>() + &hidden();
    let named = |name: &str, source: &str| -> Result<Vec<&DeviceInfo>, Error> {
        let found: Vec<_> = devices.iter().copied().filter(|device| device.matches(name)).collect();
        if found.is_empty() {
            let message = format!("{source} '{name}' matches no Vulkan device; there are:{}", listing());
            return Err(Error::NotFound(message));
        }
        Ok(found)
    };
    match choice {
        Choice::Index(index) => devices
            .get(*index)
            .map(|device| device.index)
            .ok_or_else(|| Error::NotFound(format!("there is no Vulkan device {index}; there are:{}", listing()))),
        Choice::Name(name) => match named(name, "--device")?[..] {
            [device] => Ok(device.index),
            _ => Err(Error::NotFound(format!(
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
            if is_device_chosen(std::env::vars_os().map(|(name, _)| name)) {
                return candidates.first().map(|device| device.index).ok_or_else(Error::none_found);
            }
            let low_power = wgpu::PowerPreference::from_env() == Some(wgpu::PowerPreference::LowPower);
            let best = candidates.iter().min_by_key(|device| device.rank(low_power));
            best.map(|device| device.index).ok_or_else(Error::none_found)
        }
    }
}
