//! A rectangle of a picture's pixels.

use std::fmt;
use std::str::FromStr;

use crate::misuse::Misuse;
use crate::tiles::TILE;

/// A rectangle of pixels: columns to the right from `left`, rows downwards from `top`. As text it is `X0,X1,Y0,Y1`, half-open.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Area {
    /// First row.
    pub top: u32,
    /// First column.
    pub left: u32,
    /// Number of columns.
    pub width: u32,
    /// Number of rows.
    pub height: u32,
}

impl Area {
    /// All pixels of a picture of this width and height.
    pub fn whole((width, height): (u32, u32)) -> Self {
        Self { top: 0, left: 0, width, height }
    }

    /// Part `index` of `count`, from 0, of a picture of this size: whole rows, as many in each part as can be. As long as there are
    /// enough of them, parts are of whole tiles, so that none is rendered twice.
    ///
    /// # Errors
    ///
    /// [`Misuse::Tile`] where there is no such part, or where the picture has fewer rows than parts.
    pub fn tile(index: u32, count: u32, size: (u32, u32)) -> Result<Self, Misuse> {
        if index >= count || count > size.1 {
            return Err(Misuse::Tile { index, count, height: size.1 });
        }
        let tiles = size.1.div_ceil(TILE);
        let (units, rows) = if count <= tiles { (tiles, TILE) } else { (size.1, 1) };
        let begin = |part: u32| {
            let unit = u64::from(units) * u64::from(part) / u64::from(count);
            (unit * u64::from(rows)).min(u64::from(size.1)) as u32
        };
        Ok(Self { top: begin(index), height: begin(index + 1) - begin(index), ..Self::whole(size) })
    }

    /// Width and height.
    pub fn size(self) -> (u32, u32) {
        (self.width, self.height)
    }

    /// The column beyond the last.
    pub fn right(self) -> u32 {
        self.left + self.width
    }

    /// The row beyond the last.
    pub fn bottom(self) -> u32 {
        self.top + self.height
    }

    /// Whether it has the pixel in this column and row.
    pub fn has(self, [x, y]: [u32; 2]) -> bool {
        (self.left..self.right()).contains(&x) && (self.top..self.bottom()).contains(&y)
    }

    /// Where among its pixels, row by row, the one in this column and row is; it has to be one of them.
    pub fn index(self, [x, y]: [u32; 2]) -> usize {
        (y - self.top) as usize * self.width as usize + (x - self.left) as usize
    }

    /// Whether it has any pixel, and none that a picture of this size has not.
    pub fn is_of(self, (width, height): (u32, u32)) -> bool {
        let fits = |first: u32, count: u32, all: u32| count > 0 && first < all && count <= all - first;
        fits(self.left, self.width, width) && fits(self.top, self.height, height)
    }
}

impl fmt::Display for Area {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{},{},{},{}", self.left, self.right(), self.top, self.bottom())
    }
}

impl FromStr for Area {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let numbers: Option<Vec<u32>> = text.split(',').map(|number| number.trim().parse().ok()).collect();
        match numbers.as_deref() {
            Some(&[left, right, top, bottom]) if left < right && top < bottom => {
                Ok(Self { top, left, width: right - left, height: bottom - top })
            }
            Some([_, _, _, _]) => Err("the rectangle is empty: expected X0 below X1 and Y0 below Y1".into()),
            _ => Err("expected four numbers X0,X1,Y0,Y1 such as 0,320,240,480".into()),
        }
    }
}
