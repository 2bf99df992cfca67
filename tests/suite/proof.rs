//! The reference proves its decisions: where `f64` leaves one open double-double takes it, and exact ties go by rule.

use dashu_float::FBig;
use dashu_float::round::mode::HalfEven;
use glam::DVec3;
use trueray::cpu::{Reference, Tally, oracle};
use trueray::effects::Effects;
use trueray::scene::{Scene, Window};
use trueray::settings::{Convention, Settings};
use trueray::stress::Random;

use crate::support::{root, scene as load, scene_of};

fn reference(scene: &Scene, settings: &Settings) -> Reference<f64> {
    let viewed = scene.viewed(settings);
    Reference::new(&viewed, &Effects::of(&viewed))
}

/// The colour of the pixel whose ray is the axis of view, and what it took.
fn middle(scene: &Scene) -> ([u8; 3], Tally) {
    let mut colors = [[0; 3]];
    let tally = reference(scene, &Settings::classic()).pixels(&[[20, 20]], &mut colors).unwrap();
    (colors[0], tally)
}

fn whole(scene: &Scene, settings: &Settings) -> (Vec<u8>, Tally) {
    let mut rgb = vec![0; scene.width as usize * scene.height as usize * 3];
    let tally = reference(scene, settings).rows(0, &mut rgb).unwrap();
    (rgb, tally)
}

const RED: &str = "1 0 0 1 0 0 0 1";
const GREEN: &str = "0 1 0 1 0 0 0 1";
const ROOM: &str = "AMBIENT 1 1 1\nBACK 0 0 1";

/// The ray through the point where two spheres touch is tangent to both at one distance: it meets the first.
#[test]
fn a_tie_goes_to_the_lower_index() {
    let [left, right] = ["-0.3 0 -5.7 0.3 0.3 0.3", "0.3 0 -5.7 0.3 0.3 0.3"];
    for (a, b) in [(left, right), (right, left)] {
        let (color, tally) = middle(&scene_of(&format!("SPHERE a {a} {RED}\nSPHERE b {b} {GREEN}\n{ROOM}")));
        assert_eq!((color, tally.more_bits, tally.undecided), ([255, 0, 0], 1, 1), "{a}");
    }
}

/// Spheres with the very same surface are no tie: the first is the one that is seen.
#[test]
fn one_surface_is_no_tie() {
    let sphere = "0.1 0 -5.7 0.3 0.3 0.3";
    let (color, tally) = middle(&scene_of(&format!("SPHERE a {sphere} {RED}\nSPHERE b {sphere} {GREEN}\n{ROOM}")));
    assert_eq!((color, tally.more_bits), ([255, 0, 0], 0));
}

/// Two spheres that the ray meets at distances which differ by some 1e-16, or not at all: whole numbers say which is nearer.
#[test]
fn the_nearer_is_found_where_f64_cannot_tell() {
    /// Digits after the point.
    const UNIT: i64 = 10_000_000_000_000_000;
    let number = |x: i64| format!("{}.{:016}", x / UNIT, x % UNIT);
    let mut random = Random::new(17, 0);
    let (mut ties, mut wrong) = (0, 0);
    for _ in 0..300 {
        let mut below = |limit: u64| (random.bits() % limit).cast_signed();
        // With at most 15 digits in a number but for the second radius, which lies in 0.2..0.5 and has 16.
        let front = UNIT * 3 + below(9_999) * (UNIT / 10_000);
        let radii = [UNIT / 5 + below(2_999) * (UNIT / 10_000), UNIT / 5 + below(2_999) * (UNIT / 10_000)];
        let nearer = below(5) - 2;
        let centers = radii.map(|radius| front + radius);
        let radii = [radii[0], radii[1] + nearer];
        let sphere = |k: usize, color: &str| {
            let radius = number(radii[k]);
            format!("SPHERE s{k} 0 0 -{} {radius} {radius} {radius} {color}\n", number(centers[k]))
        };
        let scene = scene_of(&format!("{}{}{ROOM}", sphere(0, RED), sphere(1, GREEN)));
        let (color, tally) = middle(&scene);
        let right = if nearer > 0 { [0, 255, 0] } else { [255, 0, 0] };
        let case = format!("{}{}", sphere(0, RED), sphere(1, GREEN));
        assert_eq!((color, tally.more_bits, tally.undecided), (right, 1, u64::from(nearer == 0)), "{case}");
        ties += u32::from(nearer == 0);
        // What f64 makes of it.
        let [first, second] = [0, 1].map(|k| {
            let sphere = &scene.spheres[k];
            oracle::intersect::<f64>(DVec3::ZERO, DVec3::NEG_Z, sphere.center, sphere.scale).unwrap().0
        });
        wrong += u32::from((second < first) != (nearer > 0));
    }
    assert!(ties > 20 && wrong > 20, "{ties} ties, {wrong} wrong in f64");
}

/// A blocker on whose surface a light lies ends before it.
#[test]
fn a_light_on_a_surface_lights() {
    let floor = "SPHERE floor 0 -101.1 -5.3 100 100 100 1 1 1 0 1 0 0 1\nLIGHT lamp 0 -0.1 -5.3 1 1 1\nAMBIENT 0 0 0";
    let alone = scene_of(floor);
    let beneath = scene_of(&format!("{floor}\nSPHERE above 0 0.6 -5.3 0.7 0.7 0.7 0 0 0 0 0 0 0 1"));
    for convention in [Convention::Classic, Convention::Exact] {
        let (free, none) = whole(&alone, &convention.settings());
        let (rgb, tally) = whole(&beneath, &convention.settings());
        let lit: Vec<usize> = (0..free.len()).filter(|&k| free[k] != 0 && k / 3 / 40 > 25).collect();
        assert!(lit.len() > 1000 && lit.iter().all(|&k| rgb[k] == free[k]), "{convention:?}");
        assert_eq!(none.more_bits, 0, "{convention:?}");
        assert!(tally.undecided > 300 && tally.undecided == tally.more_bits, "{convention:?}: {tally:?}");
    }
}

/// Where nothing ties everything is decided, also with the eye far from the origin.
#[test]
fn scenes_without_ties_are_decided() {
    for name in
        ["hard/translated", "hard/earth-at-one-metre", "hard/needles", "hard/mirror-corridor", "effects/everything"]
    {
        let scene = load(&root().join("scenes").join(name).with_extension("txt"));
        for convention in [Convention::Classic, Convention::Exact] {
            let (_, tally) = whole(&scene, &convention.settings());
            assert_eq!(tally.undecided, 0, "{name}, {convention:?}");
        }
    }
}

/// A room with a mirror for a wall and mirroring balls in it, 120 of them: their centres, in hundredths, and the scene.
fn room_of_balls() -> (Vec<[i64; 3]>, Scene) {
    let cells = (0..125_i64).map(|k| (k, [k / 25 - 2, k / 5 % 5 - 2, k % 5 - 2]));
    let far = cells.filter(|(_, cell)| (1..=9).contains(&cell.iter().map(|x| x * x).sum::<i64>()));
    let aside = |k: i64, by: i64| k * by % 11 * 5 - 25;
    let centers: Vec<[i64; 3]> =
        far.map(|(k, [x, y, z])| [300 * x + aside(k, 3), 300 * y + aside(k, 5), 300 * z + aside(k, 7)]).collect();
    let ball = |center: &[i64; 3]| {
        let [x, y, z] = center.map(|x| x as f64 / 100.0);
        format!("SPHERE ball {x} {y} {z} 1 1 1 1 1 1 0.02 0 0 1 1\n")
    };
    let balls: String = centers.iter().map(ball).collect();
    let scene = scene_of(&format!("SPHERE room 0 0 0 12 12 12 1 1 1 0.002 0 0 1 1\n{balls}AMBIENT 1 1 1"));
    let window = Window { left: -1.2, right: 1.2, bottom: -1.2, top: 1.2, ..scene.window };
    (centers, Scene { width: 12, height: 12, window, ..scene })
}

type Big = FBig<HalfEven>;

/// x/100 with 500 bits.
fn big(hundredths: i64) -> Big {
    Big::from(hundredths).with_precision(500).value() / Big::from(100)
}

fn dot(a: &[Big; 3], b: &[Big; 3]) -> Big {
    a.iter().zip(b).map(|(a, b)| a * b).reduce(|sum, x| sum + x).unwrap()
}

/// The ambient light that a ray through this point of the plane z = −1 gathers on its way over `bounces` mirrors.
fn gathered(through: [i64; 2], balls: &[[i64; 3]], bounces: u32) -> f64 {
    let (room, one) = (big(1200), big(100));
    let mut origin = [0; 3].map(big);
    let mut direction = [big(through[0]), big(through[1]), big(-100)];
    let (mut light, mut own) = (0.0, None);
    for _ in 0..=bounces {
        // Which ball is the next can be told by f64, where nothing is in doubt.
        let [o, d] = [&origin, &direction].map(|v| DVec3::from_array([0, 1, 2].map(|axis| v[axis].to_f64().value())));
        let others = balls.iter().enumerate().filter(|&(ball, _)| own != Some(ball));
        let mut hits: Vec<(f64, usize)> = others
            .filter_map(|(ball, center)| {
                let s = o - DVec3::from_array(center.map(|x| x as f64 / 100.0));
                let (a, b) = (d.dot(d), s.dot(d));
                let discriminant = b * b - a * (s.dot(s) - 1.0);
                assert!(discriminant.abs() > 1e-9, "nearly a tangent");
                let t = (-b - discriminant.max(0.0).sqrt()) / a;
                (discriminant > 0.0 && t > 0.0).then_some((t, ball))
            })
            .collect();
        hits.sort_by(|a, b| a.0.total_cmp(&b.0));
        assert!(hits.len() < 2 || hits[1].0 - hits[0].0 > 1e-9, "nearly a tie");
        own = hits.first().map(|hit| hit.1);
        let center = own.map_or([0; 3], |ball| balls[ball]).map(big);
        let radius = if own.is_some() { &one } else { &room };
        light += if own.is_some() { 0.02 } else { 0.002 };
        let s = [0, 1, 2].map(|axis| &origin[axis] - &center[axis]);
        let (a, b, c) = (dot(&direction, &direction), dot(&s, &direction), dot(&s, &s) - radius * radius);
        let root = (&b * &b - &a * c).sqrt();
        let t = if own.is_some() { (-b - root) / &a } else { (root - b) / &a };
        origin = [0, 1, 2].map(|axis| &origin[axis] + &t * &direction[axis]);
        let normal = [0, 1, 2].map(|axis| &origin[axis] - &center[axis]);
        let twice = Big::from(2) * dot(&normal, &direction) / dot(&normal, &normal);
        direction = [0, 1, 2].map(|axis| &direction[axis] - &twice * &normal[axis]);
    }
    light
}

/// Each ball multiplies what is wrong in a ray by some ten: after 40 mirrors double-double knows nothing of its way.
#[test]
fn after_forty_curved_mirrors_all_is_decided() {
    let (balls, scene) = room_of_balls();
    let settings = Settings { max_depth: 40, ..Settings::exact() };
    let reference = reference(&scene, &settings);
    let (_, tally) = whole(&scene, &settings);
    assert_eq!((tally.most_bits, tally.undecided), (144, 0));
    for pixel in 0..144 {
        let [i, j] = [pixel % 12, pixel / 12];
        // In hundredths: the window is 2.4 wide, so that the middles of pixels are whole ones.
        let through = [20 * i64::from(i) - 110, 110 - 20 * i64::from(j)];
        let (found, right) = (reference.color(i, j).unwrap().x, gathered(through, &balls, 40));
        assert!((found - right).abs() < 1e-12, "pixel {i}, {j}: {found}, not {right}");
    }
}
