//! What a page shows: view, settings, effects, tier and size.

use super::pose::{FlightScale, Pose};
use super::requests::PageRequest;
use crate::effects;
use crate::precision;
use crate::scene::{Fov, Scene, resolution};
use crate::settings::{Convention, Settings};

/// The picture that a page asks for.
#[derive(Debug, Clone, PartialEq)]
pub struct ViewState {
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
    /// The field of view in place of the scene's window.
    pub fov: Option<Fov>,
}

impl ViewState {
    /// Does what the page asks where that changes the picture; a message says why it cannot be.
    pub fn apply(&mut self, request: &PageRequest, scale: FlightScale, start: &Self) -> Result<(), String> {
        let pose = self.pose.unwrap_or(Pose::of_file(scale));
        match *request {
            PageRequest::Orbit { right, up } => self.pose = Some(pose.orbited(right, up)),
            PageRequest::Turn { right, up } => self.pose = Some(pose.turned(right, up)),
            PageRequest::Fly { right, up, forward } => self.pose = Some(pose.flown(right, up, forward, scale)),
            PageRequest::Zoom { by } => self.pose = Some(pose.zoomed(by, scale)),
            PageRequest::Look { eye, look_at, up } => {
                let pose = Pose::of_address(eye.into(), look_at.into(), up.into());
                self.pose = Some(pose.map_err(|why| format!("the address of this page names no view: {why}"))?);
            }
            PageRequest::Reset => self.pose = start.pose,
            PageRequest::Choose { .. } => self.choose(request, start)?,
            PageRequest::Ack { .. }
            | PageRequest::Pick { .. }
            | PageRequest::Save
            | PageRequest::Measure
            | PageRequest::Gaze { .. }
            | PageRequest::Preview { .. } => {}
        }
        Ok(())
    }

    fn choose(&mut self, request: &PageRequest, start: &Self) -> Result<(), String> {
        let PageRequest::Choose { convention, effects, precision, max_depth, spp, res } = request else {
            return Ok(());
        };
        let mut view = self.clone();
        if let Some(name) = convention {
            let convention = match name.as_str() {
                "start" => start.settings,
                name => name.parse::<Convention>()?.settings(),
            };
            view.settings = view.settings.with_convention(&convention);
        }
        if let Some(text) = effects {
            view.effects = text.parse()?;
        }
        if let Some(text) = precision {
            view.precision = text.parse()?;
        }
        if let Some(depth) = *max_depth {
            if depth > Settings::MAX_DEPTH {
                return Err(format!("the depth is {} at the most", Settings::MAX_DEPTH));
            }
            view.settings.max_depth = depth;
        }
        if let Some(count) = *spp {
            view.settings.pattern = view.settings.pattern.with_count(count)?;
        }
        if let Some(text) = res {
            view.res =
                if text.is_empty() { None } else { Some(resolution(text).map_err(|why| format!("'{text}': {why}"))?) };
        }
        *self = view;
        Ok(())
    }

    /// The settings, with the view of the pose.
    pub fn settings(&self) -> Settings {
        self.pose.map_or(self.settings, |pose| pose.apply(&self.settings))
    }

    /// Size of the picture of `scene`.
    pub fn size(&self, scene: &Scene) -> (u32, u32) {
        self.res.unwrap_or((scene.width, scene.height))
    }
}
