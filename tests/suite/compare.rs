//! Picture comparison: counts, typical mistakes, verdicts and heat maps.

use proptest::prelude::*;
use trueray::compare::{
    Band, Bounds, Difference, Limits, ResemblanceKind, SCALE, Verdict, WorstPixel, heatmap, three_wide, verdict,
};
use trueray::film::Picture;

fn picture(width: u32, height: u32, pixel: impl Fn(u32, u32) -> [u8; 3]) -> Picture {
    let rgb = (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).flat_map(|(x, y)| pixel(x, y)).collect();
    Picture::new(width, height, rgb).unwrap()
}

/// A disc and a ramp: no two rows, columns or channels are the same, no symmetry.
fn scene(x: u32, y: u32) -> [u8; 3] {
    let inside = x.abs_diff(14).pow(2) + y.abs_diff(11).pow(2) < 64;
    if inside { [200, (10 * y) as u8, (6 * x) as u8] } else { [(3 * x + y) as u8, 20, (2 * y) as u8] }
}

fn between(a: &Picture, b: &Picture) -> Difference {
    Difference::between(a, b).unwrap()
}

fn kinds(difference: &Difference) -> Vec<ResemblanceKind> {
    difference.resemblances.iter().map(|resemblance| resemblance.kind).collect()
}

/// Two pictures of 4×3 pixels that differ in five of them.
fn pair() -> (Picture, Picture) {
    let a = picture(4, 3, |_, _| [100; 3]);
    let b = picture(4, 3, |x, y| match (x, y) {
        (1, 0) => [101, 100, 100],
        (3, 0) => [100, 98, 101],
        (2, 1) => [90, 100, 100],
        (1, 2) => [100, 100, 160],
        (2, 2) => [100, 40, 100],
        _ => [100; 3],
    });
    (a, b)
}

#[test]
fn same_pictures() {
    let a = picture(30, 20, scene);
    let difference = between(&a, &a.clone());
    assert_eq!((difference.pixels, difference.differing.over_0, difference.max_level), (600, 0, 0));
    assert_eq!((difference.mean, difference.worst, difference.bounds), (0.0, None, None));
    assert!(difference.resemblances.is_empty());
    assert_eq!(verdict(&difference, &Limits::default()), Verdict::Same);
}

#[test]
fn sizes_must_agree() {
    let (a, b) = (picture(4, 3, scene), picture(3, 4, scene));
    let message = Difference::between(&a, &b).unwrap_err().to_string();
    assert_eq!(message, "the pictures differ in size: A is 4x3, B is 3x4");
    assert!(heatmap(&a, &b).is_err() && three_wide(&a, &b).is_err());
}

#[test]
fn counts_worst_mean_and_bounds() {
    let (a, b) = pair();
    let difference = between(&a, &b);
    assert_eq!(difference.differing.by_threshold(), [(0, 5), (1, 4), (2, 3), (10, 2)]);
    assert_eq!((difference.max_level, difference.max_per_channel), (60, [10, 60, 60]));
    // The first of two pixels that are equally bad.
    assert_eq!(difference.worst, Some(WorstPixel { x: 1, y: 2, level: 60, a: [100; 3], b: [100, 100, 160] }));
    assert_eq!(difference.bounds, Some(Bounds { x_min: 1, y_min: 0, x_max: 3, y_max: 2 }));
    assert_eq!(difference.mean, 134.0 / 36.0);
}

#[test]
fn json_names_are_stable() {
    let (a, b) = pair();
    let json = serde_json::to_value(between(&a, &b)).unwrap();
    let expected = serde_json::json!({
        "width": 4, "height": 3, "pixels": 12,
        "differing": { "over_0": 5, "over_1": 4, "over_2": 3, "over_10": 2 },
        "max_level": 60, "max_per_channel": [10, 60, 60], "mean": 134.0 / 36.0,
        "worst": { "x": 1, "y": 2, "level": 60, "a": [100, 100, 100], "b": [100, 100, 160] },
        "bounds": { "x_min": 1, "y_min": 0, "x_max": 3, "y_max": 2 },
        "resemblances": [],
    });
    assert_eq!(json, expected);
    assert_eq!(serde_json::to_value(Verdict::WithinLimits).unwrap(), "within_limits");

    let base = picture(30, 20, scene);
    let moved = picture(30, 20, |x, y| scene(x, y + 1));
    let json = serde_json::to_value(between(&base, &moved).resemblances).unwrap();
    assert_eq!(json, serde_json::json!([{ "kind": "moved_up", "compared": 570, "differing": 0 }]));
}

#[test]
fn the_report_is_aligned() {
    let (a, b) = pair();
    let expected = "\
A                 ours.ppm
B                 key.png
size              4x3, 12 pixels
differ by > 0      5   41.6667 %
differ by > 1      4   33.3333 %
differ by > 2      3   25.0000 %
differ by > 10     2   16.6667 %
worst pixel       x 1, y 2: 60 levels, A (100, 100, 100), B (100, 100, 160)
worst by channel  red 10, green 60, blue 60
mean              3.722222 levels a sample
where             x 1 to 3, y 0 to 2
";
    assert_eq!(between(&a, &b).report("ours.ppm", "key.png"), expected);
    assert_eq!(between(&a, &a).report("a", "b").lines().count(), 7);
}

#[test]
fn moves_by_one_are_found() {
    use ResemblanceKind::{MovedDown, MovedLeft, MovedRight, MovedUp};
    let base = picture(30, 20, |x, y| scene(x + 1, y + 1));
    let up = picture(30, 20, |x, y| scene(x + 1, y + 2));
    let left = picture(30, 20, |x, y| scene(x + 2, y + 1));
    for (a, b, kind) in
        [(&base, &up, MovedUp), (&up, &base, MovedDown), (&base, &left, MovedLeft), (&left, &base, MovedRight)]
    {
        let difference = between(a, b);
        assert_eq!(kinds(&difference), [kind]);
        assert_eq!(difference.resemblances[0].differing, 0);
    }
    let report = between(&base, &up).report("a", "b");
    let note = "note              B looks like A moved up by one row (B sampled at the pixels' bottom edge, A at the top \
        one?): 0 of 570 pixels differ then\n";
    assert!(report.ends_with(note), "{report}");
}

#[test]
fn a_move_is_found_among_other_differences() {
    let base = picture(30, 20, scene);
    let moved = |every: u32| {
        picture(30, 20, move |x, y| {
            let pixel = scene(x, y + 1);
            if (x + 7 * y).is_multiple_of(every) { pixel.map(|sample| sample ^ 1) } else { pixel }
        })
    };
    assert_eq!(kinds(&between(&base, &moved(23))), [ResemblanceKind::MovedUp]);
    // A tenth is too many.
    assert_eq!(kinds(&between(&base, &moved(5))), []);
}

#[test]
fn differences_at_the_edge_are_no_move() {
    // Moving by a row would drop the only difference of two pictures that are flat otherwise.
    let flat = picture(9, 9, |_, _| [5; 3]);
    for at in [(0, 0), (4, 0), (4, 8), (0, 4), (8, 4), (4, 4), (1, 1)] {
        let dot = picture(9, 9, |x, y| if (x, y) == at { [9; 3] } else { [5; 3] });
        let found = kinds(&between(&flat, &dot));
        assert!(found.is_empty(), "{at:?}: {found:?}");
    }
    for (width, height) in [(1, 1), (2, 2), (1, 9), (9, 2)] {
        let (a, b) = (picture(width, height, |_, _| [1; 3]), picture(width, height, |_, _| [2; 3]));
        assert!(!kinds(&between(&a, &b)).contains(&ResemblanceKind::MovedUp));
    }
}

#[test]
fn flips_and_exchanged_channels_are_found() {
    let a = picture(30, 20, scene);
    let upside_down = picture(30, 20, |x, y| scene(x, 19 - y));
    let mirrored = picture(30, 20, |x, y| scene(29 - x, y));
    let bgr = picture(30, 20, |x, y| {
        let [red, green, blue] = scene(x, y);
        [blue, green, red]
    });
    assert_eq!(kinds(&between(&a, &upside_down)), [ResemblanceKind::FlippedVertically]);
    assert_eq!(kinds(&between(&a, &mirrored)), [ResemblanceKind::FlippedHorizontally]);
    assert_eq!(kinds(&between(&a, &bgr)), [ResemblanceKind::RedBlueSwapped]);
}

#[test]
fn rounding_against_truncation_is_found() {
    let value = |x: u32, y: u32| (x + y) as f64 * 0.7;
    let truncated = picture(30, 20, |x, y| [value(x, y) as u8; 3]);
    let rounded = picture(30, 20, |x, y| [value(x, y).round() as u8; 3]);
    assert_eq!(kinds(&between(&truncated, &rounded)), [ResemblanceKind::OneLevelBrighter]);
    assert_eq!(kinds(&between(&rounded, &truncated)), [ResemblanceKind::OneLevelDarker]);
    let noise = picture(30, 20, |x, y| [(value(x, y) as u8 + 1) - 2 * ((x % 2) as u8).min(value(x, y) as u8); 3]);
    assert!(kinds(&between(&truncated, &noise)).is_empty());
}

#[test]
fn a_scale_of_255_9_is_told_from_rounding() {
    use ResemblanceKind::{OneLevelBrighter, OverscaledBrighter, OverscaledDarker};
    // Values spread evenly, before a background that every rule makes something else of.
    let of = |quantize: &dyn Fn(f64) -> f64, background: f64| {
        picture(64, 64, |x, y| {
            let c = f64::from((x * 64 + y) * 2654 % 4096) / 4096.0;
            [quantize(if y < 30 { background } else { c }) as u8; 3]
        })
    };
    for background in [0.0, 0.2, 0.5, 0.999, 1.0] {
        let truncated = of(&|c| 255.0 * c, background);
        let rounded = of(&|c| (255.0 * c).round(), background);
        let overscaled = of(&|c| 255.9 * c, background);
        assert_eq!(kinds(&between(&truncated, &overscaled)), [OverscaledBrighter], "{background}");
        assert_eq!(kinds(&between(&overscaled, &truncated)), [OverscaledDarker], "{background}");
        assert_eq!(kinds(&between(&truncated, &rounded)), [OneLevelBrighter], "{background}");
        assert!(between(&truncated, &overscaled).report("a", "b").contains("× 255.9"));
    }
}

#[test]
fn limits_decide() {
    let (a, b) = pair();
    let difference = between(&a, &b);
    let decide = |limits: Limits| verdict(&difference, &limits);
    assert_eq!(decide(Limits::default()), Verdict::Different);
    assert_eq!(decide(Limits::UNLIMITED), Verdict::WithinLimits);
    let exact = Limits {
        over_0: Some(5),
        over_1: Some(4),
        over_2: Some(3),
        over_10: Some(2),
        max_level: Some(60),
        max_mean: Some(134.0 / 36.0),
    };
    assert_eq!(decide(exact), Verdict::WithinLimits);
    for (tighter, reason) in [
        (Limits { over_0: Some(4), ..exact }, "pixels that differ by > 0: 5, limit 4"),
        (Limits { over_1: Some(3), ..exact }, "pixels that differ by > 1: 4, limit 3"),
        (Limits { over_2: Some(2), ..exact }, "pixels that differ by > 2: 3, limit 2"),
        (Limits { over_10: Some(1), ..exact }, "pixels that differ by > 10: 2, limit 1"),
        (Limits { max_level: Some(59), ..exact }, "greatest level difference: 60, limit 59"),
        (Limits { max_mean: Some(3.5), ..exact }, "mean difference: 3.722222, limit 3.5"),
        (Limits { max_mean: Some(f64::NAN), ..exact }, "mean difference: 3.722222, limit NaN"),
    ] {
        assert_eq!(decide(tighter), Verdict::Different);
        assert_eq!(tighter.exceeded(&difference), [reason]);
    }
}

#[test]
fn heat_map_pixels() {
    let levels = [0, 1, 2, 3, 10, 11, 50, 51, 255];
    let a = picture(9, 1, |x, _| [if x == 0 { 255 } else { 0 }; 3]);
    let b = picture(9, 1, |x, _| if x == 0 { [255; 3] } else { [0, levels[x as usize], 0] });
    let [one, two, few, some, many] = SCALE.map(|band| band.color);
    let expected = [[48; 3], one, two, few, few, some, some, many, many];
    assert_eq!(heatmap(&a, &b).unwrap().pixels(), expected);
    assert_eq!(Band::counts(&a, &b).unwrap(), [1, 1, 2, 2, 2]);
}

/// CIE 1976 L*, a*, b* of a colour.
fn lab(color: [f64; 3]) -> [f64; 3] {
    let [r, g, b] = color;
    let xyz = [
        (0.4124 * r + 0.3576 * g + 0.1805 * b) / 0.9505,
        0.2126 * r + 0.7152 * g + 0.0722 * b,
        (0.0193 * r + 0.1192 * g + 0.9505 * b) / 1.0890,
    ];
    let [x, y, z] = xyz.map(|t| if t > 0.008_856 { t.cbrt() } else { 7.787 * t + 16.0 / 116.0 });
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

/// Red, green and blue as light.
fn linear(color: [u8; 3]) -> [f64; 3] {
    color.map(|level| {
        let c = f64::from(level) / 255.0;
        if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
    })
}

/// How eyes without red, green or blue cones see light (Machado, Oliveira, Fernandes 2009, severity 1), and all others.
const EYES: [[[f64; 3]; 3]; 4] = [
    [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
    [[0.1523, 1.0526, -0.2049], [0.1145, 0.7863, 0.0992], [-0.0039, -0.0481, 1.0520]],
    [[0.3673, 0.8606, -0.2280], [0.2801, 0.6725, 0.0474], [-0.0118, 0.0429, 0.9689]],
    [[1.2555, -0.0767, -0.1788], [-0.0784, 0.9308, 0.1476], [0.0047, 0.6914, 0.3039]],
];

#[test]
fn every_eye_can_read_the_heat_map() {
    for eye in EYES {
        let seen = |color: [u8; 3]| {
            let light = linear(color);
            lab(eye.map(|row| row.iter().zip(light).map(|(k, c)| k * c).sum::<f64>().clamp(0.0, 1.0)))
        };
        let bands = SCALE.map(|band| seen(band.color));
        let same: Vec<_> = (0..=48).map(|grey| seen([grey; 3])).collect();
        let distance = |a: [f64; 3], b: [f64; 3]| a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt();
        // Of a step of lightness 10 nobody is in doubt.
        assert!(bands.windows(2).all(|pair| pair[1][0] > pair[0][0] + 10.0), "{bands:?}");
        for (index, &band) in bands.iter().enumerate() {
            assert!(bands[..index].iter().all(|&other| distance(band, other) > 15.0), "{bands:?}");
            assert!(same.iter().all(|&grey| distance(band, grey) > 15.0), "{band:?}");
        }
    }
    let [purple, ..] = SCALE.map(|band| lab(linear(band.color))[0]);
    assert!(lab(linear([48; 3]))[0] < purple);
}

#[test]
fn three_pictures_side_by_side() {
    let (a, b) = pair();
    let wide = three_wide(&a, &b).unwrap();
    let heat = heatmap(&a, &b).unwrap();
    assert_eq!((wide.width(), wide.height()), (4 + 4 + 4 + 4 + 4, 3));
    for y in 0..3 {
        let row = wide.row(y);
        assert_eq!([&row[..4], &row[8..12], &row[16..]], [a.row(y), b.row(y), heat.row(y)]);
        let gap = [[255; 3], [0; 3], [0; 3], [255; 3]];
        assert_eq!([&row[4..8], &row[12..16]], [&gap, &gap]);
    }
}

fn pairs() -> impl Strategy<Value = (Picture, Picture)> {
    (1_u32..12, 1_u32..12).prop_flat_map(|(width, height)| {
        let samples = || proptest::collection::vec(0_u8..4, (width * height * 3) as usize);
        (samples(), samples())
            .prop_map(move |(a, b)| (Picture::new(width, height, a).unwrap(), Picture::new(width, height, b).unwrap()))
    })
}

proptest! {
    #[test]
    fn comparison_is_symmetric_and_consistent((a, b) in pairs()) {
        let (forth, back) = (between(&a, &b), between(&b, &a));
        prop_assert_eq!(forth.differing, back.differing);
        prop_assert_eq!((forth.mean, forth.max_per_channel, forth.bounds), (back.mean, back.max_per_channel, back.bounds));
        let differing = a.pixels().iter().zip(b.pixels()).filter(|(a, b)| a != b).count() as u64;
        prop_assert_eq!(forth.differing.over_0, differing);
        prop_assert_eq!(forth.max_level, forth.max_per_channel.into_iter().max().unwrap());
        prop_assert_eq!(verdict(&forth, &Limits::default()) == Verdict::Same, a == b);
        if let Some(worst) = forth.worst {
            prop_assert_eq!((a.pixel(worst.x, worst.y), b.pixel(worst.x, worst.y)), (worst.a, worst.b));
        }
    }

    #[test]
    fn heat_maps_colour_just_the_differing_pixels((a, b) in pairs()) {
        let heat = heatmap(&a, &b).unwrap();
        for ((a, b), heat) in a.pixels().iter().zip(b.pixels()).zip(heat.pixels()) {
            prop_assert_eq!(a != b, SCALE.iter().any(|band| band.color == *heat));
        }
    }
}
