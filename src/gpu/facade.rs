//! What renders: a device, what is tuned to it, and its kernels.

use std::num::NonZero;
use std::sync::Arc;

use super::device::choose::Choice;
use super::device::error::Error;
use super::device::info::DeviceKind;
use super::device::open::Device;
use super::kernel::ahead::{Ahead, SOFTWARE_LADDER};
use super::kernel::compiler::Compiler;
use super::kernel::picture::Pipelines;
use super::kernel::pipeline::MAX_TABLES;
use super::kernel::specialisation::Specialisation;
use super::kernel::store::KernelStore;
use super::kernel::variant::Tables;
use super::shared::LEAST_BUFFERS;
use super::tuned::DeviceTuning;
use crate::misuse::Misuse;
use crate::precision::Tier;
use crate::tuning::Tuning;

/// Specialisations whose kernels are kept by whoever shows one scene after the other.
pub const USUAL_KERNELS: NonZero<usize> = NonZero::new(16).expect("it is not 0");

/// An open device that renders.
#[derive(Debug)]
pub struct Gpu {
    /// The device.
    pub device: Device,
    tuned: DeviceTuning,
    kernels: KernelStore,
}

impl Gpu {
    /// Opens the chosen device; [`Choice::Auto`] and [`Choice::Cpu`] mean the best one here.
    ///
    /// `WGPU_ADAPTER_NAME` and `WGPU_POWER_PREF` decide where the choice leaves it open.
    pub fn open(choice: &Choice) -> Result<Self, Error> {
        Self::with(Device::open(choice)?)
    }

    /// With a device that is open.
    pub fn with(device: Device) -> Result<Self, Error> {
        let tuned = DeviceTuning::of(&device.info);
        let kernels = device.guarded(|| Ok(KernelStore::open(&device)))?;
        Ok(Self { device, tuned, kernels })
    }

    /// Why compiled kernels of earlier runs are not used, where they could be.
    pub fn kernel_cache_note(&self) -> Option<&str> {
        self.kernels.note()
    }

    /// What holds the tables of a scene: storage buffers unless textures are faster, or there are too few.
    pub fn tables(&self) -> Tables {
        let info = &self.device.info;
        if !self.tuned.tuning.texture_tables && info.max_storage_buffers >= MAX_TABLES + LEAST_BUFFERS {
            Tables::Buffers
        } else if info.max_storage_textures >= MAX_TABLES {
            Tables::Stored
        } else {
            Tables::Sampled
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
        match self.device.info.problem_with(&tuning) {
            None => self.tuned.tuning = tuning,
            Some(problem) => return Err(Misuse::Tuning(problem)),
        }
        Ok(())
    }

    /// Uses what was done before the device was open.
    #[must_use]
    pub fn having(self, ahead: Option<Ahead>) -> Self {
        Self { kernels: self.kernels.having(ahead), ..self }
    }

    /// From now on renderers share the kernels that they compile, for `most` specialisations at the most: for whoever renders many pictures and measures no
    /// compilation.
    #[must_use]
    pub fn keeping_kernels(self, most: NonZero<usize>) -> Self {
        Self { kernels: self.kernels.keeping(most.get()), ..self }
    }

    /// From now on no dispatch is long: for whoever may change their mind.
    #[must_use]
    pub fn interactive(self) -> Self {
        let mut tuned = self.tuned;
        tuned.tuning = tuned.tuning.interactive();
        Self { tuned, ..self }
    }

    /// The kernels of a picture, and whether another picture has used them before.
    pub(crate) fn pipelines(&self, specialisation: &Specialisation) -> Result<(Arc<Pipelines>, bool), Error> {
        self.kernels.pipelines(&self.device, specialisation)
    }

    /// What compiles other kernels.
    pub(crate) fn compiler(&self) -> Compiler<'_> {
        self.kernels.compiler(&self.device)
    }

    /// The tiers that `auto` chooses from, cheapest first.
    pub fn ladder(&self) -> &'static [Tier] {
        match (self.device.info.kind, self.device.info.f64) {
            (DeviceKind::Software, true) => &SOFTWARE_LADDER,
            _ => &Tier::ALL,
        }
    }
}
