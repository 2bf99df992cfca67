//! Which files hold particles, by what they begin with.

use std::fmt;

use super::{pdb, points, table};

/// A format of files that hold particles.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// XYZ, plain or extended.
    Xyz,
    /// A text dump of LAMMPS.
    Lammps,
    /// The fixed columns of the Protein Data Bank.
    Pdb,
    /// mmCIF.
    Mmcif,
    /// Values separated by commas, tabs or semicolons under a line of names, or numbers alone.
    Table,
    /// PLY, its vertices.
    Ply,
}

impl Format {
    /// The format of a file that begins like this; 64 KiB tell all. None for what may be a scene, or is of no known kind.
    pub fn of(head: &[u8]) -> Option<Self> {
        let head = head.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(head);
        let lines = || head.split(|&byte| byte == b'\n').map(|line| line.strip_suffix(b"\r").unwrap_or(line));
        if lines().next() == Some(b"ply") {
            return Some(Self::Ply);
        }
        let mut full = lines().filter(|line| !line.trim_ascii().is_empty());
        let first = full.next()?;
        let is_number = first.trim_ascii().iter().all(u8::is_ascii_digit);
        if first.starts_with(b"ITEM:") {
            Some(Self::Lammps)
        } else if is_number && head.contains(&b'\n') {
            // Points may have their number before them, too, but no comment.
            let is_blank = |line: &&[u8]| line.trim_ascii().is_empty();
            let mut rest = lines().skip_while(is_blank).skip(1);
            let fields = |line: &[u8]| points::numbers(line).map(|numbers| numbers.len());
            let second = rest.next().and_then(fields);
            let third = rest.next().filter(|line| !is_blank(line));
            let are_points = second.is_some() && third.is_none_or(|third| fields(third) == second);
            Some(if are_points { Self::Table } else { Self::Xyz })
        } else if pdb::is_record(first) {
            Some(Self::Pdb)
        } else {
            let statement = lines().find(|line| !table::is_empty(line))?;
            if statement.get(..5).is_some_and(|word| word.eq_ignore_ascii_case(b"data_")) {
                return Some(Self::Mmcif);
            }
            (table::is_header(statement) || points::numbers(statement).is_some()).then_some(Self::Table)
        }
    }
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Xyz => "XYZ",
            Self::Lammps => "LAMMPS dump",
            Self::Pdb => "PDB",
            Self::Mmcif => "mmCIF",
            Self::Table => "table",
            Self::Ply => "PLY",
        })
    }
}
