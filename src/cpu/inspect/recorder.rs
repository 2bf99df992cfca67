//! Writes down what the tracer does, as its witness: it decides nothing.

use std::cmp::Ordering;

use super::margins::{Distinct, Least, Search, shadow_margin};
use super::record::{
    Blocker, HitRecord, LightRecord, Margin, RayKind, RayRecord, SampleRecord, ShadowRecord, SnellRecord, TestRecord,
    Verdict,
};
use super::units::{RayUnits, Units};
use crate::cpu::Decision;
use crate::cpu::intersect::{Approach, Crossing, Hit, Own, Range, Ray, approach, least_of, roots};
use crate::cpu::refract::Snell;
use crate::cpu::scene::{PointLight, Shape, World};
use crate::cpu::shade::{LightTerms, Surface};
use crate::cpu::vec3::Vec3;
use crate::cpu::witness::Witness;

/// What to write down besides rays, hits and terms.
#[derive(Debug, Clone, Copy)]
pub(super) struct Detail {
    /// Each test, and not only their number.
    pub(super) tests: bool,
    /// Margins, for which every sphere is looked at.
    pub(super) margins: bool,
}

/// A ray whose search has not ended.
#[derive(Debug, Clone, Copy)]
struct Next {
    kind: RayKind,
    parent: Option<usize>,
    bounces: u32,
    weight: f64,
    units: RayUnits,
}

/// The tests of the search in hand.
#[derive(Debug, Clone, Copy)]
enum Tested {
    Other(Shape<f64>, Approach<f64>, Option<Ordering>),
    Own(Shape<f64>, Own<f64>, f64),
    Crossed(Shape<f64>, Approach<f64>, bool),
}

impl Tested {
    fn shape(&self) -> &Shape<f64> {
        match self {
            Self::Other(shape, ..) | Self::Own(shape, ..) | Self::Crossed(shape, ..) => shape,
        }
    }
}

/// The record of one sample, while it is traced.
#[derive(Debug)]
pub(super) struct Recorder<'a> {
    units: Units,
    distinct: &'a Distinct,
    detail: Detail,
    sample: [u32; 2],
    next: Next,
    /// Refraction rays that wait.
    waiting: Vec<Next>,
    rays: Vec<RayRecord>,
    /// The units of the ray in hand.
    ray_units: RayUnits,
    tests: Vec<Tested>,
    test_count: u64,
    /// The colour of the surface in hand so far, as the tracer adds it up.
    color: Vec3<f64>,
    /// Of the ray in hand.
    least: Least,
}

impl<'a> Recorder<'a> {
    pub(super) fn new(units: Units, distinct: &'a Distinct, detail: Detail, sample: [u32; 2]) -> Self {
        let ray_units = units.primary();
        let next = Next { kind: RayKind::Primary, parent: None, bounces: 0, weight: 1.0, units: ray_units };
        Self {
            units,
            distinct,
            detail,
            sample,
            next,
            waiting: Vec::new(),
            rays: Vec::new(),
            ray_units,
            tests: Vec::new(),
            test_count: 0,
            color: Vec3::ZERO,
            least: Least::default(),
        }
    }

    /// The record, with the colour that the tracer has returned.
    pub(super) fn finish(mut self, color: Vec3<f64>) -> SampleRecord {
        self.close_ray();
        SampleRecord { sample: self.sample, rays: self.rays, color: color.to_f64().to_array() }
    }

    /// Nothing more is heard of the ray in hand.
    fn close_ray(&mut self) {
        let decisions = std::mem::take(&mut self.least).sorted();
        let color = std::mem::replace(&mut self.color, Vec3::ZERO);
        if let Some(ray) = self.rays.last_mut() {
            ray.decisions = decisions;
            ray.color = color.to_f64().to_array();
            ray.contribution = (color * ray.weight).to_f64().to_array();
        }
    }

    /// A ray that goes on from the one in hand.
    fn follower(&self, kind: RayKind, weight: f64, units: RayUnits) -> Next {
        let bounces = self.rays.last().map_or(0, |ray| ray.bounces) + 1;
        Next { kind, parent: self.rays.len().checked_sub(1), bounces, weight, units }
    }

    fn hit(&mut self) -> Option<&mut HitRecord> {
        self.rays.last_mut()?.hit.as_mut()
    }

    fn margin(&mut self, decision: Decision, margin: f64, sphere: Option<usize>, light: Option<usize>) {
        let ray = self.rays.len().checked_sub(1);
        self.least.add(Margin { decision, margin, sample: None, ray, sphere, light });
    }

    fn note(&mut self, tested: Tested) {
        self.test_count += 1;
        // Lists may have a sphere more than once, and every test of it comes to the same.
        if self.detail.tests && self.tests.iter().all(|known| known.shape().index != tested.shape().index) {
            self.tests.push(tested);
        }
    }

    /// The tests of the search that has ended, and how many there were.
    fn take_tests(&mut self, record: impl Fn(&Self, &Tested) -> TestRecord) -> (Vec<TestRecord>, u64) {
        let tests = std::mem::take(&mut self.tests);
        (tests.iter().map(|tested| record(self, tested)).collect(), std::mem::take(&mut self.test_count))
    }
}

/// A ray's test with the sphere that it leaves, which it would leave again at `t`: C = 0.
fn own_test(units: &RayUnits, ray: &Ray<f64>, shape: &Shape<f64>, own: &Own<f64>, t: f64) -> TestRecord {
    let direction = ray.direction * shape.inv_scale;
    let at = Approach { origin: own.local, direction, b: -own.local.dot(direction), ..approach(ray, shape) };
    let test = units.test(&at, shape);
    let verdict = if own.inside { Verdict::TooNear } else { Verdict::Left };
    TestRecord { c: 0.0, discriminant: test.b * test.b, roots: Some([0.0, units.t(t)]), verdict, ..test }
}

/// What came of a test whose least root that counts is `root`.
fn verdict(root: Option<(f64, bool)>, index: usize, hit: Option<&Hit<f64>>) -> Verdict {
    match (root, hit) {
        (None, _) => Verdict::TooNear,
        (Some((_, is_greater)), Some(hit)) if hit.sphere == index => {
            if is_greater {
                Verdict::GreaterTaken
            } else {
                Verdict::LesserTaken
            }
        }
        (Some((t, _)), Some(hit)) if t == hit.t => Verdict::Tied,
        (Some(_), _) => Verdict::Behind,
    }
}

impl Witness<f64> for Recorder<'_> {
    fn tested(
        &mut self,
        _ray: &Ray<f64>,
        shape: &Shape<f64>,
        at: &Approach<f64>,
        _range: &Range<f64>,
        sign: Option<Ordering>,
        _root: Option<(f64, bool)>,
    ) {
        // As the tracer has it: whether a primary ray touches is decided exactly.
        self.note(Tested::Other(*shape, *at, sign));
    }

    fn tested_own(&mut self, _ray: &Ray<f64>, own: &Own<f64>, shape: &Shape<f64>, t: f64, _range: &Range<f64>) {
        self.note(Tested::Own(*shape, *own, t));
    }

    fn crossed(
        &mut self,
        _ray: &Ray<f64>,
        shape: &Shape<f64>,
        crossing: &Crossing<f64>,
        blocks: bool,
        _t_min: f64,
    ) -> bool {
        self.note(Tested::Crossed(*shape, crossing.at, blocks));
        blocks
    }

    fn nearest(
        &mut self,
        world: &World<f64>,
        ray: &Ray<f64>,
        own: Option<&Own<f64>>,
        range: &Range<f64>,
        hit: Option<Hit<f64>>,
    ) -> Option<Hit<f64>> {
        let Next { kind, parent, bounces, weight, units } = self.next;
        self.ray_units = units;
        let (tests, test_count) = self.take_tests(|_, tested| match tested {
            Tested::Own(shape, own, t) => {
                let test = own_test(&units, ray, shape, own, *t);
                let counts = own.inside && *t > range.t_min && *t < range.t_max;
                let verdict = if own.inside {
                    verdict(counts.then_some((*t, true)), test.sphere, hit.as_ref())
                } else {
                    test.verdict
                };
                TestRecord { verdict, ..test }
            }
            Tested::Crossed(shape, at, _) => units.test(at, shape),
            Tested::Other(shape, at, sign) => {
                let test = units.test(at, shape);
                let decided = at.decided(*sign);
                let Some(both) = roots(&decided, shape.radius) else {
                    // What more bits have found out.
                    let taken = hit.filter(|hit| hit.sphere == test.sphere).map(|hit| (hit.t, hit.inside));
                    return if taken.is_some() {
                        TestRecord { verdict: verdict(taken, test.sphere, hit.as_ref()), ..test }
                    } else {
                        test
                    };
                };
                let verdict = verdict(least_of(both, range), test.sphere, hit.as_ref());
                TestRecord { roots: Some([units.t(both.0), units.t(both.1)]), verdict, ..test }
            }
        });
        self.rays.push(RayRecord {
            kind,
            parent,
            bounces,
            weight,
            origin: self.units.position(ray.origin),
            direction: units.direction(ray.direction),
            t_min: units.t(range.t_min),
            tests,
            test_count,
            hit: None,
            background: None,
            color: [0.0; 3],
            contribution: [0.0; 3],
            decisions: Vec::new(),
        });
        if self.detail.margins {
            let stretch = own.is_none().then(|| units.t(1.0));
            let search = Search { world, ray, own, range, hit: hit.as_ref(), stretch };
            let distinct = self.distinct;
            search.each(distinct, |decision, margin, sphere| self.margin(decision, margin, Some(sphere), None));
        }
        hit
    }

    fn background(&mut self, world: &World<f64>) {
        self.color = world.background;
        if let Some(ray) = self.rays.last_mut() {
            ray.background = Some(world.background.to_f64().to_array());
        }
    }

    fn surface(
        &mut self,
        world: &World<f64>,
        _ray: &Ray<f64>,
        hit: &Hit<f64>,
        _at: &Approach<f64>,
        surface: &Surface<f64>,
    ) {
        let material = &world.materials[surface.sphere];
        let ambient = world.ambient * material.color * material.ka;
        self.color = ambient;
        let record = HitRecord {
            sphere: hit.sphere,
            t: self.ray_units.t(hit.t),
            inside: hit.inside,
            position: self.units.position(surface.position),
            normal: surface.normal.to_f64().to_array(),
            view: surface.view.to_f64().to_array(),
            ambient: ambient.to_f64().to_array(),
            lights: Vec::new(),
            refraction: None,
        };
        if let Some(ray) = self.rays.last_mut() {
            ray.hit = Some(record);
        }
    }

    fn lit(
        &mut self,
        world: &World<f64>,
        surface: &Surface<f64>,
        _light: &PointLight<f64>,
        n_dot_l: f64,
        is_lit: bool,
    ) -> bool {
        let Some(hit) = self.hit() else { return is_lit };
        let light = hit.lights.len();
        let none = [0.0; 3];
        hit.lights.push(LightRecord {
            light,
            n_dot_l,
            shadow: None,
            lit: false,
            specular_cosine: None,
            diffuse: none,
            specular: none,
        });
        if shows(world, surface.sphere) {
            self.margin(Decision::Terminator, n_dot_l.abs(), Some(surface.sphere), Some(light));
        }
        is_lit
    }

    fn blocked(&mut self, world: &World<f64>, ray: &Ray<f64>, own: &Own<f64>, is_blocked: bool) -> bool {
        let units = self.units.shadow();
        let (tests, test_count) = self.take_tests(|_, tested| match tested {
            Tested::Own(shape, own, t) => {
                let blocks = own.inside && *t > world.shadow_t_min && *t < 1.0;
                let test = own_test(&units, ray, shape, own, *t);
                let passed = if own.inside { Verdict::Passed } else { Verdict::Left };
                TestRecord { verdict: if blocks { Verdict::Blocks } else { passed }, ..test }
            }
            Tested::Other(shape, at, _) => units.test(at, shape),
            Tested::Crossed(shape, at, blocks) => {
                let roots = roots(at, shape.radius).map(|(lesser, greater)| [lesser, greater]);
                let passed = if roots.is_some() { Verdict::Passed } else { Verdict::Missed };
                TestRecord { roots, verdict: if *blocks { Verdict::Blocks } else { passed }, ..units.test(at, shape) }
            }
        });
        let blocker = tests.iter().find(|test| test.verdict == Verdict::Blocks).map(|test| {
            let counts = |t: &f64| *t > world.shadow_t_min && *t < 1.0;
            let t = test.roots.into_iter().flatten().find(counts).unwrap_or(f64::NAN);
            Blocker { sphere: test.sphere, t, position: self.units.position(ray.origin + ray.direction * t) }
        });
        let shadow = ShadowRecord {
            origin: self.units.position(ray.origin),
            direction: units.direction(ray.direction),
            tests,
            test_count,
            blocked: is_blocked,
            blocker,
        };
        let Some(light) = self.hit().and_then(|hit| hit.lights.last_mut()) else { return is_blocked };
        light.shadow = Some(shadow);
        let light = light.light;
        let shows = self.hit().map(|hit| hit.sphere).is_some_and(|sphere| shows(world, sphere));
        if self.detail.margins
            && shows
            && let Some((margin, sphere)) = shadow_margin(world, self.distinct, ray, own, is_blocked)
        {
            self.margin(Decision::ShadowEdge, margin, Some(sphere), Some(light));
        }
        is_blocked
    }

    fn shaded(&mut self, world: &World<f64>, surface: &Surface<f64>, light: &PointLight<f64>, terms: &LightTerms<f64>) {
        // The tracer's own products and sums, in its order.
        let diffuse = light.intensity * world.materials[surface.sphere].color * terms.diffuse;
        let specular = light.intensity * terms.specular;
        self.color += diffuse;
        self.color += specular;
        if let Some(record) = self.hit().and_then(|hit| hit.lights.last_mut()) {
            record.lit = true;
            record.specular_cosine = Some(1.0 - terms.d);
            record.diffuse = diffuse.to_f64().to_array();
            record.specular = specular.to_f64().to_array();
        }
    }

    fn reflected(&mut self, throughput: f64) {
        self.next = self.follower(RayKind::Reflection, throughput, self.units.unit());
        self.close_ray();
    }

    fn refracted(
        &mut self,
        _world: &World<f64>,
        surface: &Surface<f64>,
        snell: Snell<f64>,
        throughput: f64,
    ) -> Snell<f64> {
        let (total, units) = (snell.is_total(), self.ray_units);
        let Snell { ratio, cosine, square, .. } = snell;
        // Nothing bends without a difference.
        if ratio != 1.0 {
            self.margin(Decision::CriticalAngle, square.abs(), Some(surface.sphere), None);
        }
        if let Some(hit) = self.hit() {
            hit.refraction = Some(SnellRecord { ratio, cosine, square, total });
        }
        let (kind, units) =
            if total { (RayKind::TotalReflection, self.units.unit()) } else { (RayKind::Refraction, units) };
        self.waiting.push(self.follower(kind, throughput, units));
        snell
    }

    fn resumed(&mut self) {
        self.close_ray();
        if let Some(next) = self.waiting.pop() {
            self.next = next;
        }
    }
}

/// Whether light changes the colour of a sphere.
fn shows(world: &World<f64>, sphere: usize) -> bool {
    let material = &world.materials[sphere];
    material.kd != 0.0 || material.ks != 0.0
}
