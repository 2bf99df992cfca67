//! `--color-bar` of `trueray render`.

use glam::DVec3;

use super::failure::{Failure, USAGE};
use crate::color_bar::{ColorBar, Side};
use crate::import::{ByColumn, ColorScale, Coloring, Map};
use crate::settings::Quantize;
use crate::words::{number, visible};

/// Whether what the colours of particles stand for is shown.
#[derive(Debug, Clone, Copy, clap::Args)]
#[command(next_help_heading = "Particles")]
pub(super) struct ColorBarOptions {
    /// Draw over the finished picture what the colours of --color-by COLUMN stand for, on its right or where =SIDE says
    #[arg(long, value_name = "SIDE", value_enum, num_args = 0..=1, require_equals = true, default_missing_value = "right")]
    color_bar: Option<Side>,
}

impl ColorBarOptions {
    /// Refuses a bar where nothing is there to be shown, or where one of `others` is given and does not go with it.
    pub(super) fn check(self, coloring: Option<&Coloring>, others: &[(bool, &str)]) -> Result<(), Failure> {
        let refused = |why: String| Err(Failure::new(USAGE, format!("--color-bar {why}")));
        if self.color_bar.is_none() {
            return Ok(());
        }
        match coloring {
            Some(Coloring::Column(ByColumn { map: Some(Map::Categories), .. })) => {
                return refused("shows a range of numbers: categories have none".into());
            }
            Some(Coloring::Column(_)) => {}
            _ => {
                return refused(
                    "shows the numbers of a column\n  help: --color-by COLUMN takes colours from one".into(),
                );
            }
        }
        match others.iter().find(|(is_given, _)| *is_given) {
            Some((_, what)) => refused(format!("does not go with {what}")),
            None => Ok(()),
        }
    }

    /// The bar of a picture of the file `name`, if one is wanted.
    pub(super) fn bar(
        self,
        name: &str,
        scale: Option<&ColorScale>,
        size: (u32, u32),
        levels: (Quantize, DVec3),
    ) -> Result<Option<ColorBar>, Failure> {
        let Some(side) = self.color_bar else { return Ok(None) };
        let refused = |why: String| Failure::new(USAGE, format!("{}: --color-bar: {why}", visible(name)));
        let scale = scale.ok_or_else(|| refused("the column of --color-by holds no numbers".into()))?;
        ColorBar::new(scale, side, size, levels).map(Some).map_err(refused)
    }
}

/// What a bar shows, in one line.
pub(super) fn in_words(ColorScale { column, map, range }: &ColorScale) -> String {
    format!("colour bar: {} from {} to {} for {}", map.name(), number(range.0), number(range.1), visible(column))
}
