//! What can go wrong on the way to a GPU picture.

use std::fmt;

use super::diagnosis::Diagnosis;
use super::info::DeviceInfo;
use crate::misuse::Misuse;

/// Why there is no picture from the GPU.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Error {
    /// There is no Vulkan device that can be used.
    NoneFound(String),
    /// Not the device that is asked for; or the drivers cannot be asked for theirs.
    NotFound(String),
    /// A device that renders no picture at all.
    Unsuitable {
        /// The device.
        device: String,
        /// What it lacks, or why it does not open.
        why: String,
    },
    /// More than the device holds.
    TooLarge {
        /// The device.
        device: String,
        /// What it is too small for.
        what: String,
        /// What that takes, and the limit.
        limit: String,
    },
    /// A scene whose numbers are none of a kernel's.
    OutOfRange {
        /// The kernel.
        kernel: &'static str,
        /// Which numbers.
        why: String,
    },
    /// The device's arithmetic is not what a tier promises.
    ArithmeticRefused {
        /// The device.
        device: String,
        /// What it is not.
        why: String,
    },
    /// The loops of the kernels have too few turns for some pixels.
    Cut {
        /// The device.
        device: String,
        /// How many.
        pixels: usize,
    },
    /// A shader that cannot be parsed, or is not valid.
    Shader(String),
    /// The device has answered, and its picture is wrong.
    Wrong(String),
    /// With another tuning the device renders another picture.
    OtherPicture {
        /// The device.
        device: String,
        /// How the tuning differs from that of its class.
        tuning: String,
    },
    /// The device was lost, or failed, while it worked.
    Lost(String),
    /// What is asked for makes no sense on any device.
    Misuse(Misuse),
    /// The process has been asked to end.
    Stopped,
}

impl Error {
    /// There is no Vulkan device that can be used; why, the Vulkan loader is asked once more.
    pub fn none_found() -> Self {
        let diagnosis = Diagnosis::new();
        let why = diagnosis.why_none();
        if diagnosis.finds_some() { Self::NotFound(why) } else { Self::NoneFound(why) }
    }

    pub(crate) fn unsuitable(device: &DeviceInfo, why: impl Into<String>) -> Self {
        Self::Unsuitable { device: device.to_string(), why: why.into() }
    }

    pub(crate) fn too_large(device: &DeviceInfo, what: &str, limit: impl Into<String>) -> Self {
        Self::TooLarge { device: device.to_string(), what: what.into(), limit: limit.into() }
    }

    /// Whether the device is well, and does not render this scene at this tier alone.
    pub fn is_refusal(&self) -> bool {
        matches!(
            self,
            Self::TooLarge { .. } | Self::OutOfRange { .. } | Self::ArithmeticRefused { .. } | Self::Cut { .. }
        )
    }
}

impl From<Misuse> for Error {
    fn from(misuse: Misuse) -> Self {
        Self::Misuse(misuse)
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoneFound(why) | Self::NotFound(why) | Self::Wrong(why) => f.write_str(why),
            Self::Unsuitable { device, why } => write!(f, "{device} cannot be used: {why}"),
            Self::TooLarge { device, what, limit } => write!(f, "{device} is too small for {what}: {limit}"),
            Self::OutOfRange { kernel, why } => {
                let help = "help: --precision double can, where the device has f64";
                write!(f, "{kernel} cannot render this scene: {why}\n  {help}")
            }
            Self::ArithmeticRefused { device, why } => write!(f, "{device}: {why}"),
            Self::Cut { device, pixels } => {
                write!(f, "{pixels} pixels need more turns of a loop than {device} has for them")
            }
            Self::Shader(why) => write!(f, "a shader is not valid: {why}"),
            Self::OtherPicture { device, tuning } => {
                write!(f, "{device} renders another picture with {tuning}: nothing is kept")
            }
            Self::Lost(why) => write!(f, "the device was lost: {why}"),
            Self::Misuse(misuse) => misuse.fmt(f),
            Self::Stopped => f.write_str("ended as it was asked to, before the picture was complete"),
        }
    }
}

impl std::error::Error for Error {}
