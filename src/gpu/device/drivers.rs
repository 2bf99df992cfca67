//! Vulkan drivers that need not be loaded: where the kernel offers no graphics device, Mesa's drivers for hardware find
//! nothing, and each takes some milliseconds to say so.

use std::ffi::OsString;
use std::io::ErrorKind;
use std::path::Path;

/// Set to anything, this variable leaves out the layer of Mesa's with which users choose a device.
pub const NO_CHOOSER: &str = "NODEVICE_SELECT";

/// Beginnings of the variables that this layer obeys: it puts the device that is meant first, or leaves out all others.
const CHOOSERS: [&str; 2] = ["MESA_VK_DEVICE_SELECT", "DRI_PRIME"];

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

/// Whether the user has chosen a device by one of the variables, named by `variables`, that Mesa's layer obeys.
pub fn is_device_chosen(variables: impl IntoIterator<Item = OsString>) -> bool {
    let chooses = |name: OsString| CHOOSERS.iter().any(|choice| name.as_encoded_bytes().starts_with(choice.as_bytes()));
    variables.into_iter().any(chooses)
}

/// What to install for a Vulkan device, on this system.
pub(super) fn install_hint() -> &'static str {
    match std::env::consts::OS {
        "linux" => hint_for(&std::fs::read_to_string("/etc/os-release").unwrap_or_default()),
        "macos" => "MoltenVK (`brew install molten-vk vulkan-loader`) brings Vulkan to macOS",
        "windows" => "Vulkan comes with the driver of the graphics card: install that of its vendor",
        _ => GENERAL_HINT,
    }
}

const GENERAL_HINT: &str = "the Vulkan drivers of Mesa have a software device, called lavapipe";

/// Likewise for the Linux that this file, `/etc/os-release`, describes.
pub fn hint_for(os_release: &str) -> &'static str {
    let field = |name: &str| {
        let value = os_release.lines().find_map(|line| line.trim().strip_prefix(name)?.strip_prefix('='));
        value.unwrap_or_default().trim_matches(['"', '\''])
    };
    // What it is before what it is like.
    let names = [field("ID"), field("ID_LIKE")];
    let hint = |name: &str| match name {
        "debian" | "ubuntu" => Some("`apt install mesa-vulkan-drivers` brings Vulkan and a software device"),
        "fedora" | "rhel" | "centos" => {
            Some("`dnf install mesa-vulkan-drivers vulkan-loader` brings Vulkan and a software device")
        }
        "arch" => Some("`pacman -S vulkan-swrast vulkan-icd-loader` brings Vulkan and a software device"),
        "alpine" => Some("`apk add mesa-vulkan-swrast vulkan-loader` brings Vulkan and a software device"),
        _ => None,
    };
    names.iter().flat_map(|names| names.split_whitespace()).find_map(hint).unwrap_or(GENERAL_HINT)
}
