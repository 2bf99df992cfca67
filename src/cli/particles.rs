//! Options for files of particles: atoms, simulations, point clouds.

use clap::Args;
use glam::DVec3;

use super::failure::{Failure, USAGE};
use super::options::PictureOptions;
use crate::import::{Coloring, Frames, Framing, Lighting, Options, Radius, color, direction};
use crate::views::Placement;

/// How particles become spheres.
#[derive(Debug, Default, Args)]
#[command(next_help_heading = "Particles")]
pub(super) struct ParticleOptions {
    /// Frames of a trajectory, counted from 1: a number, last; `trueray import` also takes all and lists such as 1-50,73
    #[arg(long, value_name = "N")]
    frame: Option<Frames>,
    /// Radii: a number, element (van der Waals), covalent, or a column of the file; without it the column `radius`, then element
    #[arg(long, value_name = "SOURCE")]
    radius: Option<Radius>,
    /// What radii are multiplied by
    #[arg(long, value_name = "FACTOR", value_parser = factor)]
    radius_scale: Option<f64>,
    /// Colours: element, R,G,B of parts 0 to 1, #rrggbb, or COLUMN, COLUMN:MAP, COLUMN:MAP:LO..HI with viridis, magma, inferno, plasma, cividis, coolwarm,
    /// gray or categories; without it those of the file, then element
    #[arg(long, value_name = "SOURCE")]
    color_by: Option<Coloring>,
    /// The direction of view in the file's coordinates: X,Y,Z or an axis such as x or -z, the default
    #[arg(long, value_name = "DIRECTION", allow_hyphen_values = true, value_parser = direction)]
    direction: Option<DVec3>,
    /// What is upwards in the picture: X,Y,Z or an axis; without it y
    #[arg(long, value_name = "DIRECTION", allow_hyphen_values = true, value_parser = direction)]
    vertical: Option<DVec3>,
    /// What fills the picture: picture, the particles as they are seen; or ball, the ball around them, which --turntable takes
    #[arg(long, value_name = "WHAT")]
    fit: Option<Framing>,
    /// The lights, which turn with the eye: headlight, three, or dome:N, whose many lamps leave hollows dark; the default is dome:32
    #[arg(long, value_name = "LIGHTS")]
    light: Option<Lighting>,
    /// The colour behind particles: R,G,B of parts 0 to 1 or #rrggbb; the default is white
    #[arg(long, value_name = "COLOR", value_parser = color)]
    background: Option<DVec3>,
}

/// How a file is read.
#[derive(Debug)]
pub(super) struct Reading {
    pub(super) options: Options,
    /// Whether options ask for what only files of particles have.
    pub(super) is_for_particles: bool,
}

impl Reading {
    /// Without options but the picture's size and the eye.
    pub(super) fn usual(picture: &PictureOptions) -> Result<Self, Failure> {
        ParticleOptions::default().one_frame(picture)
    }
}

impl ParticleOptions {
    /// Where colours come from, where that is said.
    pub(super) fn coloring(&self) -> Option<&Coloring> {
        self.color_by.as_ref()
    }

    /// How one frame is read for a picture.
    pub(super) fn one_frame(&self, picture: &PictureOptions) -> Result<Reading, Failure> {
        let mut reading = self.frames(picture.resolution())?;
        reading.options.view = picture.settings()?.view;
        if reading.options.frames.is_one() {
            return Ok(reading);
        }
        let commands = "trueray import --frame all FILE -o FOLDER/%04d.txt\n    trueray render FOLDER/*.txt -o FOLDER";
        Err(Failure::new(
            USAGE,
            format!(
                "--frame takes one frame here\n  help: two commands render several, with a FOLDER that is there:\n    {commands}"
            ),
        ))
    }

    /// The same for pictures from all sides. An eye of its own is in the coordinates of the usual scene, which therefore stays.
    pub(super) fn all_sides(&self, picture: &PictureOptions) -> Result<Reading, Failure> {
        let mut reading = self.one_frame(picture)?;
        let Placement { eye, look_at, .. } = picture.placement();
        if self.fit.is_none() && eye == DVec3::ZERO && look_at.is_none() {
            reading.options.framing = Framing::Ball;
        }
        Ok(reading)
    }

    /// How all chosen frames are read.
    pub(super) fn frames(&self, size: Option<(u32, u32)>) -> Result<Reading, Failure> {
        let Self { frame, radius, radius_scale, color_by, direction, vertical, fit, light, background } = self;
        let usual = Options::default();
        let is_for_particles = frame.is_some()
            || radius.is_some()
            || radius_scale.is_some()
            || color_by.is_some()
            || direction.is_some()
            || vertical.is_some()
            || fit.is_some()
            || light.is_some()
            || background.is_some();
        let options = Options {
            frames: frame.clone().unwrap_or(usual.frames),
            radius: radius.clone().unwrap_or(usual.radius),
            radius_scale: radius_scale.unwrap_or(usual.radius_scale),
            coloring: color_by.clone().unwrap_or(usual.coloring),
            direction: direction.unwrap_or(usual.direction),
            vertical: vertical.or(usual.vertical),
            lighting: light.unwrap_or(usual.lighting),
            background: background.unwrap_or(usual.background),
            size: size.unwrap_or(usual.size),
            framing: fit.unwrap_or(usual.framing),
            view: usual.view,
        };
        match options.axes() {
            Ok(_) => Ok(Reading { options, is_for_particles }),
            Err(_) => Err(Failure::new(USAGE, "--vertical is parallel to the direction of view: choose another one")),
        }
    }
}

fn factor(text: &str) -> Result<f64, String> {
    let factor = text.parse().ok().filter(|factor| (1e-100..=1e100).contains(factor));
    factor.ok_or_else(|| "expected a number greater than 0".into())
}
