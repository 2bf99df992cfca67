//! Why there is no device, or not the one that one expects: the Vulkan loader is asked again, without wgpu, which keeps to itself
//! what it hears from loader, layers and drivers, and which devices it leaves out.

use std::ffi::{CStr, c_void};
use std::fmt;
use std::sync::{Mutex, PoisonError};

use ash::vk;
use serde::Serialize;

use super::drivers::install_hint;
use crate::threads::lock;

/// This variable, set to 1, lets wgpu use drivers that claim no conformance.
const ADMITS: &str = "WGPU_ALLOW_UNDERLYING_NONCOMPLIANT_ADAPTER";
/// So many messages of the loader are passed on; those that follow are mostly consequences.
const MAX_MESSAGES: usize = 4;

/// How the loader says that a layer is between it and the drivers.
const INSERTS: &str = "nsert instance layer";

/// A device that is there and cannot be used.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Hidden {
    /// The device's name.
    pub name: String,
    /// The driver with its version.
    pub driver: String,
    /// Why it is left out, and what admits it.
    pub hidden: String,
}

impl fmt::Display for Hidden {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { name, driver, hidden } = self;
        write!(f, "{name} ({driver}) is left out: {hidden}")
    }
}

/// What the loader says.
#[derive(Debug, Default)]
pub(super) struct Diagnosis {
    /// What has failed, in the order in which it did.
    failures: Vec<String>,
    /// All devices: those that are left out, and how many are not.
    hidden: Vec<Hidden>,
    usable: usize,
}

/// Devices that wgpu leaves out.
pub fn hidden() -> Vec<Hidden> {
    Diagnosis::new().hidden
}

impl Diagnosis {
    #[allow(unsafe_code, reason = "Vulkan's own functions, called as its specification says; nothing is kept")]
    pub(super) fn new() -> Self {
        let mut diagnosis = Self::default();
        // The library is a system's own, the one that wgpu loads.
        let entry = match unsafe { ash::Entry::load() } {
            Ok(entry) => entry,
            Err(error) => {
                diagnosis.failures.push(format!("the Vulkan loader cannot be loaded: {error}"));
                return diagnosis;
            }
        };
        let messages = Mutex::new(Vec::new());
        let mut listener = vk::DebugUtilsMessengerCreateInfoEXT::default()
            .message_severity(
                vk::DebugUtilsMessageSeverityFlagsEXT::ERROR
                    | vk::DebugUtilsMessageSeverityFlagsEXT::WARNING
                    | vk::DebugUtilsMessageSeverityFlagsEXT::INFO,
            )
            .message_type(vk::DebugUtilsMessageTypeFlagsEXT::GENERAL)
            .pfn_user_callback(Some(hear))
            .user_data((&raw const messages).cast_mut().cast());
        let version = unsafe { entry.try_enumerate_instance_version() }.ok().flatten().unwrap_or(vk::API_VERSION_1_0);
        let application = vk::ApplicationInfo::default().api_version(version.min(vk::API_VERSION_1_3));
        let extensions = unsafe { entry.enumerate_instance_extension_properties(None) }.unwrap_or_default();
        let speaks = extensions.iter().any(|e| e.extension_name_as_c_str() == Ok(vk::EXT_DEBUG_UTILS_NAME));
        let names = [vk::EXT_DEBUG_UTILS_NAME.as_ptr()];
        let create = vk::InstanceCreateInfo::default()
            .application_info(&application)
            .enabled_extension_names(if speaks { &names } else { &[] })
            .push_next(&mut listener);
        let mut has_failed = false;
        match unsafe { entry.create_instance(&create, None) } {
            Ok(instance) => {
                match unsafe { instance.enumerate_physical_devices() } {
                    Ok(devices) => devices.into_iter().for_each(|device| diagnosis.look(&instance, version, device)),
                    Err(error) => diagnosis.failures.push(format!("the drivers cannot list their devices: {error}")),
                }
                unsafe { instance.destroy_instance(None) };
            }
            // There is none, which is no failure; where there should be one, the loader has said why there is not.
            Err(vk::Result::ERROR_INCOMPATIBLE_DRIVER) => {}
            Err(error) => {
                has_failed = true;
                diagnosis.failures.push(format!("no Vulkan instance can be made: {error}"));
            }
        }
        let messages = messages.into_inner().unwrap_or_else(PoisonError::into_inner);
        let (layers, messages): (Vec<String>, Vec<_>) =
            messages.into_iter().partition(|message: &String| message.contains(INSERTS));
        if has_failed && !layers.is_empty() {
            let names: Vec<_> = layers.iter().filter_map(|layer| Some(layer.split_once(INSERTS)?.1.trim())).collect();
            diagnosis.failures.push(format!("a driver has failed, or a layer: {}", names.join(", ")));
        }
        // What the environment asks for is obeyed, which is no failure.
        let failed = messages.into_iter().filter(|message| !message.contains("env var"));
        diagnosis.failures.extend(failed.take(MAX_MESSAGES));
        diagnosis
    }

    #[allow(
        unsafe_code,
        reason = "a device of this instance is asked for its properties, where both have the function"
    )]
    fn look(&mut self, instance: &ash::Instance, version: u32, device: vk::PhysicalDevice) {
        let basic = unsafe { instance.get_physical_device_properties(device) };
        let mut driver = vk::PhysicalDeviceDriverProperties::default();
        // As of 1.2 a driver tells what it is.
        let tells = version.min(basic.api_version) >= vk::API_VERSION_1_2;
        if tells {
            let mut all = vk::PhysicalDeviceProperties2::default().push_next(&mut driver);
            unsafe { instance.get_physical_device_properties2(device, &mut all) };
        }
        let queues = unsafe { instance.get_physical_device_queue_family_properties(device) };
        let conforms = !tells || driver.conformance_version.major > 0 || driver.driver_id == vk::DriverId::MOLTENVK;
        let draws = queues.first().is_some_and(|queue| queue.queue_flags.contains(vk::QueueFlags::GRAPHICS));
        let admitted = wgpu::InstanceFlags::empty()
            .with_env()
            .contains(wgpu::InstanceFlags::ALLOW_UNDERLYING_NONCOMPLIANT_ADAPTER);
        match why_hidden(conforms || admitted, draws) {
            None => self.usable += 1,
            Some(why) => {
                let text =
                    |text: Option<&CStr>| text.map_or_else(|| "?".into(), |text| text.to_string_lossy().into_owned());
                let words = [driver.driver_name_as_c_str().ok(), driver.driver_info_as_c_str().ok()].map(text);
                self.hidden.push(Hidden {
                    name: text(basic.device_name_as_c_str().ok()),
                    driver: words.join(" ").trim().to_owned(),
                    hidden: why,
                });
            }
        }
    }

    /// Whether there is a device after all.
    pub(super) fn finds_some(&self) -> bool {
        self.usable > 0
    }

    /// Why there is no device.
    pub(super) fn why_none(&self) -> String {
        // Where there are devices, it is none of their drivers that has failed.
        let mut reasons: Vec<_> = match &self.hidden[..] {
            [] => self.failures.clone(),
            hidden => hidden.iter().map(ToString::to_string).collect(),
        };
        if self.usable > 0 {
            reasons.push("a driver that failed before answers now: try again".into());
        }
        if reasons.is_empty() {
            let chosen = chosen_drivers().map_or_else(String::new, |chosen| format!(" ({chosen})"));
            return format!("no Vulkan device was found{chosen}. {}", install_hint());
        }
        if self.hidden.is_empty() {
            reasons.push(format!("help: {}; VK_LOADER_DEBUG=error shows what the Vulkan loader meets", install_hint()));
        }
        format!("no Vulkan device can be used:\n  {}", reasons.join("\n  "))
    }
}

/// Why wgpu leaves out a device, if it does.
fn why_hidden(conforms: bool, draws: bool) -> Option<String> {
    match (conforms, draws) {
        (_, false) => {
            Some("its first queue has no graphics, and the library that drives it wants that; nothing admits it".into())
        }
        (false, true) => Some(format!("its driver claims no conformance to Vulkan; {ADMITS}=1 admits it")),
        (true, true) => None,
    }
}

/// The variable with which drivers are chosen, if there is one; none that are chosen so need exist.
fn chosen_drivers() -> Option<String> {
    let names = ["VK_DRIVER_FILES", "VK_ICD_FILENAMES", "VK_LOADER_DRIVERS_SELECT"];
    names.into_iter().find_map(|name| Some(format!("{name} is {}", std::env::var_os(name)?.display())))
}

/// Keeps what the loader says.
#[allow(unsafe_code, reason = "what Vulkan hands over is valid for the call; the list outlives the instance")]
unsafe extern "system" fn hear(
    severity: vk::DebugUtilsMessageSeverityFlagsEXT,
    _: vk::DebugUtilsMessageTypeFlagsEXT,
    data: *const vk::DebugUtilsMessengerCallbackDataEXT<'_>,
    messages: *mut c_void,
) -> vk::Bool32 {
    let messages: &Mutex<Vec<String>> = unsafe { &*messages.cast() };
    if let Some(data) = unsafe { data.as_ref() }
        && !data.p_message.is_null()
    {
        let message = unsafe { CStr::from_ptr(data.p_message) }.to_string_lossy();
        let mut messages = lock(messages);
        let matters = severity != vk::DebugUtilsMessageSeverityFlagsEXT::INFO || message.contains(INSERTS);
        if matters && !messages.iter().any(|other| *other == message) {
            messages.push(message.into_owned());
        }
    }
    vk::FALSE
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn devices_are_left_out_with_a_reason() {
        assert_eq!(why_hidden(true, true), None);
        assert!(
            why_hidden(false, true).is_some_and(|why| why.contains("WGPU_ALLOW_UNDERLYING_NONCOMPLIANT_ADAPTER=1"))
        );
        // No variable helps here, so that none is named.
        assert!(why_hidden(false, false).is_some_and(|why| why.contains("graphics") && !why.contains("=1")));
    }

    fn diagnosis(hidden: bool, failures: &[&str], usable: usize) -> String {
        let failures = failures.iter().map(ToString::to_string).collect();
        let hidden = hidden.then(|| Hidden { name: "Card".into(), driver: "young 0.1".into(), hidden: "why".into() });
        Diagnosis { failures, hidden: hidden.into_iter().collect(), usable }.why_none()
    }

    #[test]
    fn no_device_was_found_is_said_only_where_there_is_none() {
        assert!(diagnosis(false, &[], 0).starts_with("no Vulkan device was found"));
        for (text, part) in [
            (diagnosis(true, &[], 0), "Card (young 0.1) is left out: why"),
            (diagnosis(false, &["libx.so: cannot open"], 0), "libx.so: cannot open\n"),
            (diagnosis(false, &["libx.so: cannot open"], 0), "VK_LOADER_DEBUG=error"),
            (diagnosis(false, &[], 1), "try again"),
        ] {
            assert!(text.starts_with("no Vulkan device can be used:\n") && text.contains(part), "{text}");
        }
    }
}
