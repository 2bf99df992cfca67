//! The eye that a page moves: orbit, flight, turn, zoom.

use glam::{DQuat, DVec3};

use crate::scene::Scene;
use crate::settings::Settings;
use crate::view::{View, ViewError};

/// Coordinates that a page can reach, in world units: their squares are within the range of `f64`.
const FARTHEST: f64 = 1e100;
/// Least angle between the view and the upward direction while turning, in radians.
const LEAST_ANGLE: f64 = 0.02;

/// Where the eye is and where it looks, in the words of `--eye`, `--look-at` and `--up`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pose {
    /// The eye in the world.
    pub eye: DVec3,
    /// What it looks at, and orbits around; ≠ `eye`.
    pub look_at: DVec3,
    /// What is upwards.
    pub up: DVec3,
}

/// How far away the spheres of a scene are: what the steps of a flight are measured in.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FlightScale {
    /// From the file's eye to the middle of the spheres along the view, in world units, > 0.
    pub distance: f64,
}

impl FlightScale {
    /// That of `scene`.
    pub fn of(scene: &Scene) -> Self {
        let depths = scene.spheres.iter().map(|sphere| -sphere.center.z);
        let (low, high) = depths.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), z| (l.min(z), h.max(z)));
        let middle = low.max(0.0).midpoint(high);
        let near = scene.window.near;
        // Both ends may lie beyond reach.
        let distance = if middle.is_finite() { middle.max(2.0 * near) } else { 2.0 * near };
        Self { distance: distance.min(FARTHEST) }
    }
}

impl Pose {
    /// The file's camera; it orbits around the middle of the view at the distance of the spheres.
    pub fn of_file(scale: FlightScale) -> Self {
        Self { eye: DVec3::ZERO, look_at: DVec3::new(0.0, 0.0, -scale.distance), up: DVec3::Y }
    }

    /// An eye that looks along −z, at what is as far away as the spheres are from the file's eye.
    pub fn ahead(eye: DVec3, up: DVec3, scale: FlightScale) -> Self {
        // So near to an eye that is far away, there may be no other number.
        let distance = scale.distance.max(1e-6 * eye.z.abs());
        Self { eye, look_at: eye - DVec3::Z * distance, up }
    }

    /// The pose that an address names.
    ///
    /// # Errors
    ///
    /// Where it is no view, or out of reach.
    pub fn of_address(eye: DVec3, look_at: DVec3, up: DVec3) -> Result<Self, String> {
        let pose = Self { eye, look_at, up };
        pose.view().map_err(|error| error.to_string())?;
        if pose.is_within_reach() { Ok(pose) } else { Err(format!("no coordinate may be beyond {FARTHEST:e}")) }
    }

    /// Whether the picture is that of the file's camera.
    pub fn is_of_file(&self) -> bool {
        self.view() == Ok(View::FILE)
    }

    /// The view that the renderers know.
    ///
    /// # Errors
    ///
    /// Where there is none.
    pub fn view(&self) -> Result<View, ViewError> {
        View::new(self.eye, Some(self.look_at), self.up)
    }

    /// `settings` with this view; unchanged where there is none.
    pub fn apply(&self, settings: &Settings) -> Settings {
        Settings { view: self.view().unwrap_or(settings.view), ..*settings }
    }

    /// Moves the eye around what it looks at, `right` and `up` in radians.
    #[must_use]
    pub fn orbited(self, right: f64, up: f64) -> Self {
        let arm = self.rotated(self.eye - self.look_at, right, up);
        self.accepted(Self { eye: self.look_at + arm, ..self })
    }

    /// Turns the view, `right` and `up` in radians.
    #[must_use]
    pub fn turned(self, right: f64, up: f64) -> Self {
        let ahead = self.rotated(self.look_at - self.eye, -right, up);
        self.accepted(Self { look_at: self.eye + ahead, ..self })
    }

    /// Moves eye and target along the picture's axes, in parts of `scale`.
    #[must_use]
    pub fn flown(self, right: f64, up: f64, forward: f64, scale: FlightScale) -> Self {
        let Ok(view) = self.view() else { return self };
        let [x, y, back] = view.axes();
        let step = (x * right + y * up - back * forward) * scale.distance;
        self.accepted(Self { eye: self.eye + step, look_at: self.look_at + step, ..self })
    }

    /// Multiplies the distance to what it looks at by `factor`.
    #[must_use]
    pub fn zoomed(self, factor: f64, scale: FlightScale) -> Self {
        let (arm, unit) = in_unit(self.eye - self.look_at);
        let length = (arm.length() * factor * unit).clamp(scale.distance * 1e-4, scale.distance * 1e4);
        self.accepted(Self { eye: self.look_at + arm.normalize_or_zero() * length, ..self })
    }

    /// `arm` rotated around the upward direction and then towards it.
    fn rotated(&self, arm: DVec3, around: f64, upwards: f64) -> DVec3 {
        let up = in_unit(self.up).0.normalize_or(DVec3::Y);
        let (arm, unit) = in_unit(arm);
        let arm = DQuat::from_axis_angle(up, around) * arm;
        let sideways = arm.cross(up).normalize_or_zero();
        if sideways == DVec3::ZERO {
            return arm * unit;
        }
        let angle = arm.angle_between(up);
        let wanted = (angle - upwards).clamp(LEAST_ANGLE, std::f64::consts::PI - LEAST_ANGLE);
        DQuat::from_axis_angle(sideways, angle - wanted) * arm * unit
    }

    /// `other` where it is a view within reach, else this one.
    fn accepted(self, other: Self) -> Self {
        if other.is_within_reach() && other.view().is_ok() { other } else { self }
    }

    fn is_within_reach(&self) -> bool {
        [self.eye, self.look_at].iter().all(|v| v.abs().max_element() <= FARTHEST)
    }

    /// Eye, look-at and up.
    pub fn vectors(&self) -> [[f64; 3]; 3] {
        [self.eye, self.look_at, self.up].map(|v| v.to_array())
    }

    /// The options of the command line for this view; empty for the file's camera.
    pub fn options(&self) -> String {
        if self.is_of_file() {
            return String::new();
        }
        // The shortest decimals that read back as the same numbers; `=` keeps a leading minus from being an option.
        let vector = |v: DVec3| format!("{:?},{:?},{:?}", v.x, v.y, v.z);
        format!("--eye={} --look-at={} --up={}", vector(self.eye), vector(self.look_at), vector(self.up))
    }
}

/// `v` in a unit of its own length, so that squares are in range, and that unit.
fn in_unit(v: DVec3) -> (DVec3, f64) {
    let unit = v.abs().max_element();
    if unit > 0.0 { (v / unit, unit) } else { (v, 1.0) }
}
