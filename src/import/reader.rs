//! What the readers of all formats have in common.

use super::Format;
use super::frame::Frame;
use super::lammps::Lammps;
use super::mmcif::Mmcif;
use super::options::Options;
use super::pdb::Pdb;
use super::ply::Ply;
use super::source::{Source, Stop};
use super::table::Table;
use super::xyz::Xyz;
use crate::scene::Collector;

/// Reads frame by frame.
pub(super) trait Reader {
    /// Reads the next frame, or passes over it where there is no `frame` for it; whether there was one. A `frame` that stays without
    /// one keeps what it has. Errors in single rows are reported and do not stop it.
    fn next(
        &mut self,
        source: &mut Source<'_>,
        frame: Option<&mut Frame>,
        options: &Options,
        log: &mut Collector,
    ) -> Result<bool, Stop>;
}

/// The reader of a format.
pub(super) fn reader_of(format: Format) -> Box<dyn Reader> {
    match format {
        Format::Xyz => Box::new(Xyz::default()),
        Format::Lammps => Box::new(Lammps::default()),
        Format::Pdb => Box::new(Pdb),
        Format::Mmcif => Box::new(Mmcif::default()),
        Format::Table => Box::new(Table::default()),
        Format::Ply => Box::new(Ply::default()),
    }
}
