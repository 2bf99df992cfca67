//! The built-in scenes. Their numbers come from seeded integers through additions, multiplications, divisions and square
//! roots alone, which IEEE 754 rounds alike everywhere: a family's scene of a size is the same on every machine, for ever.

use std::f64::consts::{LN_2, PI};
use std::fmt::Write as _;

use glam::DVec3;

use crate::random::Random;
use crate::scene::{Light, Names, Scene, Sphere, Window};

/// Seed of all random numbers; the size is their stream.
const SEED: u64 = 1000;
/// Width over height of the window; its half height is 1 at distance 1.
const ASPECT: f64 = 16.0 / 9.0;
/// Depths of the nearest and the farthest centre.
const DEPTHS: [f64; 2] = [15.0, 30.0];
/// Radii vary by this part up and down.
const VARIATION: f64 = 0.3;
/// Centres of the clusters.
const CLUSTERS: usize = 20;
/// Clusters and the spheres in them are so much smaller than as many spheres at random.
const SHRINK: f64 = 0.6;
/// Spheres of the scenes that differ in their lights.
const LIT_SPHERES: usize = 100;
const DOME_SPHERES: usize = 10_000;
/// The dome's radius; the spheres are within 40 of its middle.
const DOME_RADIUS: f64 = 80.0;

/// What a family's size counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Axis {
    /// Spheres and ellipsoids.
    Spheres,
    /// Point lights.
    Lights,
}

impl Axis {
    /// In words.
    pub fn name(self) -> &'static str {
        match self {
            Self::Spheres => "spheres",
            Self::Lights => "lights",
        }
    }
}

/// Scenes that differ in one number.
#[derive(Debug)]
pub struct Family {
    /// Its name on the command line and in file names.
    pub name: &'static str,
    /// What is in its scenes, in words.
    pub summary: &'static str,
    /// What the size counts.
    pub axis: Axis,
    /// The sizes, growing.
    pub sizes: &'static [usize],
    /// Spheres in a scene of this size.
    count: fn(usize) -> usize,
    build: fn(usize) -> Scene,
}

/// All families, in the order in which they are measured.
pub static FAMILIES: [Family; 9] = [
    Family {
        name: "classic",
        summary: "five ellipsoids and three lights, as in the assignment's scenes",
        axis: Axis::Spheres,
        sizes: &[5],
        count: |_| 5,
        build: |_| classic(),
    },
    Family {
        name: "spheres",
        summary: "spheres at random that cover about 60 % of the pixels, half of them mirrors, three lights",
        axis: Axis::Spheres,
        sizes: &[10, 100, 1_000, 10_000, 100_000, 1_000_000, 4_000_000],
        count: |size| size,
        build: |count| scene(count, &Look::PLAIN),
    },
    Family {
        name: "ellipsoids",
        summary: "the same with semi-axes that differ by up to 30 % from their mean",
        axis: Axis::Spheres,
        sizes: &[10, 100, 1_000, 10_000, 100_000],
        count: |size| size,
        build: |count| scene(count, &Look { ellipsoids: true, ..Look::PLAIN }),
    },
    Family {
        name: "mirrors",
        summary: "the same, but every sphere is a mirror with Kr 0.8",
        axis: Axis::Spheres,
        sizes: &[10, 100, 1_000, 10_000, 100_000],
        count: |size| size,
        build: |count| scene(count, &Look { mirrors: [0.8, 0.8], ..Look::PLAIN }),
    },
    Family {
        name: "lights",
        summary: "a hundred spheres at random with more and more lights around them",
        axis: Axis::Lights,
        sizes: &[1, 4, 16, 64, 256],
        count: |_| LIT_SPHERES,
        build: |count| lit(LIT_SPHERES, many_lights(count)),
    },
    Family {
        name: "dome",
        summary: "ten thousand spheres at random under a dome of lights, which is ambient occlusion by shadows alone",
        axis: Axis::Lights,
        sizes: &[1, 4, 16, 64, 256],
        count: |_| DOME_SPHERES,
        build: |count| lit(DOME_SPHERES, dome(count)),
    },
    Family {
        name: "glass",
        summary: "spheres at random, half of them of glass",
        axis: Axis::Spheres,
        sizes: &[10, 100, 1_000, 10_000, 100_000],
        count: |size| size,
        build: glass,
    },
    Family {
        name: "clustered",
        summary: "spheres in twenty clusters, dense towards their centres",
        axis: Axis::Spheres,
        sizes: &[100, 1_000, 10_000, 100_000],
        count: |size| size,
        build: clustered,
    },
    Family {
        name: "huge",
        summary: "spheres at random and one huge sphere in their midst",
        axis: Axis::Spheres,
        sizes: &[10, 100, 1_000, 10_000, 100_000],
        count: |size| size,
        build: |count| {
            let mut scene = scene(count, &Look::PLAIN);
            let huge = &mut scene.spheres[count / 2];
            huge.center = DVec3::new(0.0, 0.0, -f64::midpoint(DEPTHS[0], DEPTHS[1]));
            huge.scale = DVec3::splat(5.0);
            scene
        },
    },
];

impl Family {
    /// The family of this name.
    pub fn named(name: &str) -> Option<&'static Self> {
        FAMILIES.iter().find(|family| family.name == name)
    }

    /// The scene of one of the sizes, or of any other.
    pub fn scene(&self, size: usize) -> Scene {
        let mut scene = (self.build)(size.max(1));
        scene.output = Some(format!("{}.ppm", self.file_stem(size)));
        scene
    }

    /// The name of its scene of this size, for files.
    pub fn file_stem(&self, size: usize) -> String {
        format!("{}-{size}", self.name)
    }

    /// Spheres in its scene of this size.
    pub fn spheres(&self, size: usize) -> usize {
        (self.count)(size)
    }
}

/// In what random scenes differ.
struct Look {
    ellipsoids: bool,
    /// Kr of the spheres of even and of odd index.
    mirrors: [f64; 2],
}

impl Look {
    const PLAIN: Self = Self { ellipsoids: false, mirrors: [0.3, 0.0] };
}

/// To so many decimals, so that files stay short.
fn rounded(x: f64, decimals: f64) -> f64 {
    (x * decimals).round() / decimals
}

fn rounded_vector(v: DVec3, decimals: f64) -> DVec3 {
    DVec3::new(rounded(v.x, decimals), rounded(v.y, decimals), rounded(v.z, decimals))
}

/// The mean radius at which the projected areas of `count` spheres, uniform in the frustum, would sum up to ln 2 windows if
/// each were seen from straight ahead. Seen aslant they are larger: some 60 % of the pixels are covered.
fn mean_radius(count: usize) -> f64 {
    let [near, far] = DEPTHS;
    let mean_square_factor = 1.0 + VARIATION * VARIATION / 3.0;
    let mean_inverse_square_depth = 3.0 * (far - near) / (far * far * far - near * near * near);
    let window = 4.0 * ASPECT;
    (window * LN_2 / (count as f64 * PI * mean_square_factor * mean_inverse_square_depth)).sqrt()
}

/// Uniform in the frustum: of uniform depths as many are kept as the frustum is wide there.
fn in_frustum(random: &mut Random) -> DVec3 {
    let [near, far] = DEPTHS;
    let depth = loop {
        let depth = random.within(near, far);
        let width = depth / far;
        if random.within(0.0, 1.0) < width * width {
            break depth;
        }
    };
    DVec3::new(random.within(-ASPECT, ASPECT) * depth, random.within(-1.0, 1.0) * depth, -depth)
}

fn varied(random: &mut Random) -> f64 {
    random.within(1.0 - VARIATION, 1.0 + VARIATION)
}

/// A sphere around `center` of about this radius, kept well beyond the image plane.
fn sphere(random: &mut Random, index: usize, center: DVec3, mean_radius: f64, look: &Look) -> Sphere {
    let mut radius = mean_radius * varied(random);
    let depth = -center.z;
    if depth - radius * (1.0 + VARIATION) < 2.0 {
        radius = (depth - 2.0) / (1.05 + VARIATION);
    }
    let factors = DVec3::new(varied(random), varied(random), varied(random));
    let color = DVec3::new(random.within(0.15, 1.0), random.within(0.15, 1.0), random.within(0.15, 1.0));
    Sphere {
        center: rounded_vector(center, 1e5),
        scale: rounded_vector(if look.ellipsoids { factors * radius } else { DVec3::splat(radius) }, 1e6),
        color: rounded_vector(color, 1e3),
        ka: 0.4,
        kd: 0.6,
        ks: 0.4,
        kr: look.mirrors[index % 2],
        n: 40.0,
        kt: 0.0,
        eta: 1.0,
    }
}

fn names(letter: char, count: usize) -> Names {
    let (mut names, mut name) = (Names::default(), String::new());
    for index in 0..count {
        name.clear();
        let _ = write!(name, "{letter}{index}");
        names.push(&name);
    }
    names
}

/// Before a 16:9 window in the resolution of a video, lit by three lights.
fn framed(spheres: Vec<Sphere>) -> Scene {
    let light =
        |position: [f64; 3], intensity: [f64; 3]| Light { position: position.into(), intensity: intensity.into() };
    let lights = vec![
        light([-30.0, 30.0, 10.0], [0.7, 0.6, 0.6]),
        light([30.0, 20.0, 5.0], [0.5, 0.6, 0.5]),
        light([0.0, -25.0, 15.0], [0.3, 0.3, 0.5]),
    ];
    let half_width = rounded(ASPECT, 1e7);
    Scene {
        window: Window { near: 1.0, left: -half_width, right: half_width, bottom: -1.0, top: 1.0 },
        width: 1920,
        height: 1080,
        sphere_names: names('s', spheres.len()),
        light_names: names('l', lights.len()),
        spheres,
        lights,
        background: DVec3::ZERO,
        ambient: DVec3::splat(0.3),
        output: None,
    }
}

/// Spheres at random: for one count always the same ones, whatever they look like.
fn scene(count: usize, look: &Look) -> Scene {
    let random = &mut Random::new(SEED, count as u64);
    let radius = mean_radius(count);
    let one = |index| {
        let center = in_frustum(random);
        sphere(random, index, center, radius, look)
    };
    framed((0..count).map(one).collect())
}

/// Spheres at random in these lights.
fn lit(spheres: usize, lights: (Vec<Light>, Names)) -> Scene {
    let mut scene = scene(spheres, &Look::PLAIN);
    (scene.lights, scene.light_names) = lights;
    scene
}

fn glass(count: usize) -> Scene {
    let mut scene = scene(count, &Look::PLAIN);
    for sphere in scene.spheres.iter_mut().skip(1).step_by(2) {
        (sphere.kt, sphere.eta) = (0.8, 1.5);
    }
    scene
}

/// The same room, lights and look with every sphere near one of a few centres, uniform in the distance from it.
fn clustered(count: usize) -> Scene {
    let random = &mut Random::new(SEED, count as u64);
    let centers: Vec<_> = (0..CLUSTERS).map(|_| in_frustum(random)).collect();
    let (reach, radius) = (SHRINK * mean_radius(CLUSTERS), SHRINK * mean_radius(count));
    let one = |index: usize| {
        let center = centers[index % CLUSTERS] + random.unit() * random.within(0.0, reach);
        sphere(random, index, center, radius, &Look::PLAIN)
    };
    framed((0..count).map(one).collect())
}

/// Lights on the side of the eye that together are as bright as the three.
fn many_lights(count: usize) -> (Vec<Light>, Names) {
    let random = &mut Random::new(SEED, count as u64);
    let one = |_| {
        let position = DVec3::new(random.within(-40.0, 40.0), random.within(-40.0, 40.0), random.within(0.0, 20.0));
        let color = DVec3::new(random.within(0.5, 1.0), random.within(0.5, 1.0), random.within(0.5, 1.0));
        Light { position: rounded_vector(position, 1e5), intensity: rounded_vector(color * 2.0 / count as f64, 1e5) }
    };
    ((0..count).map(one).collect(), names('l', count))
}

/// White lights at random on the half of a sphere around the room that the eye is in; together as bright as the three.
fn dome(count: usize) -> (Vec<Light>, Names) {
    let random = &mut Random::new(SEED, count as u64);
    let middle = DVec3::new(0.0, 0.0, -f64::midpoint(DEPTHS[0], DEPTHS[1]));
    let one = |_| {
        let aside = random.unit() * DOME_RADIUS;
        let position = middle + DVec3::new(aside.x, aside.y, aside.z.abs());
        let intensity = DVec3::splat(rounded(2.0 / count as f64, 1e5));
        Light { position: rounded_vector(position, 1e5), intensity }
    };
    ((0..count).map(one).collect(), names('l', count))
}

fn classic() -> Scene {
    let body = |center: [f64; 3], scale: [f64; 3], color: [f64; 3], kr, n| Sphere {
        center: center.into(),
        scale: scale.into(),
        color: color.into(),
        ka: 0.8,
        kd: 0.8,
        ks: 0.7,
        kr,
        n,
        kt: 0.0,
        eta: 1.0,
    };
    let spheres = vec![
        body([0.0, -0.5, -10.0], [2.2, 3.6, 2.2], [0.7, 0.1, 0.1], 0.0, 50.0),
        body([4.2, 3.4, -11.0], [1.2, 2.0, 1.0], [0.1, 0.6, 0.2], 0.0, 30.0),
        body([-4.4, 2.2, -10.5], [1.4, 1.4, 1.4], [0.1, 0.2, 0.7], 0.3, 80.0),
        body([4.0, -4.0, -12.0], [2.0, 1.4, 2.0], [0.6, 0.5, 0.1], 0.2, 20.0),
        body([-3.2, -3.6, -8.5], [1.0, 1.0, 1.6], [0.5, 0.2, 0.6], 0.0, 100.0),
    ];
    let mut scene = framed(spheres);
    scene.window = Window { near: 1.0, left: -1.0, right: 1.0, bottom: -1.0, top: 1.0 };
    (scene.width, scene.height) = (600, 600);
    scene.background = DVec3::ONE;
    scene.lights[0].position = DVec3::ZERO;
    scene
}
