//! The tables of a scene on a device. One eye leaves them to the next, for which only what it changes is written again.

use std::sync::{Arc, Mutex};

use crate::accel::ScreenRoom;
use crate::effects::EffectSet;
use crate::gpu::device::contents::Contents;
use crate::gpu::device::error::Error;
use crate::gpu::device::open::Device;
use crate::gpu::device::upload::{fill_buffer, fill_texels, upload, upload_texels};
use crate::gpu::kernel::pipeline::{Resource, Resources};
use crate::gpu::kernel::variant::Tables;
use crate::settings::Quantize;
use crate::threads::lock;

/// Sets of tables at the most: one that is rendered from, and one that is being prepared.
const MOST: usize = 2;

/// Tables that no renderer has any more, of one scene and one device.
#[derive(Debug, Default)]
pub(crate) struct TablePool(Mutex<Vec<TableSet>>);

/// What the contents of a table go by. Where it is the same, so are they but for their beginning.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Basis {
    /// Of lists.
    Lists(ScreenRoom),
    /// Of what the spheres are made of.
    Materials {
        /// What is simulated.
        effects: EffectSet,
        /// Whether numbers are `f64`, and whether the picture is certified.
        layout: [bool; 2],
        /// Levels of AMBIENT.
        light: ([f64; 3], Quantize),
        /// The unit of lengths.
        factor: f64,
    },
}

#[derive(Debug)]
struct Table {
    name: &'static str,
    resource: Resource,
    /// Bytes.
    len: usize,
    basis: Option<Basis>,
}

/// The tables of a scene.
#[derive(Debug)]
pub(crate) struct TableSet {
    device: wgpu::Device,
    kind: Tables,
    tables: Vec<Table>,
    /// Those of an earlier eye that have not been written again.
    earlier: Vec<Table>,
    pool: Option<Arc<TablePool>>,
}

impl TableSet {
    /// None yet; what is in `pool` is written again, and goes back there in the end.
    pub(crate) fn new(device: &Device, kind: Tables, pool: Option<Arc<TablePool>>) -> Self {
        let device = device.raw.clone();
        let earlier = pool.as_ref().and_then(|pool| {
            let mut sets = lock(&pool.0);
            let at = sets.iter().position(|set| set.device == device && set.kind == kind)?;
            Some(std::mem::take(&mut sets.remove(at).tables))
        });
        Self { device, kind, tables: Vec::new(), earlier: earlier.unwrap_or_default(), pool }
    }

    /// Adds a table with `contents`, of so many `u32` a texel where it is a texture.
    pub(crate) fn add(
        &mut self,
        device: &Device,
        name: &'static str,
        contents: &Contents,
        components: u32,
    ) -> Result<(), Error> {
        self.add_changed(device, name, (contents, components), None, contents.len())
    }

    /// The same where all but this beginning of `contents` goes by `basis`.
    pub(crate) fn add_changed(
        &mut self,
        device: &Device,
        name: &'static str,
        (contents, components): (&Contents, u32),
        basis: Option<Basis>,
        beginning: usize,
    ) -> Result<(), Error> {
        let len = contents.len();
        let earlier = self.earlier.iter().position(|table| table.name == name && table.len == len);
        let resource = match earlier.map(|at| self.earlier.swap_remove(at)) {
            None => table(device, self.kind, contents, components)?,
            Some(table) => {
                let changed = if basis.is_some() && table.basis == basis { beginning } else { len };
                device.checked("filling tables", || match &table.resource {
                    Resource::Buffer(buffer) => fill_buffer(device, buffer, contents, changed),
                    Resource::Texels(view) => fill_texels(device, view.texture(), contents, components, changed),
                })??;
                table.resource
            }
        };
        self.tables.push(Table { name, resource, len, basis });
        Ok(())
    }

    /// Adds what serves no other eye.
    pub(crate) fn add_own(&mut self, name: &'static str, resource: Resource) {
        self.tables.push(Table { name, resource, len: usize::MAX, basis: None });
    }

    /// All of them by name.
    pub(crate) fn resources(&self) -> Resources {
        self.tables.iter().map(|table| (table.name, table.resource.clone())).collect()
    }
}

impl Drop for TableSet {
    fn drop(&mut self) {
        let (Some(pool), false) = (self.pool.take(), self.tables.is_empty()) else { return };
        let mut sets = lock(&pool.0);
        if sets.len() == MOST {
            sets.remove(0);
        }
        let (device, tables) = (self.device.clone(), std::mem::take(&mut self.tables));
        sets.push(Self { device, kind: self.kind, tables, earlier: Vec::new(), pool: None });
    }
}

/// How textures that are tables are bound; `None` for tables in buffers.
pub(super) fn texture_usage(tables: Tables) -> Option<wgpu::TextureUsages> {
    match tables {
        Tables::Buffers => None,
        Tables::Stored => Some(wgpu::TextureUsages::STORAGE_BINDING),
        Tables::Sampled => Some(wgpu::TextureUsages::TEXTURE_BINDING),
    }
}

/// A table with `contents`, of so many `u32` a texel where it is a texture.
fn table(device: &Device, tables: Tables, contents: &Contents, components: u32) -> Result<Resource, Error> {
    match texture_usage(tables) {
        None => storage_buffer(device, contents),
        Some(usage) => upload_texels(device, contents, components, usage).map(Resource::Texels),
    }
}

/// The same in a buffer.
pub(super) fn storage_buffer(device: &Device, contents: &Contents) -> Result<Resource, Error> {
    // A binding of size 0 is not allowed.
    let size = contents.len().max(64);
    upload(device, contents, wgpu::BufferUsages::STORAGE, size).map(Resource::Buffer)
}
