//! The front door: a device that renders scenes, and the reference that its pictures are held against.

mod views;

use std::fmt;
use std::sync::Arc;

use crate::compare::{Explanation, SizeMismatch};
use crate::cpu::Reference;
use crate::effects::Effects;
use crate::engine::{Backend, Engine, Options, render_picture};
use crate::film::{OutputError, Picture, PictureError, ReadError};
use crate::gpu::{self, Choice, Gpu, USUAL_KERNELS};
use crate::limits;
use crate::misuse::{Misuse, check_picture};
use crate::precision::{Request, Selection, Tier};
use crate::scene::{Invalid, Scene, SceneError};
use crate::settings::Settings;
use crate::verify::Verify;
use crate::viewed::ViewedScene;
pub use views::Views;

/// What renders: a Vulkan device, or the CPU reference.
///
/// It keeps the kernels that it has compiled, so one renderer for many pictures is faster than many; [`Renderer::views`] also keeps what
/// it has prepared of a scene. Clones share the device and its kernels, and may render at the same time.
///
/// ```
/// use trueray::{Error, Renderer, Scene, Settings};
///
/// # fn main() -> Result<(), Error> {
/// let scene = Scene::read("scenes/basic/ellipsoid.txt")?;
/// let picture = Renderer::reference().render(&scene, &Settings::default())?;
/// assert_eq!((picture.width(), picture.height()), (scene.width, scene.height));
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone)]
pub struct Renderer {
    gpu: Option<Arc<Gpu>>,
    precision: Request,
    verify: Option<Verify>,
}

impl Renderer {
    /// The best Vulkan device.
    ///
    /// # Errors
    ///
    /// [`Error::Device`] where there is none that can be used. To go on without one, say so:
    /// `Renderer::new().unwrap_or_else(|_| Renderer::reference())`.
    pub fn new() -> Result<Self, Error> {
        Self::on("gpu")
    }

    /// The device that `device` names, in the words of the option `--device`: `gpu` for the best one, `cpu` for the reference,
    /// `auto` for the best one or, where there is none, the reference; an index of [`Renderer::devices`], a part of a name or of a
    /// driver's name, or a PCI id.
    ///
    /// # Errors
    ///
    /// [`Error::Device`] where there is no such device, where several are meant, or where it cannot be opened.
    pub fn on(device: &str) -> Result<Self, Error> {
        let Ok(choice) = device.parse();
        let gpu = match choice {
            Choice::Cpu => None,
            Choice::Auto if gpu::list()?.is_empty() => None,
            choice => Some(Arc::new(Gpu::open(&choice)?.keeping_kernels(USUAL_KERNELS))),
        };
        Ok(Self { gpu, precision: Request::default(), verify: None })
    }

    /// The CPU reference.
    pub fn reference() -> Self {
        Self { gpu: None, precision: Request::default(), verify: None }
    }

    /// The same with the kernels of one tier; otherwise each scene gets the cheapest that covers it.
    #[must_use]
    pub fn with_precision(self, tier: Tier) -> Self {
        Self { precision: Request::Tier(tier), ..self }
    }

    /// The same with pictures that are certified: every pixel is the reference's.
    #[must_use]
    pub fn with_certification(self) -> Self {
        Self { precision: Request::Certified, ..self }
    }

    /// The same with so many pixels of a device's picture calculated by the reference, too; otherwise it is [`Verify::usual`].
    #[must_use]
    pub fn with_verification(self, verify: Verify) -> Self {
        Self { verify: Some(verify), ..self }
    }

    /// The Vulkan devices that there are, in words; the reference is none.
    ///
    /// # Errors
    ///
    /// [`Error::Device`] where the drivers cannot be asked.
    pub fn devices() -> Result<Vec<String>, Error> {
        Ok(gpu::list()?.iter().map(ToString::to_string).collect())
    }

    /// The device in words; `None` for the reference.
    pub fn device(&self) -> Option<String> {
        self.gpu.as_ref().map(|gpu| gpu.device.info.to_string())
    }

    /// The picture of `scene`.
    ///
    /// # Errors
    ///
    /// [`Error::Invalid`] where a number of the scene is none that a scene file may have, [`Error::Unrenderable`] where `f64` cannot
    /// hold what follows from them; [`Error::Device`] where the device fails, cannot hold the scene, or shows pixels that differ from
    /// the reference's by more than rounding explains.
    pub fn render(&self, scene: &Scene, settings: &Settings) -> Result<Picture, Error> {
        let (viewed, effects) = renderable(scene, settings)?;
        self.picture(viewed, &effects)
    }

    fn picture(&self, viewed: ViewedScene, effects: &Effects) -> Result<Picture, Error> {
        let backend = self.backend(&viewed, effects);
        let (scene, _) = viewed.in_file();
        let verify = self.verify.unwrap_or_else(|| Verify::usual(scene));
        let mut engine = Engine::verified(backend, viewed, effects, &Options::default(), verify)?;
        let (rgb, _) = render_picture(&mut engine)?;
        Ok(Picture::new(scene.width, scene.height, rgb)?)
    }

    /// Which pixels of a picture, wherever it comes from, differ from the reference's, and which of them rounding explains, as if
    /// this renderer had made it.
    ///
    /// # Errors
    ///
    /// As of [`Renderer::render`]; [`Error::Size`] where the picture has not the scene's size.
    pub fn explain(&self, picture: &Picture, scene: &Scene, settings: &Settings) -> Result<Explanation, Error> {
        let (viewed, effects) = renderable(scene, settings)?;
        SizeMismatch::of((picture.width(), picture.height()), (scene.width, scene.height))?;
        let judge = self.backend(&viewed, &effects).judge();
        check_picture(&viewed)?;
        let reference = Reference::new(&viewed, &effects);
        drop(viewed);
        let mut rgb = vec![0; scene.width as usize * scene.height as usize * 3];
        reference.rows(0, &mut rgb)?;
        let expected = Picture::new(scene.width, scene.height, rgb)?;
        Ok(Explanation::of(picture, &expected, &reference, &judge))
    }

    fn backend(&self, viewed: &ViewedScene, effects: &Effects) -> Backend<'_> {
        let Some(gpu) = &self.gpu else { return Backend::Reference };
        Backend::of(Some(gpu), &Selection::of(viewed, effects, self.precision, gpu.ladder()))
    }
}

/// Whether a picture of this size fits into memory.
fn check_room(scene: &Scene) -> Result<(), Error> {
    let size = scene.width as usize * scene.height as usize * 3;
    let too_large = |_| Error::Unrenderable(format!("a picture of {size} bytes does not fit into memory"));
    Vec::<u8>::new().try_reserve_exact(size).map_err(too_large)
}

/// A scene that has a picture, as its eye sees it, and its effects.
fn renderable<'a>(scene: &'a Scene, settings: &Settings) -> Result<(ViewedScene<'a>, Effects), Error> {
    scene.check()?;
    check_room(scene)?;
    let viewed = scene.viewed(settings);
    let effects = effects_of(&viewed)?;
    Ok((viewed, effects))
}

/// What `viewed` calls for, if it has a picture.
fn effects_of(viewed: &ViewedScene) -> Result<Effects, Error> {
    let effects = Effects::of(viewed);
    match effects.too_deep(viewed.scene()).or_else(|| limits::problem(viewed, &effects)) {
        Some(why) => Err(Error::Unrenderable(why)),
        None => Ok(effects),
    }
}

/// Why there is no scene, no picture or no file.
#[derive(Debug)]
#[non_exhaustive]
pub enum Error {
    /// A scene file cannot be read, or has errors.
    Scene(SceneError),
    /// A number of a scene is none that a scene file may have.
    Invalid(Invalid),
    /// The scene's numbers are too far apart, or its rays too many.
    Unrenderable(String),
    /// There is no such device, it cannot do what is asked, or it has failed.
    Device(gpu::Error),
    /// Pictures that differ in size.
    Size(SizeMismatch),
    /// No picture has so many pixels.
    Picture(PictureError),
    /// A picture file cannot be read.
    Read(ReadError),
    /// A picture file cannot be written.
    Write(OutputError),
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Scene(error) => error.fmt(f),
            Self::Invalid(error) => error.fmt(f),
            Self::Unrenderable(why) => write!(f, "the scene cannot be rendered: {why}"),
            Self::Device(error) => error.fmt(f),
            Self::Size(error) => error.fmt(f),
            Self::Picture(error) => error.fmt(f),
            Self::Read(error) => error.fmt(f),
            Self::Write(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for Error {}

macro_rules! from {
    ($($error:ty => $variant:ident),*) => {
        $(impl From<$error> for Error {
            fn from(error: $error) -> Self {
                Self::$variant(error)
            }
        })*
    };
}

from!(SceneError => Scene, Invalid => Invalid, gpu::Error => Device, SizeMismatch => Size, PictureError => Picture,
      ReadError => Read, OutputError => Write);

impl From<Misuse> for Error {
    fn from(misuse: Misuse) -> Self {
        Self::Device(misuse.into())
    }
}
