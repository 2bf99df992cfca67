//! Where two pictures differ most, and on which spheres.

use std::collections::BTreeMap;

use rayon::prelude::*;

use super::{SizeMismatch, level};
use crate::cpu::picked;
use crate::film::Picture;
use crate::viewed::ViewedScene;

/// How far places are apart at least, in columns or in rows.
const APART: u32 = 9;
/// Spheres are tried for this many pixels at the most, times their number.
const MOST_TESTS: usize = 20_000_000;

/// Up to `most` pixels (column, row) with the greatest level differences, the worst first, none of them near a worse one.
///
/// # Errors
/// Pictures of different sizes.
pub fn worst_places(a: &Picture, b: &Picture, most: usize) -> Result<Vec<[u32; 2]>, SizeMismatch> {
    SizeMismatch::check(a, b)?;
    // By level, each in reading order.
    let mut by_level: Vec<Vec<u64>> = vec![Vec::new(); 256];
    for (at, (&a, &b)) in (0..).zip(a.pixels().iter().zip(b.pixels())) {
        by_level[usize::from(level(a, b))].push(at);
    }
    let width = u64::from(a.width());
    let mut places: Vec<[u32; 2]> = Vec::new();
    for at in by_level[1..].iter().rev().flatten() {
        if places.len() == most {
            break;
        }
        let [x, y] = [(at % width) as u32, (at / width) as u32];
        if places.iter().all(|place| place[0].abs_diff(x) >= APART || place[1].abs_diff(y) >= APART) {
            places.push([x, y]);
        }
    }
    Ok(places)
}

/// How many pixels differ on a sphere.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct OnSphere {
    /// The sphere's index; `None` is the background.
    pub sphere: Option<usize>,
    /// Pixels that differ.
    pub differing: u64,
    /// Those of them that nothing explains.
    pub unexplained: u64,
}

/// Differing pixels by what they show.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct BySphere {
    /// Most unexplained first, then most differing.
    pub counts: Vec<OnSphere>,
    /// Every so many-th of the differing pixels is counted: 1 unless pixels and spheres are many.
    pub step: usize,
}

impl BySphere {
    /// Of the pixels in which `picture` differs from `expected`, the picture of `viewed`; `unexplained` are those, by column and row
    /// in reading order, that nothing explains.
    ///
    /// # Errors
    /// Pictures of different sizes.
    pub fn of(
        picture: &Picture,
        expected: &Picture,
        viewed: &ViewedScene,
        unexplained: &[[u32; 2]],
    ) -> Result<Self, SizeMismatch> {
        SizeMismatch::check(picture, expected)?;
        let width = picture.width() as usize;
        let pairs = picture.pixels().iter().zip(expected.pixels()).enumerate();
        let differing: Vec<[u32; 2]> =
            pairs.filter(|(_, (a, b))| a != b).map(|(at, _)| [(at % width) as u32, (at / width) as u32]).collect();
        let tests = differing.len().saturating_mul(viewed.scene().spheres.len());
        let step = tests.div_ceil(MOST_TESTS).max(1);
        let shown: Vec<_> = differing
            .par_iter()
            .step_by(step)
            .map(|&[x, y]| {
                // Both lists are in reading order.
                let is_unexplained = unexplained.binary_search_by_key(&(y, x), |&[x, y]| (y, x)).is_ok();
                (picked(viewed, x, y).map(|hit| hit.sphere), is_unexplained)
            })
            .collect();
        let mut counts: BTreeMap<Option<usize>, [u64; 2]> = BTreeMap::new();
        for (sphere, is_unexplained) in shown {
            let [differing, unexplained] = counts.entry(sphere).or_default();
            *differing += 1;
            *unexplained += u64::from(is_unexplained);
        }
        let on_sphere = |(sphere, [differing, unexplained]): (_, [u64; 2])| OnSphere { sphere, differing, unexplained };
        let mut counts: Vec<_> = counts.into_iter().map(on_sphere).collect();
        counts.sort_by_key(|on| std::cmp::Reverse((on.unexplained, on.differing)));
        Ok(Self { counts, step })
    }
}
