//! Typical mistakes that make one picture of another: moved by a row, upside down, channels exchanged, rounded.

use std::cmp::Ordering;
use std::fmt;

use serde::Serialize;

use super::Difference;
use crate::film::Picture;
use crate::words::count;

/// A change of the first picture that makes it resemble the second.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Resemblance {
    /// The change.
    pub kind: ResemblanceKind,
    /// Pixels that both pictures have after the change.
    pub compared: u64,
    /// How many of those still differ.
    pub differing: u64,
}

/// Changes that are looked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ResemblanceKind {
    /// B is A moved up by one row.
    MovedUp,
    /// B is A moved down by one row.
    MovedDown,
    /// B is A moved left by one column.
    MovedLeft,
    /// B is A moved right by one column.
    MovedRight,
    /// B is A upside down.
    FlippedVertically,
    /// B is A with left and right exchanged.
    FlippedHorizontally,
    /// B is A with red and blue exchanged.
    RedBlueSwapped,
    /// B is brighter by one level wherever the two differ, in many places.
    OneLevelBrighter,
    /// B is darker by one level wherever the two differ, in many places.
    OneLevelDarker,
    /// B is brighter by one level in the more places the brighter they are, as ⌊255.9·c⌋ is than ⌊255·c⌋.
    OverscaledBrighter,
    /// B is darker by one level in the more places the brighter they are.
    OverscaledDarker,
}

impl fmt::Display for ResemblanceKind {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(match self {
            Self::MovedUp => "A moved up by one row (B sampled at the pixels' bottom edge, A at the top one?)",
            Self::MovedDown => "A moved down by one row (A sampled at the pixels' bottom edge, B at the top one?)",
            Self::MovedLeft => "A moved left by one column (B sampled at the pixels' right edge, A at the left one?)",
            Self::MovedRight => "A moved right by one column (A sampled at the pixels' right edge, B at the left one?)",
            Self::FlippedVertically => "A upside down (rows written from bottom to top?)",
            Self::FlippedHorizontally => "A with left and right exchanged",
            Self::RedBlueSwapped => "A with red and blue exchanged (BGR written as RGB?)",
            Self::OneLevelBrighter => "A, in parts one level brighter (A truncated to 8 bits, B rounded?)",
            Self::OneLevelDarker => "A, in parts one level darker (A rounded to 8 bits, B truncated?)",
            Self::OverscaledBrighter => {
                "A, the more one level brighter the brighter it is (A × 255, B × 255.9, both truncated?)"
            }
            Self::OverscaledDarker => {
                "A, the more one level darker the brighter it is (A × 255.9, B × 255, both truncated?)"
            }
        })
    }
}

impl fmt::Display for Resemblance {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let Self { kind, compared, differing } = self;
        match kind {
            ResemblanceKind::OneLevelBrighter
            | ResemblanceKind::OneLevelDarker
            | ResemblanceKind::OverscaledBrighter
            | ResemblanceKind::OverscaledDarker => write!(f, "B looks like {kind}"),
            _ => write!(f, "B looks like {kind}: {differing} of {} differ then", count(*compared, "pixel")),
        }
    }
}

/// All changes that leave less than a tenth of the differing pixels, the best one first.
pub(super) fn find(a: &Picture, b: &Picture, difference: &Difference) -> Vec<Resemblance> {
    let differing = difference.differing.over_0;
    if differing == 0 {
        return Vec::new();
    }
    let mut found: Vec<Resemblance> = moves()
        .into_iter()
        .filter_map(|step| step.resemblance(a, b))
        .chain(turned(a, b, differing))
        .chain(one_sided(a, b, difference))
        .collect();
    found.sort_by_key(|resemblance| resemblance.differing);
    found
}

/// How many differences a change may leave of so many; `None` if there were none to explain.
fn tolerable(differing: u64) -> Option<u64> {
    Some(differing.checked_sub(1)? / 10)
}

/// Counts differing pixels, but gives up on more than `limit`.
struct Count {
    differing: u64,
    limit: u64,
}

impl Count {
    fn up_to(limit: u64) -> Self {
        Self { differing: 0, limit }
    }

    fn add<'a>(
        &mut self,
        a: impl IntoIterator<Item = &'a [u8; 3]>,
        b: impl IntoIterator<Item = [u8; 3]>,
    ) -> Option<()> {
        self.differing += a.into_iter().zip(b).filter(|&(&a, b)| a != b).count() as u64;
        (self.differing <= self.limit).then_some(())
    }

    /// As `add`, but fast for rows that are mostly the same.
    fn add_row(&mut self, a: &[[u8; 3]], b: &[[u8; 3]]) -> Option<()> {
        if a == b { Some(()) } else { self.add(a, b.iter().copied()) }
    }
}

/// A move by one pixel.
struct Move {
    kind: ResemblanceKind,
    x: i32,
    y: i32,
}

fn moves() -> [Move; 4] {
    let step = |kind, x, y| Move { kind, x, y };
    [
        step(ResemblanceKind::MovedUp, 0, -1),
        step(ResemblanceKind::MovedDown, 0, 1),
        step(ResemblanceKind::MovedLeft, -1, 0),
        step(ResemblanceKind::MovedRight, 1, 0),
    ]
}

/// The first pixel of a window in A, the first one in B, and the window's size.
type Windows = ([u32; 2], [u32; 2], [u32; 2]);

impl Move {
    fn resemblance(&self, a: &Picture, b: &Picture) -> Option<Resemblance> {
        // What would have to be explained: differences outside the rows or columns that such a move drops anyway.
        let limit = tolerable(differing_in(a, b, self.inside(a)?, u64::MAX)?)?;
        let windows = self.overlap(a);
        let differing = differing_in(a, b, windows, limit)?;
        let [width, height] = windows.2;
        Some(Resemblance { kind: self.kind, compared: width as u64 * height as u64, differing })
    }

    /// The picture without the outermost rows or columns along the move; `None` if nothing is left.
    fn inside(&self, picture: &Picture) -> Option<Windows> {
        let (x, y) = (self.x.unsigned_abs(), self.y.unsigned_abs());
        let size = [picture.width().checked_sub(2 * x)?, picture.height().checked_sub(2 * y)?];
        Some(([x, y], [x, y], size))
    }

    /// What both pictures show after the move.
    fn overlap(&self, picture: &Picture) -> Windows {
        let start = |step: i32| [(-step).max(0) as u32, step.max(0) as u32];
        let ([a_x, b_x], [a_y, b_y]) = (start(self.x), start(self.y));
        let size = [picture.width() - self.x.unsigned_abs(), picture.height() - self.y.unsigned_abs()];
        ([a_x, a_y], [b_x, b_y], size)
    }
}

fn differing_in(a: &Picture, b: &Picture, (from_a, from_b, [width, height]): Windows, limit: u64) -> Option<u64> {
    let mut count = Count::up_to(limit);
    for y in 0..height {
        let row_a = &a.row(from_a[1] + y)[from_a[0] as usize..][..width as usize];
        let row_b = &b.row(from_b[1] + y)[from_b[0] as usize..][..width as usize];
        count.add_row(row_a, row_b)?;
    }
    Some(count.differing)
}

/// Flips and exchanged channels.
fn turned(a: &Picture, b: &Picture, differing: u64) -> impl Iterator<Item = Resemblance> {
    let rows = || a.rows().zip(b.rows());
    let attempt = |kind, count: &dyn Fn(&mut Count) -> Option<()>| {
        let mut counted = Count::up_to(tolerable(differing)?);
        count(&mut counted)?;
        Some(Resemblance { kind, compared: a.pixel_count(), differing: counted.differing })
    };
    let found = [
        attempt(ResemblanceKind::FlippedVertically, &|count| {
            a.rows().zip(b.rows().rev()).try_for_each(|(row_a, row_b)| count.add_row(row_a, row_b))
        }),
        attempt(ResemblanceKind::FlippedHorizontally, &|count| {
            rows().try_for_each(|(row_a, row_b)| count.add(row_a, row_b.iter().rev().copied()))
        }),
        attempt(ResemblanceKind::RedBlueSwapped, &|count| {
            rows().try_for_each(|(row_a, row_b)| {
                count.add(row_a, row_b.iter().map(|&[red, green, blue]| [blue, green, red]))
            })
        }),
    ];
    found.into_iter().flatten()
}

/// One picture quantized in another way: single levels, all in one direction, in at least a twentieth of the picture.
fn one_sided(a: &Picture, b: &Picture, difference: &Difference) -> Option<Resemblance> {
    let Difference { pixels, differing, max_level, .. } = *difference;
    if max_level != 1 || differing.over_0 < pixels.div_ceil(20) {
        return None;
    }
    let mut orders = a.rgb().iter().zip(b.rgb()).map(|(a, b)| b.cmp(a)).filter(|order| order.is_ne());
    let first = orders.next()?;
    if !orders.all(|order| order == first) {
        return None;
    }
    let (darker, brighter) = if first == Ordering::Greater { (a, b) } else { (b, a) };
    let kind = match (first, is_overscaled(darker, brighter)) {
        (Ordering::Greater, false) => ResemblanceKind::OneLevelBrighter,
        (Ordering::Greater, true) => ResemblanceKind::OverscaledBrighter,
        (_, false) => ResemblanceKind::OneLevelDarker,
        (_, true) => ResemblanceKind::OverscaledDarker,
    };
    Some(Resemblance { kind, compared: pixels, differing: differing.over_0 })
}

/// So few samples of a level say nothing of how often it differs.
const LEAST_SAMPLES: u32 = 8;

/// Whether the brighter of two pictures looks like ⌊255.9·c⌋ beside ⌊255·c⌋ rather than like 255·c rounded: at level v, 0.9·v/255 of
/// its samples are greater then, not one half. All levels weigh the same, so that a flat background is only one voice.
fn is_overscaled(darker: &Picture, brighter: &Picture) -> bool {
    let mut counts = [[0_u32; 2]; 256];
    for (&dark, &bright) in darker.rgb().iter().zip(brighter.rgb()) {
        counts[dark as usize][usize::from(dark != bright)] += 1;
    }
    // Black and white are often clamped, and white cannot be greater.
    let levels = (1..255).filter(|&level: &usize| counts[level].iter().sum::<u32>() >= LEAST_SAMPLES);
    let (mut rounded, mut overscaled) = (0.0, 0.0);
    for level in levels {
        let [same, greater] = counts[level].map(f64::from);
        let share = greater / (same + greater);
        rounded += (share - 0.5).powi(2);
        overscaled += (share - 0.9 * level as f64 / 255.0).powi(2);
    }
    overscaled < rounded
}
