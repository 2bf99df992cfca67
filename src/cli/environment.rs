//! What the program changes in its own environment: what the Vulkan loader and its layers read there, and how memory goes back.

use crate::gpu::drivers;

/// Sets what is not set yet; before any thread starts.
pub(super) fn prepare() {
    let variables = || std::env::vars_os().map(|(name, _)| name);
    // Mesa's device-select layer asks the display server which device it uses, and complains where there is none. Nothing
    // here needs a display, and devices are ranked by their type, unless the user has chosen one.
    if !drivers::is_device_chosen(variables()) {
        set_unless_set(drivers::NO_CHOOSER, "1");
    }
    if let Some(idle) = drivers::idle(variables()) {
        set_unless_set(drivers::SWITCH, idle);
    }
    return_memory();
}

/// Allocations from this size on are given back to the system when they are freed.
#[cfg(all(target_os = "linux", target_env = "gnu"))]
const LARGE: libc::c_int = 16 << 20;

/// Lists of a million spheres come and go before the device takes its share of memory. Left to itself glibc learns from the
/// first large block to keep those that follow: a hundred MiB that nobody uses.
#[cfg(all(target_os = "linux", target_env = "gnu"))]
fn return_memory() {
    let is_chosen = |variable| std::env::var_os(variable).is_some();
    if !is_chosen("GLIBC_TUNABLES") && !is_chosen("MALLOC_MMAP_THRESHOLD_") {
        #[allow(unsafe_code, reason = "a number for the allocator; the process has one thread yet")]
        unsafe {
            libc::mallopt(libc::M_MMAP_THRESHOLD, LARGE);
        }
    }
}

#[cfg(not(all(target_os = "linux", target_env = "gnu")))]
fn return_memory() {}

fn set_unless_set(variable: &str, value: &str) {
    if std::env::var_os(variable).is_none() {
        #[allow(unsafe_code, reason = "the process has one thread yet, so no other reads the environment")]
        unsafe {
            std::env::set_var(variable, value);
        }
    }
}
