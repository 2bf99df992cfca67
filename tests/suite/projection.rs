//! Orthographic pictures: what a pixel shows by hand, the same on every device and at every tier, and what goes with them and what not.

use glam::DVec3;
use trueray::accel::Rounding;
use trueray::area::Area;
use trueray::cpu::{Dd, Decision, Inspector, Margin, Reference, picked};
use trueray::effects::{Effect, Effects};
use trueray::engine::{Backend, Engine, render_picture};
use trueray::pattern::{Filter, Pattern};
use trueray::precision::{self, Selection, Tier};
use trueray::scene::{Scene, Window};
use trueray::settings::Settings;
use trueray::view::{Projection, View};

use crate::support::{Case, Folder, gpu, gpu_picture, orthographic, scene, scene_files, scene_of, widened};

/// A scene with a window of this half width around the view.
fn seen(text: &str, half: f64, (width, height): (u32, u32)) -> Scene {
    let mut scene = scene_of(text);
    (scene.width, scene.height) = (width, height);
    let up = half * f64::from(height) / f64::from(width);
    scene.window = Window { left: -half, right: half, bottom: -up, top: up, ..scene.window };
    scene
}

fn picture(backend: Backend, scene: &Scene, settings: &Settings) -> Vec<u8> {
    let viewed = scene.viewed(settings);
    let effects = Effects::of(&viewed);
    render_picture(&mut Engine::new(backend, viewed, &effects).unwrap()).unwrap().0
}

/// The scenes of these folders, each with a window as large as what an eye sees at the depth of the first sphere.
fn scenes(folders: &[&str]) -> Vec<(String, Scene)> {
    let of = |file: &std::path::PathBuf| {
        (file.display().to_string(), Scene { width: 48, height: 36, ..widened(scene(file)) })
    };
    scene_files(folders).iter().map(of).collect()
}

// --- by hand ---------------------------------------------------------------------------------------------------------------

/// A disc of the sphere's own radius, however far away it is and wherever NEAR is, with its rim: all numbers are sixteenths.
#[test]
fn a_sphere_is_a_disc_of_its_radius() {
    let gpu = gpu("projection::a_sphere_is_a_disc_of_its_radius");
    for (z, near) in [(-3, 1.0), (-3, 0.015_625), (-1000, 1.0), (-3, 1.5)] {
        let text = format!("SPHERE s 0.5 0.25 {z} 1.25 1.25 1.25 1 1 1 1 0 0 0 1\nAMBIENT 1 1 1");
        let mut scene = seen(&text, 2.0, (64, 64));
        scene.window.near = near;
        let settings = orthographic(Settings::classic());
        let expected: Vec<u8> = (0..64 * 64)
            .flat_map(|at: i32| {
                let (x, y) = (at % 64 - 32 - 8, 32 - at / 64 - 4);
                [if x * x + y * y <= 20 * 20 { 255 } else { 0 }; 3]
            })
            .collect();
        assert!(picture(Backend::Reference, &scene, &settings) == expected, "{z}, {near}");
        let Some(gpu) = &gpu else { continue };
        for tier in [Tier::Robust, Tier::Double] {
            assert!(picture(Backend::Device(gpu, tier), &scene, &settings) == expected, "{z}, {near} at {tier}");
        }
        assert!(picture(Backend::Certified(gpu, Tier::Fast), &scene, &settings) == expected, "{z}, {near}, certified");
        // In f32 a tangent may be missed, and nothing else.
        let shown = picture(Backend::Device(gpu, Tier::Fast), &scene, &settings);
        assert!(shown.iter().zip(&expected).filter(|(a, b)| a != b).count() <= 3 * 12, "{z}, {near} at fast");
    }
}

/// The normal of a point of the disc, a light's direction there, and a viewer in the direction of +z.
#[test]
fn light_is_seen_along_the_view() {
    let text = "SPHERE s 0.5 0.25 -7 1.5 1.5 1.5 0.5 1 0.25 0 0.5 0.4 0 5\nLIGHT l 3 5 2 0.9 0.8 0.7";
    let scene = seen(text, 2.0, (32, 32));
    let settings = orthographic(Settings::exact());
    let effects = Effects::of(&scene.viewed(&settings));
    let reference = Reference::<f64>::new(&scene.viewed(&settings), &effects);
    let mut lit = 0;
    for at in 0..32 * 32 {
        let (i, j) = (at % 32, at / 32);
        let (x, y) = ((f64::from(i) + 0.5) / 8.0 - 2.0, 2.0 - (f64::from(j) + 0.5) / 8.0);
        let (dx, dy) = (x - 0.5, y - 0.25);
        let square = 1.5 * 1.5 - dx * dx - dy * dy;
        let mut expected = DVec3::ZERO;
        if square > 0.0 {
            let normal = DVec3::new(dx, dy, square.sqrt()) / 1.5;
            let to_light = (DVec3::new(3.0, 5.0, 2.0) - DVec3::new(x, y, -7.0 + square.sqrt())).normalize();
            let cosine = normal.dot(to_light);
            if cosine > 0.0 {
                let mirrored = 2.0 * cosine * normal - to_light;
                let light = DVec3::new(0.9, 0.8, 0.7);
                expected =
                    light * DVec3::new(0.5, 1.0, 0.25) * 0.5 * cosine + light * 0.4 * mirrored.z.max(0.0).powi(5);
                lit += 1;
            }
        }
        let color = reference.color(i, j).unwrap();
        assert!((color - expected).abs().max_element() < 1e-12, "{i} {j}: {color} {expected}");
    }
    assert!(lit > 200, "{lit}");
}

/// What lies before the image plane is cut away: there the inner wall is seen, and a ball that only touches the plane is whole.
#[test]
fn the_image_plane_cuts_spheres_open() {
    let text = "SPHERE s 0 0 -2 1.5 1.5 1.5 1 1 1 1 0 0 0 1\nAMBIENT 1 1 1";
    let mut scene = seen(text, 2.0, (16, 16));
    scene.window.near = 1.0;
    let settings = orthographic(Settings::exact());
    let hit = |x, y| picked(&scene.viewed(&settings), x, y);
    let middle = hit(8, 8).unwrap();
    let depth = (1.5_f64.powi(2) - 2.0 * 0.125_f64.powi(2)).sqrt();
    assert!(middle.inside && (middle.t - (2.0 + depth)).abs() < 1e-12, "{middle:?}");
    assert!((middle.position - DVec3::new(0.125, -0.125, -2.0 - depth)).length() < 1e-12, "{middle:?}");
    // Where the front lies beyond the plane it is seen: 1.5² − 1² = 1.25 from the axis.
    let rim = hit(12, 8).unwrap();
    assert!(!rim.inside && rim.t > 1.0, "{rim:?}");
    let before = Scene { window: Window { near: 5.0, ..scene.window }, ..scene.clone() };
    assert_eq!(picked(&before.viewed(&settings), 8, 8), None);
    assert!(Effects::of(&scene.viewed(&settings)).set.has(Effect::Shells));
}

/// From the side, and from above with another direction upwards: the scene turned instead.
#[test]
fn a_turned_view_shows_the_turned_scene() {
    let ball = |[x, y, z]: [f64; 3], [a, b, c]: [f64; 3]| {
        format!("SPHERE s {x} {y} {z} {a} {b} {c} 0.9 0.5 0.1 0.2 0.6 0.4 0.5 9\n")
    };
    let rest = |[x, y, z]: [f64; 3]| format!("LIGHT l {x} {y} {z} 0.9 0.9 0.8\nAMBIENT 0.3 0.3 0.3\nBACK 0.1 0.2 0.3");
    let text = |turn: fn([f64; 3]) -> [f64; 3]| {
        let size = |s| turn(s).map(f64::abs);
        ball(turn([0.25, 0.5, -4.0]), size([1.0, 0.5, 0.75]))
            + &ball(turn([-1.0, -0.5, -6.0]), size([1.0, 1.0, 1.0]))
            + &rest(turn([3.0, 5.0, 1.0]))
    };
    let plain = seen(&text(|v| v), 2.0, (40, 30));
    let expected = picture(Backend::Reference, &plain, &orthographic(Settings::exact()));
    // Along +x, and downwards with −z upwards in the picture.
    let aside = seen(&text(|[x, y, z]| [-z, y, x]), 2.0, (40, 30));
    let below = seen(&text(|[x, y, z]| [x, z, -y]), 2.0, (40, 30));
    for (scene, ahead, up) in [(aside, DVec3::X, DVec3::Y), (below, -DVec3::Y, -DVec3::Z)] {
        for eye in [DVec3::ZERO, DVec3::new(64.0, -32.0, 16.0)] {
            let mut scene = scene.clone();
            scene.spheres.iter_mut().for_each(|sphere| sphere.center += eye);
            scene.lights.iter_mut().for_each(|light| light.position += eye);
            let view = View::new(eye, Some(eye + ahead), up).unwrap().projected(Projection::Orthographic);
            let settings = Settings { view, ..Settings::exact() };
            assert!(picture(Backend::Reference, &scene, &settings) == expected, "{ahead} from {eye}");
        }
    }
}

/// Powers of two change no byte, and other factors no more than rounding explains.
#[test]
fn worlds_of_any_size_show_the_same_picture() {
    let scene = scenes(&["show"]).into_iter().find(|(name, _)| name.contains("showcase")).unwrap().1;
    let settings = orthographic(Settings { secondary: Settings::exact().secondary, ..Settings::classic() });
    let expected = picture(Backend::Reference, &scene, &settings);
    for factor in [2.0_f64.powi(60), 2.0_f64.powi(-60), 2.0_f64.powi(9)] {
        let mut scene = scene.clone();
        scene
            .spheres
            .iter_mut()
            .for_each(|sphere| (sphere.center, sphere.scale) = (sphere.center * factor, sphere.scale * factor));
        scene.lights.iter_mut().for_each(|light| light.position *= factor);
        let Window { near, left, right, bottom, top } = scene.window;
        let [near, left, right, bottom, top] = [near, left, right, bottom, top].map(|x| x * factor);
        scene.window = Window { near, left, right, bottom, top };
        assert!(picture(Backend::Reference, &scene, &settings) == expected, "{factor:e}");
    }
}

// --- every way of rendering ------------------------------------------------------------------------------------------------

#[test]
fn lists_leave_out_nothing() {
    for (name, scene) in scenes(&["effects", "hard"]) {
        for base in [
            Settings::classic(),
            Settings { pattern: Pattern::Fibonacci { count: 3, filter: Filter::Tent }, ..Settings::exact() },
        ] {
            let settings = orthographic(base);
            let viewed = scene.viewed(&settings);
            let effects = Effects::of(&viewed);
            let rows = |rounding| {
                let mut rgb = vec![0; 48 * 36 * 3];
                Reference::<f64>::with_rounding(&viewed, &effects, rounding).rows(0, &mut rgb).unwrap();
                rgb
            };
            assert!(rows(Rounding::DOUBLE) == rows(Rounding::UNKNOWN), "{name}");
        }
    }
}

/// Decisions of the reference in `f64` are those of double-double.
#[test]
fn the_reference_is_proven() {
    for (name, scene) in scenes(&["hard", "show"]) {
        let settings = orthographic(Settings::exact());
        let viewed = scene.viewed(&settings);
        let effects = Effects::of(&viewed);
        let (double, exact) = (Reference::<f64>::new(&viewed, &effects), Reference::<Dd>::new(&viewed, &effects));
        let off = (0..48 * 36).filter(|&at| {
            let [a, b] = [double.color(at % 48, at / 48), exact.color(at % 48, at / 48)];
            (a.unwrap() - b.unwrap()).abs().max_element() > 1e-6
        });
        assert_eq!(off.count(), 0, "{name}");
    }
}

#[test]
fn every_tier_is_explained_and_certified_pictures_are_the_reference() {
    let Some(gpu) = gpu("projection::every_tier_is_explained_and_certified_pictures_are_the_reference") else { return };
    for (name, scene) in scenes(&["basic", "effects", "hard", "show"]) {
        for base in [Settings::classic(), Settings { pattern: Pattern::Grid { side: 2 }, ..Settings::exact() }] {
            let settings = orthographic(base);
            let case = Case::new(&scene, &settings);
            let area = Area { left: 13, top: 7, width: 30, height: 25 };
            let cut = |rgb: &[u8]| -> Vec<u8> {
                let rows = rgb.chunks(48 * 3).skip(7).take(25);
                rows.flat_map(|row| row[13 * 3..43 * 3].to_vec()).collect()
            };
            for tier in Tier::ALL {
                let (shown, not_finite) = gpu_picture(&gpu, tier, &scene, &settings, &case.effects);
                assert_eq!(not_finite, 0);
                let differing = shown.pixels().iter().zip(case.expected.pixels()).filter(|(a, b)| a != b).count();
                case.assert_explained(&format!("{name} at {tier}"), &shown, Backend::Device(&gpu, tier).judge());
                let is_exact = tier == Tier::Double && gpu.device.info.f64;
                assert!(!is_exact || differing == 0, "{name}: {differing}");
                let part = scene.viewed(&settings).within(area).unwrap();
                let part = render_picture(&mut Engine::new(Backend::Device(&gpu, tier), part, &case.effects).unwrap())
                    .unwrap()
                    .0;
                assert!(part == cut(shown.rgb()), "{name} at {tier}: a part");
            }
            for tier in [Tier::Fast, Tier::Double] {
                let certified = picture(Backend::Certified(&gpu, tier), &scene, &settings);
                assert!(certified == case.expected.rgb(), "{name}, certified from {tier}");
            }
        }
    }
}

/// Balls of round numbers, where rays meet the critical angle itself: a ray that enters there has a chord of about no length, and rounding
/// of its direction decides whether that is longer than the epsilon.
#[test]
fn chords_of_about_no_length_are_explained() {
    let Some(gpu) = gpu("projection::chords_of_about_no_length_are_explained") else { return };
    let (mut differing, mut critical) = (0, 0);
    for (center, eta) in [("-1 1 -4", 0.25), ("0 0 -4", 0.25), ("1 0 -3", 0.25), ("0 0 -4", 0.5), ("0 1 -5", 0.75)] {
        let text = format!(
            "SPHERE g {center} 1 1 1 0.5 0.9 0.7 0.02 0 0.3 0.1 20 0.9 {eta}\nBACK 0.3 0.4 0.5\nAMBIENT 0.4 0.4 0.4"
        );
        let scene = seen(&text, 2.0, (64, 64));
        let settings = orthographic(Settings::classic());
        let case = Case::new(&scene, &settings);
        for tier in Tier::ALL {
            let (shown, _) = gpu_picture(&gpu, tier, &scene, &settings, &case.effects);
            let judge = Backend::Device(&gpu, tier).judge();
            case.assert_explained(&format!("{center}, {eta} at {tier}"), &shown, judge);
            differing += case.explained(&shown, judge).differing;
        }
        // Where the reference itself has the angle all but met.
        let inspector = Inspector::new(&scene.viewed(&settings), &case.effects);
        let is_met = |it: &Margin| it.decision == Decision::CriticalAngle && it.margin < 1e-12;
        let pixels = (0..64 * 64).filter_map(|pixel| inspector.pixel(pixel % 64, pixel / 64));
        critical += pixels.filter(|record| record.decisions.iter().any(is_met)).count();
    }
    assert!(differing > 20 && critical > 4, "{differing} pixels differ, {critical} meet the angle");
}

/// `fast` leaves few pixels to the reference.
#[test]
fn a_kernel_is_sure_of_most_pixels() {
    let Some(gpu) = gpu("projection::a_kernel_is_sure_of_most_pixels") else { return };
    let (mut sure, mut all) = (0, 0);
    for (_, scene) in scenes(&["effects"]) {
        let viewed = scene.viewed(&orthographic(Settings::exact()));
        let effects = Effects::of(&viewed);
        let mut engine = Engine::new(Backend::Certified(&gpu, Tier::Fast), viewed, &effects).unwrap();
        render_picture(&mut engine).unwrap();
        (sure, all) = (sure + engine.stages().unwrap().kernel, all + 48 * 36);
    }
    assert!(sure * 100 > all * 97, "{sure} of {all}");
}

/// The cheapest tier does for usual scenes, and not for what is far away beside its size.
#[test]
fn the_precision_is_chosen_for_what_is_seen() {
    let choice = |text: &str, half| {
        let scene = seen(text, half, (64, 48));
        let viewed = scene.viewed(&orthographic(Settings::exact()));
        Selection::of(&viewed, &Effects::of(&viewed), precision::Request::Auto, &Tier::ALL).tier
    };
    let rest = "\nLIGHT l 3 5 0 0.9 0.9 0.9\nAMBIENT 0.2 0.2 0.2";
    let ball = |x: f64, r: f64| format!("SPHERE s {x} 0 -10 {r} {r} {r} 1 1 1 0.2 0.6 0.4 0 5{rest}");
    assert_eq!(choice(&ball(0.0, 1.0), 2.0), Tier::Fast);
    // The plane where rays begin may cut a ball: nothing near it is seen.
    assert_eq!(choice(&format!("SPHERE s 0 0 0 5 5 5 1 1 1 0.2 0.6 0.4 0 5{rest}"), 6.0), Tier::Fast);
    assert_ne!(choice(&ball(0.0, 1e-6), 2e-6), Tier::Fast);
}

// --- the program -----------------------------------------------------------------------------------------------------------

/// A folder with two spheres, one of them an ellipsoid.
fn folder() -> Folder {
    let text = "SPHERE a 0 0 -6 2 2 2 0.9 0.2 0.1 0.3 0.7 0.3 0.4 20\nSPHERE b 2 1 -5 0.5 1 0.5 0.1 0.8 0.3 0.3 0.6 0.2 0 10\n\
                LIGHT l 5 6 0 0.9 0.9 0.8\nAMBIENT 0.3 0.3 0.3\nBACK 0.1 0.1 0.2\n";
    Folder::with_scene(&seen(text, 3.0, (48, 36)).to_string())
}

#[test]
fn what_does_not_go_with_it_is_refused() {
    let folder = folder();
    std::fs::write(folder.path("views.csv"), "eye_z,fov\n1,30\n").unwrap();
    std::fs::write(folder.path("atoms.xyz"), "1\n\nO 0 0 0\n").unwrap();
    for (arguments, code, message) in [
        ("render --fov 40 scene.txt", 2, "an orthographic picture has no field of view"),
        ("render --views views.csv scene.txt -o f.png", 3, "an orthographic picture has no field of view"),
        ("render atoms.xyz -o f.png", 2, "particles are framed for an eye"),
        ("view scene.txt", 2, "the live view is perspective only"),
    ] {
        folder.says(&format!("{arguments} --projection orthographic"), code, message);
    }
    folder.says("render --projection isometric scene.txt", 2, "possible values: perspective, orthographic");
}

#[test]
fn the_program_knows_it_everywhere() {
    let folder = folder();
    let option = "--projection orthographic";
    folder.says(&format!("render -q --device cpu {option} --certificate c.json scene.txt -o a.png"), 0, "");
    folder.says(
        &format!("verify --device cpu a.png --scene scene.txt --certificate c.json {option}"),
        0,
        "of this scene",
    );
    folder.says("verify --device cpu a.png --scene scene.txt", 1, "");
    folder.says(
        "verify --device cpu a.png --scene scene.txt --certificate c.json",
        1,
        "of something else: settings.view.projection is \"orthographic\" there and none here",
    );
    folder.says(&format!("compare --device cpu --scene scene.txt a.png {option} --explain"), 0, "");
    folder.says("compare --device cpu --scene scene.txt a.png", 1, "unexplained");
    folder.says(&format!("pixel --device cpu scene.txt 24 18 {option}"), 0, "");
    folder.says(&format!("check scene.txt {option}"), 0, "");
    for tile in 0..2 {
        folder.says(&format!("render -q --device cpu {option} --tile {tile}/2 scene.txt -o {tile}.png"), 0, "");
    }
    folder.says("merge 0.png 1.png -o merged.png", 0, "");
    folder.says("compare merged.png a.png", 0, "");
    folder.says("render -q --device cpu --tile 1/2 scene.txt -o 2.png", 0, "");
    folder.says("merge 0.png 2.png -o mixed.png", 2, "projection");
    // In an eye's picture the ball would fill the window.
    std::fs::write(
        folder.path("beside.txt"),
        "NEAR 1\nLEFT -1\nRIGHT 1\nBOTTOM -1\nTOP 1\nRES 9 9\nSPHERE s 3 0 -9 1 1 1 1 1 1 1 0 0 0 1\nAMBIENT 1 1 1\n",
    )
    .unwrap();
    folder.says(&format!("check beside.txt {option}"), 0, "every sphere lies beside the window");
    let output = "check beside.txt";
    folder.says(output, 0, "");
}
