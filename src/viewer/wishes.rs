//! What a page wishes to see, and the command line that renders it.

use super::pose::{Pose, Range};
use super::protocol::FromPage;
use crate::effects;
use crate::precision;
use crate::scene::{MAX_RESOLUTION, Scene};
use crate::settings::Settings;

/// The picture that a page wishes.
#[derive(Debug, Clone, PartialEq)]
pub struct Wishes {
    /// The view; `None` is the file's camera.
    pub pose: Option<Pose>,
    /// Conventions, depth, samples; its view is that of the start.
    pub settings: Settings,
    /// The effects.
    pub effects: effects::Request,
    /// The tier.
    pub precision: precision::Request,
    /// Size of the picture in place of the scene's.
    pub res: Option<(u32, u32)>,
}

impl Wishes {
    /// Does what the page asks where that changes the picture; a message says why it cannot be.
    pub fn heed(&mut self, message: &FromPage, range: Range, start: &Self) -> Result<(), String> {
        let pose = self.pose.unwrap_or(Pose::of_file(range));
        match *message {
            FromPage::Orbit { right, up } => self.pose = Some(pose.orbited(right, up)),
            FromPage::Turn { right, up } => self.pose = Some(pose.turned(right, up)),
            FromPage::Fly { right, up, forward } => self.pose = Some(pose.flown(right, up, forward, range)),
            FromPage::Zoom { by } => self.pose = Some(pose.zoomed(by, range)),
            FromPage::Reset => self.pose = start.pose,
            FromPage::Choose { .. } => self.choose(message, start)?,
            FromPage::Ack { .. }
            | FromPage::Pick { .. }
            | FromPage::Save
            | FromPage::Measure
            | FromPage::Gaze { .. }
            | FromPage::Attend { .. } => {}
        }
        Ok(())
    }

    fn choose(&mut self, message: &FromPage, start: &Self) -> Result<(), String> {
        let FromPage::Choose { convention, effects, precision, max_depth, spp, res } = message else { return Ok(()) };
        let mut wishes = self.clone();
        if let Some(name) = convention {
            let convention = match name.as_str() {
                "classic" => Settings::classic(),
                "exact" => Settings::exact(),
                "start" => start.settings,
                _ => return Err(format!("no convention is called '{name}'")),
            };
            let Settings { view, max_depth, samples, .. } = wishes.settings;
            wishes.settings = Settings { view, max_depth, samples, ..convention };
        }
        if let Some(text) = effects {
            wishes.effects = text.parse()?;
        }
        if let Some(text) = precision {
            wishes.precision = text.parse()?;
        }
        if let Some(depth) = *max_depth {
            if depth > Settings::MAX_DEPTH {
                return Err(format!("the depth is {} at the most", Settings::MAX_DEPTH));
            }
            wishes.settings.max_depth = depth;
        }
        if let Some(count) = *spp {
            wishes.settings.samples = Settings::samples_side(count)?;
        }
        if let Some(text) = res {
            wishes.res = if text.is_empty() { None } else { Some(size(text)?) };
        }
        *self = wishes;
        Ok(())
    }

    /// Settings with the wished view.
    pub fn settings(&self) -> Settings {
        self.pose.map_or(self.settings, |pose| pose.apply(&self.settings))
    }

    /// Size of the picture of `scene`.
    pub fn size(&self, scene: &Scene) -> (u32, u32) {
        self.res.unwrap_or((scene.width, scene.height))
    }

    /// The options of `trueray render` that give this very picture, at `size` where it is not the scene's.
    pub fn options(&self, size: Option<(u32, u32)>) -> String {
        let mut words = Vec::new();
        let classic = Settings::classic();
        let Settings { sampling, quantize, secondary, specular, max_depth, samples, .. } = self.settings;
        if self.settings == (Settings { max_depth, samples, view: self.settings.view, ..Settings::exact() }) {
            words.push("--convention exact".into());
        } else {
            let name = |value: serde_json::Result<serde_json::Value>| {
                value.ok().and_then(|value| value.as_str().map(str::to_owned)).unwrap_or_default()
            };
            if sampling != classic.sampling {
                words.push(format!("--sampling {}", name(serde_json::to_value(sampling))));
            }
            if quantize != classic.quantize {
                words.push(format!("--quantize {}", name(serde_json::to_value(quantize))));
            }
            if secondary != classic.secondary {
                words.push(format!("--secondary-epsilon {:?}", secondary.shadow));
            }
            if specular != classic.specular {
                words.push(format!("--specular {}", name(serde_json::to_value(specular))));
            }
        }
        if max_depth != classic.max_depth {
            words.push(format!("--max-depth {max_depth}"));
        }
        if samples != classic.samples {
            words.push(format!("--spp {}", samples * samples));
        }
        if self.effects != effects::Request::Auto {
            words.push(format!("--effects={}", self.effects));
        }
        if self.precision != precision::Request::default() {
            words.push(format!("--precision {}", self.precision));
        }
        if let Some((width, height)) = size {
            words.push(format!("--res {width}x{height}"));
        }
        words.extend(self.pose.map(|pose| pose.options()).filter(|options| !options.is_empty()));
        words.join(" ")
    }
}

fn size(text: &str) -> Result<(u32, u32), String> {
    let side = |text: &str| text.trim().parse().ok().filter(|side| (1..=MAX_RESOLUTION).contains(side));
    text.split_once(['x', 'X', '×'])
        .and_then(|(width, height)| Some((side(width)?, side(height)?)))
        .ok_or_else(|| format!("'{text}' is no size such as 640x480"))
}
