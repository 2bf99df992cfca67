//! What else a device is asked for than pictures of scenes.

mod compute;
pub(super) mod echo;
pub(super) mod fill;
pub(super) mod probe;
pub(super) mod quotients;
mod record;
pub(super) mod selftest;
