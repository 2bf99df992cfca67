//! What can go wrong on the way to a GPU picture.

use std::fmt;

use super::diagnosis::Diagnosis;
use crate::misuse::Misuse;

/// Why there is no picture from the GPU.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Error {
    /// No device, or not the one that was asked for, or it cannot do what is needed.
    NoDevice(String),
    /// The device was lost, or failed, while it worked.
    Lost(String),
    /// The device has answered, and its picture is wrong.
    Wrong(String),
    /// What is asked for makes no sense on any device.
    Misuse(Misuse),
}

impl Error {
    /// There is no Vulkan device that can be used; why, the Vulkan loader is asked once more.
    pub fn none_found() -> Self {
        Self::NoDevice(Diagnosis::new().why_none())
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
            Self::NoDevice(why) | Self::Wrong(why) => f.write_str(why),
            Self::Lost(why) => write!(f, "the device was lost: {why}"),
            Self::Misuse(misuse) => misuse.fmt(f),
        }
    }
}

impl std::error::Error for Error {}
