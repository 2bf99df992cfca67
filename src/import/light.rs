//! The lights of a scene, and the material that suits them.

use std::f64::consts::PI;

use glam::DVec3;

use super::options::Lighting;
use crate::scene::{Light, Sphere};
use crate::view::View;

/// How far lamps are from the middle of the scene, in half diagonals of the box around it.
const DISTANCE: f64 = 10.0;
/// Where the middle of a dome is: upwards, to the left and towards the eye.
const ZENITH: DVec3 = DVec3::new(-0.35, 0.6, 0.72);
/// Key, fill and rim light: direction and intensity.
const THREE: [(DVec3, f64); 3] =
    [(DVec3::new(-0.5, 0.6, 0.62), 0.6), (DVec3::new(0.85, 0.1, 0.5), 0.25), (DVec3::new(0.3, 0.75, -0.6), 0.15)];

/// The lights of a scene of particles, which turn with the eye.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lamps {
    pub(super) lighting: Lighting,
    /// Of the box around the spheres.
    pub(super) middle: DVec3,
    /// Half the diagonal of that box.
    pub(super) size: f64,
}

impl Lamps {
    /// The lights for this eye. Their intensities sum to 1.
    pub fn seen_by(&self, view: &View) -> Vec<Light> {
        let [right, up, back] = view.axes();
        let turned = |direction: DVec3| right * direction.x + up * direction.y + back * direction.z;
        let distance = DISTANCE * self.size;
        let lamp = |direction: DVec3, intensity: f64| Light {
            position: self.middle + turned(direction.normalize()) * distance,
            intensity: DVec3::splat(intensity),
        };
        match self.lighting {
            Lighting::Headlight => vec![Light { position: view.eye, intensity: DVec3::ONE }],
            Lighting::Three => THREE.map(|(direction, intensity)| lamp(direction, intensity)).to_vec(),
            Lighting::Dome(lamps) => dome(lamps).map(|direction| lamp(direction, 1.0 / f64::from(lamps))).collect(),
        }
    }
}

/// The directions of a dome's lamps, a spherical Fibonacci lattice (R. Swinbank and R. J. Purser, Q. J. R. Meteorol. Soc. 132 (2006)
/// 1769) on the disc under the dome: as many lamps are in a part of it as a surface that faces the zenith gets light from there.
fn dome(lamps: u32) -> impl Iterator<Item = DVec3> {
    let golden = PI * (3.0 - 5.0_f64.sqrt());
    let zenith = ZENITH.normalize();
    let (right, up) = zenith.any_orthonormal_pair();
    (0..lamps).map(move |index| {
        let square = (f64::from(index) + 0.5) / f64::from(lamps);
        let (sin, cos) = (golden * f64::from(index)).sin_cos();
        let radius = square.sqrt();
        right * (radius * cos) + up * (radius * sin) + zenith * (1.0 - square).sqrt()
    })
}

/// The material under these lights; the colour of `AMBIENT` is white.
pub(super) fn material(lighting: Lighting) -> Sphere {
    let (ka, kd, ks, n) = match lighting {
        Lighting::Headlight => (0.15, 0.8, 0.15, 30.0),
        Lighting::Three => (0.3, 1.0, 0.25, 30.0),
        // Highlights of many lamps are a haze.
        Lighting::Dome(_) => (0.25, 1.0, 0.0, 1.0),
    };
    Sphere { ka, kd, ks, n, ..Sphere::default() }
}
