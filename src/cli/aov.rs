//! `trueray render --aov`: intermediate values beside the picture.

use std::path::{Path, PathBuf};

use clap::ValueEnum;

use super::failure::{Failure, OUTPUT, USAGE};
use super::files::check_place;
use super::guard::Guard;
use super::named::check_replaced;
use super::output::errln;
use crate::aov::{Aov, DeviceLayers, Layer, TooMany, layers, names};
use crate::cpu::Inspector;
use crate::effects::Effects;
use crate::engine::Backend;
use crate::film::{Format, Picture, PictureWriter, Target, encode_exr, encode_pfm, save_bytes};
use crate::settings::Quantize;
use crate::viewed::ViewedScene;
use crate::words::{count, visible, visible_path};

/// Which intermediate values are written, and how.
#[derive(Debug, Clone, clap::Args)]
#[command(next_help_heading = "Output")]
pub(super) struct AovOptions {
    /// Intermediate values to write beside the picture: a list of the names below, or `all`
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_enum)]
    aov: Vec<Wanted>,
    /// Where intermediate values are from: all from the CPU reference, or those that its kernels tell from the device that renders
    #[arg(long, value_name = "SOURCE", value_enum, default_value = "reference", requires = "aov")]
    aov_from: Source,
    /// Files of intermediate values: `png` for the eye, `pfm` with the numbers, `exr` with all numbers in one file
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_enum, default_value = "png,pfm", requires = "aov")]
    aov_format: Vec<AovFormat>,
    /// One EXR file of this name for all intermediate values
    #[arg(long, value_name = "FILE", requires = "aov", conflicts_with = "aov_format")]
    aov_file: Option<PathBuf>,
}

/// One kind of intermediate value, or all that there are.
#[derive(Debug, Clone, Copy)]
enum Wanted {
    All,
    One(Aov),
}

impl ValueEnum for Wanted {
    fn value_variants<'a>() -> &'a [Self] {
        const ALL: [Wanted; 19] = [
            Wanted::All,
            Wanted::One(Aov::Color),
            Wanted::One(Aov::T),
            Wanted::One(Aov::Sphere),
            Wanted::One(Aov::Inside),
            Wanted::One(Aov::Position),
            Wanted::One(Aov::Normal),
            Wanted::One(Aov::NDotL),
            Wanted::One(Aov::Shadow),
            Wanted::One(Aov::Background),
            Wanted::One(Aov::Ambient),
            Wanted::One(Aov::Diffuse),
            Wanted::One(Aov::Specular),
            Wanted::One(Aov::Bounce),
            Wanted::One(Aov::Rays),
            Wanted::One(Aov::Tests),
            Wanted::One(Aov::Margin),
            Wanted::One(Aov::Step),
            Wanted::One(Aov::Error),
        ];
        &ALL
    }

    fn to_possible_value(&self) -> Option<clap::builder::PossibleValue> {
        match self {
            Self::All => Some(clap::builder::PossibleValue::new("all").help("All that there are")),
            Self::One(aov) => aov.to_possible_value(),
        }
    }
}

/// Where values are from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Source {
    /// The CPU reference
    Reference,
    /// The device that renders, what it does not tell from the CPU reference
    Device,
}

/// How layers are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum AovFormat {
    /// A picture a layer, on a scale for the eye
    Png,
    /// The numbers of a layer
    Pfm,
    /// The numbers of all layers in one file of named channels
    Exr,
}

impl AovOptions {
    /// Whether any values are asked for.
    pub(super) fn is_given(&self) -> bool {
        !self.aov.is_empty()
    }

    /// Refuses one file for the values of several scenes, and one that the run has another use for.
    pub(super) fn check_file(&self, scenes: usize, guard: &mut Guard) -> Result<(), Failure> {
        if scenes > 1 && self.aov_file.is_some() {
            return Err(Failure::new(USAGE, "--aov-file takes one scene"));
        }
        if self.aov_file.as_deref().is_some_and(|file| file.as_os_str() == "-") {
            return Err(Failure::new(USAGE, "--aov-file takes a file, not standard output"));
        }
        guard.options([("--aov-file", &self.aov_file)])
    }

    /// Refuses files beside the picture of a scene with so many lights that the run has another use for.
    pub(super) fn check_names(&self, picture: &Path, lights: usize, guard: &Guard) -> Result<(), Failure> {
        if self.aov.is_empty() || self.aov_file.is_some() {
            return Ok(());
        }
        let names = names(&self.wanted(true), lights);
        let files = self.aov_format.iter().flat_map(|format| match format {
            AovFormat::Png => names.iter().map(|name| beside(picture, name, "png")).collect(),
            AovFormat::Pfm => names.iter().map(|name| beside(picture, name, "pfm")).collect(),
            AovFormat::Exr => vec![file_of_all(picture)],
        });
        files.collect::<Vec<_>>().iter().try_for_each(|file| guard.check_free("--aov", file))
    }

    /// What is wanted, of a device or not.
    fn wanted(&self, has_device: bool) -> Vec<Aov> {
        let all = || Aov::value_variants().iter().copied().filter(|&aov| aov != Aov::Error || has_device);
        let wanted = self.aov.iter().flat_map(|wanted| match wanted {
            Wanted::All => all().collect(),
            Wanted::One(aov) => vec![*aov],
        });
        wanted.collect()
    }

    /// Refuses what cannot be written beside the picture.
    pub(super) fn check(&self, target: &Target) -> Result<(), Failure> {
        match target {
            Target::Stdout if !self.aov.is_empty() && self.aov_file.is_none() => {
                Err(Failure::new(USAGE, "--aov writes beside the picture: it needs a file for it, or --aov-file"))
            }
            _ => Ok(()),
        }
    }

    /// What collects the values of a scene; `None` where none are wanted.
    pub(super) fn of<'a>(
        &self,
        viewed: &ViewedScene,
        effects: &Effects,
        backend: Backend<'a>,
    ) -> Result<Option<Collector<'a>>, Failure> {
        let has_device = backend.gpu().is_some();
        let names_error = self.aov.iter().any(|wanted| matches!(wanted, Wanted::One(Aov::Error)));
        if names_error && !has_device {
            let message = "--aov error is of a device's picture, and the CPU reference renders this one";
            return Err(Failure::new(USAGE, message));
        }
        if self.aov.is_empty() {
            return Ok(None);
        }
        let wanted = self.wanted(has_device);
        let picture = wanted.contains(&Aov::Error).then(Vec::new);
        let device = match (self.aov_from, backend) {
            (Source::Reference, _) => None,
            (Source::Device, Backend::Device(gpu, tier)) => {
                Some(DeviceLayers::new(gpu, tier, viewed, effects, &wanted)?)
            }
            (Source::Device, Backend::Certified(..)) => {
                let message =
                    "--aov-from device does not go with --precision certified, whose pixels are the CPU reference's";
                return Err(Failure::new(USAGE, message));
            }
            (Source::Device, Backend::Reference) => {
                let message =
                    "--aov-from device asks the device that renders, and the CPU reference renders this picture";
                return Err(Failure::new(USAGE, message));
            }
        };
        let (inspector, lights) = (Inspector::new(viewed, effects), viewed.scene().lights.len());
        let quantize = viewed.settings().quantize;
        let formats = if self.aov_file.is_some() { vec![AovFormat::Exr] } else { self.aov_format.clone() };
        let file = self.aov_file.clone();
        Ok(Some(Collector { inspector, device, lights, quantize, wanted, formats, file, picture }))
    }
}

/// A scene whose intermediate values are wanted.
#[derive(Debug)]
pub(super) struct Collector<'a> {
    inspector: Inspector,
    /// What is asked first, where that is not the reference.
    device: Option<DeviceLayers<'a>>,
    lights: usize,
    quantize: Quantize,
    wanted: Vec<Aov>,
    formats: Vec<AovFormat>,
    file: Option<PathBuf>,
    /// The device's, where it is compared.
    picture: Option<Vec<u8>>,
}

impl Collector<'_> {
    /// Takes the next rows of the picture.
    pub(super) fn add(&mut self, rgb: &[u8]) {
        if let Some(picture) = &mut self.picture {
            picture.extend_from_slice(rgb);
        }
    }

    /// Calculates the values and writes their files, beside the picture of this name; where the scene has named it, over nothing but
    /// pictures. Says which unless `quiet`.
    pub(super) fn write(
        mut self,
        name: &str,
        (picture, is_named): (&Path, bool),
        guard: &mut Guard,
        quiet: bool,
    ) -> Result<(), Failure> {
        let layers = self.layers()?;
        let mut files: Vec<(PathBuf, Contents)> = Vec::new();
        for format in &self.formats {
            match format {
                AovFormat::Png => {
                    files.extend(layers.iter().map(|l| (beside(picture, &l.name, "png"), Contents::Picture(l))));
                }
                AovFormat::Pfm => {
                    files.extend(layers.iter().map(|l| (beside(picture, &l.name, "pfm"), Contents::Numbers(l))));
                }
                AovFormat::Exr => {
                    let file = self.file.clone().unwrap_or_else(|| file_of_all(picture));
                    files.push((file, Contents::All(&layers)));
                }
            }
        }
        // All names are looked at before any file is written.
        guard.written(picture);
        for (path, _) in &files {
            check_place(path)?;
            if self.file.is_none() {
                if is_named {
                    check_replaced("--aov", path)?;
                }
                guard.output("--aov", path)?;
            }
            guard.check_unwritten("--aov", path)?;
        }
        let expected = self.expected()?;
        for (path, contents) in &files {
            contents.save(path, self.quantize, expected.as_ref(), |layers| self.note(layers))?;
            guard.written(path);
        }
        if !quiet {
            let names: Vec<String> = files.iter().map(|(path, _)| visible_path(path)).collect();
            let (count, sources) = (count(files.len() as u64, "file"), self.sources(&layers));
            errln!("trueray: {}: {count} of values from {sources}: {}", visible(name), names.join(", "));
        }
        Ok(())
    }

    fn layers(&mut self) -> Result<Vec<Layer>, Failure> {
        let Self { inspector, device, wanted, .. } = self;
        let is_told = |aov| device.as_ref().is_some_and(|device| device.tells(aov));
        let of_reference: Vec<Aov> = wanted.iter().copied().filter(|&aov| !is_told(aov)).collect();
        let shown = self.picture.as_deref();
        let mut layers = layers(inspector, self.lights, self.quantize, &of_reference, shown)?;
        if let Some(device) = device {
            layers.extend(device.layers(inspector)??);
            layers.sort_by_key(|layer| layer.aov);
        }
        Ok(layers)
    }

    /// Where these are from.
    fn sources(&self, layers: &[Layer]) -> String {
        let Some(device) = &self.device else { return REFERENCE.to_owned() };
        let (told, others): (Vec<_>, Vec<_>) = layers.iter().partition(|layer| device.tells(layer.aov));
        let named = |layers: Vec<&Layer>, source: &str| {
            let names: Vec<_> = layers.iter().map(|layer| layer.name.as_str()).collect();
            (!names.is_empty()).then(|| format!("{source} ({})", names.join(", ")))
        };
        let sources = [named(told, device.name()), named(others, REFERENCE)];
        sources.into_iter().flatten().collect::<Vec<_>>().join(" and ")
    }

    /// What a file says of where its layers are from; nothing where all are the reference's.
    fn note(&self, layers: &[Layer]) -> Option<String> {
        self.device.as_ref().map(|_| format!("values from {}", self.sources(layers)))
    }

    /// The reference's picture, where the device's is compared with it.
    fn expected(&self) -> Result<Option<Picture>, Failure> {
        if self.picture.is_none() {
            return Ok(None);
        }
        let (width, height) = self.inspector.reference().size();
        let mut rgb = vec![0; width as usize * height as usize * 3];
        self.inspector.reference().rows(0, &mut rgb)?;
        Ok(Some(Picture::assemble(width, height, rgb)))
    }
}

const REFERENCE: &str = "the CPU reference";

/// `scene.normal.png` beside `scene.png`.
fn beside(picture: &Path, name: &str, ending: &str) -> PathBuf {
    picture.with_extension(format!("{name}.{ending}"))
}

/// `scene.aov.exr` beside `scene.png`.
fn file_of_all(picture: &Path) -> PathBuf {
    picture.with_extension("aov.exr")
}

/// What a file has.
enum Contents<'a> {
    Picture(&'a Layer),
    Numbers(&'a Layer),
    All(&'a [Layer]),
}

impl Contents<'_> {
    fn save(
        &self,
        path: &Path,
        quantize: Quantize,
        expected: Option<&Picture>,
        note: impl Fn(&[Layer]) -> Option<String>,
    ) -> Result<(), Failure> {
        let target = Target::File(path.to_owned());
        match self {
            Self::Picture(layer) => {
                let note = note(std::slice::from_ref(layer));
                let source = note.as_deref().map(|note| ("Source", note));
                let size = (layer.width, layer.height);
                let mut writer = PictureWriter::with_text(&target, Format::Png, size, source)?;
                writer.write_rows(layer.picture(quantize, expected).rgb())?;
                writer.finish()?;
            }
            Self::Numbers(layer) => {
                let Layer { width, height, values, .. } = layer;
                save_bytes(&target, &encode_pfm(*width, *height, layer.channels(), values))?;
            }
            Self::All(layers) => {
                let Some(Layer { width, height, .. }) = layers.first() else { return Ok(()) };
                let channels = layers.iter().flat_map(channels).collect();
                let file = encode_exr(*width, *height, channels, note(layers).as_deref())
                    .map_err(|why| Failure::new(OUTPUT, format!("cannot write {}: {why}", path.display())))?;
                save_bytes(&target, &file)?;
            }
        }
        Ok(())
    }
}

/// The channels of a layer, each for itself.
fn channels(layer: &Layer) -> Vec<(String, Vec<f32>)> {
    let names = layer.channel_names();
    let of = |channel| layer.values.iter().copied().skip(channel).step_by(layer.channels()).collect();
    names.into_iter().enumerate().map(|(channel, name)| (name, of(channel))).collect()
}

impl From<TooMany> for Failure {
    fn from(too_many: TooMany) -> Self {
        Self::new(USAGE, too_many.to_string())
    }
}
