//! Exit codes and what they stand for: a documented contract.

use super::output::errln;
use std::fmt;

use crate::film::OutputError;
use crate::gpu;
use crate::misuse::Misuse;
use crate::threads;
use crate::words::visible_lines;

/// All is well.
pub(super) const OK: u8 = 0;
/// `compare`: the pictures differ by more than the limits; `verify`: the picture is wrong.
pub(super) const DIFFERENT: u8 = 1;
/// `stress`: a promise is broken on this device.
pub(super) const BROKEN: u8 = 1;
/// `merge`: parts are missing.
pub(super) const INCOMPLETE: u8 = 1;
/// The arguments make no sense; for `compare` and `verify` any trouble.
pub(super) const USAGE: u8 = 2;
/// The scene cannot be read or has errors.
pub(super) const SCENE: u8 = 3;
/// There is no device, or not the one asked for, or it cannot do what is asked.
pub(super) const NO_DEVICE: u8 = 4;
/// The device failed while it worked, or rendered a wrong picture.
pub(super) const DEVICE_LOST: u8 = 5;
/// A file cannot be written.
pub(super) const OUTPUT: u8 = 6;
/// The system gives no thread where one is needed.
pub(super) const NO_THREAD: u8 = 7;
/// SIGTERM ended `render`, which may be repeated: `EX_TEMPFAIL` of `sysexits.h`.
pub(super) const STOPPED: u8 = 75;

/// Why a subcommand ends early.
#[derive(Debug)]
pub(super) struct Failure {
    /// The exit code.
    pub code: u8,
    /// What to tell the user; empty where that is done already.
    pub message: String,
    /// What `--device cpu` would do about it, where the command takes that.
    cpu: Option<&'static str>,
}

impl Failure {
    pub(super) fn new(code: u8, message: impl Into<String>) -> Self {
        Self { code, message: message.into(), cpu: None }
    }

    /// The same, of a command that needs a device.
    pub(super) fn without_cpu(self) -> Self {
        Self { cpu: None, ..self }
    }

    /// The same, said of one of several inputs.
    pub(super) fn of(self, name: &str) -> Self {
        Self { message: format!("{name}: {}", self.message), ..self }
    }

    /// Tells the user and returns the exit code.
    pub(super) fn report(&self) -> u8 {
        if !self.message.is_empty() {
            // Messages hold names that somebody else chose.
            errln!("trueray: {}", visible_lines(&self.message));
        }
        if let Some(help) = self.cpu {
            errln!("  help: `--device cpu` {help}");
        }
        self.code
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl From<gpu::Error> for Failure {
    fn from(error: gpu::Error) -> Self {
        use gpu::Error;
        let code = match &error {
            Error::NoneFound(_) | Error::NotFound(_) | Error::Unsuitable { .. } if threads::are_short() => {
                let help = "help: the system refuses threads, of which a driver needs some: `ulimit -u` says how many there may be";
                return Self::new(NO_THREAD, format!("{error}\n  {help}"));
            }
            Error::NoneFound(_)
            | Error::NotFound(_)
            | Error::Unsuitable { .. }
            | Error::TooLarge { .. }
            | Error::OutOfRange { .. }
            | Error::ArithmeticRefused { .. }
            | Error::Cut { .. } => NO_DEVICE,
            Error::Lost(_) | Error::Shader(_) | Error::Wrong(_) | Error::OtherPicture { .. } => DEVICE_LOST,
            Error::Misuse(_) => USAGE,
            Error::Stopped => STOPPED,
        };
        let cpu = match &error {
            Error::NoneFound(_) => Some("renders without any"),
            Error::TooLarge { .. } | Error::OutOfRange { .. } | Error::Cut { .. } => Some("has no such limit"),
            Error::ArithmeticRefused { .. } => Some("does not depend on it"),
            _ => None,
        };
        Self { cpu, ..Self::new(code, error.to_string()) }
    }
}

impl From<Misuse> for Failure {
    fn from(misuse: Misuse) -> Self {
        Self::new(USAGE, misuse.to_string())
    }
}

impl From<OutputError> for Failure {
    fn from(error: OutputError) -> Self {
        Self::new(OUTPUT, error.to_string())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn causes_end_with_the_documented_codes() {
        let (device, tuning) = (String::from("card"), String::from("paths 8"));
        for (error, code) in [
            (gpu::Error::NotFound("none of that name".into()), NO_DEVICE),
            (gpu::Error::Cut { device: device.clone(), pixels: 1 }, NO_DEVICE),
            (gpu::Error::OtherPicture { device, tuning }, DEVICE_LOST),
            (gpu::Error::Shader("a token".into()), DEVICE_LOST),
            (gpu::Error::Misuse(Misuse::Batch("no lights".into())), USAGE),
        ] {
            assert_eq!(Failure::from(error.clone()).code, code, "{error:?}");
        }
    }
}
