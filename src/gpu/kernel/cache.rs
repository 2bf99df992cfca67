//! Compiled kernels of earlier runs, for drivers that leave it to the program to keep them.
//!
//! Lavapipe keeps its machine code by itself, and what it gives to be kept is empty; so software devices have this only
//! where [`SWITCH`] asks for it.

use std::path::{Path, PathBuf};
use std::sync::Mutex;

use crate::cache;
use crate::gpu::device::info::DeviceKind;
use crate::gpu::device::open::Device;
use crate::hash::{EMPTY, fnv1a};
use crate::threads::lock;

/// Set to 0, this variable keeps every device from using such a file; set to 1, it lets software devices use one.
pub const SWITCH: &str = "TRUERAY_KERNEL_CACHE";

/// The cache of an open device and its file.
#[derive(Debug)]
pub(super) struct KernelCache {
    cache: wgpu::PipelineCache,
    path: PathBuf,
    /// Checksum of what the file has.
    saved: Mutex<Option<u64>>,
    /// Why a file that was there is not used.
    note: Option<String>,
}

impl KernelCache {
    /// Whether a device of this type uses one.
    fn is_wanted(kind: DeviceKind) -> bool {
        match std::env::var(SWITCH) {
            Ok(value) if value == "0" => false,
            Ok(value) if value == "1" => true,
            _ => kind != DeviceKind::Software,
        }
    }

    /// Reads the file of a device, if there is one; `None` where it cannot use it or there is no place for it.
    pub(super) fn open(device: &Device) -> Option<Self> {
        if !Self::is_wanted(device.info.kind) || !device.raw.features().contains(wgpu::Features::PIPELINE_CACHE) {
            return None;
        }
        let info = device.raw.adapter_info();
        let key = wgpu::util::pipeline_cache_key(&info)?;
        let driver = cache::key(&[&key, &info.name, &info.driver, &info.driver_info]);
        let path = cache::folder()?.join(format!("kernels-{driver}"));
        let (data, note) = match read(&path) {
            Ok(data) => (data, None),
            Err(why) => (None, Some(format!("the compiled kernels in {} are not used: {why}", path.display()))),
        };
        let descriptor = wgpu::PipelineCacheDescriptor { label: None, data: data.as_deref(), fallback: true };
        #[allow(
            unsafe_code,
            reason = "the data has the checksum that this program gave it when it came from the same driver"
        )]
        let cache = unsafe { device.raw.create_pipeline_cache(&descriptor) };
        Some(Self { cache, path, saved: Mutex::new(data.as_deref().map(checksum)), note })
    }

    /// What pipelines are created with.
    pub(super) fn handle(&self) -> &wgpu::PipelineCache {
        &self.cache
    }

    /// Why a file that was there is not used.
    pub(super) fn note(&self) -> Option<&str> {
        self.note.as_deref()
    }

    /// Writes the file anew where kernels have been added. One that cannot be written is no loss but time.
    pub(super) fn save(&self) {
        let Some(data) = self.cache.get_data() else { return };
        let sum = checksum(&data);
        let mut saved = lock(&self.saved);
        if *saved != Some(sum) && write(&self.path, sum, &data).is_ok() {
            *saved = Some(sum);
        }
    }
}

/// It finds what a disk or an editor has done to a file.
fn checksum(data: &[u8]) -> u64 {
    fnv1a(EMPTY, data.iter().copied())
}

/// The data of a file; `None` where there is no file.
fn read(path: &Path) -> Result<Option<Vec<u8>>, String> {
    let bytes = match std::fs::read(path) {
        Ok(bytes) => bytes,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(None),
        Err(error) => return Err(error.to_string()),
    };
    match bytes.split_first_chunk() {
        Some((sum, data)) if u64::from_le_bytes(*sum) == checksum(data) => Ok(Some(data.to_vec())),
        _ => Err("the file is damaged".into()),
    }
}

/// The file appears complete or not at all.
fn write(path: &Path, sum: u64, data: &[u8]) -> std::io::Result<()> {
    let folder = path.parent().unwrap_or(Path::new("."));
    std::fs::create_dir_all(folder)?;
    crate::atomic::save(path, &[&sum.to_le_bytes(), data])
}
