//! Moving pictures of which a part is sampled, as a page gets them, without a browser.

use serde_json::Value;
use trueray::gpu::DeviceKind;
use trueray::sampling::{Density, Fovea, Samples};
use trueray::viewer::{PLACES, Places, SAMPLES, SampleColors};

use crate::support::{gpu, say_skipped};
use crate::view::{Page, SCENE, Work, rendered, scene};

/// Large enough that a CPU does not render all of it in a frame, and small enough to be sampled at its full size.
const WIDTH: u32 = 3000;
const HEIGHT: u32 = 2200;
const SIZE: &str = r#"{"do":"choose","res":"3000x2200"}"#;

/// Whether the reference itself may render all of it in a frame.
fn has_many_cores() -> bool {
    std::thread::available_parallelism().is_ok_and(|cores| cores.get() > 4)
}

/// Sends a message, and draws until a picture of samples has come and words about it; `None` where the whole picture was there
/// as soon.
fn sketched(page: &mut Page, message: &str) -> Option<Value> {
    let before = page.sketches;
    page.send(message);
    let version = page.desk.wishes().0;
    loop {
        let words = page.until(|words| words["version"] == version && words["is"] == "state");
        if page.sketches > before {
            return Some(words);
        }
        if words["finished"] == true {
            return None;
        }
    }
}

/// The density that the page is told.
fn density(words: &Value) -> Density {
    let density = &words["sampled"]["density"];
    let number = |value: &Value| value.as_f64().unwrap();
    let fovea = density["fovea"].as_object().map(|fovea| Fovea {
        center: [number(&fovea["center"][0]), number(&fovea["center"][1])],
        radius: number(&fovea["radius"]),
        falloff: number(&fovea["falloff"]),
    });
    Density { fovea, far: number(&density["far"]) }
}

#[test]
fn a_moving_picture_has_samples_of_render_and_the_rest_follows() {
    for on_device in [false, true] {
        let device = if on_device { gpu("sketch::a_moving_picture") } else { None };
        if on_device && device.is_none() {
            continue;
        }
        let work = Work::new(SCENE, on_device);
        let mut page = work.page();
        page.finish();
        page.send(SIZE);
        page.finish();
        for (look, economy) in [
            (
                r#"{"do":"gaze","x":0.25,"y":0.75}"#,
                r#"{"do":"attend","economy":"foveated","least":0.03125,"radius":0.1}"#,
            ),
            (r#"{"do":"gaze","x":0.5,"y":0.5}"#, r#"{"do":"attend","economy":"sparse","least":0.0625}"#),
        ] {
            page.send(look);
            page.send(economy);
            let Some(words) = sketched(&mut page, r#"{"do":"orbit","right":0.1,"up":0.05}"#) else {
                let is_hardware = device.as_ref().is_some_and(|gpu| gpu.device.info.kind != DeviceKind::Software);
                assert!(is_hardware || has_many_cores(), "the picture was never sampled in part");
                say_skipped("sketch::a_moving_picture", "all of it is there in a frame");
                continue;
            };
            let expected = rendered(device.as_deref(), &scene(SCENE), &page.desk.wishes().1);
            let density = density(&words);
            assert_eq!(density.fovea.is_some(), economy.contains("foveated"));
            if let Some(fovea) = density.fovea {
                assert_eq!(fovea.center, [0.25 * f64::from(WIDTH), 0.75 * f64::from(HEIGHT)]);
            }
            let samples = Samples::new((WIDTH, HEIGHT), &density).unwrap();
            assert_eq!(words["sampled"]["pixels"], samples.pixels().len());
            let at = |rgb: &[u8], index: usize| [rgb[3 * index], rgb[3 * index + 1], rgb[3 * index + 2]];
            for &[x, y] in samples.pixels() {
                let index = (y * WIDTH + x) as usize;
                assert_eq!(page.ways[index], [0, 0]);
                assert_eq!(at(&page.rgb, index), at(&expected, index), "({x}, {y}), on the device: {on_device}");
            }
            assert_ne!(page.rgb, expected);
            let words = page.finish();
            assert!(words["sampled"].is_null());
            assert!(page.rgb == expected, "the picture at rest, on the device: {on_device}");
        }
    }
}

#[test]
fn a_page_may_want_fewer_pixels_in_place_of_fewer_samples() {
    if has_many_cores() {
        say_skipped("sketch::a_page_may_want_fewer_pixels", "all of it is there in a frame");
        return;
    }
    let work = Work::new(SCENE, false);
    let mut page = work.page();
    page.finish();
    page.send(r#"{"do":"attend","economy":"coarse"}"#);
    page.send(SIZE);
    page.finish();
    page.send(r#"{"do":"orbit","right":0.1,"up":0.05}"#);
    let words = page.until(|words| words["step"].as_u64() > Some(1));
    assert!(words["sampled"].is_null());
    page.finish();
    assert_eq!(page.sketches, 0);
}

#[test]
fn what_makes_no_sense_is_said() {
    let work = Work::new(SCENE, false);
    let mut page = work.page();
    page.finish();
    let before = page.desk.attention();
    for (message, word) in [
        (r#"{"do":"attend","economy":"lazy"}"#, "lazy"),
        (r#"{"do":"attend","least":0}"#, "least density"),
        (r#"{"do":"attend","radius":-1,"least":0.5}"#, "radius"),
        (r#"{"do":"attend","falloff":0}"#, "falloff"),
    ] {
        page.send(message);
        page.until(|words| words["trouble"].as_str().is_some_and(|trouble| trouble.contains(word)));
        assert_eq!(page.desk.attention(), before);
    }
    page.send(r#"{"do":"gaze","x":7,"y":-3}"#);
    assert_eq!(page.desk.attention().gaze, [1.0, 0.0]);
}

#[test]
fn places_and_samples_are_as_documented() {
    // Two rows of three pixels; the samples are the first and the last pixel.
    let last = 1 << 16 | 2;
    let places = Places::new((3, 2), &[0, 0, last, 0, last, last]);
    assert!(places.fits);
    let message = places.encode(3);
    let words: Vec<u32> = message[..24].as_chunks::<4>().0.iter().map(|word| u32::from_le_bytes(*word)).collect();
    assert_eq!(words, [PLACES, 0, 3, 2, 2, 3]);
    assert_eq!(message[24..], [0, 0, 255, 0, 0, 1, 0, 255, 1, 0, 0, 0]);
    assert!(!Places::new((300, 1), &[299; 300]).fits);
    let message = SampleColors { size: (3, 2), rgb: vec![1, 2, 3, 4, 5, 6] }.encode(1);
    assert_eq!(message[..4], SAMPLES.to_le_bytes());
    assert_eq!(message[24..], [1, 2, 3, 4, 5, 6]);
}
