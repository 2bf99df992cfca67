//! What the first line of a scene file says in words, asserted of its picture; one test a scene, for all that can be checked.
//!
//! Pictures are the reference's, in the scene's own size. Which body a pixel sees is found here by the plain quadratic.

use std::collections::BTreeSet;

use glam::DVec3;
use trueray::cpu::Reference;
use trueray::effects::{Effect, EffectSet, Effects};
use trueray::film::Picture;
use trueray::scene::{Scene, parse};
use trueray::settings::{Settings, Specular};

use crate::support::{cpu_picture, root, scene};

/// A scene and how it is rendered.
#[derive(Clone)]
struct View {
    scene: Scene,
    names: Vec<String>,
    settings: Settings,
}

/// The body that a pixel's ray meets first.
#[derive(Clone, Copy, PartialEq)]
struct Seen {
    sphere: usize,
    is_inside: bool,
    at: DVec3,
}

type Pixels = BTreeSet<(u32, u32)>;

fn view(name: &str) -> View {
    let scene = scene(&root().join(format!("scenes/{name}.txt")));
    let names = (0..scene.spheres.len()).map(|index| scene.sphere_names.get(index).to_owned()).collect();
    View { scene, names, settings: Settings::classic() }
}

impl View {
    fn changed(&self, change: impl Fn(&mut Scene)) -> Self {
        let mut view = self.clone();
        change(&mut view.scene);
        view
    }

    fn set(&self, change: impl Fn(&mut Settings)) -> Self {
        let mut view = self.clone();
        change(&mut view.settings);
        view
    }

    /// Without the bodies that `is_out` names.
    fn without(&self, is_out: impl Fn(&str) -> bool) -> Self {
        let mut view = self.clone();
        let mut names = self.names.iter();
        view.scene.spheres.retain(|_| !is_out(names.next().unwrap()));
        view.names.retain(|name| !is_out(name));
        assert!(view.names.len() < self.names.len());
        view
    }

    fn with_lights(&self, kept: &[usize]) -> Self {
        self.changed(|scene| scene.lights = kept.iter().map(|&light| scene.lights[light]).collect())
    }

    fn picture(&self) -> Picture {
        let effects = Effects::of(&self.scene.viewed(&self.settings));
        let (picture, not_finite) = cpu_picture::<f64>(&self.scene, &self.settings, &effects);
        assert_eq!(not_finite, 0);
        picture
    }

    /// The unclamped colours of these pixels.
    fn colors(&self, pixels: &Pixels) -> Vec<DVec3> {
        let reference =
            Reference::<f64>::new(&self.scene.viewed(&self.settings), &Effects::of(&self.scene.viewed(&self.settings)));
        pixels.iter().map(|&(x, y)| reference.color(x, y).unwrap()).collect()
    }

    fn effects(&self) -> EffectSet {
        Effects::of(&self.scene.viewed(&self.settings)).set
    }

    fn all(&self) -> impl Iterator<Item = (u32, u32)> + use<> {
        let (width, height) = (self.scene.width, self.scene.height);
        (0..height).flat_map(move |y| (0..width).map(move |x| (x, y)))
    }

    fn seen(&self, (x, y): (u32, u32)) -> Option<Seen> {
        let Scene { window, width, height, spheres, .. } = &self.scene;
        let (sx, sy) = self.settings.sampling.offset();
        let u = window.left + (window.right - window.left) * (f64::from(x) + sx) / f64::from(*width);
        let v = window.top - (window.top - window.bottom) * (f64::from(y) + sy) / f64::from(*height);
        let ray = DVec3::new(u, v, -window.near);
        let mut nearest = (f64::INFINITY, None);
        for (sphere, body) in spheres.iter().enumerate() {
            let (origin, direction) = (-body.center / body.scale, ray / body.scale);
            let [a, b] = [direction.dot(direction), origin.dot(direction)];
            let discriminant = b * b - a * (origin.dot(origin) - 1.0);
            for (root, is_inside) in [(-discriminant.sqrt(), false), (discriminant.sqrt(), true)] {
                let t = (-b + root) / a;
                if t > 1.0 + 1e-6 && t < nearest.0 {
                    nearest = (t, Some(Seen { sphere, is_inside, at: t * ray }));
                }
            }
        }
        nearest.1
    }

    /// The pixels that see bodies that `is_it` names.
    fn on(&self, is_it: impl Fn(&str) -> bool) -> Pixels {
        let is_seen = |seen: Seen| is_it(&self.names[seen.sphere]);
        let pixels: Pixels = self.all().filter(|&pixel| self.seen(pixel).is_some_and(is_seen)).collect();
        assert!(!pixels.is_empty(), "nothing of it is seen");
        pixels
    }

    fn body(&self, name: &str) -> usize {
        self.names.iter().position(|other| other == name).unwrap()
    }

    /// The pixels of these on which the pictures differ.
    fn differing(&self, other: &Self, on: &Pixels) -> Pixels {
        let (a, b) = (self.picture(), other.picture());
        on.iter().copied().filter(|&(x, y)| a.pixel(x, y) != b.pixel(x, y)).collect()
    }

    fn looks_like(&self, other: &Self) -> bool {
        self.picture() == other.picture()
    }

    /// The pixels outside a body that it changes: its shadow and its mirror images.
    fn touched_by(&self, name: &str) -> Pixels {
        let without = self.without(|other| other == name);
        let elsewhere: Pixels =
            self.all().collect::<Pixels>().difference(&self.on(|other| other == name)).copied().collect();
        self.differing(&without, &elsewhere)
    }

    fn without_light(&self) -> Self {
        self.with_lights(&[])
    }
}

fn values(picture: &Picture, pixels: &Pixels) -> Vec<[u8; 3]> {
    pixels.iter().map(|&(x, y)| picture.pixel(x, y)).collect()
}

fn distinct(colors: &[[u8; 3]]) -> usize {
    colors.iter().collect::<BTreeSet<_>>().len()
}

/// Width and height of the smallest rectangle around pixels.
fn extent(pixels: &Pixels) -> (u32, u32) {
    let span =
        |of: fn(&(u32, u32)) -> u32| pixels.iter().map(of).max().unwrap() - pixels.iter().map(of).min().unwrap() + 1;
    (span(|&(x, _)| x), span(|&(_, y)| y))
}

fn middle(pixels: &Pixels) -> (f64, f64) {
    let mean = |of: fn(&(u32, u32)) -> u32| pixels.iter().map(|p| f64::from(of(p))).sum::<f64>() / pixels.len() as f64;
    (mean(|&(x, _)| x), mean(|&(_, y)| y))
}

fn both(a: &Pixels, b: &Pixels) -> Pixels {
    a.intersection(b).copied().collect()
}

fn is(name: &'static str) -> impl Fn(&str) -> bool {
    move |other| other == name
}

/// Pixels of a body with more than half of the greatest value that its own specular term reaches there.
fn highlight(view: &View, body: &'static str) -> Pixels {
    let on = view.on(is(body));
    let dull = view.changed(|scene| scene.spheres.iter_mut().for_each(|sphere| sphere.ks = 0.0));
    let shine: Vec<_> = view.colors(&on).iter().zip(dull.colors(&on)).map(|(a, b)| (*a - b).max_element()).collect();
    let greatest = shine.iter().copied().fold(0.0, f64::max);
    assert!(greatest > 0.0, "no highlight on {body}");
    on.into_iter().zip(shine).filter(|(_, shine)| *shine > greatest / 2.0).map(|(pixel, _)| pixel).collect()
}

mod basic {
    use super::*;

    #[test]
    fn behind_the_eye() {
        let view = view("basic/behind-the-eye");
        let background = view.settings.quantize.levels(view.scene.background);
        assert!(!view.scene.spheres.is_empty() && view.picture().pixels().iter().all(|pixel| *pixel == background));
    }

    #[test]
    fn ellipsoid() {
        let view = view("basic/ellipsoid");
        let (on, picture) = (view.on(is("egg")), view.picture());
        assert!(values(&picture, &on).iter().all(|[r, g, b]| g >= r && g >= b), "green");
        let (width, height) = extent(&on);
        assert!(height > 2 * width, "upright");
        let DVec3 { x, y, z } = view.scene.spheres[0].scale;
        assert!(view.scene.spheres.len() == 1 && x != y && y != z && z != x);
    }

    #[test]
    fn loose_format() {
        let plain = "NEAR 1\nLEFT -0.8\nRIGHT 0.8\nBOTTOM -0.6\nTOP 0.6\nRES 160 120\nBACK 0.1 0.1 0.15\n\
            AMBIENT 0.4 0.4 0.4\nSPHERE bead 1.3 -0.4 -4 0.5 0.5 0.5 0.3 0.6 0.8 0.3 0.7 0.5 0 30\n\
            SPHERE ball -0.5 0.1 -4.5 1 1 1 0.8 0.5 0.3 0.3 0.7 0.5 0 30\nLIGHT lamp -4 5 2 1 1 1\n";
        let loose = view("basic/loose-format");
        let scene = parse("plain", plain.as_bytes()).scene.unwrap();
        assert!(loose.picture() == View { scene, ..loose.clone() }.picture());
    }

    #[test]
    fn mirrored_window() {
        let view = view("basic/mirrored-window");
        let large = view.body("large");
        assert!(view.scene.window.left > view.scene.window.right && view.scene.spheres[large].center.x < 0.0);
        assert!(middle(&view.on(is("large"))).0 > f64::from(view.scene.width) / 2.0);
        let file = std::fs::read(root().join("scenes/basic/mirrored-window.txt")).unwrap();
        assert_eq!(parse("", &file).warnings, 1);
    }

    #[test]
    fn no_lights() {
        let view = view("basic/no-lights");
        assert!(view.scene.lights.is_empty());
        assert_eq!(distinct(view.picture().pixels()), 3, "two flat discs and the background");
    }

    #[test]
    fn no_spheres() {
        let view = view("basic/no-spheres");
        let background = view.settings.quantize.levels(view.scene.background);
        assert!(view.scene.spheres.is_empty() && view.picture().pixels().iter().all(|pixel| *pixel == background));
    }

    #[test]
    fn odd_size() {
        let is_prime = |n: u32| (2..n).all(|k| !n.is_multiple_of(k));
        let Scene { width, height, .. } = view("basic/odd-size").scene;
        assert!((width, height) == (197, 151) && is_prime(width) && is_prime(height));
    }

    #[test]
    fn off_centre_window() {
        let view = view("basic/off-centre-window");
        let window = view.scene.window;
        assert!(window.left > 0.0 && window.bottom > 0.0);
        assert!((window.right - window.left).to_bits() != (window.top - window.bottom).to_bits());
        let ball = view.on(is("ball"));
        // Farther from the axis by half than it is high.
        let (width, height) = extent(&ball);
        assert!(width * 10 > height * 11, "stretched: {width} x {height}");
    }

    #[test]
    fn one_column_and_one_row() {
        for (name, size) in [("one-column", (1, 211)), ("one-row", (211, 1))] {
            let view = view(&format!("basic/{name}"));
            assert_eq!((view.scene.width, view.scene.height), size);
            let bodies: Vec<_> = view.all().map(|pixel| view.seen(pixel).map(|seen| seen.sphere)).collect();
            let mut runs = bodies.clone();
            runs.dedup();
            assert_eq!(runs.iter().flatten().count(), 3, "{name}: three balls");
        }
    }

    #[test]
    fn one_pixel() {
        let view = view("basic/one-pixel");
        assert_eq!((view.scene.width, view.scene.height), (1, 1));
        let [lit, dark] = [&view, &view.without_light()].map(|view| view.picture().pixel(0, 0));
        assert!(view.seen((0, 0)).is_some() && lit.iter().zip(dark).all(|(lit, dark)| *lit > dark));
    }

    #[test]
    fn one_sphere() {
        let view = view("basic/one-sphere");
        let on = view.on(|_| true);
        let (x, y) = middle(&on);
        assert!((x - 100.0).abs() < 1.0 && (y - 75.0).abs() < 1.0, "in the middle");
        assert!(values(&view.picture(), &on).iter().all(|[r, g, b]| r > g && r > b), "red");
        let (bright_x, bright_y) = middle(&highlight(&view, "ball"));
        assert!(bright_x < x && bright_y < y, "from the upper left");
    }

    #[test]
    fn overlap() {
        let flat = view("basic/overlap").without_light();
        let picture = flat.picture();
        for pixel in flat.all() {
            let color = flat.seen(pixel).map_or(flat.scene.background, |seen| {
                let body = &flat.scene.spheres[seen.sphere];
                body.ka * body.color * flat.scene.ambient
            });
            let difference = DVec3::from_array(picture.pixel(pixel.0, pixel.1).map(f64::from)) - 255.0 * color;
            assert!(difference.abs().max_element() <= 1.0, "{pixel:?}");
        }
        assert_eq!(distinct(picture.pixels()), 5, "four bodies and the background");
    }

    #[test]
    fn seventeen_lights() {
        let view = view("basic/seventeen-lights");
        let count = view.scene.lights.len();
        assert_eq!(count, 17);
        let (picture, all) = (view.picture(), view.all().collect());
        for light in 0..count {
            let others: Vec<_> = (0..count).filter(|&other| other != light).collect();
            let changed = view.differing(&view.with_lights(&others), &all);
            assert!(changed.len() > picture.pixels().len() / 10, "lamp {light}");
        }
    }

    /// Of up to sixteen spheres none is in the grid.
    #[test]
    fn seventeen_spheres() {
        let view = view("basic/seventeen-spheres");
        assert_eq!(view.scene.spheres.len(), 17);
        let in_no_cell = |scene: &Scene| {
            let settings = Settings::classic();
            let rounding = trueray::accel::Rounding::DOUBLE;
            let lists = trueray::accel::Acceleration::new(&scene.viewed(&settings), EffectSet::ALL, rounding);
            lists.grid.unwrap().large().len()
        };
        assert_eq!(in_no_cell(&view.scene), 0);
        assert_eq!(in_no_cell(&view.without(is("bead1")).scene), 16);
    }

    #[test]
    fn ten_thousand_spheres() {
        assert_eq!(view("basic/ten-thousand-spheres").scene.spheres.len(), 10_000);
    }

    #[test]
    fn upside_down_window() {
        let view = view("basic/upside-down-window");
        let (ball, shadow) = (view.on(is("ball")), view.touched_by("ball"));
        assert!(middle(&ball).1 > middle(&shadow).1 + 5.0, "the ball floats below its shadow");
    }

    #[test]
    fn window_corner() {
        let view = view("basic/window-corner");
        let inside = |name| view.on(is(name)).into_iter().filter(|&p| view.seen(p).unwrap().is_inside).count();
        assert!(inside("ball") > 50 && inside("touch") == 0);
        let (upper, lower) = (middle(&view.on(is("ball"))), middle(&view.on(is("touch"))));
        assert!(upper.0 > 150.0 && upper.1 < 30.0 && lower.0 < 50.0 && lower.1 > 120.0);
        let body = view.scene.spheres[view.body("touch")];
        assert!((body.center.z + body.scale.z - -view.scene.window.near).abs() < 1e-15);
    }
}

mod effects {
    use super::*;

    /// Every scene that says in its name and in its first line that effects are off.
    #[test]
    fn what_is_off_is_off() {
        let mut count = 0;
        for file in crate::support::scene_files(&["effects"]) {
            let name = file.file_stem().unwrap().to_str().unwrap();
            let text = std::fs::read_to_string(&file).unwrap();
            let Some((said, _)) = text.lines().next().unwrap().trim_start_matches("# ").split_once(" off:") else {
                assert!(!name.contains("-off-"), "{name}");
                continue;
            };
            count += 1;
            let set = view(&format!("effects/{name}")).effects();
            for effect in Effect::ALL {
                let is_said = said.to_lowercase().contains(effect.name());
                assert!(!(is_said && set.has(effect)), "{name}: {effect}");
            }
            let first = said.to_lowercase();
            assert!(Effect::ALL.iter().any(|effect| first.contains(effect.name())), "{name}: {said}");
        }
        assert!(count > 10);
    }

    #[test]
    fn ambient_off_colour() {
        let view = view("effects/ambient-off-colour");
        assert!(view.looks_like(&view.changed(|scene| scene.ambient = DVec3::ZERO)));
        let brightest = values(&view.picture(), &view.on(|_| true)).into_iter().max().unwrap();
        assert!(brightest[0] > 100, "white highlights on bodies without red: {brightest:?}");
    }

    #[test]
    fn ambient_off_dark() {
        let view = view("effects/ambient-off-dark");
        let (ball, lamp) = (view.scene.spheres[0].center, view.scene.lights[0].position);
        let is_away = |at: DVec3| (at - ball).dot(lamp - at) < 0.0;
        let away: Pixels = view.on(is("ball")).into_iter().filter(|&p| is_away(view.seen(p).unwrap().at)).collect();
        assert!(away.len() > 100 && values(&view.picture(), &away).iter().all(|pixel| *pixel == [0; 3]));
    }

    #[test]
    fn ambient() {
        let view = view("effects/ambient");
        assert!(view.scene.lights.len() == 1 && view.looks_like(&view.without_light()));
        assert!(view.effects().iter().eq([Effect::Ambient]));
        assert_eq!(distinct(view.picture().pixels()), 6, "flat colours");
    }

    #[test]
    fn blocker_beyond_light() {
        let view = view("effects/blocker-beyond-light");
        let ground = view.on(is("ground"));
        assert!(both(&view.touched_by("ball"), &ground).is_empty());
        let lamp = view.scene.lights[0].position;
        let ball = view.scene.spheres[view.body("ball")];
        assert!(ball.center.y - ball.scale.y > lamp.y);
    }

    #[test]
    fn bright_lights() {
        let view = view("effects/bright-lights");
        let lamps = view.scene.lights.iter().map(|light| light.intensity.max_element());
        assert!(lamps.fold(f64::INFINITY, f64::min) >= 3.0);
        let picture = view.picture();
        assert_eq!(picture.pixel(0, 0), [255, 102, 25], "each channel by itself");
        let ball = values(&picture, &view.on(is("ball")));
        assert!(ball.iter().any(|[r, g, b]| *r == 255 && *g == 255 && *b < 200) && ball.contains(&[255; 3]));
    }

    #[test]
    fn coloured_shadows() {
        let view = view("effects/coloured-shadows");
        let wall = values(&view.picture(), &view.on(is("wall")));
        for dark in 0..3 {
            let mixes = |pixel: &&[u8; 3]| (0..3).all(|channel| (pixel[channel] == 0) == (channel == dark));
            assert!(wall.iter().filter(mixes).count() > 100, "channel {dark}");
        }
        assert!(wall.iter().filter(|pixel| pixel.iter().all(|channel| *channel > 50)).count() > 1000);
    }

    #[test]
    fn diffuse_off_black() {
        let view = view("effects/diffuse-off-black");
        let dull = view.changed(|scene| scene.spheres.iter_mut().for_each(|sphere| sphere.ks = 0.0));
        let on = view.on(|_| true);
        assert!(values(&dull.picture(), &on).iter().all(|pixel| *pixel == [0; 3]), "highlights only");
        assert!(view.scene.spheres.iter().all(|sphere| sphere.kd > 0.0) && view.differing(&dull, &on).len() > 300);
    }

    #[test]
    fn diffuse_off_colour() {
        let view = view("effects/diffuse-off-colour");
        let (lit, dark, on) = (view.picture(), view.without_light().picture(), view.on(|_| true));
        let pairs: Vec<_> = values(&lit, &on).into_iter().zip(values(&dark, &on)).collect();
        assert!(pairs.iter().all(|(lit, dark)| lit[1..] == dark[1..]), "red alone");
        assert!(pairs.iter().any(|(lit, dark)| lit[0] > dark[0] + 50));
    }

    #[test]
    fn diffuse() {
        let view = view("effects/diffuse");
        assert!(view.scene.lights.len() == 1 && view.effects().iter().eq([Effect::Diffuse]));
        let moon = values(&view.picture(), &view.on(is("moon")));
        assert!(moon.contains(&[0; 3]) && distinct(&moon) > 100, "a soft border of day and night");
    }

    #[test]
    fn ellipsoids() {
        let view = view("effects/ellipsoids");
        let volumes: Vec<f64> = view.scene.spheres.iter().map(|sphere| sphere.scale.element_product()).collect();
        assert!(volumes.iter().all(|volume| (volume / volumes[0] - 1.0).abs() < 1e-3), "{volumes:?}");
        assert_eq!(distinct(view.picture().pixels()), 4, "flat colours");
    }

    #[test]
    fn everything() {
        let all_but_refraction = EffectSet::ALL.with(Effect::Refraction, false);
        assert_eq!(view("effects/everything").effects(), all_but_refraction);
    }

    #[test]
    fn exponent_half() {
        let view = view("effects/exponent-half");
        assert!(view.scene.spheres.iter().map(|sphere| sphere.n).eq([0.5, 1.0, 2.0]));
        let sizes = ["half", "one", "two"].map(|name| highlight(&view, name).len());
        assert!(sizes[0] > sizes[1] && sizes[1] > sizes[2] && sizes[2] > 200, "{sizes:?}");
    }

    #[test]
    fn exponent_zero() {
        let view = view("effects/exponent-zero");
        let on = view.on(is("ball"));
        let dull = view.changed(|scene| scene.spheres[0].ks = 0.0);
        let flat = DVec3::splat(0.5);
        let shine: Vec<_> = view.colors(&on).iter().zip(dull.colors(&on)).map(|(a, b)| *a - b).collect();
        let is_flat = |shine: &&DVec3| (**shine - flat).abs().max_element() < 1e-12;
        let lit = shine.iter().filter(is_flat).count();
        assert!(lit > 500 && shine.iter().all(|shine| *shine == DVec3::ZERO || is_flat(&shine)));
    }

    #[test]
    fn highlights_grazing() {
        let phong = view("effects/highlights-grazing").with_lights(&[0]);
        let blinn = phong.set(|settings| settings.specular = Specular::Blinn);
        let shape = |view: &View| {
            let (width, height) = extent(&highlight(view, "lake"));
            (width, f64::from(width) / f64::from(height))
        };
        let (phong, blinn) = (shape(&phong), shape(&blinn));
        assert!(phong.0 > blinn.0 && phong.1 > blinn.1 && phong.1 > 1.0, "{phong:?} {blinn:?}");
    }

    #[test]
    fn light_behind_eye() {
        let view = view("effects/light-behind-eye");
        assert!(view.scene.lights.len() == 1 && view.scene.lights[0].position.z > 5.0);
        for name in ["a", "b"] {
            let (ball, shadow) = (view.on(is(name)), view.touched_by(name));
            assert!(!ball.is_empty() && shadow.len() * 4 < ball.len(), "{name}: {} of {}", shadow.len(), ball.len());
        }
    }

    #[test]
    fn light_below_horizon() {
        let view = view("effects/light-below-horizon");
        assert!(view.scene.lights.len() == 1 && view.looks_like(&view.without_light()));
    }

    #[test]
    fn light_in_sphere() {
        let view = view("effects/light-in-sphere");
        assert!(view.looks_like(&view.with_lights(&[1])));
        for name in ["lampshade", "ball"] {
            assert!(view.differing(&view.with_lights(&[0]), &view.on(is(name))).len() > 300, "{name}");
        }
    }

    #[test]
    fn lights_off_dark() {
        let view = view("effects/lights-off-dark");
        assert!(view.scene.lights.len() == 2 && view.looks_like(&view.without_light()));
    }

    #[test]
    fn mirror_misses() {
        let view = view("effects/mirror-misses");
        let mirror = view.on(is("mirror"));
        let black = values(&view.picture(), &mirror).iter().filter(|pixel| **pixel == [0; 3]).count();
        assert!(black * 2 > mirror.len(), "{black} of {}", mirror.len());
        let other_sky = view.changed(|scene| scene.background = DVec3::ZERO);
        assert!(view.differing(&other_sky, &mirror).is_empty());
    }

    #[test]
    fn mirrors_over_one() {
        let view = view("effects/mirrors-over-one");
        let on = view.on(|name| name == "left" || name == "right");
        let sum = |max_depth| -> f64 {
            let deep = view.set(|settings| settings.max_depth = max_depth);
            deep.colors(&on).iter().map(|color| color.element_sum()).sum()
        };
        let sums = [0, 1, 2, 3, 8].map(sum);
        assert!(sums.windows(2).all(|pair| pair[0] < pair[1]) && sums[4].is_finite(), "{sums:?}");
    }

    #[test]
    fn negative_scale() {
        let view = view("effects/negative-scale");
        let positive =
            view.changed(|scene| scene.spheres.iter_mut().for_each(|sphere| sphere.scale = sphere.scale.abs()));
        assert!(view.scene.spheres[1].scale.x < 0.0 && view.looks_like(&positive));
        assert_eq!(extent(&view.on(is("plain"))), extent(&view.on(is("negative"))));
    }

    #[test]
    fn reflections_depth_1() {
        let view = view("effects/reflections-depth-1");
        let depth = |max_depth| view.set(move |settings| settings.max_depth = max_depth);
        assert!(depth(1).looks_like(&depth(9)) && !depth(0).looks_like(&depth(1)));
        assert_eq!(Effects::of(&view.scene.viewed(&view.settings)).depth, 1);
    }

    #[test]
    fn reflections_touching() {
        let view = view("effects/reflections-touching");
        assert_eq!(Effects::of(&view.scene.viewed(&view.settings)).depth, view.settings.max_depth);
        let [mirror, ball] = [view.scene.spheres[0], view.scene.spheres[1]];
        assert!((mirror.center.distance(ball.center) - mirror.scale.x - ball.scale.x).abs() < 1e-12);
    }

    #[test]
    fn reflections() {
        let view = view("effects/reflections");
        assert!(view.scene.lights.is_empty());
        let mirrors = view.on(|name| name.starts_with("mirror"));
        for name in ["gold", "teal", "ruby"] {
            assert!(both(&view.touched_by(name), &mirrors).len() > 5, "{name} is repeated");
        }
    }

    /// Opposite corners of the glass show opposite balls.
    #[test]
    fn refraction() {
        let view = view("effects/refraction");
        let glass = view.on(is("glass"));
        let (x, y) = middle(&glass);
        for (name, is_left, is_upper) in
            [("red", true, true), ("gold", false, true), ("teal", true, false), ("violet", false, false)]
        {
            let stands = view.scene.spheres[view.body(name)].center;
            assert!((stands.x < 0.0) == is_left && (stands.y > 0.0) == is_upper, "{name} stands at {stands}");
            // Without light its shadow does not matter.
            let glow = view.without_light();
            let shown = middle(&glow.differing(&glow.without(|other| other == name), &glass));
            assert!((shown.0 < x) != is_left && (shown.1 < y) != is_upper, "{name} is shown at {shown:?}");
        }
        let sky = view.changed(|scene| scene.background = DVec3::ZERO);
        assert!(view.differing(&sky, &glass).len() * 2 > glass.len(), "the sky shows through");
    }

    #[test]
    fn same_place() {
        let view = view("effects/same-place");
        let first = view.changed(|scene| scene.spheres = vec![scene.spheres[0], scene.spheres[2]]);
        assert!(view.looks_like(&first));
        let picture = view.picture();
        let (left, right) = (picture.pixel(47, 55), picture.pixel(153, 55));
        assert!(left[0] > left[2] + 30 && right[2] > right[0] + 30, "rust left, teal right: {left:?} {right:?}");
    }

    #[test]
    fn shadows_one_of_two_lights() {
        let view = view("effects/shadows-one-of-two-lights");
        assert!(view.effects().has(Effect::Shadows));
        assert!(
            view.with_lights(&[1]).touched_by("small").is_empty()
                && view.with_lights(&[1]).touched_by("large").is_empty()
        );
        assert!(view.with_lights(&[0]).touched_by("small").len() > 20);
    }

    #[test]
    fn shadows() {
        let view = view("effects/shadows");
        let planet = view.on(is("planet"));
        let moons = ["moon1", "moon2", "moon3"];
        assert!(moons.iter().all(|moon| both(&view.touched_by(moon), &planet).len() > 10), "on the planet");
        let other_moons = |moon: &str| view.on(|name| name.starts_with("moon") && name != moon);
        assert!(moons.iter().any(|moon| both(&view.touched_by(moon), &other_moons(moon)).len() > 3), "on each other");
    }

    #[test]
    fn shell_cut_part_blocks() {
        let view = view("effects/shell-cut-part-blocks");
        let unseen = view.body("unseen");
        assert!(view.all().all(|pixel| view.seen(pixel).is_none_or(|seen| seen.sphere != unseen)), "it is not seen");
        let open = view.without(is("unseen"));
        assert!(view.differing(&open, &view.on(is("ball"))).len() > 200, "it throws its shadow");
    }

    #[test]
    fn shell_eye_inside() {
        let view = view("effects/shell-eye-inside");
        let room = view.scene.spheres[view.body("room")];
        let within = |point: DVec3| ((point - room.center) / room.scale).length() < 1.0;
        assert!(within(DVec3::ZERO) && within(view.scene.lights[0].position));
        // Without light there are no shadows on the wall, only mirror images.
        let (glow, wall) = (view.without_light(), view.on(is("room")));
        assert!(["red", "ivory"].iter().all(|name| both(&glow.touched_by(name), &wall).len() > 50));
    }

    #[test]
    fn shell_lit_inside() {
        let view = view("effects/shell-lit-inside");
        let cave = view.on(is("cave"));
        assert!(cave.iter().all(|&pixel| view.seen(pixel).unwrap().is_inside));
        assert!(view.differing(&view.without_light(), &cave).len() * 10 > cave.len() * 9);
    }

    #[test]
    fn shell_own_shadow() {
        let view = view("effects/shell-own-shadow");
        let wall: Pixels =
            view.on(is("bowl")).into_iter().filter(|&pixel| view.seen(pixel).unwrap().is_inside).collect();
        assert!(wall.len() > 1000 && view.differing(&view.without_light(), &wall).is_empty());
    }

    #[test]
    fn shells() {
        let view = view("effects/shells");
        assert!(view.scene.lights.is_empty());
        for name in ["bowl", "slice"] {
            let on = view.on(|other| other == name);
            let inside = on.iter().filter(|&&pixel| view.seen(pixel).unwrap().is_inside).count();
            // The rim beyond the image plane is seen from outside.
            assert!(inside * 10 > on.len() * 9, "{name}: {inside} of {}", on.len());
        }
    }

    #[test]
    fn specular_off_matte() {
        let view = view("effects/specular-off-matte");
        assert!(view.looks_like(&view.changed(|scene| scene.spheres.iter_mut().for_each(|sphere| sphere.n = 7.0))));
    }

    #[test]
    fn specular() {
        let view = view("effects/specular");
        assert!(view.effects().iter().eq([Effect::Specular]));
        assert!(view.scene.spheres.iter().map(|sphere| sphere.n).eq([4.0, 20.0, 200.0]));
        let sizes = ["dull", "glossy", "polished"].map(|name| highlight(&view, name).len());
        assert!(sizes[0] > sizes[1] && sizes[1] > sizes[2], "{sizes:?}");
    }

    #[test]
    fn three_mirrors() {
        let view = view("effects/three-mirrors");
        let depth = |max_depth| view.set(move |settings| settings.max_depth = max_depth);
        for mirror in ["top", "left", "right"] {
            let on = view.on(is(mirror));
            assert!((0..3).all(|bounce| depth(bounce).differing(&depth(bounce + 1), &on).len() > 20), "{mirror}");
        }
    }

    #[test]
    fn two_mirrors() {
        let view = view("effects/two-mirrors").changed(|scene| (scene.width, scene.height) = (960, 480));
        for mirror in ["left", "right"] {
            let on = view.on(is(mirror));
            let repeated = |max_depth| {
                both(&view.set(move |settings| settings.max_depth = max_depth).touched_by("bead"), &on).len()
            };
            let counts = [1, 2, 3].map(repeated);
            assert!(counts[0] > 10 && counts[1] > counts[0], "{mirror}: {counts:?}");
        }
    }
}

mod hard {
    use super::*;

    #[test]
    fn concentric_shells() {
        let view = view("hard/concentric-shells");
        for view in [view.clone(), View { settings: Settings::exact(), ..view.clone() }] {
            let on = view.on(|_| true);
            assert!(values(&view.picture(), &on).iter().all(|[r, g, b]| r >= g && g > b || r > b), "warm, not blue");
            assert!(on.len() > 5000);
        }
    }

    /// A point of the floor whose way to the lamp goes through a ball is dark, up to the very contact.
    #[test]
    fn contact() {
        let view = view("hard/contact");
        let floor = view.body("floor");
        let lamp = view.scene.lights[0].position;
        let is_behind_a_ball = |at: DVec3| {
            view.scene.spheres.iter().enumerate().filter(|(index, _)| *index != floor).any(|(_, ball)| {
                let way = lamp - at;
                let nearest = ((ball.center - at).dot(way) / way.dot(way)).clamp(0.0, 1.0);
                (at + nearest * way).distance(ball.center) < ball.scale.x * 0.9999
            })
        };
        for settings in [Settings::classic(), Settings::exact()] {
            // Near the contacts, 25 times as large.
            for center in view.scene.spheres[1..4].iter().map(|ball| ball.center) {
                let mut near = View { settings, ..view.clone() };
                let (x, y) = (center.x / 5.0, (center.y - 0.5) / 5.0);
                let window = &mut near.scene.window;
                (window.left, window.right, window.bottom, window.top) = (x - 0.032, x + 0.032, y - 0.024, y + 0.024);
                let on = near.on(is("floor"));
                let shadow: Pixels =
                    on.into_iter().filter(|&pixel| is_behind_a_ball(near.seen(pixel).unwrap().at)).collect();
                assert!(shadow.len() > 200, "{}", shadow.len());
                let leaks = near.differing(&near.without_light(), &shadow);
                assert!(leaks.is_empty(), "{settings:?}: light at {:?}", leaks.first());
            }
        }
    }

    #[test]
    fn discs() {
        let view = view("hard/discs");
        for name in ["lying", "facing", "edge"] {
            let mut axes = view.scene.spheres[view.body(name)].scale.to_array();
            axes.sort_by(f64::total_cmp);
            assert!(
                (axes[0] / axes[1] - 0.001).abs() < 1e-9 && axes[1].to_bits() == axes[2].to_bits(),
                "{name}: {axes:?}"
            );
        }
        assert!(both(&view.touched_by("ball"), &view.on(is("lying"))).len() > 50);
        assert!(both(&view.touched_by("bead"), &view.on(is("facing"))).len() > 20);
    }

    #[test]
    fn earth_at_one_metre() {
        let view = view("hard/earth-at-one-metre");
        let earth = view.scene.spheres[view.body("earth")];
        assert_eq!(earth.center.length() - earth.scale.x, 1.0);
        let horizon = (earth.center.length_squared() - earth.scale.x * earth.scale.x).sqrt();
        let tower = view.scene.spheres[view.body("tower")];
        assert!(tower.center.length() - tower.scale.x > horizon);
        assert!(["obelisk", "ball", "hill", "tower"].iter().all(|name| view.on(|other| other == *name).len() > 20));
    }

    #[test]
    fn exponents() {
        let view = view("hard/exponents");
        let row = |is_upper: bool| {
            let spheres = view.scene.spheres.iter().filter(move |sphere| (sphere.center.y > 0.0) == is_upper);
            spheres.map(|sphere| sphere.n).collect::<Vec<_>>()
        };
        assert_eq!((row(true), row(false)), (vec![0.0, 0.5, 1.0, 10.0], vec![100.0, 1e3, 1e4, 1e5]));
    }

    #[test]
    fn light_at_surface() {
        let view = view("hard/light-at-surface");
        for (light, name, is_lit) in [(0, "inside", false), (1, "on", false), (2, "above", true)] {
            let alone = view.with_lights(&[light]);
            let lit = alone.differing(&view.without_light(), &view.on(|other| other == name)).len();
            assert_eq!(lit > 0, is_lit, "{name}: {lit} pixels are lit");
        }
    }

    #[test]
    fn mirror_corridor() {
        let view = view("hard/mirror-corridor").without_light();
        for side in ["left", "right"] {
            let wall = view.on(is(side));
            for name in ["ball", "post", "end"] {
                assert!(both(&view.touched_by(name), &wall).len() > 50, "{name} in the {side} mirror");
            }
        }
    }

    #[test]
    fn near_plane_tangent() {
        let view = view("hard/near-plane-tangent");
        for (settings, name) in [(Settings::classic(), "corner"), (Settings::exact(), "centre")] {
            let view = View { settings, ..view.clone() };
            let balls = view.on(|name| name != "wall");
            let inside: Vec<_> = balls.into_iter().filter(|&pixel| view.seen(pixel).unwrap().is_inside).collect();
            assert_eq!(inside.len(), 1, "{name}");
            assert_eq!(view.names[view.seen(inside[0]).unwrap().sphere], name);
            let here = inside.iter().copied().collect();
            assert!(view.differing(&view.without_light(), &here).is_empty(), "its wall keeps the light out");
        }
    }

    #[test]
    fn needles() {
        let view = view("hard/needles");
        for sphere in &view.scene.spheres {
            let mut axes = sphere.scale.to_array();
            axes.sort_by(f64::total_cmp);
            assert_eq!(axes, [0.01, 1.0, 100.0]);
        }
        let [left, right, below] = ["blade1", "blade2", "flat"].map(|name| middle(&view.on(|other| other == name)));
        assert!(left.0 < 90.0 && right.0 > 110.0 && (below.0 - 100.0).abs() < 10.0 && below.1 > 80.0);
        assert!(extent(&view.on(is("cross"))).0 > 150, "across the picture");
    }

    #[test]
    fn pin_head() {
        let view = view("hard/pin-head");
        let head = view.scene.spheres[view.body("head")];
        assert!((head.center.length() / head.scale.x / 1e5 - 1.0).abs() < 1e-9);
        let pin = extent(&view.on(|name| name != "cloth"));
        assert!(pin.1 * 5 > view.scene.height * 4, "{pin:?}");
    }

    #[test]
    fn sharp_highlights() {
        let view = view("hard/sharp-highlights");
        for light in 0..3 {
            let spot = highlight(&view.with_lights(&[light]), "wall");
            let (width, height) = extent(&spot);
            assert!(width.abs_diff(height) <= 2 && (3..40).contains(&width), "{light}: {width} x {height}");
            assert!(spot.len() as f64 > 0.6 * f64::from(width * height), "round");
        }
    }

    /// Blockers alone count, not what else stands between the eye and their spots.
    #[test]
    fn tiny_blockers() {
        let view = view("hard/tiny-blockers");
        let radii: Vec<f64> = view.scene.spheres[1..].iter().map(|sphere| sphere.scale.x).collect();
        assert_eq!(radii, [0.1, 0.01, 0.001, 0.0001]);
        let wall = view.on(is("wall"));
        let spots = ["b1", "b2", "b3", "b4"].map(|name| {
            let light = view.body(name) - 1;
            let without = view.without(|other| other == name).with_lights(&[light]);
            let spot = view.with_lights(&[light]).differing(&without, &wall);
            f64::from(extent(&spot).1)
        });
        assert!(spots.iter().all(|spot| (spot / spots[1] - 1.0).abs() < 0.2), "all of a size: {spots:?}");
    }

    #[test]
    fn translated() {
        let view = view("hard/translated");
        let far = DVec3::new(1e6, 0.0, -1e6);
        assert!(view.scene.spheres.iter().all(|sphere| (sphere.center - far).abs().max_element() < 12.0));
        let width = view.scene.window.right - view.scene.window.left;
        assert!((width / 8e-6 - 1.0).abs() < 1e-9);
        assert!(["globe", "cube", "table"].iter().all(|name| view.on(|other| other == *name).len() > 500));
    }

    /// A world as it is, and a world of a few units.
    fn worlds(name: &str, unit: f64) -> [View; 2] {
        let view = view(name);
        let scaled = view.changed(|scene| {
            let window = &mut scene.window;
            for side in [&mut window.near, &mut window.left, &mut window.right, &mut window.bottom, &mut window.top] {
                *side /= unit;
            }
            for sphere in &mut scene.spheres {
                sphere.center /= unit;
                sphere.scale /= unit;
            }
            scene.lights.iter_mut().for_each(|light| light.position /= unit);
        });
        [view, scaled].map(|view| View { settings: Settings::exact(), ..view })
    }

    /// Numbers are no powers of two, so that a silhouette may move by a rounding.
    fn assert_alike(name: &str, unit: f64) {
        let [tiny, common] = worlds(name, unit);
        let differing = tiny.differing(&common, &tiny.all().collect());
        assert!(differing.len() <= 3, "{}", differing.len());
    }

    #[test]
    fn world_1e_30() {
        assert_alike("hard/world-1e-30", 1e-30);
        let view = view("hard/world-1e-30");
        let matte = view.changed(|scene| scene.spheres.iter_mut().for_each(|sphere| sphere.kr = 0.0));
        assert!(view.looks_like(&matte), "the classic epsilon swallows its reflections");
    }

    #[test]
    fn world_1e20() {
        assert_alike("hard/world-1e20", 1e20);
    }
}

mod refraction {
    use super::*;

    /// Whether a ball lies within another.
    fn is_within(view: &View, inner: &str, outer: &str) -> bool {
        let [inner, outer] = [inner, outer].map(|name| view.scene.spheres[view.body(name)]);
        let reach = inner.scale.max_element() / outer.scale.min_element();
        ((inner.center - outer.center) / outer.scale).length() + reach < 1.0
    }

    #[test]
    fn bubbles() {
        let view = view("refraction/bubbles");
        assert!(["one", "two", "flat", "air"].iter().all(|name| view.scene.spheres[view.body(name)].eta < 1.0));
        assert!(is_within(&view, "air", "ball") && view.scene.spheres[view.body("ball")].eta > 1.0);
    }

    #[test]
    fn deep() {
        let view = view("refraction/deep");
        let depth = |max_depth| view.set(move |settings| settings.max_depth = max_depth);
        let glass = view.on(|name| name.starts_with('g') && name != "gold");
        for bounces in 0..8 {
            let changed = depth(bounces).differing(&depth(bounces + 1), &glass).len();
            assert!(changed > 50, "{bounces}: {changed}");
        }
    }

    #[test]
    fn eye_inside() {
        let view = view("refraction/eye-inside");
        let around = view.scene.spheres[view.body("around")];
        assert!((around.center / around.scale).length() < 1.0 && around.kt > 0.0);
        assert!(is_within(&view, "drop", "around") && is_within(&view, "pip", "around"));
        let wall = view.on(is("around"));
        assert!(wall.iter().all(|&pixel| view.seen(pixel).unwrap().is_inside), "rays are born inside");
    }

    /// The upper beads are seen in the lower half of the ball.
    #[test]
    fn glass_ball() {
        let view = view("refraction/glass-ball").set(|settings| settings.max_depth = 6).without_light();
        let glass = view.on(is("glass"));
        let y = middle(&glass).1;
        for (row, is_upper) in [("4", true), ("3", true), ("1", false), ("0", false)] {
            let without = view.without(|name| name.starts_with("bead") && name.ends_with(row));
            let (_, shown) = middle(&view.differing(&without, &glass));
            assert_eq!(shown > y, is_upper, "row {row}: {shown} of {y}");
        }
        let shown = view.differing(&view.without(is("bead32")), &glass);
        let bead = view.without(is("glass")).on(is("bead32"));
        assert!(extent(&shown).0 > 2 * extent(&bead).0, "larger");
    }

    #[test]
    fn glass_in_glass() {
        let view = view("refraction/glass-in-glass");
        assert!(is_within(&view, "inner", "outer") && is_within(&view, "seed", "inner"));
        let seed = view.without_light();
        assert!(both(&seed.touched_by_seed(), &view.on(is("outer"))).len() > 100);
    }

    impl View {
        /// Where the seed, which no ray from the eye meets first, is seen through the glass.
        fn touched_by_seed(&self) -> Pixels {
            self.differing(&self.without(is("seed")), &self.all().collect())
        }
    }

    #[test]
    fn image_plane() {
        let view = view("refraction/image-plane");
        let glass = |seen: Seen| view.scene.spheres[seen.sphere].kt > 0.0;
        let born_inside = view.all().filter_map(|pixel| view.seen(pixel)).filter(|seen| seen.is_inside);
        assert!(born_inside.filter(|seen| glass(*seen)).count() > 20);
    }

    #[test]
    fn invisible() {
        let view = view("refraction/invisible").set(|settings| settings.max_depth = 8);
        let air: Vec<_> = view.scene.spheres.iter().filter(|sphere| sphere.kt > 0.0).collect();
        assert!(air.len() == 3 && air.iter().all(|sphere| (sphere.kt, sphere.eta) == (1.0, 1.0)));
        let is_air: BTreeSet<_> = (0..view.names.len()).filter(|&k| view.scene.spheres[k].kt > 0.0).collect();
        let names: BTreeSet<_> = is_air.iter().map(|&k| view.names[k].clone()).collect();
        assert!(view.looks_like(&view.without(|name| names.contains(name))));
    }

    #[test]
    fn over_one() {
        let view = view("refraction/over-one").set(|settings| settings.max_depth = 12);
        assert!(view.scene.spheres.iter().any(|sphere| sphere.kr + sphere.kt > 1.0));
        let glass = view.on(|name| view.scene.spheres[view.body(name)].kt > 0.0);
        let colors = view.colors(&glass);
        assert!(colors.iter().all(|color| color.is_finite()) && colors.iter().any(|color| color.max_element() > 1.0));
    }

    /// sin of the angle at the wall times eta decides.
    #[test]
    fn total_reflection() {
        let view = view("refraction/total-reflection");
        let glass = view.scene.spheres[view.body("glass")];
        assert!(glass.center.length() < glass.scale.x, "the eye is in it");
        let alone = view.without(|name| name.starts_with("bead"));
        let sine = |pixel: &(u32, u32)| {
            let at = view.seen(*pixel).unwrap().at;
            (at - glass.center).normalize().cross(at.normalize()).length() * glass.eta
        };
        let wall = view.on(is("glass"));
        let (beyond, within): (Pixels, Pixels) = wall.into_iter().partition(|pixel| sine(pixel) > 1.0);
        // One bounce: what the mirrored ray shows later is another matter.
        let [view, alone] = [&view, &alone].map(|view| view.set(|settings| settings.max_depth = 1));
        assert!(beyond.len() > 1000 && view.differing(&alone, &beyond).is_empty());
        assert!(view.differing(&alone, &within).len() > 200);
    }

    #[test]
    fn touching() {
        let view = view("refraction/touching");
        let gap = |a: &str, b: &str| {
            let [a, b] = [a, b].map(|name| view.scene.spheres[view.body(name)]);
            a.center.distance(b.center) - a.scale.x - b.scale.x
        };
        let pairs = [("left", "right"), ("left", "matte"), ("right", "matte"), ("left", "floor"), ("right", "floor")];
        for (a, b) in pairs {
            assert!(gap(a, b).abs() < 1e-12, "{a}, {b}: {}", gap(a, b));
        }
        assert!(gap("lens1", "lens2") < 0.0);
        assert_eq!(gap("first", "second"), -0.5, "at one place");
    }
}
