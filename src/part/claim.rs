//! What a picture file is of. It says so itself, in a text of a PNG or a comment of a PPM: one JSON object in a line.

use serde::Serialize;
use serde_json::Value;

use crate::area::Area;
use crate::certificate::{SceneHash, first_difference};
use crate::effects::EffectSet;
use crate::origin::{COMMIT, PROGRAM};
use crate::settings::Settings;

/// The precision of pictures that are the CPU reference's in every pixel, whatever has rendered them.
const CERTIFIED: &str = "certified";

/// Everything that decides the bytes of a picture, and which part of it there is.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Identity {
    program: &'static str,
    commit: Option<&'static str>,
    scene: SceneHash,
    settings: Settings,
    effects: EffectSet,
    depth: u32,
    /// The tier of the kernel, or `certified`.
    precision: String,
    device: String,
    /// Width and height of the whole picture.
    size: [u32; 2],
    /// The part: first column and the one beyond the last, likewise of rows.
    area: [u32; 4],
}

impl Identity {
    /// A picture of this program. `tier` is none where the picture is the CPU reference's in every pixel.
    pub fn new(
        scene: SceneHash,
        settings: &Settings,
        (effects, depth): (EffectSet, u32),
        tier: Option<&str>,
        device: String,
        (size, area): ((u32, u32), Area),
    ) -> Self {
        Self {
            program: PROGRAM,
            commit: COMMIT,
            scene,
            settings: *settings,
            effects,
            depth,
            precision: tier.unwrap_or(CERTIFIED).to_owned(),
            device,
            size: size.into(),
            area: [area.left, area.right(), area.top, area.bottom()],
        }
    }

    /// As it stands in a file.
    pub fn to_line(&self) -> String {
        serde_json::to_string(self).unwrap_or_default()
    }
}

/// What a file claims to be of.
#[derive(Debug, Clone, PartialEq)]
pub struct Claim {
    value: Value,
    /// Width and height of the whole picture.
    pub size: (u32, u32),
    /// The part of it that the file has.
    pub area: Area,
    /// What has rendered it.
    pub device: String,
    is_certified: bool,
}

impl Claim {
    /// From the line of a file whose own picture has this width and height.
    ///
    /// # Errors
    /// In words, where the line is none of [`Identity::to_line`], or the file has another size than its part.
    pub fn parse(line: &str, size: (u32, u32)) -> Result<Self, String> {
        let mut value: Value = serde_json::from_str(line).map_err(|error| format!("its note is damaged: {error}"))?;
        let (Some([width, height]), Some([left, right, top, bottom])) =
            (take(&mut value, "size"), take(&mut value, "area"))
        else {
            return Err("its note does not say which part of a picture it is".into());
        };
        let text = |name: &str| value.get(name).and_then(Value::as_str).map(str::to_owned);
        let (Some(device), Some(precision)) = (text("device"), text("precision")) else {
            return Err("its note does not say what has rendered it".into());
        };
        let ends = right.checked_sub(left).zip(bottom.checked_sub(top));
        let area = ends.map(|(width, height)| Area { top, left, width, height });
        let whole = (width, height);
        let area = area.filter(|area| area.is_of(whole)).ok_or("its note is of no part of a picture")?;
        if area.size() != size {
            return Err(format!(
                "it has {}x{} pixels, and its note is of {}x{}",
                size.0, size.1, area.width, area.height
            ));
        }
        value.as_object_mut().map(|fields| fields.remove("device"));
        Ok(Self { value, size: whole, area, device, is_certified: precision == CERTIFIED })
    }

    /// What makes the other a part of another picture: the field and its values here and there. Devices do not.
    pub fn difference(&self, other: &Self) -> Option<[String; 3]> {
        if self.size != other.size {
            let [own, others] = [self.size, other.size].map(|(width, height)| format!("{width}x{height}"));
            return Some(["size".into(), own, others]);
        }
        let names = [self, other].map(|claim| claim.value.as_object().into_iter().flat_map(|fields| fields.keys()));
        first_difference(&self.value, &other.value, names.into_iter().flatten())
    }

    /// Whether the same device has rendered both, or each pixel is the CPU reference's, which is the same everywhere.
    pub fn rounds_like(&self, other: &Self) -> bool {
        self.is_certified && other.is_certified || self.device == other.device
    }
}

/// Takes an array of numbers out of an object.
fn take<const N: usize>(value: &mut Value, name: &str) -> Option<[u32; N]> {
    let found = value.as_object_mut()?.remove(name)?;
    let numbers: Option<Vec<u32>> = found.as_array()?.iter().map(|number| number.as_u64()?.try_into().ok()).collect();
    numbers?.try_into().ok()
}
