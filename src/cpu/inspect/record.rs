//! What is written down of a pixel: in the units and coordinates of the scene's file, with spheres and lights by their index.

use serde::Serialize;

use crate::cpu::Decision;

/// A pixel of the reference's picture and how it came about.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PixelRecord {
    /// Its samples, row by row.
    pub samples: Vec<SampleRecord>,
    /// The unclamped colour: the mean of the samples.
    pub color: [f64; 3],
    /// That within 0..=1, as a level with its fraction, which is cut off.
    pub scaled: [f64; 3],
    /// The levels.
    pub levels: [u8; 3],
    /// Whether `f64` leaves a decision open, so that double-double has taken them all,
    pub more_bits: bool,
    /// whether that leaves one open, too, so that 237 bits have taken them,
    pub most_bits: bool,
    /// and whether these leave one open: on a tie it goes by rule, beyond what they say stands.
    pub undecided: bool,
    /// Of each kind of decision the one that the least change would turn, nearest first.
    pub decisions: Vec<Margin>,
}

/// One sample: its rays in the order in which they were followed, which is that in which their colours were added.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SampleRecord {
    /// Column and row among the samples of the picture.
    pub sample: [u32; 2],
    /// The ray from the eye first.
    pub rays: Vec<RayRecord>,
    /// The unclamped colour, as the tracer has it: from 0 on, the sum of all `contribution`s.
    pub color: [f64; 3],
}

/// How a ray came about.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum RayKind {
    /// From the eye.
    Primary,
    /// Mirrored.
    Reflection,
    /// Bent by Snell's law.
    Refraction,
    /// Mirrored in place of a refraction, where all light is reflected.
    TotalReflection,
}

/// A ray, what it was tested with and what it brought.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RayRecord {
    /// How it came about.
    pub kind: RayKind,
    /// The ray that it goes on from, by its place among the rays.
    pub parent: Option<usize>,
    /// Bounces between the eye and its origin.
    pub bounces: u32,
    /// What its colour counts for in that of the sample.
    pub weight: f64,
    /// Where t is 0.
    pub origin: [f64; 3],
    /// One unit of t: of a primary ray the way to the image plane, of a reflection ray a unit vector, of a refraction ray as long
    /// as the direction before.
    pub direction: [f64; 3],
    /// Roots count beyond this t.
    pub t_min: f64,
    /// Each sphere that it was tested with, once; of equal spheres the first.
    pub tests: Vec<TestRecord>,
    /// How many tests that were: lists may have a sphere more than once.
    pub test_count: u64,
    /// What it meets first.
    pub hit: Option<HitRecord>,
    /// The background that it adds, where it meets nothing and is not mirrored.
    pub background: Option<[f64; 3]>,
    /// The colour that it has of its own, without that of rays that go on from it.
    pub color: [f64; 3],
    /// The same times its weight.
    pub contribution: [f64; 3],
    /// Of each kind of decision the one that the least change would turn.
    pub decisions: Vec<Margin>,
}

/// A ray and a sphere: A·t² + 2·B·t + C = 0 where the sphere is the unit sphere.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct TestRecord {
    /// The sphere.
    pub sphere: usize,
    /// The square of the direction.
    pub a: f64,
    /// The product of origin and direction; negative where the centre lies ahead.
    pub b: f64,
    /// The square of the origin, less 1.
    pub c: f64,
    /// B² − A·C, from the distance of the line to the centre.
    pub discriminant: f64,
    /// Both, lesser first; none where the line misses. Of the sphere that the ray leaves the first is its start.
    pub roots: Option<[f64; 2]>,
    /// What came of it.
    pub verdict: Verdict,
}

/// What came of a test.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// The lesser root is the hit: the least that counts of all spheres.
    LesserTaken,
    /// The greater root is the hit, since the lesser is too near: the sphere is seen from inside.
    GreaterTaken,
    /// The line misses the sphere.
    Missed,
    /// No root is far enough.
    TooNear,
    /// Another sphere is hit before.
    Behind,
    /// Another sphere with a lower index is hit at the same t.
    Tied,
    /// The ray leaves the outside of this sphere and cannot meet it again.
    Left,
    /// Of a shadow ray: it stands between the point and the light.
    Blocks,
    /// Of a shadow ray: it does not.
    Passed,
}

/// A surface point and its light.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct HitRecord {
    /// The sphere.
    pub sphere: usize,
    /// Parameter of the ray.
    pub t: f64,
    /// Whether it is the inner wall.
    pub inside: bool,
    /// Where.
    pub position: [f64; 3],
    /// Unit normal, on the side of the ray's origin.
    pub normal: [f64; 3],
    /// Unit vector towards the ray's origin.
    pub view: [f64; 3],
    /// The ambient term.
    pub ambient: [f64; 3],
    /// All lights, in order; none where no sphere reflects light.
    pub lights: Vec<LightRecord>,
    /// How the surface bends the ray that goes on into glass.
    pub refraction: Option<SnellRecord>,
}

/// A light at a surface point.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LightRecord {
    /// The light.
    pub light: usize,
    /// N·L; NaN where the light is at the point.
    pub n_dot_l: f64,
    /// The shadow ray; none where N·L says that no light comes, or where nothing casts shadows.
    pub shadow: Option<ShadowRecord>,
    /// Whether its light reaches the point.
    pub lit: bool,
    /// The cosine whose power is the specular term: R·V, or N·H for Blinn's; of a light that reaches the point.
    pub specular_cosine: Option<f64>,
    /// The diffuse term.
    pub diffuse: [f64; 3],
    /// The specular term.
    pub specular: [f64; 3],
}

/// A shadow ray: from the point at t = 0 to the light at t = 1.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ShadowRecord {
    /// The point.
    pub origin: [f64; 3],
    /// The way to the light.
    pub direction: [f64; 3],
    /// Each sphere that it was tested with.
    pub tests: Vec<TestRecord>,
    /// How many tests that were.
    pub test_count: u64,
    /// Whether it is blocked.
    pub blocked: bool,
    /// What blocks it: the first that was found.
    pub blocker: Option<Blocker>,
}

/// What stands before a light.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Blocker {
    /// The sphere.
    pub sphere: usize,
    /// The part of the way to the light at which the shadow ray meets it first.
    pub t: f64,
    /// Where that is.
    pub position: [f64; 3],
}

/// Snell's law at a surface point.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct SnellRecord {
    /// The index of refraction where the ray comes from over that where it goes.
    pub ratio: f64,
    /// The cosine between ray and normal.
    pub cosine: f64,
    /// The square of the refracted ray's cosine; not above 0 where all light is reflected.
    pub square: f64,
    /// Whether all light is reflected.
    pub total: bool,
}

/// How far a decision is from being taken otherwise. A renderer takes it otherwise where its rounding errors come to as much.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Margin {
    /// The kind of decision.
    pub decision: Decision,
    /// How far, without a unit:
    ///
    /// * silhouette: |1 − l²|, with l the distance of the line from the centre where the sphere is the unit sphere;
    /// * tie: the difference of both t over the greater;
    /// * near plane: the difference of t to the plane at which roots begin to count, where 1 is the image plane;
    /// * secondary epsilon: that distance, over the sphere's greatest semi-axis;
    /// * shadow edge: |1 − l²|, or the part of the way to the light by which a root lies off its ends;
    /// * terminator: |N·L|;
    /// * critical angle: the square of the refracted ray's cosine;
    /// * quantisation step: the change of the colour.
    pub margin: f64,
    /// The sample; none where it is the pixel's.
    pub sample: Option<usize>,
    /// The ray, by its place among those of the sample; none where it is the pixel's.
    pub ray: Option<usize>,
    /// The sphere that decides.
    pub sphere: Option<usize>,
    /// The light that it is about.
    pub light: Option<usize>,
}
