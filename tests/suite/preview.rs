//! Moving pictures of which a part is sampled, as a page gets them, without a browser.

use serde_json::Value;
use trueray::gpu::DeviceKind;
use trueray::sampling::{Density, Fovea, Samples};
use trueray::viewer::{PageRequest, SAMPLE_COLORS, SAMPLE_MAP, SampleColors, SampleMap};

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
fn sampled_in_part(page: &mut Page, message: &str) -> Option<Value> {
    let before = page.sampled_pictures;
    page.send(message);
    let version = page.session.view().0;
    loop {
        let words = page.until(|words| words["version"] == version && words["is"] == "state");
        if page.sampled_pictures > before {
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
        let device = if on_device { gpu("preview::a_moving_picture") } else { None };
        if on_device && device.is_none() {
            continue;
        }
        let work = Work::new(SCENE, on_device);
        let mut page = work.page();
        page.finish();
        page.send(SIZE);
        page.finish();
        for (gaze, preview) in [
            (
                r#"{"do":"gaze","x":0.25,"y":0.75}"#,
                r#"{"do":"preview","mode":"foveated","least":0.03125,"radius":0.1}"#,
            ),
            (r#"{"do":"gaze","x":0.5,"y":0.5}"#, r#"{"do":"preview","mode":"sparse","least":0.0625}"#),
        ] {
            page.send(gaze);
            page.send(preview);
            let Some(words) = sampled_in_part(&mut page, r#"{"do":"orbit","right":0.1,"up":0.05}"#) else {
                let is_hardware = device.as_ref().is_some_and(|gpu| gpu.device.info.kind != DeviceKind::Software);
                assert!(is_hardware || has_many_cores(), "the picture was never sampled in part");
                say_skipped("preview::a_moving_picture", "all of it is there in a frame");
                continue;
            };
            let expected = rendered(device.as_deref(), &scene(SCENE), &page.session.view().1);
            let density = density(&words);
            assert_eq!(density.fovea.is_some(), preview.contains("foveated"));
            if let Some(fovea) = density.fovea {
                assert_eq!(fovea.center, [0.25 * f64::from(WIDTH), 0.75 * f64::from(HEIGHT)]);
            }
            let samples = Samples::new((WIDTH, HEIGHT), &density).unwrap();
            assert_eq!(words["sampled"]["pixels"], samples.pixels().len());
            let at = |rgb: &[u8], index: usize| [rgb[3 * index], rgb[3 * index + 1], rgb[3 * index + 2]];
            for &[x, y] in samples.pixels() {
                let index = (y * WIDTH + x) as usize;
                assert_eq!(page.offsets[index], [0, 0]);
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
        say_skipped("preview::a_page_may_want_fewer_pixels", "all of it is there in a frame");
        return;
    }
    let work = Work::new(SCENE, false);
    let mut page = work.page();
    page.finish();
    page.send(r#"{"do":"preview","mode":"coarse"}"#);
    page.send(SIZE);
    page.finish();
    page.send(r#"{"do":"orbit","right":0.1,"up":0.05}"#);
    let words = page.until(|words| words["step"].as_u64() > Some(1));
    assert!(words["sampled"].is_null());
    page.finish();
    assert_eq!(page.sampled_pictures, 0);
}

#[test]
fn what_makes_no_sense_is_said() {
    let work = Work::new(SCENE, false);
    let mut page = work.page();
    page.finish();
    let before = page.session.preview();
    let unknown = serde_json::from_str::<PageRequest>(r#"{"do":"preview","mode":"lazy"}"#).unwrap_err();
    assert!(unknown.to_string().contains("lazy"), "{unknown}");
    for (message, word) in [
        (r#"{"do":"preview","least":0}"#, "least density"),
        (r#"{"do":"preview","radius":-1,"least":0.5}"#, "radius"),
        (r#"{"do":"preview","falloff":0}"#, "falloff"),
    ] {
        page.send(message);
        page.until(|words| words["problem"].as_str().is_some_and(|problem| problem.contains(word)));
        assert_eq!(page.session.preview(), before);
    }
    page.send(r#"{"do":"gaze","x":7,"y":-3}"#);
    assert_eq!(page.session.preview().gaze, [1.0, 0.0]);
}

#[test]
fn sample_maps_and_colours_are_as_documented() {
    // Two rows of three pixels; the samples are the first and the last pixel.
    let last = 1 << 16 | 2;
    let map = SampleMap::new((3, 2), &[0, 0, last, 0, last, last]);
    assert!(map.fits);
    let message = map.encode(3);
    let words: Vec<u32> = message[..24].as_chunks::<4>().0.iter().map(|word| u32::from_le_bytes(*word)).collect();
    assert_eq!(words, [SAMPLE_MAP, 0, 3, 2, 2, 3]);
    assert_eq!(message[24..], [0, 0, 255, 0, 0, 1, 0, 255, 1, 0, 0, 0]);
    assert!(!SampleMap::new((300, 1), &[299; 300]).fits);
    let message = SampleColors { size: (3, 2), rgb: vec![1, 2, 3, 4, 5, 6] }.encode(1);
    assert_eq!(message[..4], SAMPLE_COLORS.to_le_bytes());
    assert_eq!(message[24..], [1, 2, 3, 4, 5, 6]);
}
