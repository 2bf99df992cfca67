//! Causes whose size is found from the pixels: intensities, colours, places.

use std::collections::HashMap;
use std::sync::Arc;

use glam::DVec3;
use rayon::prelude::*;

use super::case::{Case, Sample};
use super::catalogue::Way;
use super::simplex::minimum;
use super::variant::Variant;
use super::world::World;
use crate::scene::{Scene, Sphere};

/// More spheres than this are not all tried, but those that most differing pixels show.
const SPHERES: usize = 7;
/// Of more spheres than this nothing is fitted: each candidate has a world of its own, a few thousand of which are kept.
const FITTED_SPHERES: usize = 300;
/// More lights than this are not tried.
const LIGHTS: usize = 6;
/// Below this part of a colour a term says too little of its coefficient.
const LEAST_PART: f64 = 0.01;
/// A fit that leaves less than this part of the error is refined.
const PROMISING: f64 = 0.7;
/// Decimals to which fitted numbers are rounded, since scenes are written by people.
const DECIMALS: [i32; 4] = [0, 1, 2, 3];

/// Every fit of a cause to what `base` leaves unexplained, by a sample, and by a smaller one where many renderings are needed.
pub(super) fn fits(case: &Case, scene: &Scene, base: &Variant, [sample, few]: [&Sample; 2]) -> Vec<Way> {
    if scene.spheres.len() > FITTED_SPHERES {
        return Vec::new();
    }
    let fitter = Fitter { case, scene, base, sample, few };
    let spheres = fitter.suspects();
    let lights = 0..scene.lights.len().min(LIGHTS);
    let mut tasks: Vec<Task> = vec![
        Box::new(|f: &Fitter| {
            let set: Setter = Arc::new(|w: &mut World, c| w.ambient = c);
            f.linear("ambient-intensity", "", f.base.world.ambient, &set)
        }),
        Box::new(|f: &Fitter| {
            let set: Setter = Arc::new(|w: &mut World, c| w.background = c);
            f.linear("background-color", "", f.base.world.background, &set)
        }),
    ];
    for light in lights {
        tasks.push(Box::new(move |f: &Fitter| {
            let set: Setter = Arc::new(move |w: &mut World, c| w.lights[light].intensity = c);
            let name = f.scene.light_names.in_words("light", light);
            f.linear("light-intensity", &name, f.base.world.lights[light].intensity, &set)
        }));
        tasks.push(Box::new(move |f: &Fitter| f.light_moved(light)));
    }
    for sphere in spheres {
        tasks.push(Box::new(move |f: &Fitter| vec![f.missing(sphere)]));
        tasks.push(Box::new(move |f: &Fitter| {
            let set: Setter = Arc::new(move |w: &mut World, c| w.bodies[sphere].material.color = c);
            f.linear("sphere-color", &f.sphere_name(sphere), f.base.world.bodies[sphere].material.color, &set)
        }));
        tasks.push(Box::new(move |f: &Fitter| f.material(sphere)));
        tasks.push(Box::new(move |f: &Fitter| f.moved(sphere)));
        tasks.push(Box::new(move |f: &Fitter| f.scaled(sphere)));
    }
    tasks.into_par_iter().filter(|_| !case.limit.is_over()).flat_map_iter(|task| task(&fitter)).collect()
}

type Task = Box<dyn Fn(&Fitter) -> Vec<Way> + Send + Sync>;

/// A coefficient's letter and place.
type Coefficient = (&'static str, fn(&mut Sphere) -> &mut f64);

/// Puts a colour into a world.
type Setter = Arc<dyn Fn(&mut World, DVec3) + Send + Sync>;

struct Fitter<'a> {
    case: &'a Case<'a>,
    scene: &'a Scene,
    base: &'a Variant,
    sample: &'a Sample,
    /// For what takes many renderings.
    few: &'a Sample,
}

/// `x` with so many decimals.
fn rounded(x: f64, decimals: i32) -> f64 {
    let scale = 10_f64.powi(decimals);
    (x * scale).round() / scale
}

/// A vector as it is and with few decimals, each once.
fn with_decimals(vector: DVec3) -> Vec<DVec3> {
    let mut all: Vec<DVec3> = Vec::new();
    for candidate in DECIMALS.map(|decimals| vector.map(|x| rounded(x, decimals))).into_iter().chain([vector]) {
        if candidate.is_finite() && !all.contains(&candidate) {
            all.push(candidate);
        }
    }
    all
}

/// Numbers as reports have them, without −0.
fn in_words(vector: DVec3) -> String {
    let [x, y, z] = vector.to_array().map(|x| format!("{}", rounded(x, 4) + 0.0));
    format!("({x}, {y}, {z})")
}

impl Fitter<'_> {
    fn sphere_name(&self, sphere: usize) -> String {
        self.scene.sphere_names.in_words("sphere", sphere)
    }

    /// The spheres that may be wrong: those that differing pixels show, most first; of few spheres all.
    fn suspects(&self) -> Vec<usize> {
        let mut counts: HashMap<usize, usize> = HashMap::new();
        for &pixel in &self.sample.differing {
            if let Some(sphere) = self.base.seen(&self.case.stage, pixel) {
                *counts.entry(sphere).or_default() += 1;
            }
        }
        let count = self.base.world.bodies.len();
        let mut order: Vec<usize> =
            if count <= SPHERES { (0..count).collect() } else { counts.keys().copied().collect() };
        order.sort_by_key(|sphere| (std::cmp::Reverse(counts.get(sphere).copied().unwrap_or(0)), *sphere));
        order.truncate(SPHERES);
        order
    }

    fn with(&self, change: impl FnOnce(&mut World)) -> Variant {
        let mut variant = self.base.clone();
        change(Arc::make_mut(&mut variant.world));
        variant
    }

    fn missing(&self, sphere: usize) -> Way {
        let detail = self.sphere_name(sphere);
        let apply = move |v: &mut Variant| Arc::make_mut(&mut v.world).remove(sphere);
        Way { name: "sphere-missing", detail, apply: Box::new(apply) }
    }

    /// What each channel of each differing pixel asks for of a coefficient, with the part of the colour that it says it by: from the
    /// colours without it and with 1 in its place.
    fn ask(&self, [none, one]: [&Variant; 2], mut hear: impl FnMut(usize, (f64, f64))) {
        for &pixel in &self.sample.differing {
            if self.case.limit.is_over() {
                return;
            }
            let wanted = self.base.encoding.color(self.case.levels(pixel));
            let without = none.color(&self.case.stage, pixel);
            let part = one.color(&self.case.stage, pixel) - without;
            for c in 0..3 {
                if part[c] > LEAST_PART && wanted[c].is_finite() {
                    hear(c, ((wanted[c] - without[c]) / part[c], part[c]));
                }
            }
        }
    }

    /// A colour in which the picture is linear: median of what the pixels ask for.
    fn linear(&self, name: &'static str, what: &str, now: DVec3, set: &Setter) -> Vec<Way> {
        let (none, one) = (self.with(|w| set(w, DVec3::ZERO)), self.with(|w| set(w, DVec3::ONE)));
        let mut asked: [Vec<(f64, f64)>; 3] = Default::default();
        self.ask([&none, &one], |c, value| asked[c].push(value));
        let mut fitted = now;
        for c in 0..3 {
            if let Some(median) = weighted_median(&mut asked[c]) {
                fitted[c] = median.max(0.0);
            }
        }
        let refined = self.refined(set, fitted);
        let mut ways = Vec::new();
        for value in [with_decimals(fitted), with_decimals(refined)].concat() {
            let set = Arc::clone(set);
            let detail =
                format!("{what}{}{} for {}", if what.is_empty() { "" } else { ": " }, in_words(value), in_words(now));
            let apply = move |v: &mut Variant| set(Arc::make_mut(&mut v.world), value);
            ways.push(Way { name, detail, apply: Box::new(apply) });
        }
        ways
    }

    /// The middle of the colours around `fitted` for which the fewest pixels of the sample are off, channel by channel.
    fn refined(&self, set: &Setter, fitted: DVec3) -> DVec3 {
        let mut best = fitted;
        let error = |color: DVec3| self.case.error(&self.with(|w| set(w, color)), self.few);
        for c in 0..3 {
            let steps = [-0.004, -0.002, -0.001, -0.0005, 0.0, 0.0005, 0.001, 0.002, 0.004];
            let tried = steps.map(|step| {
                let mut color = best;
                color[c] = (color[c] + step).max(0.0);
                (error(color), color)
            });
            if let Some((_, color)) = tried.into_iter().min_by(|a, b| a.0.total_cmp(&b.0)) {
                best = color;
            }
        }
        best
    }

    /// A sphere's coefficients, one at a time.
    fn material(&self, sphere: usize) -> Vec<Way> {
        let mut ways = Vec::new();
        let now = self.base.world.bodies[sphere].material;
        let coefficients: [Coefficient; 4] =
            [("Ka", |s| &mut s.ka), ("Kd", |s| &mut s.kd), ("Ks", |s| &mut s.ks), ("Kr", |s| &mut s.kr)];
        for (letter, of) in coefficients {
            let set = move |w: &mut World, value: f64| *of(&mut w.bodies[sphere].material) = value;
            let mut copy = now;
            let old = *of(&mut copy);
            let (none, one) = (self.with(|w| set(w, 0.0)), self.with(|w| set(w, 1.0)));
            let mut asked = Vec::new();
            self.ask([&none, &one], |_, value| asked.push(value));
            let Some(fitted) = weighted_median(&mut asked) else { continue };
            for value in DECIMALS.map(|decimals| rounded(fitted, decimals)).into_iter().chain([fitted]) {
                let detail = format!("{}: {letter} {} for {old}", self.sphere_name(sphere), rounded(value, 4));
                let apply = move |v: &mut Variant| set(Arc::make_mut(&mut v.world), value);
                ways.push(Way { name: "sphere-material", detail, apply: Box::new(apply) });
            }
        }
        for exponent in
            [1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0, now.n * 2.0, now.n / 2.0, now.n + 1.0, now.n - 1.0]
        {
            if now.ks != 0.0 && exponent != now.n {
                let detail = format!("{}: n {exponent} for {}", self.sphere_name(sphere), now.n);
                let apply = move |v: &mut Variant| Arc::make_mut(&mut v.world).bodies[sphere].material.n = exponent;
                ways.push(Way { name: "sphere-material", detail, apply: Box::new(apply) });
            }
        }
        ways
    }

    /// A sphere elsewhere.
    fn moved(&self, sphere: usize) -> Vec<Way> {
        let body = self.base.world.bodies[sphere];
        let (center, scale) = (body.material.center, body.material.scale);
        let error = |sample: &Sample, shift: DVec3| {
            let variant = self.with(|w| w.reshape(sphere, center + shift, scale));
            self.case.error(&variant, sample)
        };
        let radius = scale.abs().max_element();
        let mut starts = vec![DVec3::ZERO];
        for x in -4..=4 {
            for y in -4..=4 {
                starts.push(DVec3::new(f64::from(x), f64::from(y), 0.0) * radius * 0.5);
            }
        }
        starts.extend([DVec3::Z, -DVec3::Z, 2.0 * DVec3::Z, -2.0 * DVec3::Z].map(|z| z * radius));
        let found = self.best_of(starts, radius * 0.2, &error);
        let (unit, eye) = (self.case.stage.unit, self.case.stage.eye);
        let place = |center: DVec3| center / unit + eye;
        let mut ways = Vec::new();
        for goal in found.into_iter().flat_map(|shift| with_decimals(place(center + shift))) {
            let detail =
                format!("{}: at {}, not {}", self.sphere_name(sphere), in_words(goal), in_words(place(center)));
            let apply = move |v: &mut Variant| Arc::make_mut(&mut v.world).reshape(sphere, (goal - eye) * unit, scale);
            ways.push(Way { name: "sphere-moved", detail, apply: Box::new(apply) });
        }
        ways
    }

    /// A sphere of another size or shape.
    fn scaled(&self, sphere: usize) -> Vec<Way> {
        let body = self.base.world.bodies[sphere];
        let (center, scale) = (body.material.center, body.material.scale.abs());
        // Logarithms, so that no semi-axis vanishes.
        let size = |factors: DVec3| scale * factors.map(f64::exp);
        let error = |sample: &Sample, factors: DVec3| {
            let variant = self.with(|w| w.reshape(sphere, center, size(factors)));
            self.case.error(&variant, sample)
        };
        let steps = [-0.7, -0.4, -0.2, -0.1, -0.05, 0.05, 0.1, 0.2, 0.4, 0.7];
        let mut starts = vec![DVec3::ZERO];
        starts
            .extend(steps.iter().flat_map(|&step| [DVec3::ONE, DVec3::X, DVec3::Y, DVec3::Z].map(|axes| axes * step)));
        let found = self.best_of(starts, 0.05, &error);
        let unit = self.case.stage.unit;
        let mut ways = Vec::new();
        for axes in found.into_iter().flat_map(|factors| with_decimals(size(factors) / unit)) {
            if axes.min_element() <= 0.0 {
                continue;
            }
            let detail = format!("{}: {}, not {}", self.sphere_name(sphere), in_words(axes), in_words(scale / unit));
            let apply = move |v: &mut Variant| Arc::make_mut(&mut v.world).reshape(sphere, center, axes * unit);
            ways.push(Way { name: "sphere-scaled", detail, apply: Box::new(apply) });
        }
        ways
    }

    /// A light elsewhere.
    fn light_moved(&self, light: usize) -> Vec<Way> {
        let now = self.base.world.lights[light].position;
        let error = |sample: &Sample, shift: DVec3| {
            let variant = self.with(|w| w.lights[light].position = now + shift);
            self.case.error(&variant, sample)
        };
        let bodies = &self.base.world.bodies;
        let middle = bodies.iter().map(|body| body.shape.center).sum::<DVec3>() / bodies.len().max(1) as f64;
        let reach = (now - middle).length().max(1e-3);
        let directions = [DVec3::X, DVec3::Y, DVec3::Z, -DVec3::X, -DVec3::Y, -DVec3::Z];
        let mut starts = vec![DVec3::ZERO];
        starts.extend([0.1, 0.3, 1.0].into_iter().flat_map(|step| directions.map(|axis| axis * reach * step)));
        // A coordinate whose sign is wrong is as likely as any small step.
        starts.extend([DVec3::X, DVec3::Y, DVec3::Z].map(|axis| -2.0 * axis * now));
        let found = self.best_of(starts, reach * 0.1, &error);
        let (unit, eye) = (self.case.stage.unit, self.case.stage.eye);
        let place = |position: DVec3| position / unit + eye;
        let name = self.scene.light_names.in_words("light", light);
        let mut ways = Vec::new();
        for goal in found.into_iter().flat_map(|shift| with_decimals(place(now + shift))) {
            let detail = format!("{name}: at {}, not {}", in_words(goal), in_words(place(now)));
            let apply = move |v: &mut Variant| Arc::make_mut(&mut v.world).lights[light].position = (goal - eye) * unit;
            ways.push(Way { name: "light-moved", detail, apply: Box::new(apply) });
        }
        ways
    }

    /// The least error around the best two of some starts, the first of which is right; where it is promising, by more pixels.
    fn best_of(&self, starts: Vec<DVec3>, step: f64, error: &impl Fn(&Sample, DVec3) -> f64) -> Vec<DVec3> {
        let mut tried: Vec<(f64, DVec3)> = starts.into_iter().map(|start| (error(self.few, start), start)).collect();
        let now = tried.first().map_or(0.0, |tried| tried.0);
        tried.sort_by(|a, b| a.0.total_cmp(&b.0));
        tried.truncate(2);
        let refined = |start: DVec3| {
            let found = minimum(start, step, |x| error(self.few, x));
            let is_promising = error(self.few, found) < PROMISING * now;
            if is_promising { minimum(found, step * 0.1, |x| error(self.sample, x)) } else { found }
        };
        tried.into_iter().map(|(_, start)| refined(start)).collect()
    }
}

/// The value with as much weight below as above.
fn weighted_median(values: &mut [(f64, f64)]) -> Option<f64> {
    values.sort_by(|a, b| a.0.total_cmp(&b.0));
    let half = values.iter().map(|(_, weight)| weight).sum::<f64>() / 2.0;
    let mut sum = 0.0;
    values.iter().find_map(|(value, weight)| {
        sum += weight;
        (sum >= half).then_some(*value)
    })
}
