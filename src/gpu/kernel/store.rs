//! The compiled kernels of a device: of earlier runs, of other pictures, and those that are begun before it is open.

use std::sync::{Arc, Mutex};

use super::ahead::Ahead;
use super::cache::KernelCache;
use super::compiler::Compiler;
use super::picture::{Pipelines, compile};
use super::specialisation::Specialisation;
use crate::gpu::device::error::Error;
use crate::gpu::device::open::Device;
use crate::threads::lock;

/// Compiled kernels, those used last at the end.
type RecentlyUsed = Vec<(Specialisation, Arc<Pipelines>)>;

/// Kernels of one device.
#[derive(Debug)]
pub(crate) struct KernelStore {
    /// Those of earlier runs.
    cache: Option<KernelCache>,
    /// What was done before the device was open.
    ahead: Option<Ahead>,
    /// Compiled kernels that are used again; `None` where every renderer compiles its own.
    recent: Option<Mutex<RecentlyUsed>>,
    /// For so many specialisations they are kept; one more drops the one that was not used for the longest time.
    most: usize,
}

impl KernelStore {
    /// For a device that has compiled nothing yet.
    pub(crate) fn open(device: &Device) -> Self {
        Self { cache: KernelCache::open(device), ahead: None, recent: None, most: 0 }
    }

    /// Uses what was done before the device was open.
    pub(crate) fn having(self, ahead: Option<Ahead>) -> Self {
        Self { ahead, ..self }
    }

    /// From now on kernels are kept for other pictures.
    pub(crate) fn keeping(self, most: usize) -> Self {
        Self { recent: Some(Mutex::default()), most, ..self }
    }

    /// Why compiled kernels of earlier runs are not used, where they could be.
    pub(crate) fn note(&self) -> Option<&str> {
        self.cache.as_ref()?.note()
    }

    /// What compiles for `device`, whose kernels these are.
    pub(crate) fn compiler<'a>(&'a self, device: &'a Device) -> Compiler<'a> {
        Compiler { device, cache: self.cache.as_ref() }
    }

    /// The kernels of a picture, and whether another picture has used them before.
    pub(crate) fn pipelines(
        &self,
        device: &Device,
        specialisation: &Specialisation,
    ) -> Result<(Arc<Pipelines>, bool), Error> {
        let recent = || self.recent.as_ref().map(lock);
        if let Some(mut recent) = recent()
            && let Some(index) = recent.iter().position(|(key, _)| key == specialisation)
        {
            recent[index..].rotate_left(1);
            return Ok((Arc::clone(&recent[recent.len() - 1].1), true));
        }
        let ahead = self.ahead.as_ref().and_then(|ahead| ahead.module(specialisation));
        let pipelines = Arc::new(compile(self.compiler(device), ahead, specialisation)?);
        if let Some(cache) = &self.cache {
            cache.save();
        }
        if let Some(mut recent) = recent() {
            if recent.len() == self.most {
                recent.remove(0);
            }
            recent.push((*specialisation, Arc::clone(&pipelines)));
        }
        Ok((pipelines, false))
    }
}
