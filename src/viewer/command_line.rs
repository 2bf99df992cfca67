//! The command line that renders what a page shows.

use super::view_state::ViewState;
use crate::effects;
use crate::pattern::Pattern;
use crate::precision;
use crate::settings::{Convention, Settings};

impl ViewState {
    /// The options of `trueray render` that give this very picture, at `size` where it is not the scene's.
    pub fn options(&self, size: Option<(u32, u32)>) -> String {
        let mut options = Vec::new();
        let classic = Settings::classic();
        let name = |value: serde_json::Result<serde_json::Value>| {
            value.ok().and_then(|value| value.as_str().map(str::to_owned)).unwrap_or_default()
        };
        let Settings { sampling, quantize, secondary, specular, max_depth, pattern, .. } = self.settings;
        if self.settings.convention() == Some(Convention::Exact) {
            options.push("--convention exact".into());
        } else {
            if sampling != classic.sampling {
                options.push(format!("--sampling {}", name(serde_json::to_value(sampling))));
            }
            if quantize != classic.quantize {
                options.push(format!("--quantize {}", name(serde_json::to_value(quantize))));
            }
            if secondary != classic.secondary {
                options.push(format!("--secondary-epsilon {:?}", secondary.shadow));
            }
            if specular != classic.specular {
                options.push(format!("--specular {}", name(serde_json::to_value(specular))));
            }
        }
        if max_depth != classic.max_depth {
            options.push(format!("--max-depth {max_depth}"));
        }
        if let Pattern::Fibonacci { filter, .. } = pattern {
            options.push(format!("--pattern fibonacci --filter {}", name(serde_json::to_value(filter))));
        }
        if pattern.count() > 1 {
            options.push(format!("--spp {}", pattern.count()));
        }
        if self.effects != effects::Request::Auto {
            options.push(format!("--effects={}", self.effects));
        }
        if self.precision != precision::Request::default() {
            options.push(format!("--precision {}", self.precision));
        }
        if let Some((width, height)) = size {
            options.push(format!("--res {width}x{height}"));
        }
        options.extend(self.fov.map(|fov| format!("--fov {:?}", fov.degrees())));
        options.extend(self.pose.map(|pose| pose.options()).filter(|pose| !pose.is_empty()));
        options.join(" ")
    }
}
