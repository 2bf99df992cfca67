//! What can go wrong on the way to a GPU picture.

use std::fmt;

/// Why there is no picture from the GPU.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Error {
    /// No device, or not the one that was asked for, or it cannot do what is needed.
    NoDevice(String),
    /// The device was lost, or failed, while it worked.
    Lost(String),
}

impl Error {
    /// There is no Vulkan device at all.
    pub fn none_found() -> Self {
        Self::NoDevice(
            "no Vulkan device was found. Debian's package mesa-vulkan-drivers has a software one; `--device cpu` renders \
             without any"
                .into(),
        )
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoDevice(why) => f.write_str(why),
            Self::Lost(why) => write!(f, "the device was lost: {why}"),
        }
    }
}

impl std::error::Error for Error {}
