//! A device that knows no kernel: which there are, how one is opened, asked and waited for, and what can go wrong.

pub mod calls;
pub(crate) mod choose;
pub(crate) mod contents;
pub(crate) mod diagnosis;
pub mod drivers;
pub(crate) mod error;
mod guard;
pub(crate) mod info;
pub(crate) mod mask;
pub(crate) mod open;
pub(crate) mod readable;
pub(crate) mod timestamps;
pub(crate) mod upload;
pub(crate) mod vulkan;
