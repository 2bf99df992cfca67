//! What the program changes in its own environment: what the Vulkan loader and its layers read there.

use crate::gpu::drivers;

/// Sets what is not set yet; before any thread starts.
pub(super) fn prepare() {
    // Mesa's device-select layer asks the display server which device it uses, and complains where there is none. Nothing
    // here needs a display, and devices are ranked by their type.
    set_unless_set("NODEVICE_SELECT", "1");
    if let Some(idle) = drivers::idle(std::env::vars_os().map(|(name, _)| name)) {
        set_unless_set(drivers::SWITCH, idle);
    }
}

fn set_unless_set(variable: &str, value: &str) {
    if std::env::var_os(variable).is_none() {
        #[allow(unsafe_code, reason = "the process has one thread yet, so no other reads the environment")]
        unsafe {
            std::env::set_var(variable, value);
        }
    }
}
