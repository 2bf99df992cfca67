//! Ray tracer for scenes of spheres and ellipsoids: a WGSL compute shader on any Vulkan device, checked against a CPU
//! reference.
//!
//! Three calls lead from a scene file to a picture, and one more says whether it is right:
//!
//! ```no_run
//! use trueray::{Error, Renderer, Scene, Settings};
//!
//! # fn main() -> Result<(), Error> {
//! let scene = Scene::read("scene.txt")?;
//! let renderer = Renderer::new()?;
//! let picture = renderer.render(&scene, &Settings::default())?;
//! assert_eq!(renderer.explain(&picture, &scene, &Settings::default())?.unexplained, 0);
//! picture.write("scene.png")?;
//! # Ok(())
//! # }
//! ```
//!
//! A scene can also be made of one's own numbers:
//!
//! ```
//! use trueray::{DVec3, Error, Light, Renderer, Scene, Settings, Sphere, Window};
//!
//! # fn main() -> Result<(), Error> {
//! let spheres = vec![Sphere::new([0.0, 0.0, -5.0], 1.5, [0.9, 0.3, 0.1])];
//! let lights = vec![Light { position: DVec3::new(3.0, 5.0, 0.0), intensity: DVec3::ONE }];
//! let scene = Scene { spheres, lights, ..Scene::new(Window::default(), 64, 64) };
//! let picture = Renderer::reference().render(&scene, &Settings::exact())?;
//! assert_eq!(picture.pixel(0, 0), [0, 0, 0]);
//! assert!(picture.pixel(32, 32)[0] > 100);
//! # Ok(())
//! # }
//! ```
//!
//! To depend on it: `trueray = { path = "…", default-features = false }`; the default feature `view` is the command line's live
//! view and brings a web server. Build with `--release`: without optimisation pictures take many times as long.
//!
//! Two pictures are compared by [`Difference::between`]. The folder `examples` has whole programs. What the documentation does not
//! show is the program's own and may change.

// The data walk: scene text → scene::Scene → viewed::ViewedScene, moved to the eye → effects::Effects → lists of spheres (accel) →
// packed tables → composed WGSL and constants → SPIR-V of each kernel → stages of dispatches → rows of pixels → file. `cpu` and `gpu`
// never see each other; both read viewed, effects, camera, geometry, accel and sampling. Modules are public for the tests, which are
// a crate of their own.
#[doc(hidden)]
pub mod accel;
#[doc(hidden)]
pub mod aov;
#[doc(hidden)]
pub mod area;
mod atomic;
#[doc(hidden)]
pub mod bench;
#[doc(hidden)]
pub mod brightness;
mod cache;
#[doc(hidden)]
pub mod camera;
mod census;
#[doc(hidden)]
pub mod certificate;
#[doc(hidden)]
pub mod cli;
#[doc(hidden)]
pub mod color_bar;
#[doc(hidden)]
pub mod compare;
#[doc(hidden)]
pub mod conform;
#[doc(hidden)]
pub mod cpu;
mod decimal;
#[doc(hidden)]
pub mod doubts;
#[doc(hidden)]
pub mod effects;
#[doc(hidden)]
pub mod engine;
#[doc(hidden)]
pub mod exact;
#[doc(hidden)]
pub mod export;
#[doc(hidden)]
pub mod film;
#[doc(hidden)]
pub mod geometry;
#[doc(hidden)]
pub mod gpu;
#[doc(hidden)]
pub mod grade;
mod hash;
pub mod import;
#[doc(hidden)]
pub mod kept;
#[doc(hidden)]
pub mod limits;
#[doc(hidden)]
pub mod linear;
#[doc(hidden)]
pub mod mistakes;
#[doc(hidden)]
pub mod misuse;
mod origin;
mod panics;
#[doc(hidden)]
pub mod part;
#[doc(hidden)]
pub mod pattern;
#[doc(hidden)]
pub mod pixel;
#[doc(hidden)]
pub mod precision;
mod random;
mod renderer;
mod report;
mod roundings;
#[doc(hidden)]
pub mod sampling;
#[doc(hidden)]
pub mod scene;
pub mod settings;
mod stop;
#[doc(hidden)]
pub mod stress;
#[doc(hidden)]
pub mod study;
mod threads;
#[doc(hidden)]
pub mod tiles;
#[doc(hidden)]
pub mod tuning;
#[doc(hidden)]
pub mod verify;
#[doc(hidden)]
pub mod view;
#[doc(hidden)]
pub mod viewed;
#[cfg(feature = "view")]
#[doc(hidden)]
pub mod viewer;
#[doc(hidden)]
pub mod views;
mod words;

pub use compare::{Difference, Explanation};
pub use film::Picture;
pub use glam::DVec3;
pub use pattern::{Filter, Pattern};
pub use precision::Tier;
pub use renderer::{Error, Renderer, Views};
pub use scene::{Fov, Light, Scene, Sphere, Window};
pub use settings::Settings;
pub use verify::Verify;
pub use view::{Projection, View};

/// The causes of an [`Error`].
pub mod errors {
    pub use crate::compare::SizeMismatch;
    pub use crate::film::{OutputError, PictureError, ReadError};
    pub use crate::gpu::Error as DeviceError;
    pub use crate::misuse::Misuse;
    pub use crate::scene::{Invalid, SceneError};
    pub use crate::view::ViewError;
}
