//! From the particles of a frame to a scene.

use glam::DVec3;

use super::camera::Camera;
use super::color::{ColorScale, colors, range_of};
use super::elements::Element;
use super::frame::{Frame, Numbers};
use super::light::{Lamps, material};
use super::options::{ByColumn, Coloring, Options, Radius};
use crate::scene::{Names, Scene, Sphere};
use crate::view::ViewError;
use crate::words::{count, number};

/// What is taken from the first frame and stays for all: pictures of a trajectory are of one piece.
#[derive(Debug, Clone, Copy)]
pub(super) struct Look {
    camera: Camera,
    /// The values at the ends of the colour map.
    range: (f64, f64),
    /// The radius of what has none.
    spacing: f64,
}

/// A frame as a scene.
pub(super) struct Made {
    pub(super) scene: Scene,
    pub(super) lamps: Lamps,
    pub(super) color_scale: Option<ColorScale>,
    /// What the user may want to know of it.
    pub(super) notes: Vec<String>,
}

/// The scene of a frame with at least one particle.
pub(super) fn scene_of(frame: &Frame, options: &Options, look: &mut Option<Look>) -> Result<Made, ViewError> {
    let is_first = look.is_none();
    let spacing = look.map_or_else(|| half_distance(&frame.positions), |look| look.spacing);
    let (radius_of, without) = radii(frame, options, spacing);
    let radius_of = |index| radius_of(index) * options.radius_scale;
    let mut notes = Vec::new();
    if without > 0 {
        let short = format!("{spacing:.3e}").parse().unwrap_or(spacing);
        let (without, spacing) = (count(without, "particle"), number(short));
        notes.push(format!("no radius for {without}: half their mean distance is taken, {spacing} (--radius sets it)"));
    }
    if is_first {
        notes.extend(notes_of_elements(frame));
    }
    let look = if let Some(look) = *look {
        look
    } else {
        let axes = options.axes()?;
        let spheres = frame.positions.iter().enumerate().map(|(index, &center)| (center, radius_of(index)));
        let camera = Camera::fit(spheres, axes, options.size, options.framing);
        let range = match &options.coloring {
            Coloring::Column(ByColumn { range: Some(range), .. }) => *range,
            _ => range_of(&frame.values),
        };
        *look.insert(Look { camera, range, spacing })
    };

    let color_of = colors(frame, &options.coloring, look.range);
    let material = material(options.lighting);
    let sphere = |(index, &position): (usize, &DVec3)| Sphere {
        center: look.camera.see(position),
        scale: DVec3::splat(radius_of(index)),
        color: color_of(index),
        ..material
    };
    let spheres: Vec<_> = frame.positions.iter().enumerate().map(sphere).collect();
    let (low, high) = spheres.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), sphere| {
        (low.min(sphere.center - sphere.scale), high.max(sphere.center + sphere.scale))
    });
    let outside = spheres.iter().filter(|sphere| !look.camera.shows(sphere.center, sphere.scale.x)).count() as u64;
    if !is_first && outside > 0 {
        notes.push(format!("warning: {} not whole in the picture, which fits the first frame", are(outside)));
    }
    let lamps = Lamps { lighting: options.lighting, middle: (low + high) / 2.0, size: (high - low).length() / 2.0 };
    let (width, height) = options.size;
    let scene = Scene {
        spheres,
        sphere_names: names(frame),
        lights: lamps.seen_by(&options.view),
        background: options.background,
        ambient: DVec3::ONE,
        ..Scene::new(look.camera.window, width, height)
    };
    let color_scale = ColorScale::of(frame, &options.coloring, look.range);
    Ok(Made { scene, lamps, color_scale, notes })
}

/// How many particles, with their verb.
fn are(particles: u64) -> String {
    let verb = if particles == 1 { "is" } else { "are" };
    format!("{} {verb}", count(particles, "particle"))
}

/// How elements were found, where the file does not say it.
fn notes_of_elements(frame: &Frame) -> Vec<String> {
    let mut notes = Vec::new();
    if let Some(numbers) = frame.numbers {
        let meaning = match numbers {
            Numbers::Types => "types, not for elements",
            Numbers::Atomic => "atomic numbers",
        };
        notes.push(format!("the numbers before the coordinates are taken for {meaning}"));
    }
    if frame.guesses > 0 {
        let guesses = count(frame.guesses, "particle");
        notes.push(format!("warning: the elements of {guesses} are guessed from names of atoms"));
    }
    notes
}

/// The radius of each particle by its number, before it is scaled, and for how many nothing gives one.
fn radii<'a>(frame: &'a Frame, options: &'a Options, spacing: f64) -> (Box<dyn Fn(usize) -> f64 + 'a>, u64) {
    let is_covalent = options.radius == Radius::Covalent;
    match options.radius {
        Radius::Fixed(radius) => (Box::new(move |_| radius), 0),
        Radius::Auto | Radius::Column(_) if !frame.radii.is_empty() => (Box::new(|index| frame.radii[index]), 0),
        _ if frame.kinds.is_empty() => (Box::new(move |_| spacing), frame.positions.len() as u64),
        _ => {
            let of_element = |element: &Element| {
                if is_covalent { element.covalent } else { element.van_der_waals }
            };
            let known: Vec<_> = frame.elements.iter().map(|element| element.and_then(of_element)).collect();
            let without = frame.kinds.iter().filter(|&&kind| known[kind as usize].is_none()).count() as u64;
            (Box::new(move |index| known[frame.kinds[index] as usize].unwrap_or(spacing)), without)
        }
    }
}

/// Half the mean distance of neighbours, were the particles evenly spread over the box, rectangle or line around them.
fn half_distance(positions: &[DVec3]) -> f64 {
    let (low, high) = positions
        .iter()
        .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), &position| (low.min(position), high.max(position)));
    let extents: Vec<_> = (high - low).to_array().into_iter().filter(|&extent| extent > 0.0).collect();
    // Logarithms, since the volume of large numbers is none.
    let logarithm = extents.iter().map(|extent| extent.ln()).sum::<f64>() - (positions.len() as f64).ln();
    if extents.is_empty() { 1.0 } else { (logarithm / extents.len() as f64).exp() / 2.0 }
}

/// The kind of each particle as its name, in letters that a scene file can have.
fn names(frame: &Frame) -> Names {
    let allowed = |c: char| if c.is_ascii_graphic() && c != '#' { c } else { '_' };
    let name = |label: &[u8]| String::from_utf8_lossy(label).chars().map(allowed).collect::<String>();
    let labels: Vec<_> = frame.labels.names().map(name).collect();
    let mut names = Names::default();
    frame.kinds.iter().for_each(|&kind| names.push(&labels[kind as usize]));
    names
}
