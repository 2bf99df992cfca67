//! Kinds of scenes, ordinary and hard, on which promises are tested by whole pictures.

use crate::bench::FAMILIES;
use crate::random::Random;
use crate::scene::{Light, Names, Scene, Sphere, Window};
use glam::DVec3;

/// Scenes of one kind: each seed gives another.
pub struct SceneKind {
    /// What is in them, in words.
    pub name: String,
    build: Box<dyn Fn(&mut Random) -> Scene>,
}

impl SceneKind {
    /// The scene of this seed.
    pub fn scene(&self, seed: u64) -> Scene {
        let stream = self.name.bytes().fold(0, |hash: u64, byte| hash.wrapping_mul(31).wrapping_add(u64::from(byte)));
        let mut scene = (self.build)(&mut Random::new(seed, stream));
        (scene.sphere_names, scene.light_names) = (names('s', scene.spheres.len()), names('l', scene.lights.len()));
        scene
    }
}

/// All kinds, more than a hundred.
pub fn scene_kinds() -> Vec<SceneKind> {
    let mut kinds = Kinds(Vec::new());
    kinds.plain();
    kinds.floors();
    kinds.lights();
    kinds.glass();
    kinds.crowds();
    kinds.shells();
    kinds.flat_and_thin();
    kinds.large();
    kinds.close();
    kinds.far();
    kinds.mirrors();
    kinds.0
}

struct Kinds(Vec<SceneKind>);

impl Kinds {
    fn add(&mut self, name: impl Into<String>, build: impl Fn(&mut Random) -> Scene + 'static) {
        self.0.push(SceneKind { name: name.into(), build: Box::new(build) });
    }

    /// A few bodies of one material.
    fn plain(&mut self) {
        self.add("matte spheres", |r| room(bodies(r, 6, 1.0, MATTE), two_lights()));
        for n in [1.0, 10.0, 100.0, 1e3, 1e4, 1e5] {
            self.add(format!("exponent {n}"), move |r| {
                room(bodies(r, 6, 1.0, Look { ks: 0.6, n, ..MATTE }), two_lights())
            });
        }
        for kr in [0.2, 0.5, 0.9] {
            let look = Look { kr, ..SHINY };
            self.add(format!("six mirrors of {kr}"), move |r| room(bodies(r, 6, 1.0, look), two_lights()));
            self.add(format!("forty mirrors of {kr}"), move |r| room(bodies(r, 40, 1.0, look), two_lights()));
        }
        for ratio in [1.5, 3.0, 10.0] {
            self.add(format!("ellipsoids up to 1:{ratio}"), move |r| {
                let look = Look { kr: 0.3, ..SHINY };
                room(bodies(r, 12, ratio, look), two_lights())
            });
        }
        self.add("ambient alone", |r| {
            room(bodies(r, 12, 1.0, Look { ka: 0.5, kd: 0.0, ks: 0.0, ..MATTE }), two_lights())
        });
        self.add("many lights", |r| {
            let lights = (0..16).map(|_| light(r.unit() * 20.0 + DVec3::new(0.0, 5.0, 0.0), 0.12)).collect();
            room(bodies(r, 20, 1.0, SHINY), lights)
        });
        self.add("tele lens", |r| {
            let mut scene = room(bodies(r, 12, 1.0, Look { kr: 0.3, ..SHINY }), two_lights());
            scene.window = window(0.05);
            scene
        });
        self.add("wide lens", |r| {
            let mut scene = room(bodies(r, 12, 1.0, Look { kr: 0.3, ..SHINY }), two_lights());
            scene.window = window(4.0);
            scene
        });
    }

    /// Balls on a floor that is a large sphere.
    fn floors(&mut self) {
        for radius in [5.0, 20.0, 100.0, 500.0, 1e3, 5e3, 15e3, 1e5] {
            self.add(format!("matte floor of radius {radius}"), move |r| {
                room(on_floor(r, radius, SHINY, MATTE), two_lights())
            });
            self.add(format!("mirror floor of radius {radius}"), move |r| {
                room(on_floor(r, radius, Look { kr: 0.4, ..SHINY }, Look { kr: 0.3, ..MATTE }), two_lights())
            });
        }
        self.add("pebbles on a floor", |r| {
            let mut spheres = on_floor(r, 1e3, SHINY, MATTE);
            for _ in 0..200 {
                let at = DVec3::new(r.within(-6.0, 6.0), -1.45, -r.within(4.0, 14.0));
                spheres.push(body(r, at, DVec3::splat(0.05), MATTE));
            }
            room(spheres, two_lights())
        });
        self.add("walls of a box", |r| {
            let mut spheres = bodies(r, 6, 1.0, Look { kr: 0.3, ..SHINY });
            // None as far away as another: where walls meet before a symmetrical picture, whole rows of pixels are exact ties.
            let walls =
                [(DVec3::X, 7.9), (DVec3::NEG_X, 8.2), (DVec3::Y, 6.1), (DVec3::NEG_Y, 5.7), (DVec3::NEG_Z, 8.0)];
            for (axis, distance) in walls {
                let at = DVec3::new(0.0, 0.0, -6.0) + axis * (1000.0 + distance);
                spheres.push(body(r, at, DVec3::splat(1e3), MATTE));
            }
            room(spheres, vec![light(DVec3::new(0.0, 3.0, -4.0), 0.9)])
        });
    }

    fn lights(&mut self) {
        for distance in [0.3, 0.03, 1e-3, 1e-5] {
            self.add(format!("light {distance} from a surface"), move |r| {
                let spheres = bodies(r, 6, 1.0, SHINY);
                let s = &spheres[0];
                let toward = (-s.center).normalize();
                let at = s.center + toward * (s.scale.x + distance);
                room(spheres, vec![light(at, 0.8), light(DVec3::new(8.0, 8.0, 5.0), 0.3)])
            });
        }
        for power in [2, 4, 6, 8, 10, 11, 12, 13, 14] {
            self.add(format!("sun 1e{power} away"), move |r| {
                let mut spheres = bodies(r, 12, 1.0, Look { kr: 0.2, ..SHINY });
                spheres.push(body(r, DVec3::new(0.0, -22.0, -9.0), DVec3::splat(20.0), MATTE));
                room(spheres, vec![light(r.unit().abs() * 10_f64.powi(power), 0.9)])
            });
        }
        self.add("light within a shell", |r| {
            let mut spheres = bodies(r, 6, 1.0, SHINY);
            let at = spheres[0].center;
            spheres.truncate(6);
            room(spheres, vec![light(at, 0.9), light(DVec3::new(8.0, 8.0, 5.0), 0.5)])
        });
    }

    fn glass(&mut self) {
        for eta in [1.0, 1.01, 1.5, 2.4] {
            let look = Look { kt: 0.8, eta, kr: 0.1, kd: 0.1, ..SHINY };
            self.add(format!("glass of {eta}"), move |r| {
                let mut spheres = on_floor(r, 100.0, SHINY, MATTE);
                spheres[1] = Sphere { kt: look.kt, eta, kr: 0.1, kd: 0.1, ..spheres[1] };
                spheres[2] = Sphere { kt: look.kt, eta, kr: 0.1, kd: 0.1, ..spheres[2] };
                room(spheres, two_lights())
            });
        }
        self.add("many glass balls", |r| {
            room(bodies(r, 40, 1.0, Look { kt: 0.7, eta: 1.5, kr: 0.2, ..SHINY }), two_lights())
        });
        self.add("glass ellipsoids", |r| {
            room(bodies(r, 12, 3.0, Look { kt: 0.7, eta: 1.3, kr: 0.2, ..SHINY }), two_lights())
        });
        self.add("glass in glass", |r| {
            let mut spheres = bodies(r, 6, 1.0, SHINY);
            for scale in [1.6, 1.2, 0.6] {
                spheres.push(body(
                    r,
                    DVec3::new(0.0, 0.0, -4.0),
                    DVec3::splat(scale),
                    Look { kt: 0.8, eta: 1.2, ..SHINY },
                ));
            }
            room(spheres, two_lights())
        });
    }

    /// The scenes of the benchmark.
    fn crowds(&mut self) {
        for (name, sizes) in [
            ("classic", &[5][..]),
            ("spheres", &[10, 100, 300, 1_000, 3_000]),
            ("ellipsoids", &[10, 100, 1_000]),
            ("mirrors", &[10, 100, 1_000]),
            ("lights", &[16]),
            ("clustered", &[100, 1_000]),
            ("huge", &[10, 100, 1_000]),
        ] {
            for (family, &size) in FAMILIES
                .iter()
                .filter(|family| family.name == name)
                .flat_map(|it| sizes.iter().map(move |size| (it, size)))
            {
                self.add(format!("bench {name} {size}"), move |_| Scene { output: None, ..family.scene(size) });
            }
        }
    }

    fn shells(&mut self) {
        self.add("shells cut by the image plane", |r| {
            let mut spheres = bodies(r, 6, 1.0, SHINY);
            for x in [-1.2, 0.0, 1.2] {
                spheres.push(body(r, DVec3::new(x, -0.6, -1.2), DVec3::splat(0.55), SHINY));
            }
            room(spheres, two_lights())
        });
        self.add("eye within a shell", |r| {
            let mut spheres = bodies(r, 12, 1.0, Look { kr: 0.3, ..SHINY });
            spheres.push(body(r, DVec3::new(0.0, 0.0, -6.0), DVec3::splat(20.0), Look { kr: 0.2, ..SHINY }));
            room(spheres, two_lights())
        });
        for power in 1..=7 {
            let gap = 0.1_f64.powi(power);
            self.add(format!("nested shells, gap 1e-{power}"), move |r| {
                let mut spheres = bodies(r, 6, 1.0, SHINY);
                for k in 0..3 {
                    let s = spheres[k];
                    spheres.push(body(r, s.center, s.scale * (1.0 - gap), SHINY));
                    spheres.push(body(r, s.center, s.scale * (1.0 - 2.0 * gap), SHINY));
                }
                room(spheres, two_lights())
            });
        }
        self.add("tiny nested shells", |r| {
            let mut spheres = bodies(r, 6, 1.0, SHINY);
            for scale in [1e-3, 0.999_999e-3] {
                spheres.push(body(r, DVec3::new(0.3, 0.2, -4.0), DVec3::splat(scale), SHINY));
            }
            room(spheres, two_lights())
        });
        self.add("equal spheres", |r| {
            let mut spheres = bodies(r, 6, 1.0, Look { kr: 0.3, ..SHINY });
            spheres.extend_from_within(..);
            room(spheres, two_lights())
        });
    }

    fn flat_and_thin(&mut self) {
        for power in [1, 2, 3, 4, 5] {
            let thin = 0.1_f64.powi(power);
            self.add(format!("discs 1:1e-{power}"), move |r| room(flat(r, DVec3::new(1.0, 1.0, thin)), two_lights()));
            self.add(format!("lying discs 1:1e-{power}"), move |r| {
                room(flat(r, DVec3::new(1.5, thin * 1.5, 1.5)), two_lights())
            });
        }
        for power in [1, 2, 3, 4] {
            let thin = 0.1_f64.powi(power);
            self.add(format!("needles 1:1e-{power}"), move |r| {
                room(flat(r, DVec3::new(thin, 1.5, thin)), two_lights())
            });
        }
        self.add("a thin pane as a mirror", |r| {
            let mut spheres = bodies(r, 6, 1.0, SHINY);
            spheres.push(body(r, DVec3::new(0.0, -1.5, -7.0), DVec3::new(6.0, 0.01, 6.0), Look { kr: 0.5, ..MATTE }));
            room(spheres, two_lights())
        });
    }

    fn large(&mut self) {
        for height in [1.7, 1e2, 1e4] {
            self.add(format!("earth from {height} m"), move |r| {
                let mut spheres = vec![body(r, DVec3::new(0.0, -6.4e6 - height, 0.0), DVec3::splat(6.4e6), MATTE)];
                for _ in 0..6 {
                    let z = -height * r.within(4.0, 20.0);
                    let at = DVec3::new(r.within(-0.8, 0.8) * z, r.within(-0.4, 0.4) * z, z);
                    let size = height * r.within(0.5, 1.5);
                    spheres.push(body(r, at, DVec3::splat(size), SHINY));
                }
                room(spheres, vec![light(DVec3::new(-3e8, 5e8, 2e8), 0.9)])
            });
        }
        for scale in [100.0, 300.0, 1e3, 3e3] {
            self.add(format!("balls of some {scale} units"), move |r| {
                scaled(room(bodies(r, 6, 1.0, Look { kr: 0.4, ..SHINY }), two_lights()), scale)
            });
        }
        for scale in [1e-20, 1e-3, 1e20] {
            self.add(format!("a world of {scale:e}"), move |r| {
                scaled(room(bodies(r, 12, 1.0, Look { kr: 0.4, ..SHINY }), two_lights()), scale)
            });
        }
    }

    /// What lies closer together than its size.
    fn close(&mut self) {
        for gap in [0.0, 1e-3, 1e-5, 1e-7] {
            self.add(format!("contacts, gap {gap:e}"), move |r| {
                let mut spheres = on_floor(r, 50.0, SHINY, MATTE);
                let s = spheres[1];
                for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
                    let at = s.center + axis * (s.scale.x + 0.3 + gap);
                    spheres.push(body(r, at, DVec3::splat(0.3), SHINY));
                }
                room(spheres, two_lights())
            });
        }
        for power in 1..=7 {
            let height = 0.1_f64.powi(power);
            for near_light in [false, true] {
                let name = if near_light { "eye and light" } else { "eye" };
                self.add(format!("{name} 1e-{power} before a sphere"), move |r| {
                    let mut spheres = bodies(r, 6, 1.0, SHINY);
                    spheres.push(body(r, DVec3::new(0.0, 0.0, -1.0 - height), DVec3::ONE, SHINY));
                    let mut lights = two_lights();
                    if near_light {
                        lights[0].position = DVec3::new(0.7, 0.4, 0.3) * height;
                    }
                    let mut scene = room(spheres, lights);
                    scale_window(&mut scene, height * 0.1);
                    scene
                });
            }
        }
        for power in [1, 3, 5] {
            let height = 0.1_f64.powi(power);
            self.add(format!("eye 1e-{power} above a mirror"), move |r| {
                let mut spheres = bodies(r, 6, 1.0, SHINY);
                let mirror = Look { kr: 0.5, ..SHINY };
                spheres.push(body(r, DVec3::new(0.0, -2.0 - height, 0.0), DVec3::splat(2.0), mirror));
                let mut scene = room(spheres, two_lights());
                scale_window(&mut scene, height * 0.1);
                scene
            });
        }
    }

    fn far(&mut self) {
        for power in [1, 2, 3, 4, 5] {
            let size = 0.1_f64.powi(power);
            self.add(format!("tiny spheres of 1e-{power}"), move |r| {
                let mut spheres = on_floor(r, 30.0, SHINY, MATTE);
                for _ in 0..12 {
                    let at = DVec3::new(r.within(-2.0, 2.0), r.within(-1.0, 1.5), -r.within(3.0, 8.0));
                    spheres.push(body(r, at, DVec3::splat(size), SHINY));
                }
                room(spheres, two_lights())
            });
        }
        for power in 1..=6 {
            self.add(format!("a group 1e{power} away"), move |r| {
                let away = DVec3::new(0.3, 0.2, -1.0) * 10_f64.powi(power);
                let mut spheres = bodies(r, 12, 1.0, Look { kr: 0.3, ..SHINY });
                for s in &mut *spheres {
                    s.center += away;
                }
                let lights = two_lights().into_iter().map(|l| Light { position: l.position + away, ..l }).collect();
                let mut scene = room(spheres, lights);
                // The same part of the world as from nearby.
                let depth = 8.0 - away.z;
                let middle = away / depth;
                let half = 5.0 / depth;
                scene.window = Window {
                    near: 1.0,
                    left: middle.x - half,
                    right: middle.x + half,
                    bottom: middle.y - 0.75 * half,
                    top: middle.y + 0.75 * half,
                };
                scene
            });
        }
        self.add("from near to the horizon", |r| {
            let spheres = (0..60)
                .map(|_| {
                    let z = -r.magnitude(0.7, 5.0);
                    let at = DVec3::new(r.within(-1.0, 1.0) * z, r.within(-0.75, 0.75) * z, z);
                    body(r, at, DVec3::splat(1.0), SHINY)
                })
                .collect();
            room(spheres, two_lights())
        });
    }

    fn mirrors(&mut self) {
        for width in [3.0, 30.0] {
            self.add(format!("corridor of mirrors, {width} wide"), move |r| {
                let mut spheres = bodies(r, 6, 1.0, SHINY);
                for side in [-1.0, 1.0] {
                    let at = DVec3::new(side * (1e3 + width), 0.0, -8.0);
                    spheres.push(body(r, at, DVec3::splat(1e3), Look { kr: 0.8, ..MATTE }));
                }
                room(spheres, two_lights())
            });
        }
        self.add("within a ball of mirror", |r| {
            let mut spheres = bodies(r, 12, 1.0, Look { kr: 0.5, ..SHINY });
            spheres.push(body(r, DVec3::new(0.0, 0.0, -6.0), DVec3::splat(16.0), Look { kr: 0.7, ..SHINY }));
            room(spheres, vec![light(DVec3::new(0.0, 6.0, -3.0), 0.8)])
        });
        self.add("small mirrors far apart", |r| {
            let mut spheres = Vec::new();
            for _ in 0..30 {
                let z = -r.within(20.0, 60.0);
                let at = DVec3::new(r.within(-0.9, 0.9) * z, r.within(-0.7, 0.7) * z, z);
                spheres.push(body(r, at, DVec3::splat(0.5), Look { kr: 0.8, ..SHINY }));
            }
            room(spheres, two_lights())
        });
        self.add("cluster of mirrors that touch", |r| {
            let mut spheres = Vec::new();
            for x in -1..=1 {
                for y in -1..=1 {
                    for z in -1..=1 {
                        let at =
                            DVec3::new(f64::from(x) * 2.0 + 0.1, f64::from(y) * 2.0 + 0.1, f64::from(z) * 2.0 - 8.0);
                        spheres.push(body(r, at, DVec3::ONE, Look { kr: 0.7, ..SHINY }));
                    }
                }
            }
            room(spheres, two_lights())
        });
        self.add("mirror behind the eye", |r| {
            let mut spheres = bodies(r, 12, 1.0, Look { kr: 0.6, ..SHINY });
            spheres.push(body(r, DVec3::new(0.0, 0.0, 203.0), DVec3::splat(200.0), Look { kr: 0.6, ..SHINY }));
            room(spheres, two_lights())
        });
    }
}

/// What a material shares with others of its kind.
#[derive(Clone, Copy)]
struct Look {
    ka: f64,
    kd: f64,
    ks: f64,
    kr: f64,
    n: f64,
    kt: f64,
    eta: f64,
}

const MATTE: Look = Look { ka: 0.3, kd: 0.7, ks: 0.0, kr: 0.0, n: 1.0, kt: 0.0, eta: 1.0 };
const SHINY: Look = Look { ks: 0.4, n: 30.0, ..MATTE };

fn body(r: &mut Random, center: DVec3, scale: DVec3, look: Look) -> Sphere {
    let Look { ka, kd, ks, kr, n, kt, eta } = look;
    let color = DVec3::new(r.within(0.1, 1.0), r.within(0.1, 1.0), r.within(0.1, 1.0));
    Sphere { center, scale, color, ka, kd, ks, kr, n, kt, eta }
}

/// Bodies at random ahead of the eye that cover a part of the picture, with semi-axes that differ by up to `ratio`.
fn bodies(r: &mut Random, count: usize, ratio: f64, look: Look) -> Vec<Sphere> {
    let radius = 2.2 / (count as f64).sqrt();
    (0..count)
        .map(|_| {
            let z = -r.within(4.0, 12.0);
            let at = DVec3::new(r.within(-0.7, 0.7) * z, r.within(-0.5, 0.5) * z, z);
            let mut axis = || radius * r.within(0.7, 1.3) * ratio.powf(-r.within(0.0, 1.0));
            let scale = if ratio == 1.0 { DVec3::splat(axis()) } else { DVec3::new(axis(), axis(), axis()) };
            body(r, at, scale, look)
        })
        .collect()
}

/// Balls that lie on a floor, which is the first sphere, at y = −1.5.
fn on_floor(r: &mut Random, radius: f64, balls: Look, floor: Look) -> Vec<Sphere> {
    let mut spheres = vec![body(r, DVec3::new(0.0, -1.5 - radius, -6.0), DVec3::splat(radius), floor)];
    for index in 0..5 {
        let size = r.within(0.4, 0.9);
        let at = DVec3::new(-3.0 + 1.5 * f64::from(index), size - 1.5, -r.within(4.0, 9.0));
        spheres.push(body(r, at, DVec3::splat(size), balls));
    }
    spheres
}

/// Ellipsoids of one shape, in three sizes.
fn flat(r: &mut Random, scale: DVec3) -> Vec<Sphere> {
    (0..12)
        .map(|index| {
            let z = -r.within(4.0, 10.0);
            let at = DVec3::new(r.within(-0.7, 0.7) * z, r.within(-0.5, 0.5) * z, z);
            body(r, at, scale * [0.5, 0.8, 1.1][index % 3], Look { kr: [0.0, 0.3][index % 2], ..SHINY })
        })
        .collect()
}

fn light(position: DVec3, intensity: f64) -> Light {
    Light { position, intensity: DVec3::new(1.0, 0.95, 0.9) * intensity }
}

fn two_lights() -> Vec<Light> {
    vec![light(DVec3::new(-6.0, 8.0, 3.0), 0.6), light(DVec3::new(7.0, 4.0, 1.0), 0.4)]
}

/// Half the width; a picture of 4:3.
fn window(half: f64) -> Window {
    Window { near: 1.0, left: -half, right: half, bottom: -0.75 * half, top: 0.75 * half }
}

fn room(spheres: Vec<Sphere>, lights: Vec<Light>) -> Scene {
    Scene {
        window: window(1.0),
        width: 640,
        height: 480,
        spheres,
        sphere_names: Names::default(),
        lights,
        light_names: Names::default(),
        background: DVec3::new(0.1, 0.2, 0.35),
        ambient: DVec3::splat(0.5),
        output: None,
    }
}

fn scale_window(scene: &mut Scene, factor: f64) {
    let Window { near, left, right, bottom, top } = scene.window;
    let [near, left, right, bottom, top] = [near, left, right, bottom, top].map(|x| x * factor);
    scene.window = Window { near, left, right, bottom, top };
}

/// `scene` in other units.
fn scaled(mut scene: Scene, factor: f64) -> Scene {
    scale_window(&mut scene, factor);
    for sphere in &mut scene.spheres {
        sphere.center *= factor;
        sphere.scale *= factor;
    }
    scene.lights.iter_mut().for_each(|light| light.position *= factor);
    scene
}

fn names(letter: char, count: usize) -> Names {
    let mut names = Names::default();
    (0..count).for_each(|index| names.push(&format!("{letter}{index}")));
    names
}
