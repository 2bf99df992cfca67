//! The state that a page is told.

use super::{Context, Job, SessionRenderer};
use crate::engine::device_name;
use crate::viewer::messages::{Controls, PageMessage, PageState, SceneSummary};

impl SessionRenderer<'_> {
    /// Tells the page its state.
    pub(super) fn send_state(&mut self, context: &Context) {
        self.tell = false;
        let Some(job) = &self.job else { return };
        let Job { view, settings, effects, selection, size, .. } = job;
        self.heard = self.session.heard_of(job.version).unwrap_or(self.heard);
        let (scene, shown) = (&*context.scene, &self.shown);
        let state = PageState {
            version: job.version,
            heard: self.heard,
            finished: self.finished(),
            size: *size,
            shrunk: *size != view.size(scene),
            step: shown.step,
            samples: shown.samples,
            sampled: shown.sampled,
            preview: self.session.preview(),
            frame_ms: shown.frame_ms,
            times: shown.times,
            not_finite: shown.not_finite,
            device: device_name(self.gpu),
            effects: &effects.rows,
            tier: selection.tier,
            tier_reason: &selection.reason,
            controls: Controls {
                convention: settings.convention(),
                precision: view.precision.to_string(),
                max_depth: settings.max_depth,
                spp: settings.pattern.count(),
                res: view.res.map_or_else(String::new, |(width, height)| format!("{width}x{height}")),
            },
            eye: settings.view.eye.to_array(),
            camera: view.pose.filter(|pose| !pose.is_of_file()).map(|pose| pose.vectors()),
            options: view.options((*size != (scene.width, scene.height)).then_some(*size)),
            scene: SceneSummary { file: context.scene_file, spheres: scene.spheres.len(), lights: scene.lights.len() },
            error: context.error,
            problem: self.problem.as_deref(),
        };
        self.session.send(&PageMessage::State(Box::new(state)));
    }
}
