//! What several test modules share.

mod folder;

use std::collections::BTreeMap;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::io::Write as _;
use std::num::NonZero;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};

use trueray::compare::Explanation;
use trueray::cpu::{Judge, Real, Reference};
use trueray::effects::Effects;
use trueray::engine::{Backend, Engine, render_picture};
use trueray::film::Picture;
use trueray::gpu::{Choice, Gpu};
use trueray::precision::Tier;
use trueray::scene::{Scene, Window, parse};
use trueray::settings::Settings;
use trueray::view::Projection;

pub(crate) use folder::{Folder, assert_exit};

/// Compiling is what tests with a device take most of their time for: they share as many kernels as there are.
pub(crate) const KEPT: NonZero<usize> = NonZero::new(400).unwrap();

/// The one device of all tests, or `None`, said aloud, where there is none and none is required.
pub(crate) fn gpu(test: &str) -> Option<MutexGuard<'static, Gpu>> {
    static GPU: OnceLock<Result<Mutex<Gpu>, String>> = OnceLock::new();
    match GPU.get_or_init(|| {
        Gpu::open(&Choice::Gpu).map(|gpu| Mutex::new(gpu.keeping_kernels(KEPT))).map_err(|error| error.to_string())
    }) {
        Ok(gpu) => Some(gpu.lock().unwrap_or_else(PoisonError::into_inner)),
        Err(error) => {
            assert!(!is_set("TRUERAY_REQUIRE_GPU"), "TRUERAY_REQUIRE_GPU is set, but {error}");
            say_skipped(test, "no Vulkan device");
            None
        }
    }
}

/// The device as one without `f64`, whose `double` calculates in pairs of `f32`; where a test has the device.
pub(crate) fn pairs() -> Option<MutexGuard<'static, Gpu>> {
    static PAIRS: OnceLock<Option<Mutex<Gpu>>> = OnceLock::new();
    let open = || {
        let mut gpu = Gpu::open(&Choice::Gpu).ok()?.keeping_kernels(KEPT);
        gpu.device.info.f64 = false;
        Some(Mutex::new(gpu))
    };
    PAIRS.get_or_init(open).as_ref().map(|gpu| gpu.lock().unwrap_or_else(PoisonError::into_inner))
}

/// Says that a test is skipped.
pub(crate) fn say_skipped(test: &str, why: &str) {
    say(test, &format!("skipped: {why}"));
}

/// Says something past the test harness, which hides what passing tests print.
#[allow(clippy::explicit_write, reason = "eprintln! is what the harness hides")]
pub(crate) fn say(test: &str, what: &str) {
    writeln!(std::io::stderr(), "{test}: {what}").unwrap();
}

/// Whether an environment variable is set to something but 0.
pub(crate) fn is_set(variable: &str) -> bool {
    std::env::var(variable).is_ok_and(|value| !value.is_empty() && value != "0")
}

/// Where Mesa keeps machine code, for a program whose own caches are to lie elsewhere: as its `MESA_SHADER_CACHE_DIR`.
pub(crate) fn driver_cache() -> PathBuf {
    let set = |variable| std::env::var_os(variable).filter(|value| !value.is_empty()).map(PathBuf::from);
    let in_home = || set("HOME").map_or_else(std::env::temp_dir, |home| home.join(".cache"));
    set("MESA_SHADER_CACHE_DIR").or_else(|| set("XDG_CACHE_HOME")).unwrap_or_else(in_home)
}

/// The project's folder.
pub(crate) fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// All scene files below `scenes/` of the named folders, sorted.
pub(crate) fn scene_files(folders: &[&str]) -> Vec<PathBuf> {
    let in_folder = |folder: &&str| {
        let entries = std::fs::read_dir(root().join("scenes").join(folder)).unwrap();
        entries.map(|entry| entry.unwrap().path()).collect::<Vec<_>>()
    };
    let mut files: Vec<_> = folders.iter().flat_map(in_folder).collect();
    files.retain(|file| file.extension().is_some_and(|extension| extension == "txt"));
    files.sort();
    assert!(!files.is_empty());
    files
}

/// Reads a scene without errors.
pub(crate) fn scene(file: &Path) -> Scene {
    let parsed = parse(&file.display().to_string(), &std::fs::read(file).unwrap());
    parsed.scene.clone().unwrap_or_else(|| panic!("{}", parsed.report(false)))
}

/// A scene from its text, with a window and a small picture before it.
pub(crate) fn scene_of(statements: &str) -> Scene {
    let text = format!("NEAR 1\nLEFT -1\nRIGHT 1\nBOTTOM -1\nTOP 1\nRES 40 40\n{statements}");
    let parsed = parse("test", text.as_bytes());
    parsed.scene.clone().unwrap_or_else(|| panic!("{}", parsed.report(false)))
}

/// `scene` in other units.
pub(crate) fn scaled(scene: &Scene, factor: f64) -> Scene {
    let mut scene = scene.clone();
    let Window { near, left, right, bottom, top } = scene.window;
    let [near, left, right, bottom, top] = [near, left, right, bottom, top].map(|x| x * factor);
    scene.window = Window { near, left, right, bottom, top };
    for sphere in &mut scene.spheres {
        sphere.center *= factor;
        sphere.scale *= factor;
    }
    scene.lights.iter_mut().for_each(|light| light.position *= factor);
    scene
}

/// The GPU's picture and its number of pixels that are not finite.
pub(crate) fn gpu_picture(
    gpu: &Gpu,
    tier: Tier,
    scene: &Scene,
    settings: &Settings,
    effects: &Effects,
) -> (Picture, u64) {
    let mut engine = Engine::new(Backend::Device(gpu, tier), scene.viewed(settings), effects).unwrap();
    let (rgb, not_finite) = render_picture(&mut engine).unwrap();
    (picture(scene, rgb), not_finite)
}

/// The CPU's picture in the scalar `T` and its number of pixels that are not finite, made once for all tests that ask for it.
pub(crate) fn cpu_picture<T: Real>(scene: &Scene, settings: &Settings, effects: &Effects) -> (Picture, u64) {
    type Made = Arc<OnceLock<(Picture, u64)>>;
    static MADE: Mutex<BTreeMap<u64, Made>> = Mutex::new(BTreeMap::new());
    let mut hasher = DefaultHasher::new();
    format!("{} {scene:?} {settings:?} {effects:?}", std::any::type_name::<T>()).hash(&mut hasher);
    let made = Arc::clone(MADE.lock().unwrap().entry(hasher.finish()).or_default());
    made.get_or_init(|| {
        let mut rgb = vec![0; scene.width as usize * scene.height as usize * 3];
        let tally = Reference::<T>::new(&scene.viewed(settings), effects).rows(0, &mut rgb).unwrap();
        (picture(scene, rgb), tally.not_finite)
    })
    .clone()
}

/// The settings with parallel rays.
pub(crate) fn orthographic(settings: Settings) -> Settings {
    Settings { view: settings.view.projected(Projection::Orthographic), ..settings }
}

/// The scene with a window for parallel rays: as large as what an eye sees at the depth of the first sphere.
pub(crate) fn widened(mut scene: Scene) -> Scene {
    let Window { near, left, right, bottom, top } = scene.window;
    let depth = scene.spheres.first().map_or(near, |sphere| sphere.center.z.abs().max(sphere.scale.max_element()));
    let [left, right, bottom, top] = [left, right, bottom, top].map(|edge| edge / near * depth);
    scene.window = Window { near, left, right, bottom, top };
    scene
}

/// A scene with its reference and the reference's picture.
pub(crate) struct Case {
    pub(crate) scene: Scene,
    pub(crate) settings: Settings,
    pub(crate) effects: Effects,
    pub(crate) reference: Reference<f64>,
    pub(crate) expected: Picture,
}

impl Case {
    pub(crate) fn new(scene: &Scene, settings: &Settings) -> Self {
        let effects = Effects::of(&scene.viewed(settings));
        let reference = Reference::new(&scene.viewed(settings), &effects);
        let (expected, not_finite) = cpu_picture::<f64>(scene, settings, &effects);
        assert_eq!(not_finite, 0);
        Self { scene: scene.clone(), settings: *settings, effects, reference, expected }
    }

    /// Of a scene's file, made once for all tests.
    pub(crate) fn of(file: &Path, settings: &Settings) -> Arc<Self> {
        static CASES: Mutex<BTreeMap<String, Arc<OnceLock<Arc<Case>>>>> = Mutex::new(BTreeMap::new());
        let key = format!("{} {settings:?}", file.display());
        let case = Arc::clone(CASES.lock().unwrap().entry(key).or_default());
        Arc::clone(case.get_or_init(|| Arc::new(Self::new(&scene(file), settings))))
    }

    pub(crate) fn explained(&self, picture: &Picture, judge: Judge) -> Explanation {
        Explanation::of(picture, &self.expected, &self.reference, &judge)
    }

    /// Fails where a pixel of `picture` is unexplained.
    #[track_caller]
    pub(crate) fn assert_explained(&self, what: &str, picture: &Picture, judge: Judge) -> Explanation {
        let explanation = self.explained(picture, judge);
        assert_eq!(explanation.unexplained, 0, "{what}:\n{}", explanation.report());
        explanation
    }
}

fn picture(scene: &Scene, rgb: Vec<u8>) -> Picture {
    Picture::new(scene.width, scene.height, rgb).unwrap()
}
