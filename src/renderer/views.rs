//! One scene and many eyes.

use super::{Error, Renderer, check_room, effects_of};
use crate::film::Picture;
use crate::kept::Kept;
use crate::scene::Scene;
use crate::settings::Settings;
use crate::view::View;

/// Renders a scene from many places: what no eye changes, such as the lists of spheres around the lights, is prepared once.
///
/// A picture is, byte for byte, that of [`Renderer::render`].
///
/// ```
/// use trueray::{DVec3, Renderer, Scene, Settings, View};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let scene = Scene::read("scenes/basic/ellipsoid.txt")?;
/// let renderer = Renderer::reference();
/// let views = renderer.views(&scene, &Settings::default())?;
/// for x in [0.0, 0.5, 1.0] {
///     let view = View::new(DVec3::new(x, 0.0, 0.0), Some(DVec3::new(0.0, 0.0, -10.0)), DVec3::Y)?;
///     assert_eq!(views.render(&view)?.width(), scene.width);
/// }
/// # Ok(())
/// # }
/// ```
#[derive(Debug)]
pub struct Views<'a> {
    renderer: &'a Renderer,
    scene: &'a Scene,
    settings: Settings,
    kept: Kept,
}

impl Renderer {
    /// What renders `scene` from many places under `settings`, whose own view counts for nothing.
    ///
    /// # Errors
    ///
    /// [`Error::Invalid`] where a number of the scene is none that a scene file may have.
    pub fn views<'a>(&'a self, scene: &'a Scene, settings: &Settings) -> Result<Views<'a>, Error> {
        scene.check()?;
        check_room(scene)?;
        Ok(Views { renderer: self, scene, settings: *settings, kept: Kept::default() })
    }
}

impl Views<'_> {
    /// The picture that `view` has of the scene.
    ///
    /// # Errors
    ///
    /// As of [`Renderer::render`].
    pub fn render(&self, view: &View) -> Result<Picture, Error> {
        let viewed = self.scene.viewed_again(&Settings { view: *view, ..self.settings }, &self.kept);
        let effects = effects_of(&viewed)?;
        self.renderer.picture(viewed, &effects)
    }
}
