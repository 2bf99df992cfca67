//! The reference's proof of its own decisions: it carries a bound of its errors along, and where that leaves a decision open the
//! sample is traced in double-double, where that does too with 237 bits, and then once more with the decisions of these.

use std::sync::{Arc, OnceLock};

use super::bound::Bound;
use super::dd::Dd;
use super::intersect::{Primary, Range};
use super::octuple::Octuple;
use super::oracle::quotient;
use super::per_sphere::PerSphere;
use super::real::{Real, Wide};
use super::render::{Reference, Tally, resolve};
use super::replay::{Notes, Replay};
use super::scene::{Glass, Material, PointLight, Shape, World};
use super::ties::Ties;
use super::trace::trace;
use super::vec3::{Vec3, largest};
use crate::camera::NEAR_T_MIN;
use crate::decimal::Decimal;
use crate::geometry::reciprocal_power_of_two;

impl<T: Real> Reference<T> {
    /// What proves the decisions of a pixel, one after the other.
    pub(super) fn bound(&self) -> Bound<T, true> {
        Bound::new(&self.world)
    }

    /// The unclamped colour of a pixel, with each decision proven where `T` does so.
    pub(super) fn proven_color(&self, i: u32, j: u32, bound: &mut Bound<T, true>, tally: &mut Tally) -> Vec3<T> {
        let count = self.camera.pattern().count();
        if !T::PROVES {
            return resolve(self.primaries(i, j).map(|primary| trace(&self.world, &primary, tally)), count);
        }
        let mut effort = None;
        let samples = self.primaries(i, j).map(|primary| {
            if primary.seen.is_empty() {
                // No ray of the tile meets a sphere.
                return self.world.background;
            }
            let hits = tally.hits;
            let color = self.bounded_color(&primary, bound, tally);
            if bound.unsure.is_none() {
                return color;
            }
            let (mut decisions, took) = self.decide(&primary);
            effort = effort.max(Some(took));
            let mut decided = Tally::default();
            let color = trace(&self.world, &primary, &mut (&mut decisions, &mut decided));
            tally.hits = hits + decided.hits;
            color
        });
        let color = resolve(samples, count);
        tally.more_bits += u64::from(effort.is_some());
        tally.most_bits += u64::from(effort > Some(Effort::DoubleDouble));
        tally.undecided += u64::from(effort == Some(Effort::Rule));
        color
    }

    /// The decisions of a sample where `T` leaves one open, and what they took.
    pub(super) fn open_decisions(&self, primary: &Primary<T>) -> Option<(Replay, Effort)> {
        let mut bound = self.bound();
        self.bounded_color(primary, &mut bound, &mut Tally::default());
        bound.unsure.map(|_| self.decide(primary))
    }

    /// The colour of a sample, and in `bound` whether its decisions are sure.
    #[inline]
    fn bounded_color(&self, primary: &Primary<T>, bound: &mut Bound<T, true>, tally: &mut Tally) -> Vec3<T> {
        bound.begin(self.errors());
        trace(&self.world, primary, &mut (bound, tally))
    }

    /// The decisions of a sample that `T` leaves open.
    #[cold]
    fn decide(&self, primary: &Primary<T>) -> (Replay, Effort) {
        let (double_double, octuple) = &self.wide_worlds;
        let (decisions, are_sure) = self.decide_in(double_double, primary);
        if are_sure {
            return (decisions, Effort::DoubleDouble);
        }
        let (decisions, are_sure) = self.decide_in(octuple, primary);
        (decisions, if are_sure { Effort::Octuple } else { Effort::Rule })
    }

    /// The decisions of a sample in a `W`, and whether that leaves none open.
    fn decide_in<W: Wide>(&self, world: &OnceLock<World<W>>, primary: &Primary<T>) -> (Replay, bool) {
        let world = world.get_or_init(|| widened(&self.world));
        let primary = Primary { ray: world.exact.ray(primary.sample), sample: primary.sample, seen: primary.seen };
        let (mut ties, mut notes) = (Ties::new(world, &primary.ray), Notes::default());
        trace(world, &primary, &mut (&mut ties, &mut notes));
        (notes.replay(), ties.bound.unsure.is_none())
    }
}

/// What the decisions of a sample take that `f64` leaves open.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Effort {
    /// Double-double.
    DoubleDouble,
    /// 237 bits.
    Octuple,
    /// What 237 bits leave open, too, was taken for a tie where it lies all but on one; beyond, what they say stands.
    Rule,
}

/// The scene with the places of its file, in the types that decide, once one has to.
pub(super) type WideWorlds = (OnceLock<World<Dd>>, OnceLock<World<Octuple>>);

/// `world` with its places as the decimals of the file say. Of many spheres few are asked for.
fn widened<T: Real, W: Wide>(world: &Arc<World<T>>) -> World<W> {
    let exact = &world.exact;
    let light = |(index, light): (usize, &PointLight<T>)| {
        let (position, kernels) = (exact.light(index), light.position.to_f64());
        // Lights out of reach have come nearer.
        let has_moved = (position.to_f64() - kernels).length() > 1e-6 * kernels.length();
        let position = if has_moved { Vec3::from_f64(kernels) } else { position };
        PointLight { position, intensity: Vec3::from_f64(light.intensity.to_f64()) }
    };
    let range = |t_min, greater| Range { t_min, t_max: W::FAR, greater };
    let primary = if world.primary.t_min > T::ZERO { exact.part(NEAR_T_MIN) } else { W::ZERO };
    // The lists are of what `f64` has made of the file.
    let allowance = |of: T| W::from_f64(of.to_f64() - world.moved);
    World {
        shapes: each(world, world.shapes.all().len(), shape),
        materials: each(world, world.materials.all().len(), material),
        glasses: each(world, world.glasses.all().len(), glass),
        lights: world.lights.iter().enumerate().map(light).collect(),
        ambient: Vec3::from_f64(world.ambient.to_f64()),
        background: Vec3::from_f64(world.background.to_f64()),
        primary: range(primary, world.primary.greater),
        shadow_t_min: decimal(world.shadow_t_min),
        reflection: range(exact.length(world.reflection.t_min.to_f64()), world.reflection.greater),
        refraction: range(decimal(world.refraction.t_min), world.refraction.greater),
        shadows: world.shadows,
        refracts: world.refracts,
        specular: world.specular,
        max_depth: world.max_depth,
        allowance: allowance(world.allowance),
        light_allowance: allowance(world.light_allowance),
        ellipsoids: world.ellipsoids,
        moved: world.moved,
        middle: Vec3::from_f64(world.middle.to_f64()),
        extent: as_it_is(world.extent),
        accel: world.accel.clone(),
        tangents: world.tangents,
        exact: exact.clone(),
    }
}

/// What `make` makes of `world` for each of so many spheres.
fn each<T: Real, S>(
    world: &Arc<World<T>>,
    count: usize,
    make: impl Fn(&World<T>, usize) -> S + Send + Sync + 'static,
) -> PerSphere<S> {
    let world = Arc::clone(world);
    PerSphere::lazy(count, move |sphere| make(&world, sphere))
}

fn shape<T: Real, W: Wide>(world: &World<T>, sphere: usize) -> Shape<W> {
    let Axes { center, semi_axes, largest, k } = Axes::of(world, sphere);
    let ratios = quotient(Vec3::new(largest, largest, largest), semi_axes);
    Shape { center, inv_scale: ratios * k, radius: largest * k, index: world.shapes[sphere].index }
}

fn material<T: Real, W: Wide>(world: &World<T>, sphere: usize) -> Material<W> {
    let (material, Axes { semi_axes, largest, k, .. }) = (&world.materials[sphere], Axes::of(world, sphere));
    let scale = quotient(semi_axes, Vec3::new(largest * k, largest * k, largest * k));
    let [ka, kd, ks, kr, n] = [material.ka, material.kd, material.ks, material.kr, material.n].map(as_it_is);
    Material { scale, color: Vec3::from_f64(material.color.to_f64()), ka, kd, ks, kr, n }
}

fn glass<T: Real, W: Wide>(world: &World<T>, sphere: usize) -> Glass<W> {
    let glass = &world.glasses[sphere];
    let eta = decimal(glass.eta);
    Glass { kt: as_it_is(glass.kt), eta, inv_eta: W::ONE / eta }
}

/// A sphere as the file has it, in the units of kernels.
struct Axes<W> {
    center: Vec3<W>,
    semi_axes: Vec3<W>,
    largest: W,
    /// The power of two that brings it between 1 and 2.
    k: W,
}

impl<W: Wide> Axes<W> {
    fn of<T: Real>(world: &World<T>, sphere: usize) -> Self {
        let [center, semi_axes] = world.exact.sphere::<W>(sphere);
        let largest = largest(semi_axes);
        Self { center, semi_axes, largest, k: W::from_f64(reciprocal_power_of_two(largest.to_f64())) }
    }
}

/// The decimal that a number of the file stands for.
fn decimal<T: Real, W: Wide>(x: T) -> W {
    Decimal::shortest(x.to_f64()).rounded(0)
}

/// A number that decides nothing.
fn as_it_is<T: Real, W: Wide>(x: T) -> W {
    W::from_f64(x.to_f64())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::Effects;
    use crate::scene::parse;
    use crate::settings::Settings;

    /// One tie among many spheres asks for more bits of the few that its ray may meet.
    #[test]
    fn few_spheres_are_widened() {
        let ball = |x: f64, y: f64, r: f64| format!("SPHERE s {x} {y} -5.7 {r} {r} {r} 1 1 1 1 0 0 0 1\n");
        let others: String =
            (0..5000).map(|k| ball(f64::from(k % 100) - 50.0, f64::from(k / 100) + 1.0, 0.1)).collect();
        let text = format!(
            "NEAR 1\nLEFT -1\nRIGHT 1\nBOTTOM -1\nTOP 1\nRES 40 40\nBACK 0 0 0\nAMBIENT 1 1 1\n{}{}{others}",
            ball(-0.3, 0.0, 0.3),
            ball(0.3, 0.0, 0.3)
        );
        let scene = parse("test", text.as_bytes()).scene.expect("it is valid");
        let viewed = scene.viewed(&Settings::classic());
        let reference = Reference::<f64>::new(&viewed, &Effects::of(&viewed));
        let tally = reference.pixels(&[[20, 20]], &mut [[0; 3]]).expect("it is a pixel");
        assert_eq!((tally.most_bits, tally.undecided), (1, 1));
        let (double_double, octuple) = &reference.wide_worlds;
        let made = double_double.get().map_or(0, |world| world.shapes.made());
        assert!((2..100).contains(&made), "{made}");
        assert_eq!(octuple.get().map(|world| world.shapes.made()), Some(made));
    }
}
