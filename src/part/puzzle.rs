//! Whether rectangles make a whole picture.

use crate::area::Area;

/// Rectangles beside each other.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Puzzle {
    /// What no rectangle has, from the top.
    pub missing: Vec<Area>,
}

impl Puzzle {
    /// Of a picture of this size; its rectangles lie within it, and none [overlaps](overlap) another.
    pub fn new(size: (u32, u32), areas: &[Area]) -> Self {
        let mut missing: Vec<Area> = Vec::new();
        for [top, bottom] in strips(size.1, areas) {
            for (left, right) in gaps(size.0, areas.iter().filter(|area| area.top <= top && bottom <= area.bottom())) {
                let gap = Area { top, left, width: right - left, height: bottom - top };
                // One that goes on from the strip above is the same.
                let above = missing
                    .iter_mut()
                    .rev()
                    .find(|area| (area.left, area.right(), area.bottom()) == (left, right, top));
                match above {
                    Some(above) => above.height += gap.height,
                    None => missing.push(gap),
                }
            }
        }
        missing.sort_unstable();
        Self { missing }
    }
}

/// The first two rectangles with a pixel in common, by index.
pub fn overlap(areas: &[Area]) -> Option<[usize; 2]> {
    let mut order: Vec<usize> = (0..areas.len()).collect();
    order.sort_unstable_by_key(|&index| areas[index]);
    let meets = |a: Area, b: Area| a.left < b.right() && b.left < a.right() && a.top < b.bottom() && b.top < a.bottom();
    order.iter().enumerate().find_map(|(place, &index)| {
        let below = order[place + 1..].iter().take_while(|&&other| areas[other].top < areas[index].bottom());
        below
            .copied()
            .find(|&other| meets(areas[index], areas[other]))
            .map(|other| [index.min(other), index.max(other)])
    })
}

/// Rows between which no rectangle begins or ends.
fn strips(height: u32, areas: &[Area]) -> Vec<[u32; 2]> {
    let mut rows: Vec<u32> = areas.iter().flat_map(|area| [area.top, area.bottom()]).chain([0, height]).collect();
    rows.sort_unstable();
    rows.dedup();
    rows.windows(2).map(|ends| [ends[0], ends[1]]).collect()
}

/// Columns that none of these has.
fn gaps<'a>(width: u32, areas: impl Iterator<Item = &'a Area>) -> Vec<(u32, u32)> {
    let mut columns: Vec<(u32, u32)> = areas.map(|area| (area.left, area.right())).chain([(width, width)]).collect();
    columns.sort_unstable();
    let mut end = 0;
    let gap = |(left, right): (u32, u32)| {
        let before = std::mem::replace(&mut end, right);
        (before < left).then_some((before, left))
    };
    columns.into_iter().filter_map(gap).collect()
}
