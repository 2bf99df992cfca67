//! A camera that goes around the spheres once.

use std::f64::consts::TAU;
use std::fmt;

use glam::{DQuat, DVec3};

use super::Placement;
use crate::scene::Scene;

/// There is nothing to go around: no sphere, and no point to look at.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct NoCenter;

impl fmt::Display for NoCenter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a turntable goes around the spheres, and the scene has none\n  help: --look-at X,Y,Z is a centre")
    }
}

impl std::error::Error for NoCenter {}

/// `count` placements at equal angles around the axis along `start.up`, counterclockwise seen from its tip, of which the first is
/// `start` itself: the whole camera turns, so eye and view keep their distance and their angle to the axis.
///
/// The axis goes through `start.look_at`; without it through the middle of the least box around `scene`'s spheres.
///
/// # Errors
///
/// Where there is neither.
pub fn turntable(count: u32, scene: &Scene, start: &Placement) -> Result<Vec<Placement>, NoCenter> {
    let center = start.look_at.or_else(|| middle(scene)).ok_or(NoCenter)?;
    // As far ahead as the centre is away: any point there would do.
    let ahead = (center - start.eye).length().max(scene.window.near);
    let look_at = start.look_at.unwrap_or(start.eye - DVec3::Z * ahead);
    // Scaled first: squares of a long vector overflow.
    let axis = (start.up / start.up.abs().max_element()).normalize();
    let placement = |index: u32| {
        let turn = DQuat::from_axis_angle(axis, TAU * f64::from(index) / f64::from(count));
        let turned = |point: DVec3| center + turn * (point - center);
        Placement { eye: turned(start.eye), look_at: Some(turned(look_at)), ..*start }
    };
    let turned = (1..count).map(placement);
    Ok(std::iter::once(*start).chain(turned).collect())
}

/// The middle of the box around all spheres.
fn middle(scene: &Scene) -> Option<DVec3> {
    let ends = scene.spheres.iter().map(|sphere| {
        let reach = sphere.scale.abs();
        [sphere.center - reach, sphere.center + reach]
    });
    let [low, high] = ends.reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])])?;
    Some(low.midpoint(high))
}
