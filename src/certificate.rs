//! What a certified picture is certified by: what it is of, who calculated it, and how.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use serde::Serialize;
use serde_json::Value;
use sha2::{Digest, Sha256};

use crate::effects::{EffectSet, Effects};
use crate::engine::Stages;
use crate::precision::Tier;
use crate::roundings::counted;
use crate::scene::{Names, Scene};
use crate::settings::Settings;

/// What a certificate says.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Certificate {
    #[serde(flatten)]
    subject: Subject,
    /// What rendered it, in words.
    pub device: String,
    /// The tier of its first kernel; none where the CPU reference calculated all of it.
    pub kernel: Option<Tier>,
    /// How many pixels are right by which stage.
    pub stages: Stages,
    /// What the bounds of error count with, by the names of `src/roundings.rs`.
    pub roundings: BTreeMap<String, f64>,
}

/// What a certificate is of: nobody else's picture has all of this.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Subject {
    scene: SceneHash,
    settings: Settings,
    effects: EffectSet,
    /// As many bounces as the scene has use for.
    depth: u32,
    picture: PictureHash,
}

/// What a scene is told by.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct SceneHash {
    spheres: usize,
    lights: usize,
    /// Of its numbers as a scene file has them, with as many digits as it takes to read them back unchanged, and without labels and
    /// OUTPUT.
    sha256: String,
}

impl SceneHash {
    /// Of the numbers of `scene`, its size included.
    pub fn of(scene: &Scene) -> Self {
        let (sphere_names, light_names) = (Names::default(), Names::default());
        let plain = Scene { sphere_names, light_names, output: None, ..scene.clone() };
        let sha256 = hex(Sha256::digest(plain.to_string()));
        Self { spheres: scene.spheres.len(), lights: scene.lights.len(), sha256 }
    }

    /// The hash in hexadecimal digits.
    pub fn sha256(&self) -> &str {
        &self.sha256
    }
}

/// What a picture is told by.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct PictureHash {
    width: u32,
    height: u32,
    /// Of a level.
    bits: u8,
    /// Of its P6 file, of 8 or 16 bits, whatever format it is stored in.
    sha256: String,
}

/// The bits of a level.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(missing_docs, reason = "the names say all")]
pub enum Bits {
    Eight = 8,
    Sixteen = 16,
}

impl PictureHash {
    /// The hash in hexadecimal digits.
    pub fn sha256(&self) -> &str {
        &self.sha256
    }
}

/// The hash of a picture whose rows come one after another.
#[derive(Debug, Clone)]
pub struct PictureHasher {
    size: (u32, u32),
    bits: Bits,
    sha256: Sha256,
}

impl PictureHasher {
    /// For a picture of this width and height, none of whose rows is there yet.
    pub fn new(width: u32, height: u32, bits: Bits) -> Self {
        let greatest = (1_u32 << bits as u32) - 1;
        let sha256 = Sha256::new_with_prefix(format!("P6\n{width} {height}\n{greatest}\n"));
        Self { size: (width, height), bits, sha256 }
    }

    /// Adds a pixel with levels of 16 bits.
    pub fn add_deep(&mut self, levels: [u16; 3]) {
        self.sha256.update(levels.map(u16::to_be_bytes).as_flattened());
    }

    /// Adds rows with levels of 8 bits, 3 bytes a pixel.
    pub fn add(&mut self, rgb: &[u8]) {
        self.sha256.update(rgb);
    }

    /// The hash of all of them.
    pub fn finish(self) -> PictureHash {
        let (width, height) = self.size;
        PictureHash { width, height, bits: self.bits as u8, sha256: hex(self.sha256.finalize()) }
    }
}

fn hex(bytes: impl AsRef<[u8]>) -> String {
    bytes.as_ref().iter().fold(String::new(), |mut text, byte| {
        let _ = write!(text, "{byte:02x}");
        text
    })
}

impl Subject {
    /// A picture of this scene.
    pub fn new(scene: SceneHash, settings: &Settings, effects: &Effects, picture: PictureHash) -> Self {
        Self { scene, settings: *settings, effects: effects.set, depth: effects.depth, picture }
    }

    /// The first field in which the certificate `text` is of something else, with both values; none where it is of this.
    ///
    /// # Errors
    ///
    /// Where the text is no certificate.
    pub fn mismatch(&self, text: &str) -> Result<Option<String>, String> {
        let certificate: Value = serde_json::from_str(text).map_err(|error| error.to_string())?;
        let own: Value = serde_json::to_string(self)
            .and_then(|text| serde_json::from_str(&text))
            .map_err(|error| error.to_string())?;
        let names = || own.as_object().into_iter().flat_map(|fields| fields.keys());
        if let Some(name) = names().find(|name| certificate.get(name).is_none()) {
            return Err(format!("it does not say of which {name} it is"));
        }
        let found = first_difference(&certificate, &own, names());
        Ok(found.map(|[name, there, here]| format!("{name} is {there} there and {here} here")))
    }
}

/// What a picture is of, causes before what follows from them.
const CAUSES: [&str; 7] = ["program", "commit", "scene", "settings", "effects", "depth", "precision"];

/// The first of these fields, causes first, in which two objects differ, and both of its values.
pub(crate) fn first_difference<'a>(
    first: &Value,
    second: &Value,
    names: impl IntoIterator<Item = &'a String>,
) -> Option<[String; 3]> {
    let mut names: Vec<&String> = names.into_iter().collect();
    names.sort_by_key(|name| CAUSES.iter().position(|cause| cause == name).unwrap_or(CAUSES.len()));
    names.into_iter().find_map(|name| difference(name, &first[name], &second[name]))
}

/// The first field in which two values differ that `name` stands for, and both of its values. What one has not is `none`.
fn difference(name: &str, first: &Value, second: &Value) -> Option<[String; 3]> {
    match (first, second) {
        (Value::Object(fields), Value::Object(others)) => others
            .keys()
            .chain(fields.keys())
            .find_map(|key| difference(&format!("{name}.{key}"), &first[key], &second[key])),
        (first, second) if first == second => None,
        (first, second) => {
            let shown = |value: &Value| if value.is_null() { "none".to_owned() } else { value.to_string() };
            Some([name.to_owned(), shown(first), shown(second)])
        }
    }
}

impl Certificate {
    /// Of a picture that `device` rendered.
    pub fn new(subject: Subject, device: String, kernel: Option<Tier>, stages: Stages) -> Self {
        Self { subject, device, kernel, stages, roundings: counted() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Window;

    fn subject(settings: &Settings, level: u8) -> Subject {
        let scene = Scene::new(Window::default(), 1, 1);
        let mut picture = PictureHasher::new(1, 1, Bits::Eight);
        picture.add(&[level; 3]);
        Subject::new(SceneHash::of(&scene), settings, &Effects::of(&scene.viewed(settings)), picture.finish())
    }

    #[test]
    fn the_hash_of_a_picture_is_that_of_its_file() {
        let mut hasher = PictureHasher::new(2, 1, Bits::Eight);
        hasher.add(&[1, 2, 3]);
        hasher.add(&[4, 5, 6]);
        // sha256sum says so.
        let expected = hex(Sha256::digest(b"P6\n2 1\n255\n\x01\x02\x03\x04\x05\x06"));
        assert_eq!(hasher.finish().sha256, expected);
        let mut hasher = PictureHasher::new(1, 1, Bits::Sixteen);
        hasher.add_deep([1, 0x0203, 0xffff]);
        assert_eq!(hasher.finish().sha256, hex(Sha256::digest(b"P6\n1 1\n65535\n\x00\x01\x02\x03\xff\xff")));
        assert_eq!(hex([0, 10, 255]), "000aff");
    }

    #[test]
    fn a_certificate_is_of_one_picture_under_one_name_for_each_part() {
        let mut settings = Settings::exact();
        settings.secondary.shadow = 0.1;
        let own = subject(&settings, 7);
        let certificate = Certificate::new(own.clone(), "card".into(), Some(Tier::Fast), Stages::default());
        let text = serde_json::to_string_pretty(&certificate).unwrap_or_default();
        assert_eq!(own.mismatch(&text), Ok(None));
        let other = subject(&settings, 8).mismatch(&text);
        assert!(other.is_ok_and(|found| found.is_some_and(|found| found.starts_with("picture.sha256 is \""))));
        settings.secondary.shadow = 0.1_f64.next_up();
        let found = subject(&settings, 7).mismatch(&text);
        let expected = "settings.secondary.shadow is 0.1 there and 0.10000000000000002 here";
        assert_eq!(found, Ok(Some(expected.to_owned())));
        assert_eq!(own.mismatch("{}"), Err("it does not say of which depth it is".to_owned()));
        assert!(own.mismatch("P6").is_err());
    }
}
