//! `trueray merge`: parts of a picture, rendered one by one, into the picture.

use std::path::PathBuf;

use super::failure::{Failure, INCOMPLETE, OK, USAGE};
use super::files::check_place;
use super::guard::Guard;
use super::named::format_by_ending;
use super::output::errln;
use crate::film::{Format, PictureWriter, Target};
use crate::part::{MergeError, Merger};
use crate::words::count;

/// Arguments of `trueray merge`.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// Files that `render --crop`, `--tile` or `--resume` have written, P6 or PNG, in any order
    #[arg(required = true, value_name = "PART", help_heading = "Picture file")]
    parts: Vec<PathBuf>,
    /// The picture: the very file that `render` writes of all of it
    #[arg(short, long, value_name = "FILE", help_heading = "Output")]
    output: PathBuf,
    /// File format: p6, p3 or png; without it the file name's ending decides
    #[arg(long, value_name = "FORMAT", help_heading = "Output")]
    format: Option<Format>,
    /// Take parts that different devices have rendered at the same tier, whose pixels may round differently. Certified parts and those of
    /// the CPU reference need no leave
    #[arg(long, help_heading = "Picture file")]
    allow_mixed_devices: bool,
    /// Print errors only
    #[arg(short, long, help_heading = "Output")]
    quiet: bool,
}

pub(super) fn run(args: &Args) -> Result<u8, Failure> {
    let mut guard = Guard::new(&args.parts);
    let target = Target::from_argument(args.output.as_os_str());
    if let Target::File(path) = &target {
        check_place(path)?;
    }
    guard.output("the picture", target.argument())?;
    let format = match (args.format, &target) {
        (Some(format), _) => format,
        (None, Target::File(path)) => format_by_ending(path)?,
        (None, Target::Stdout) => Format::default(),
    };
    let merger = Merger::new(&args.parts, args.allow_mixed_devices)?;
    let (width, height) = merger.size();
    let mut writer = PictureWriter::create(&target, format, width, height)?;
    merger.rows(|row| Ok::<_, Failure>(writer.write_rows(row)?))?;
    writer.finish()?;
    if !args.quiet {
        errln!("{target}: {width} × {height} from {}", count(args.parts.len() as u64, "part"));
    }
    Ok(OK)
}

impl From<MergeError> for Failure {
    fn from(error: MergeError) -> Self {
        let code = match error {
            MergeError::Missing(_) => INCOMPLETE,
            MergeError::File(_) | MergeError::Together(_) => USAGE,
        };
        Self::new(code, error.to_string())
    }
}
