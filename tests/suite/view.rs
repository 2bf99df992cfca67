//! The live picture: what a page would see, without a browser.

use std::fmt::Write as _;
use std::io::{Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::atomic::Ordering;
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use glam::DVec3;
use serde_json::Value;
use trueray::effects::{self, Effects};
use trueray::engine::{Backend, Engine, render_picture};
use trueray::gpu::{Choice, Gpu, USUAL_KERNELS};
use trueray::import::{self, Format, Import, Options};
use trueray::pattern::Pattern;
use trueray::precision::{self, Selection};
use trueray::scene::{Scene, parse};
use trueray::settings::Settings;
use trueray::viewer::{
    Access, Canvas, FlightScale, MAX_PAGES, MAX_UNACKNOWLEDGED, Outgoing, PageRequest, Patch, Pose, ReadScene,
    RenderLoop, SAMPLE_COLORS, SAMPLE_MAP, SLOTS, SceneFile, Session, ViewState, watch,
};

use crate::support::gpu;

pub(crate) const SCENE: &str = "NEAR 1\nLEFT -1\nRIGHT 1\nBOTTOM -1\nTOP 1\nRES 90 70\nSPHERE a 0 0 -10 2 4 2 0.5 0 0 1 1 0.9 0 50\n\
                     SPHERE b 4 4 -10 1 2 1 0 0.5 0 1 1 0.9 0.3 50\nLIGHT l 0 0 0 0.9 0.9 0.9\nBACK 0.2 0.5 1\n\
                     AMBIENT 0.2 0.2 0.2\n";

/// Long enough for kernels to be compiled on a machine that has other things to do.
const PATIENCE: Duration = Duration::from_secs(60);

pub(crate) fn scene(text: &str) -> Scene {
    parse("scene.txt", text.as_bytes()).scene.unwrap()
}

fn start() -> ViewState {
    ViewState {
        pose: None,
        settings: Settings::classic(),
        effects: effects::Request::Auto,
        precision: precision::Request::default(),
        res: None,
        fov: None,
    }
}

/// A render loop at work on a scene file.
pub(crate) struct Work {
    render_loop: Arc<RenderLoop>,
    thread: Option<JoinHandle<()>>,
    folder: tempfile::TempDir,
    /// The device in use.
    gpu: Arc<Mutex<Option<Arc<Gpu>>>>,
}

impl Work {
    pub(crate) fn new(text: &str, on_device: bool) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("scene.txt");
        std::fs::write(&path, text).unwrap();
        let render_loop =
            Arc::new(RenderLoop::new(SceneFile::new(&path, scene(text).into(), Options::default()), start()));
        watch(Arc::clone(&render_loop.scene_file), Arc::clone(&render_loop.wake), Arc::clone(&render_loop.quit))
            .unwrap();
        let gpu = Arc::new(Mutex::new(None));
        let (rendering, opened) = (Arc::clone(&render_loop), Arc::clone(&gpu));
        let open = move || {
            let gpu =
                if on_device { Some(Arc::new(Gpu::open(&Choice::Auto)?.keeping_kernels(USUAL_KERNELS))) } else { None };
            opened.lock().unwrap().clone_from(&gpu);
            Ok(gpu)
        };
        let thread = Some(std::thread::spawn(move || rendering.run(&mut Box::new(open))));
        Self { render_loop, thread, folder, gpu }
    }

    pub(crate) fn page(&self) -> Page {
        Page {
            session: self.render_loop.connect().unwrap(),
            render_loop: Arc::clone(&self.render_loop),
            size: (0, 0),
            rgb: Vec::new(),
            maps: std::array::from_fn(|_| Vec::new()),
            offsets: Vec::new(),
            sampled_pictures: 0,
        }
    }

    fn edit(&self, text: &str) {
        std::fs::write(self.folder.path().join("scene.txt"), text).unwrap();
    }
}

impl Drop for Work {
    fn drop(&mut self) {
        self.render_loop.quit.store(true, Ordering::Relaxed);
        self.render_loop.wake.raise();
        let ended = self.thread.take().unwrap().join();
        assert!(ended.is_ok() || std::thread::panicking(), "the thread that renders has panicked");
    }
}

/// What a page does: draws patches and acknowledges.
pub(crate) struct Page {
    pub(crate) session: Arc<Session>,
    render_loop: Arc<RenderLoop>,
    pub(crate) size: (u32, u32),
    pub(crate) rgb: Vec<u8>,
    /// Of each slot, the offset from each pixel to its nearest sample.
    maps: [Vec<[i8; 2]>; SLOTS as usize],
    /// Those of the last picture of samples.
    pub(crate) offsets: Vec<[i8; 2]>,
    /// Pictures of samples so far.
    pub(crate) sampled_pictures: u32,
}

impl Page {
    pub(crate) fn send(&self, message: &str) {
        self.session.receive(&serde_json::from_str(message).unwrap());
        self.render_loop.wake.raise();
    }

    /// Draws the next message; words are returned.
    pub(crate) fn next(&mut self) -> Option<Value> {
        let start = Instant::now();
        let message = loop {
            if let Some(message) = self.session.take() {
                break message;
            }
            assert!(start.elapsed() < PATIENCE, "nothing comes");
            std::thread::sleep(Duration::from_millis(1));
        };
        self.handle(message)
    }

    /// Draws a message and acknowledges it; words are returned.
    fn handle(&mut self, message: Outgoing) -> Option<Value> {
        let (number, words) = match message {
            Outgoing::Bytes(bytes) => {
                match u32::from_le_bytes(bytes[..4].try_into().unwrap()) {
                    SAMPLE_MAP => {
                        let offsets = bytes[24..].as_chunks::<2>().0;
                        self.maps[bytes[20] as usize] =
                            offsets.iter().map(|offset| offset.map(u8::cast_signed)).collect();
                    }
                    SAMPLE_COLORS => self.draw_samples(&bytes),
                    _ => {
                        if let Some(patch) = Patch::decode(&bytes) {
                            self.draw(&patch);
                        }
                    }
                }
                (u64::from(u32::from_le_bytes(bytes[4..8].try_into().unwrap())), None)
            }
            Outgoing::Text(words) => {
                let words: Value = serde_json::from_str(&words).unwrap();
                (words["number"].as_u64().unwrap(), Some(words))
            }
        };
        self.send(&format!(r#"{{"do":"ack","through":{number}}}"#));
        words
    }

    fn draw(&mut self, patch: &Patch) {
        let (width, height) = patch.size;
        if self.size != patch.size {
            self.size = patch.size;
            self.rgb = vec![0; width as usize * height as usize * 3];
        }
        for (part, rgb) in &patch.parts {
            let (columns, _) = patch.sent(part);
            for y in part.y..part.y + part.height {
                for x in part.x..part.x + part.width {
                    let from = ((y - part.y) / patch.step) as usize * columns + ((x - part.x) / patch.step) as usize;
                    let to = y as usize * width as usize + x as usize;
                    self.rgb[to * 3..][..3].copy_from_slice(&rgb[from * 3..][..3]);
                }
            }
        }
    }

    /// Shows each pixel as its nearest sample.
    fn draw_samples(&mut self, message: &[u8]) {
        let word = |index: usize| u32::from_le_bytes(message[4 * index..][..4].try_into().unwrap());
        self.size = (word(2), word(3));
        let width = self.size.0 as usize;
        self.offsets.clone_from(&self.maps[word(5) as usize]);
        assert_eq!(self.offsets.len(), width * self.size.1 as usize);
        let mut samples = message[24..].as_chunks::<3>().0.iter();
        let mut pixels = vec![[0; 3]; self.offsets.len()];
        for (pixel, offset) in pixels.iter_mut().zip(&self.offsets) {
            if *offset == [0, 0] {
                *pixel = *samples.next().unwrap();
            }
        }
        assert_eq!((samples.next(), word(4) as usize), (None, message[24..].len() / 3));
        let source = |(index, [dx, dy]): (usize, &[i8; 2])| {
            pixels[index.wrapping_add_signed(isize::from(*dx) + isize::from(*dy) * width.cast_signed())]
        };
        self.rgb = self.offsets.iter().enumerate().flat_map(source).collect();
        self.sampled_pictures += 1;
    }

    /// Draws until words have the property.
    pub(crate) fn until(&mut self, property: impl Fn(&Value) -> bool) -> Value {
        let start = Instant::now();
        loop {
            assert!(start.elapsed() < PATIENCE, "never");
            if let Some(words) = self.next().filter(&property) {
                return words;
            }
        }
    }

    /// Draws until the full picture of the newest view is there.
    pub(crate) fn finish(&mut self) -> Value {
        let version = self.session.view().0;
        self.until(|words| words["finished"] == true && words["version"] == version)
    }
}

/// What `trueray render` gives for what a page shows.
pub(crate) fn rendered(gpu: Option<&Gpu>, scene: &Scene, view: &ViewState) -> Vec<u8> {
    let mut scene = scene.clone();
    (scene.width, scene.height) = view.size(&scene);
    let settings = view.settings();
    let effects = Effects::requested(&scene.viewed(&settings), &view.effects);
    let select = |gpu: &Gpu| Selection::of(&scene.viewed(&settings), &effects, view.precision, gpu.ladder()).tier;
    let backend = gpu.map_or(Backend::Reference, |gpu| Backend::Device(gpu, select(gpu)));
    render_picture(&mut Engine::new(backend, scene.viewed(&settings), &effects).unwrap()).unwrap().0
}

#[test]
fn the_picture_at_rest_is_that_of_render() {
    for on_device in [false, true] {
        let device = if on_device { gpu("view::the_picture_at_rest_is_that_of_render") } else { None };
        if on_device && device.is_none() {
            continue;
        }
        let work = Work::new(SCENE, on_device);
        let mut page = work.page();
        let messages = [
            r#"{"do":"reset"}"#,
            r#"{"do":"orbit","right":0.4,"up":0.2}"#,
            r#"{"do":"choose","convention":"exact","spp":4,"max_depth":2}"#,
            r#"{"do":"fly","right":0.1,"up":-0.05,"forward":0.3}"#,
            r#"{"do":"choose","effects":"-shadows,+shells","precision":"double","res":"61x33"}"#,
            r#"{"do":"turn","right":0.1,"up":0.1}"#,
            r#"{"do":"zoom","by":0.7}"#,
            r#"{"do":"choose","res":"1x1","spp":1}"#,
            r#"{"do":"choose","res":"2000x3"}"#,
        ];
        for (index, message) in messages.into_iter().enumerate() {
            page.send(message);
            if index > 0 || page.rgb.is_empty() {
                page.finish();
            }
            let expected = rendered(device.as_deref(), &scene(SCENE), &page.session.view().1);
            assert!(page.rgb == expected, "after {message}, on the device: {on_device}");
        }
    }
}

#[test]
fn the_command_line_of_a_view_renders_it() {
    let fov = trueray::Fov::from_degrees(37.5);
    let work = work_with(ViewState { fov, ..start() }, || Ok(None));
    let mut page = work.page();
    page.send(r#"{"do":"orbit","right":-0.7,"up":0.3}"#);
    page.send(r#"{"do":"fly","right":0.013,"up":0.3,"forward":-0.21}"#);
    for choice in [
        r#"{"do":"choose","spp":9,"res":"50x41","effects":"ambient,diffuse"}"#,
        r#"{"do":"choose","convention":"exact","effects":"auto"}"#,
        r#"{"do":"choose","convention":"classic","precision":"double","max_depth":0,"res":"","effects":"none"}"#,
        r#"{"do":"reset"}"#,
    ] {
        page.send(choice);
        let state = page.finish();
        let options = state["options"].as_str().unwrap();
        let mut command = Command::new(env!("CARGO_BIN_EXE_trueray"));
        command.current_dir(work.folder.path()).args(["render", "--device", "cpu"]);
        let output = command.args(options.split_whitespace()).args(["scene.txt", "-o", "view.png"]).output().unwrap();
        assert!(output.status.success(), "{options}: {}", String::from_utf8_lossy(&output.stderr));
        page.send(r#"{"do":"save"}"#);
        let file = loop {
            match page.session.take() {
                Some(Outgoing::Bytes(bytes)) if bytes[0] == 2 => break bytes,
                _ => std::thread::sleep(Duration::from_millis(1)),
            }
        };
        let number = u32::from_le_bytes(file[4..8].try_into().unwrap());
        page.send(&format!(r#"{{"do":"ack","through":{number}}}"#));
        assert!(file[8..] == std::fs::read(work.folder.path().join("view.png")).unwrap(), "{options}");
    }
}

/// What the address of a page keeps leads back to the same picture, and an address that names no view changes nothing.
#[test]
fn a_camera_is_told_and_taken_again() {
    let work = Work::new(SCENE, false);
    let mut page = work.page();
    assert_eq!(page.finish()["camera"], Value::Null, "that of the file");
    page.send(r#"{"do":"orbit","right":0.4,"up":0.2}"#);
    page.send(r#"{"do":"fly","right":0.1,"up":-0.05,"forward":0.3}"#);
    let state = page.finish();
    let camera = state["camera"].as_array().unwrap();
    let mut other = work.page();
    let look =
        |camera: &[Value]| format!(r#"{{"do":"look","eye":{},"look_at":{},"up":{}}}"#, camera[0], camera[1], camera[2]);
    other.send(&look(camera));
    assert_eq!(other.finish()["camera"], state["camera"]);
    assert_eq!(other.rgb, page.rgb);
    for (index, vector, why) in [
        (1, camera[0].clone(), "the same point"),
        (2, serde_json::json!([0, 0, 0]), "it has no direction"),
        (0, serde_json::json!([1e200, 0, 0]), "no coordinate may be beyond 1e100"),
    ] {
        let mut wrong = camera.clone();
        wrong[index] = vector;
        other.send(&look(&wrong));
        let state = other.until(|words| words["problem"].as_str().is_some_and(|problem| problem.contains(why)));
        let problem = state["problem"].as_str().unwrap();
        assert!(problem.starts_with("the address of this page names no view: "), "{problem}");
        assert_eq!(state["camera"].as_array(), Some(camera));
    }
}

/// A page knows whether its picture answers what it has asked for, even where that changes nothing.
#[test]
fn each_request_for_a_view_is_heard() {
    let work = Work::new(SCENE, false);
    let mut page = work.page();
    assert_eq!(page.finish()["heard"], 0);
    page.send(r#"{"do":"reset"}"#);
    let state = page.until(|words| words["heard"] == 1);
    assert_eq!((&state["version"], &state["finished"]), (&1.into(), &true.into()));
    page.send(r#"{"do":"choose","max_depth":1}"#);
    page.send(r#"{"do":"choose","max_depth":100000}"#);
    let state = page.until(|words| words["heard"] == 3);
    assert_eq!(state["version"], 2);
    page.send(r#"{"do":"pick","x":0,"y":0}"#);
    page.until(|words| words["is"] == "pixel");
    page.send(r#"{"do":"orbit","right":0.1,"up":0}"#);
    assert_eq!(page.finish()["heard"], 4);
}

#[test]
fn a_page_that_does_not_read_gets_no_queue() {
    let work = Work::new(SCENE, false);
    let mut page = work.page();
    let session = Arc::clone(&page.session);
    for _ in 0..200 {
        page.send(r#"{"do":"orbit","right":0.01,"up":0}"#);
        page.send(r#"{"do":"pick","x":1,"y":1}"#);
        std::thread::sleep(Duration::from_millis(1));
    }
    let mut waiting = Vec::new();
    while let Some(message) = session.take() {
        waiting.push(message);
    }
    // A turn that began while there was room ends with a patch, a state, a pixel and a state.
    assert!(!waiting.is_empty() && waiting.len() <= MAX_UNACKNOWLEDGED + 3, "{} messages", waiting.len());
    assert!(!session.is_open());
    for message in waiting {
        page.handle(message);
    }
    page.finish();
    assert_eq!(page.rgb, rendered(None, &scene(SCENE), &session.view().1));
}

#[test]
fn an_edited_scene_is_shown_and_an_error_keeps_the_last_picture() {
    let work = Work::new(SCENE, false);
    let mut page = work.page();
    page.finish();
    let before = page.rgb.clone();
    work.edit(&SCENE.replace("LIGHT l", "LAMP l"));
    let state = page.until(|words| !words["error"].is_null());
    assert_eq!(state["error"]["line"], 9);
    assert!(state["error"]["text"].as_str().unwrap().contains("LAMP"));
    assert_eq!(page.rgb, before);
    // Whoever comes now gets the last good picture and the error.
    let mut other = work.page();
    assert_eq!(other.finish()["error"]["line"], 9);
    assert_eq!(other.rgb, before);
    let edited = SCENE.replace("BACK 0.2", "BACK 0.7").replace("RES 90 70", "RES 64 48");
    work.edit(&edited);
    page.until(|words| words["error"].is_null() && words["finished"] == true && words["size"][0] == 64);
    assert_eq!(page.rgb, rendered(None, &scene(&edited), &start()));
    std::fs::remove_file(work.folder.path().join("scene.txt")).unwrap();
    let state = page.until(|words| !words["error"].is_null());
    assert!(state["error"]["text"].as_str().unwrap().contains("cannot read"));
}

#[test]
fn a_lost_device_is_opened_again() {
    let Some(device) = gpu("view::a_lost_device_is_opened_again") else { return };
    let work = Work::new(SCENE, true);
    let mut page = work.page();
    page.finish();
    for round in 0..3 {
        let gpu = work.gpu.lock().unwrap().clone().unwrap();
        gpu.device.destroy();
        page.send(&format!(r#"{{"do":"orbit","right":0.{},"up":0.1}}"#, round + 1));
        page.until(|words| words["is"] == "lost");
        page.finish();
        assert_eq!(page.rgb, rendered(Some(&device), &scene(SCENE), &page.session.view().1));
    }
}

#[test]
fn pages_have_their_own_pictures_and_may_vanish() {
    let work = Work::new(SCENE, false);
    let mut pages: Vec<_> = (0..MAX_PAGES).map(|_| work.page()).collect();
    assert!(work.render_loop.connect().is_none());
    for (index, page) in pages.iter().enumerate() {
        page.send(&format!(r#"{{"do":"orbit","right":{},"up":0}}"#, 0.1 * index as f64));
    }
    // Half of them go without a word, some in the midst of a picture.
    for page in pages.drain(..MAX_PAGES / 2) {
        page.session.close();
    }
    for page in &mut pages {
        page.finish();
        assert_eq!(page.rgb, rendered(None, &scene(SCENE), &page.session.view().1));
    }
    assert!(work.render_loop.connect().is_some());
}

#[test]
fn a_huge_size_is_shown_smaller() {
    let work = Work::new("NEAR 1\nLEFT -1\nRIGHT 1\nBOTTOM -1\nTOP 1\nRES 40 30\n", false);
    let mut page = work.page();
    page.send(r#"{"do":"choose","res":"16777216x16777216"}"#);
    let state = page.finish();
    assert_eq!(state["shrunk"], true);
    assert!(state["options"].as_str().unwrap().contains("--res 8192x8192"), "{}", state["options"]);
    page.send(r#"{"do":"choose","res":"0x5"}"#);
    let state = page.until(|words| !words["problem"].is_null());
    assert!(state["problem"].as_str().unwrap().contains("0x5"));
}

#[test]
fn a_pixel_says_what_it_shows() {
    let work = Work::new(SCENE, false);
    let mut page = work.page();
    page.finish();
    page.send(r#"{"do":"pick","x":45,"y":35}"#);
    let pixel = page.until(|words| words["is"] == "pixel");
    assert_eq!(pixel["hit"]["name"], "a");
    assert_eq!(pixel["hit"]["sphere"], 0);
    // The ray of this pixel's corner goes straight ahead, and the sphere's nearest point is at z = -8.
    assert_eq!(pixel["hit"]["t"], 8.0);
    assert_eq!(pixel["hit"]["position"], serde_json::json!([0.0, 0.0, -8.0]));
    let start = (35 * 90 + 45) * 3;
    assert_eq!(pixel["rgb"], serde_json::json!(page.rgb[start..start + 3]));
    assert!(pixel["table"]["text"].as_str().unwrap().contains("sphere 'a' (0) from outside at t 8\n"), "{pixel}");
    page.send(r#"{"do":"pick","x":0,"y":0}"#);
    assert!(page.until(|words| words["is"] == "pixel")["hit"].is_null());
}

/// What `trueray pixel` prints with these options, of the scene that `work` shows.
fn of_command(work: &Work, options: &str, [x, y]: [u32; 2], device: &str, more: &[&str]) -> String {
    let mut command = Command::new(env!("CARGO_BIN_EXE_trueray"));
    command.arg("pixel").args(options.split_whitespace()).arg(&work.render_loop.scene_file.path);
    let output = command.args([x.to_string(), y.to_string()]).args(["--device", device]).args(more).output().unwrap();
    assert!(output.status.success(), "{options}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

/// For the eye and the settings that the page shows, all that the command tells: rays, tiers, colours, how far they are off.
#[test]
fn the_table_of_a_pixel_is_that_of_the_command() {
    for device in ["cpu", "gpu"] {
        if device == "gpu" && gpu("view::the_table_of_a_pixel_is_that_of_the_command").is_none() {
            continue;
        }
        let work = Work::new(SCENE, device == "gpu");
        let mut page = work.page();
        for (message, place) in [
            (r#"{"do":"reset"}"#, [40, 30]),
            (r#"{"do":"orbit","right":0.4,"up":0.2}"#, [45, 35]),
            (r#"{"do":"choose","convention":"exact","spp":4,"effects":"-shadows","res":"61x33"}"#, [31, 17]),
            (r#"{"do":"choose","spp":1,"max_depth":0}"#, [0, 0]),
        ] {
            page.send(message);
            let version = page.session.view().0;
            let state = page.until(|words| words["finished"] == true && words["version"] == version);
            let [x, y] = place;
            page.send(&format!(r#"{{"do":"pick","x":{x},"y":{y}}}"#));
            let pixel = page.until(|words| words["is"] == "pixel");
            assert_eq!(pixel["table"]["waits"], device == "gpu", "{message}");
            let found =
                if device == "gpu" { page.until(|words| words["is"] == "tiers") } else { pixel["table"].clone() };
            assert_eq!(found["waits"], false);
            assert_eq!(found["tiers"].as_array().unwrap().len(), if device == "gpu" { 3 } else { 0 }, "{found}");

            // Of this very pixel.
            for (tier, c) in found["tiers"].as_array().unwrap().iter().flat_map(|tier| [0, 1, 2].map(|c| (tier, c))) {
                let [color, expected] = [&tier["color"], &found["color"]].map(|color| color[c].as_f64().unwrap());
                assert!((color - expected).abs() < 1e-3, "{message}: {tier} for {expected}");
            }
            let options = state["options"].as_str().unwrap();
            let json: Value = serde_json::from_str(&of_command(&work, options, place, device, &["--json"])).unwrap();
            for field in ["single", "device", "tiers", "lacking"] {
                assert_eq!(found[field], json[field], "{message}: {field}");
            }
            for field in ["color", "levels", "decisions"] {
                assert_eq!(found[field], json["reference"][field], "{message}: {field}");
            }
            let without_device = |text: &str| -> Vec<String> {
                text.lines().filter(|line| !line.starts_with("device ")).map(str::to_owned).collect()
            };
            let text = of_command(&work, options, place, device, &[]);
            assert_eq!(without_device(found["text"].as_str().unwrap()), without_device(&text), "{message}");
        }
    }
}

/// A tier that the device does not render at says why; one whose `f64` are pairs of `f32` says so.
#[test]
fn tiers_that_a_device_lacks_are_told() {
    let test = "view::tiers_that_a_device_lacks_are_told";
    if gpu(test).is_none() {
        return;
    }
    let work = work_with(start(), || {
        let mut gpu = Gpu::open(&Choice::Auto)?;
        gpu.device.info.f64 = false;
        Ok(Some(Arc::new(gpu)))
    });
    let mut page = work.page();
    page.finish();
    page.send(r#"{"do":"pick","x":45,"y":35}"#);
    let found = page.until(|words| words["is"] == "tiers");
    let tiers = found["tiers"].as_array().unwrap();
    let of = |tier: &str| tiers.iter().find(|found| found["tier"] == tier).unwrap_or_else(|| panic!("{found}"));
    assert_eq!((&of("fast")["pairs"], &of("double")["pairs"]), (&false.into(), &true.into()));
    assert!(found["text"].as_str().unwrap().contains("by pairs of f32: the device has no f64\n"), "{found}");
    // Beyond f32: no tier without f64.
    work.edit(&SCENE.replace("SPHERE b 4 4 -10 1 2 1", "SPHERE b 4e60 4e60 -1e61 1e60 2e60 1e60"));
    page.until(|words| words["is"] == "state" && !words["problem"].is_null());
    page.send(r#"{"do":"pick","x":45,"y":35}"#);
    let found = page.until(|words| words["is"] == "tiers");
    let lacking = found["lacking"].as_array().unwrap();
    assert_eq!((lacking.len(), found["tiers"].as_array().unwrap().len()), (3, 0), "{found}");
    for tier in lacking {
        let why = tier["why"].as_str().unwrap();
        assert!(why.contains("cannot render this scene"), "{why}");
    }
    assert_eq!(found["text"].as_str().unwrap().matches(" not on this device: ").count(), 3, "{found}");
}

#[test]
fn effects_are_measured_on_demand() {
    let work = Work::new(SCENE, false);
    let mut page = work.page();
    page.finish();
    page.send(r#"{"do":"measure"}"#);
    let costs = page.until(|words| words["is"] == "costs");
    let costs = costs["effects"].as_array().unwrap();
    let names: Vec<_> = costs.iter().map(|cost| cost["effect"].as_str().unwrap()).collect();
    assert_eq!(names, effects::Effect::ALL.map(effects::Effect::name));
    assert!(costs.iter().all(|cost| cost["with_ms"].as_f64().unwrap() > 0.0));
}

#[test]
fn patches_hold_what_has_changed() {
    let mut canvas = Canvas::new((40, 20));
    let mut rgb = vec![7; 40 * 20 * 3];
    let whole = canvas.rows(0, &rgb).unwrap();
    assert_eq!((whole.parts.len(), whole.parts[0].1.len()), (1, rgb.len()));
    assert_eq!(canvas.rows(0, &rgb), None);
    rgb[(9 * 40 + 5) * 3] = 1;
    rgb[(10 * 40 + 12) * 3 + 2] = 1;
    let patch = canvas.rows(0, &rgb).unwrap();
    let (part, pixels) = &patch.parts[0];
    assert_eq!((part.x, part.y, part.width, part.height, pixels.len()), (5, 8, 8, 8, 8 * 8 * 3));
    assert!(canvas.complete() == Some(&rgb[..]));
    assert_eq!(canvas.coarse(8, vec![0; 5 * 3 * 3]).parts[0].1.len(), 45);
    assert_eq!(canvas.complete(), None);
    assert_eq!(canvas.rows(0, &rgb).unwrap().parts[0].1.len(), rgb.len());
}

#[test]
fn patches_are_read_back_and_torn_ones_are_not() {
    let mut canvas = Canvas::new((17, 9));
    let patch = canvas.rows(0, &(0..17 * 9 * 3).map(|i| i as u8).collect::<Vec<_>>()).unwrap();
    let bytes = patch.encode();
    assert_eq!(Patch::decode(&bytes), Some(patch));
    for length in 0..bytes.len() {
        assert_eq!(Patch::decode(&bytes[..length]), None);
    }
}

#[test]
fn the_eye_moves_as_the_page_asks() {
    let scale = FlightScale { distance: 10.0 };
    let pose = Pose::of_file(scale);
    assert!(pose.is_of_file() && pose.options().is_empty());
    let close = |a: DVec3, b: DVec3| (a - b).length() < 1e-9;
    // To the right around the middle by a quarter: the eye is to the right of it and looks to the left.
    let right = pose.orbited(std::f64::consts::FRAC_PI_2, 0.0);
    assert!(close(right.eye, DVec3::new(10.0, 0.0, -10.0)), "{right:?}");
    assert!(close(pose.orbited(0.0, 0.5).eye, DVec3::new(0.0, 10.0 * 0.5_f64.sin(), -10.0 + 10.0 * 0.5_f64.cos())));
    assert!(close(pose.turned(std::f64::consts::FRAC_PI_2, 0.0).look_at, DVec3::new(10.0, 0.0, 0.0)));
    assert!(pose.turned(0.0, 0.5).look_at.y > 0.0);
    assert!(close(pose.flown(0.1, 0.2, 0.3, scale).eye, DVec3::new(1.0, 2.0, -3.0)));
    assert!(close(pose.zoomed(0.5, scale).eye, DVec3::new(0.0, 0.0, -5.0)));
    // Never through the poles, and never where there is no view.
    let mut pose = pose;
    for _ in 0..100 {
        pose = pose.orbited(0.3, 0.3).turned(0.2, 0.4).zoomed(0.5, scale).zoomed(f64::NAN, scale);
        pose = pose.flown(f64::INFINITY, 0.0, 0.0, scale).flown(1e300, 0.0, 0.0, scale);
        assert!(pose.view().is_ok() && pose.eye.is_finite());
    }
}

/// NEAR beyond what a page could reach, and spheres behind that: a distance all the same, and an eye that moves.
#[test]
fn worlds_of_any_size_can_be_flown_through() {
    for size in [1e-300, 1e-20, 1e15, 1e16, 1e60, 1e300] {
        let text = format!(
            "NEAR {size}\nLEFT -{size}\nRIGHT {size}\nBOTTOM -{size}\nTOP {size}\nRES 8 8\n\
             SPHERE a 0 0 -{} {size} {size} {size} 1 0 0 1 0 0 0 1",
            4.0 * size
        );
        let parsed = parse("test", text.as_bytes());
        let scale = FlightScale::of(parsed.scene.as_ref().unwrap());
        assert!(scale.distance > 0.0 && scale.distance.is_finite(), "{size}");
        let pose = Pose::of_file(scale);
        if (1e-300..1e90).contains(&size) {
            for moved in [pose.orbited(0.3, 0.0), pose.flown(0.0, 0.0, 0.1, scale), pose.zoomed(0.5, scale)] {
                assert!(moved.eye != pose.eye && moved.view().is_ok(), "{size}: {moved:?}");
            }
        }
    }
}

#[test]
fn only_the_page_itself_comes_in() {
    let access = Access { token: "abc".into(), loopback: true };
    let permits = |token, host, origin| access.permits(token, Some(host), origin, true);
    assert!(permits("abc", "127.0.0.1:8000", Some("http://127.0.0.1:8000")));
    assert!(permits("abc", "[::1]:8000", Some("http://[::1]:8000")));
    assert!(permits("abc", "localhost:8000", Some("http://localhost:8000")));
    assert!(!permits("abd", "127.0.0.1:8000", Some("http://127.0.0.1:8000")));
    assert!(!permits("", "127.0.0.1:8000", Some("http://127.0.0.1:8000")));
    assert!(!permits("abc", "127.0.0.1:8000", Some("http://127.0.0.1:9000")));
    assert!(!permits("abc", "127.0.0.1:8000", Some("https://elsewhere.example")));
    assert!(!permits("abc", "127.0.0.1:8000", None));
    // A name that resolves to this machine.
    assert!(!permits("abc", "elsewhere.example:8000", Some("http://elsewhere.example:8000")));
    assert!(access.permits("abc", Some("127.0.0.1:8000"), None, false));
    assert!(!access.permits("abc", None, None, false));
}

#[test]
fn messages_that_are_none_are_refused() {
    for text in [r#"{"do":"fly","right":1}"#, r#"{"do":"dance"}"#, "[]", ""] {
        assert!(serde_json::from_str::<PageRequest>(text).is_err(), "{text}");
    }
}

/// The program, ended when dropped.
struct Program(Child);

impl Drop for Program {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

fn request(address: &str, path: &str, headers: &str) -> String {
    let mut stream = TcpStream::connect(address).unwrap();
    write!(stream, "GET {path} HTTP/1.1\r\nHost: {address}\r\n{headers}\r\n").unwrap();
    stream.set_read_timeout(Some(PATIENCE)).unwrap();
    let mut answer = [0; 1024];
    let count = stream.read(&mut answer).unwrap();
    String::from_utf8_lossy(&answer[..count]).into_owned()
}

#[test]
fn the_program_serves_its_page_to_those_who_know_the_address() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("scene.txt"), SCENE).unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_trueray"));
    command.args(["view", "--device", "cpu", "scene.txt"]).current_dir(folder.path()).stdout(Stdio::piped());
    let mut program = Program(command.spawn().unwrap());
    let mut line = String::new();
    let output = program.0.stdout.as_mut().unwrap();
    std::io::BufRead::read_line(&mut std::io::BufReader::new(output), &mut line).unwrap();
    let (address, path) = line.trim().strip_prefix("http://").unwrap().split_once('/').unwrap();
    assert!(address.starts_with("127.0.0.1:"));
    let page = request(address, &format!("/{path}"), "");
    assert!(page.starts_with("HTTP/1.1 200") && page.contains("default-src 'none'"), "{page}");
    assert!(request(address, "/", "").starts_with("HTTP/1.1 404"));
    assert!(request(address, "/0123456789abcdef0123456789abcdef/", "").starts_with("HTTP/1.1 403"));
    let upgrade = "Connection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n\
                   Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n";
    let foreign = format!("{upgrade}Origin: http://elsewhere.example\r\n");
    assert!(request(address, &format!("/{path}ws"), &foreign).starts_with("HTTP/1.1 403"));
    let own = format!("{upgrade}Origin: http://{address}\r\n");
    assert!(request(address, &format!("/{path}ws"), &own).starts_with("HTTP/1.1 101"));
}

#[test]
fn the_page_asks_nothing_of_other_hosts() {
    let page = std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("src/viewer/page.html")).unwrap();
    for word in ["http://", "https://", "//cdn", "@import", "src=\"", "url("] {
        assert!(!page.contains(word), "{word}");
    }
}

#[test]
fn a_large_scene_is_shown_in_part_and_then_whole() {
    let mut text = "NEAR 1\nLEFT -1\nRIGHT 1\nBOTTOM -1\nTOP 1\nRES 64 48\nAMBIENT 1 1 1\n".to_owned();
    for i in 0..20_500 {
        let (x, y, z) = (i % 100 - 50, i / 100 % 100 - 50, -100 - i / 10_000);
        writeln!(text, "SPHERE s {x} {y} {z} 0.4 0.4 0.4 1 0.5 0 1 0 0 0 1").unwrap();
    }
    let work = Work::new(&text, false);
    let mut page = work.page();
    page.finish();
    page.send(r#"{"do":"orbit","right":0.2,"up":0.1}"#);
    page.finish();
    assert_eq!(page.rgb, rendered(None, &scene(&text), &page.session.view().1));
    // Its pixels are told without a table of all rays, and why.
    page.send(r#"{"do":"pick","x":32,"y":24}"#);
    let pixel = page.until(|words| words["is"] == "pixel");
    assert_eq!((&pixel["table"], pixel["hit"].is_null()), (&Value::Null, false), "{pixel}");
    assert_eq!(pixel["no_table"], "the scene has more than 20000 spheres");
}

/// The lights of particles turn with the eye, as those of `trueray render --eye` do.
#[test]
fn lights_of_particles_go_with_the_eye() {
    let atoms = "4\n\nO 0 0 0\nC 2 0.5 0\nN 0 2 1\nH -1 1 2\n";
    let picture_of = |view: &ViewState| {
        let (size, settings) = ((48, 36), view.settings());
        let options = Options { size, view: settings.view, ..Default::default() };
        rendered(None, &import::scene("atoms", atoms.as_bytes(), &options).unwrap(), view)
    };
    let options = Options { size: (48, 36), ..Default::default() };
    let work = work_on(atoms, options, start(), || Ok(None));
    let mut page = work.page();
    page.finish();
    assert!(page.rgb == picture_of(&page.session.view().1), "before the eye moves");
    page.send(r#"{"do":"orbit","right":0.9,"up":0.4}"#);
    page.finish();
    let view = page.session.view().1;
    assert!(page.rgb == picture_of(&view), "after it has moved");
    // Of two pages each has its own.
    let mut other = work.page();
    other.finish();
    assert!(other.rgb == picture_of(&other.session.view().1) && other.rgb != page.rgb);
    page.send(r#"{"do":"choose","max_depth":2}"#);
    page.finish();
    assert!(page.rgb == picture_of(&view));
    // The file changes, and is read again.
    work.edit(&atoms.replace("H -1 1 2", "H -1 1 1.5"));
    let before = page.rgb.clone();
    page.until(|words| words["finished"] == true && words["scene"]["lights"] == 32);
    while page.rgb == before {
        page.until(|words| words["finished"] == true);
    }
    let moved = atoms.replace("H -1 1 2", "H -1 1 1.5");
    let options = Options { size: (48, 36), view: view.settings().view, ..Default::default() };
    let scene = import::scene("atoms", moved.as_bytes(), &options).unwrap();
    assert!(page.rgb == rendered(None, &scene, &page.session.view().1));
}

/// A render loop whose pages start with this view and that opens a device like this.
fn work_with(
    start: ViewState,
    open: impl FnMut() -> Result<Option<Arc<Gpu>>, trueray::gpu::Error> + Send + 'static,
) -> Work {
    work_on(SCENE, Options::default(), start, open)
}

/// The same for another file, whose particles are imported like this.
fn work_on(
    text: &str,
    options: Options,
    start: ViewState,
    open: impl FnMut() -> Result<Option<Arc<Gpu>>, trueray::gpu::Error> + Send + 'static,
) -> Work {
    let mut work = Work::new(SCENE, false);
    work.render_loop.quit.store(true, Ordering::Relaxed);
    work.render_loop.wake.raise();
    work.thread.take().unwrap().join().unwrap();
    let path = work.folder.path().join("scene.txt");
    std::fs::write(&path, text).unwrap();
    let read = match Format::of(text.as_bytes()) {
        None => scene(text).into(),
        Some(format) => {
            let imported = Import::new("file", format, text.as_bytes(), options.clone()).first();
            ReadScene { scene: imported.parsed.scene.unwrap(), lamps: imported.lamps }
        }
    };
    work.render_loop = Arc::new(RenderLoop::new(SceneFile::new(&path, read, options), start));
    watch(
        Arc::clone(&work.render_loop.scene_file),
        Arc::clone(&work.render_loop.wake),
        Arc::clone(&work.render_loop.quit),
    )
    .unwrap();
    let rendering = Arc::clone(&work.render_loop);
    work.thread = Some(std::thread::spawn(move || {
        let mut open = open;
        rendering.run(&mut open);
    }));
    work
}

/// So many samples a pixel overflow a counter, which debug builds answer with a panic; no page can ask for them.
#[cfg(debug_assertions)]
#[test]
fn a_panic_is_told_and_what_is_asked_next_is_shown() {
    let start =
        ViewState { settings: Settings { pattern: Pattern::Grid { side: 1 << 16 }, ..Settings::classic() }, ..start() };
    let work = work_with(start, || Ok(None));
    let mut page = work.page();
    let words = page.until(|words| words["is"] == "failed");
    assert!(words["why"].as_str().unwrap().contains("overflow"), "{words}");
    // It is tried again with another scene, and not before.
    std::thread::sleep(Duration::from_millis(300));
    assert_eq!(page.session.take(), None);
    let edited = SCENE.replace("BACK 0.2", "BACK 0.7").replace("RES 90 70", "RES 64 48");
    work.edit(&edited);
    page.until(|words| words["is"] == "failed");
    page.send(r#"{"do":"choose","spp":1}"#);
    page.finish();
    assert_eq!((page.size, &page.rgb), ((64, 48), &rendered(None, &scene(&edited), &page.session.view().1)));
}

#[test]
fn a_panic_on_the_way_to_a_device_is_told_and_it_is_opened_again() {
    let mut attempts = 0;
    let work = work_with(start(), move || {
        attempts += 1;
        assert!(attempts > 2, "the driver has given up");
        Ok(None)
    });
    let mut page = work.page();
    let words = page.until(|words| words["is"] == "lost");
    assert!(words["why"].as_str().unwrap().contains("the driver has given up"), "{words}");
    page.finish();
    assert_eq!(page.rgb, rendered(None, &scene(SCENE), &start()));
}

/// Numbers of any size that a scene file may have: a picture or a reason, and never the end of the service.
#[test]
fn every_legal_scene_is_shown_or_refused() {
    use proptest::strategy::{Strategy, ValueTree};
    let work = Work::new(SCENE, false);
    let mut page = work.page();
    page.finish();
    let mut runner = proptest::test_runner::TestRunner::deterministic();
    let exponents = proptest::collection::vec(-300..300_i32, 8);
    let mut legal = 0;
    for round in 0..60 {
        let e = exponents.new_tree(&mut runner).unwrap().current();
        // Far apart in each number by itself, or all of one size as in near.txt.
        let power = |index: usize| format!("1e{}", if round % 2 == 0 { e[index] } else { e[0] });
        let text = format!(
            "NEAR {near}\nLEFT -{x}\nRIGHT {x}\nBOTTOM -{y}\nTOP {y}\nRES 24 16\n\
             SPHERE a 0 0 -{z} {s} {s} {t} 1 0 0 .3 .5 .2 .1 10\nSPHERE b {z} 0 -{z} {t} {s} {s} 1 0 0 .3 .5 .2 .1 10\n\
             LIGHT l {l} 0 {z} 1 1 1\nAMBIENT 1 1 1\n",
            near = power(1),
            x = power(2),
            y = power(3),
            z = power(4),
            s = power(5),
            t = power(6),
            l = power(7)
        );
        let Some(fresh) = parse("test", text.as_bytes()).scene else { continue };
        legal += 1;
        {
            let mut slot = work.render_loop.scene_file.slot.lock().unwrap();
            (slot.fresh, slot.error) = (Some(fresh.into()), None);
            slot.revision += 1;
        }
        work.render_loop.wake.raise();
        for message in [
            r#"{"do":"choose","res":"8x8"}"#,
            r#"{"do":"orbit","right":0.3,"up":0.1}"#,
            r#"{"do":"zoom","by":0.5}"#,
            r#"{"do":"fly","right":0.1,"up":-0.1,"forward":0.3}"#,
            r#"{"do":"pick","x":3,"y":3}"#,
            r#"{"do":"reset"}"#,
        ] {
            page.send(message);
        }
        let version = page.session.view().0;
        let words = page.until(|words| {
            let answered = words["finished"] == true || !words["problem"].is_null();
            words["is"] == "failed" || words["is"] == "lost" || (answered && words["version"] == version)
        });
        assert_eq!(words["is"], "state", "{words}\n{text}");
    }
    assert!(legal > 40, "{legal}");
    work.edit(&SCENE.replace("BACK 0.2", "BACK 0.7"));
    page.send(r#"{"do":"choose","res":""}"#);
    page.until(|words| words["finished"] == true && words["size"][0] == 90);
}

/// `trueray view` with these arguments, and how many files it may open; its address, and what it says on standard error.
fn served(folder: &Path, arguments: &str, files: u32) -> (Program, String) {
    std::fs::write(folder.join("scene.txt"), SCENE).unwrap();
    let mut command = Command::new("sh");
    let program = env!("CARGO_BIN_EXE_trueray");
    command.args(["-c", &format!("ulimit -n {files}; exec {program} view --device cpu {arguments} scene.txt")]);
    command.current_dir(folder).stdout(Stdio::piped()).stderr(std::fs::File::create(folder.join("errors")).unwrap());
    let mut program = Program(command.spawn().unwrap());
    let mut line = String::new();
    let output = program.0.stdout.as_mut().unwrap();
    std::io::BufRead::read_line(&mut std::io::BufReader::new(output), &mut line).unwrap();
    (program, line.trim().to_owned())
}

/// Whoever holds connections without a word is put out: by the time, or by those who come after.
#[cfg(unix)]
#[test]
fn strangers_that_say_nothing_keep_nobody_out() {
    let folder = tempfile::tempdir().unwrap();
    let (_program, url) = served(folder.path(), "", 128);
    let (address, path) = url.strip_prefix("http://").unwrap().split_once('/').unwrap();
    let mut idle: Vec<_> = (0..400).map(|_| TcpStream::connect(address).unwrap()).collect();
    let page = request(address, &format!("/{path}"), "");
    assert!(page.starts_with("HTTP/1.1 200"), "{page}");
    // The oldest have been put out already, and the newest will be.
    for stream in [0, idle.len() - 1] {
        let stream = &mut idle[stream];
        stream.set_read_timeout(Some(PATIENCE)).unwrap();
        let start = Instant::now();
        assert!(matches!(stream.read(&mut [0; 16]), Ok(0) | Err(_)));
        assert!(start.elapsed() < PATIENCE / 2);
    }
    assert!(request(address, &format!("/{path}"), "").starts_with("HTTP/1.1 200"));
}

#[cfg(unix)]
#[test]
fn a_page_for_the_network_has_an_address_that_opens_and_a_warning() {
    let folder = tempfile::tempdir().unwrap();
    let (_program, url) = served(folder.path(), "-q --listen 0.0.0.0:0", 256);
    let (address, path) = url.strip_prefix("http://").unwrap().split_once('/').unwrap();
    assert!(!address.starts_with("0.0.0.0"), "{address}");
    let page = request(address, &format!("/{path}"), "");
    assert!(page.starts_with("HTTP/1.1 200"), "{page}");
    let errors = std::fs::read_to_string(folder.path().join("errors")).unwrap();
    assert!(errors.contains("served to the network"), "{errors}");
}

/// The one script of the page runs by its hash, and no other.
#[cfg(unix)]
#[test]
fn only_the_pages_own_script_runs() {
    use base64::prelude::{BASE64_STANDARD, Engine as _};
    use sha2::Digest as _;
    let folder = tempfile::tempdir().unwrap();
    let (_program, url) = served(folder.path(), "", 256);
    let (address, path) = url.strip_prefix("http://").unwrap().split_once('/').unwrap();
    let mut stream = TcpStream::connect(address).unwrap();
    stream.set_read_timeout(Some(PATIENCE)).unwrap();
    write!(stream, "GET /{path} HTTP/1.1\r\nHost: {address}\r\nConnection: close\r\n\r\n").unwrap();
    let mut page = String::new();
    stream.read_to_string(&mut page).unwrap();
    let (head, body) = page.split_once("\r\n\r\n").unwrap();
    let policy = head.lines().find_map(|line| line.strip_prefix("content-security-policy: ")).unwrap();
    let scripts = policy.split("; ").find_map(|part| part.strip_prefix("script-src ")).unwrap();
    let parts: Vec<_> = body.split("<script>").collect();
    let [_, rest] = parts[..] else { panic!("{} scripts", parts.len() - 1) };
    let (script, after) = rest.split_once("</script>").unwrap();
    assert!(script.len() > 1000 && !after.contains("<script"));
    assert_eq!(scripts, format!("'sha256-{}'", BASE64_STANDARD.encode(sha2::Sha256::digest(script))));
}
