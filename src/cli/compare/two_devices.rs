//! `--device A --device B`: a scene on two devices, the pictures beside each other and each beside the reference.

use serde::Serialize;

use super::{Args, load, save};
use crate::cli::failure::{DIFFERENT, Failure, OK, USAGE};
use crate::cli::files::report_json;
use crate::cli::options::{DeviceOptions, open_device};
use crate::cli::output::{out, outln};
use crate::compare::{Difference, Explanation, Verdict, heatmap, three_wide, verdict};
use crate::cpu::Reference;
use crate::engine::{Backend, Engine, device_name, render_picture};
use crate::film::Picture;
use crate::gpu::Choice;
use crate::words::visible;

/// What `--json` prints.
#[derive(Debug, Serialize)]
struct Report {
    a: Side,
    b: Side,
    scene: String,
    verdict: Verdict,
    exceeded: Vec<String>,
    /// Of the two devices.
    #[serde(flatten)]
    difference: Difference,
}

/// A device's picture.
#[derive(Debug, Serialize)]
struct Side {
    /// The device and the tier.
    name: String,
    /// Its picture beside the reference.
    explanation: Explanation,
    not_finite_pixels: u64,
}

pub(super) fn compare(args: &Args, devices: &[DeviceOptions; 2]) -> Result<u8, Failure> {
    let (Some(scene), []) = (&args.scene, &args.pictures[..]) else {
        return Err(Failure::new(USAGE, "two devices compare their pictures of --scene SCENE, and no other"));
    };
    if args.report.is_some() {
        return Err(Failure::new(USAGE, "--report is for one device's picture, or for two pictures"));
    }
    let loaded = load(args, scene)?;
    let scene = &loaded.scene;
    let picture = |rgb| Picture::assemble(scene.width, scene.height, rgb);
    let settings = args.picture.settings()?;
    let effects = args.picture.renderable_effects(&scene.viewed(&settings))?;
    let (rgb, _) = render_picture(&mut Engine::new(Backend::Reference, scene.viewed(&settings), &effects)?)?;
    let expected = picture(rgb);
    let reference = Reference::new(&scene.viewed(&settings), &effects);
    let render = |device: &DeviceOptions| {
        let choice = if device.device == Choice::Auto { &Choice::Gpu } else { &device.device };
        if *choice == Choice::Cpu {
            return Err(Failure::new(
                USAGE,
                "--device cpu is the reference, beside which each device's picture is held anyway",
            ));
        }
        let gpu = open_device(choice)?;
        let viewed = scene.viewed(&settings);
        let selection = device.selection(Some(&gpu), &viewed, &effects);
        let backend = Backend::of(Some(&gpu), &selection);
        let (rgb, not_finite_pixels) = render_picture(&mut Engine::new(backend, viewed, &effects)?)?;
        let picture = picture(rgb);
        let explanation = Explanation::of(&picture, &expected, &reference, &backend.judge());
        let name = format!("{}, {selection}", device_name(Some(&gpu)));
        Ok((picture, Side { name, explanation, not_finite_pixels }))
    };
    let [(picture_a, a), (picture_b, b)] = [render(&devices[0])?, render(&devices[1])?];

    let difference = Difference::between(&picture_a, &picture_b)?;
    let limits = args.limits.limits(true);
    let mut exceeded = limits.exceeded(&difference);
    for (letter, side) in [("A", &a), ("B", &b)] {
        let (unexplained, most) = (side.explanation.unexplained, args.limits.max_unexplained);
        if unexplained > most {
            exceeded.push(format!("unexplained pixels of {letter}: {unexplained}, limit {most}"));
        }
        if side.not_finite_pixels > 0 {
            exceeded.push(format!("pixels of {letter} that are not finite: {}", side.not_finite_pixels));
        }
    }
    let verdict = if exceeded.is_empty() { verdict(&difference, &limits) } else { Verdict::Different };
    if let Some(path) = &args.heatmap {
        save(path, &heatmap(&picture_a, &picture_b)?)?;
    }
    if let Some(path) = &args.three_wide {
        save(path, &three_wide(&picture_a, &picture_b)?)?;
    }
    if args.json {
        out!("{}", report_json(&Report { a, b, scene: loaded.name.clone(), verdict, exceeded, difference })?);
    } else {
        out!("{}", difference.report(&visible(&a.name), &visible(&b.name)));
        for (letter, side) in [("A", &a), ("B", &b)] {
            outln!("\n{letter} beside the reference of {}", visible(&loaded.name));
            out!("{}", side.explanation.report());
        }
        outln!("");
        for limit in &exceeded {
            outln!("over the limit    {limit}");
        }
        outln!("verdict           {verdict}");
    }
    Ok(if verdict == Verdict::Different { DIFFERENT } else { OK })
}
