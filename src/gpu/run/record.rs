//! Which tests a device has passed with its driver, in the user's cache folder.

use std::path::PathBuf;

use crate::cache;
use crate::gpu::facade::Gpu;
use crate::gpu::kernel::module::Module;

/// What the record of a pass says.
const PASSED: &[u8] = b"passed\n";

/// The record of a test: one of each device, driver and shader. Without a cache folder, and where the device is made worse than it is,
/// there is none, and the test, which takes milliseconds, is simply made again.
pub(super) struct Record(Option<PathBuf>);

impl Record {
    pub(super) fn of(gpu: &Gpu, name: &str, module: &Module) -> Self {
        let info = &gpu.device.info;
        // wgpu's translation lets drivers fuse.
        let way = if gpu.device.takes_spirv { "as written" } else { "translated" };
        let key = cache::key(&[&info.name, &info.driver, &info.pci, way, &module.text]);
        let folder = cache::folder().filter(|_| gpu.device.units_off == 0);
        Self(folder.map(|folder| folder.join(format!("{name}-{key}"))))
    }

    /// Whether it says that the device has passed.
    pub(super) fn has_passed(&self) -> bool {
        self.0.as_ref().is_some_and(|file| std::fs::read(file).is_ok_and(|text| text == PASSED))
    }

    /// From now on it does.
    pub(super) fn keep(self) {
        if let Some(file) = self.0
            && let Some(folder) = file.parent()
        {
            let _ = std::fs::create_dir_all(folder).and_then(|()| std::fs::write(&file, PASSED));
        }
    }
}
