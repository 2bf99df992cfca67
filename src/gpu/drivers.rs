//! Vulkan drivers that need not be loaded: where the kernel offers no graphics device, Mesa's drivers for hardware find
//! nothing, and each takes some milliseconds to say so.

use std::ffi::OsString;
use std::io::ErrorKind;
use std::path::Path;

/// The Vulkan loader's list of drivers to leave out, by the names of their manifests. Loaders before 1.3.234 ignore it.
pub const SWITCH: &str = "VK_LOADER_DRIVERS_DISABLE";

/// Manifests of those of Mesa's drivers that look for devices in [`DEVICES`] alone. Freedreno, Venus and whatever is not
/// Mesa's have other ways to find one.
const NEED_DEVICES: &str =
    "asahi_icd.*,broadcom_icd.*,intel_icd.*,intel_hasvk_icd.*,nouveau_icd.*,panfrost_icd.*,radeon_icd.*";

/// Where the kernel offers graphics devices.
const DEVICES: &str = "/dev/dri";

/// Beginnings of the variables with which a user chooses drivers, or shows one a device that is not there.
const CHOICES: [&str; 10] = [
    "VK_DRIVER_FILES",
    "VK_ICD_FILENAMES",
    "VK_ADD_DRIVER_FILES",
    "VK_LOADER_DRIVERS_",
    "LD_",
    "AMD_",
    "ANV_",
    "INTEL_",
    "MESA_LOADER_",
    "RADV_",
];

/// The value of [`SWITCH`] that leaves out the drivers which cannot find a device here. `None` where they might, or where a
/// variable, of those named by `variables`, chooses.
pub fn idle(variables: impl IntoIterator<Item = OsString>) -> Option<&'static str> {
    idle_without(Path::new(DEVICES), variables)
}

/// Likewise where the kernel offers its devices in another folder.
pub fn idle_without(devices: &Path, variables: impl IntoIterator<Item = OsString>) -> Option<&'static str> {
    let chooses = |name: OsString| CHOICES.iter().any(|choice| name.as_encoded_bytes().starts_with(choice.as_bytes()));
    (!variables.into_iter().any(chooses) && is_surely_empty(devices)).then_some(NEED_DEVICES)
}

/// Whether a folder has no entries, or is not there; one that cannot be read may have anything.
fn is_surely_empty(folder: &Path) -> bool {
    match std::fs::read_dir(folder) {
        Ok(mut entries) => entries.next().is_none(),
        Err(error) => error.kind() == ErrorKind::NotFound,
    }
}
