//! What a run makes of a picture besides its file: intermediate values, and a view in the terminal.

use super::aov::{AovOptions, Collector};
use super::failure::Failure;
use super::guard::Guard;
use super::show::{Show, show};
use crate::effects::Effects;
use crate::engine::Backend;
use crate::film::{Picture, Target};
use crate::viewed::ViewedScene;

/// What is wanted of one picture, whose rows come one after another.
#[derive(Debug)]
pub(super) struct Beside<'a> {
    size: (u32, u32),
    aov: Option<Collector<'a>>,
    /// The rows so far, where the picture is to be shown.
    shown: Option<(Show, Vec<u8>)>,
}

impl<'a> Beside<'a> {
    pub(super) fn new(
        aov: &AovOptions,
        how: Option<Show>,
        viewed: &ViewedScene,
        effects: &Effects,
        backend: Backend<'a>,
    ) -> Result<Self, Failure> {
        let size = (viewed.scene().width, viewed.scene().height);
        Ok(Self { size, aov: aov.of(viewed, effects, backend)?, shown: how.map(|how| (how, Vec::new())) })
    }

    /// Takes the next rows, 3 bytes a pixel: as they are rendered, and as the file has them.
    pub(super) fn add(&mut self, rgb: &[u8], written: &[u8]) {
        if let Some(aov) = &mut self.aov {
            aov.add(rgb);
        }
        if let Some((_, shown)) = &mut self.shown {
            shown.extend_from_slice(written);
        }
    }

    /// All rows are there, in the file that `target` names; where the scene has named it, what is beside it replaces only pictures.
    pub(super) fn finish(
        self,
        name: &str,
        (target, is_named): (&Target, bool),
        guard: &mut Guard,
        quiet: bool,
    ) -> Result<(), Failure> {
        if let Some((how, rgb)) = self.shown {
            show(&Picture::assemble(self.size.0, self.size.1, rgb), how)?;
        }
        self.aov.map_or(Ok(()), |aov| aov.write(name, (target.argument(), is_named), guard, quiet))
    }
}
