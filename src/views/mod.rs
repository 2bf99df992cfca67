//! Many views of scenes: where the eye is in each frame.

mod table;
mod turntable;

use std::path::PathBuf;

use glam::DVec3;

use crate::scene::{Fov, Scene, Window};
use crate::view::{Projection, View, ViewError};

pub use table::table;
pub use turntable::{NoCenter, turntable};

/// An eye in the words of `--eye`, `--look-at`, `--up` and `--fov`, in world units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Placement {
    /// The eye.
    pub eye: DVec3,
    /// What is in the middle of the picture; without it the eye looks along −z.
    pub look_at: Option<DVec3>,
    /// What is upwards.
    pub up: DVec3,
    /// The field of view, where it takes the place of the scene's window.
    pub fov: Option<Fov>,
    /// How the world is projected.
    pub projection: Projection,
}

impl Placement {
    /// The view from there.
    ///
    /// # Errors
    ///
    /// Where these define none.
    pub fn view(&self) -> Result<View, ViewError> {
        let view = View::new(self.eye, self.look_at, self.up)?.projected(self.projection);
        if view.is_parallel() && self.fov.is_some() { Err(ViewError::FovOfParallel) } else { Ok(view) }
    }
}

/// One picture of many: what is not as the scene has it.
#[derive(Debug, Clone, PartialEq)]
pub struct Frame {
    /// The eye.
    pub view: View,
    /// Columns and rows, where they are not the scene's.
    pub size: [Option<u32>; 2],
    /// What gives the window, where it is not the scene's.
    pub fov: Option<Fov>,
    /// Near, left, right, bottom and top of the window, where they are neither the scene's nor those of `fov`.
    pub window: [Option<f64>; 5],
    /// The file of another scene.
    pub scene: Option<PathBuf>,
}

impl Frame {
    /// The scene as it is, seen by this eye.
    pub fn seen_by(view: View) -> Self {
        Self { view, size: [None; 2], fov: None, window: [None; 5], scene: None }
    }

    /// Sets window and size of `scene`, whose own are these.
    pub fn apply(&self, scene: &mut Scene, window: Window, [width, height]: [u32; 2]) {
        scene.width = self.size[0].unwrap_or(width);
        scene.height = self.size[1].unwrap_or(height);
        let near = self.window[0].unwrap_or(window.near);
        let window = self.fov.map_or(window, |fov| fov.window(near, (scene.width, scene.height)));
        let own = [near, window.left, window.right, window.bottom, window.top];
        let [near, left, right, bottom, top] = std::array::from_fn(|edge| self.window[edge].unwrap_or(own[edge]));
        scene.window = Window { near, left, right, bottom, top };
    }
}
