//! From variants and constants to compiled kernels: what a device is told to do, but not with what.

pub(crate) mod ahead;
pub(crate) mod bindings;
pub mod cache;
pub(crate) mod compiler;
mod compose;
mod constants;
mod correct;
pub(crate) mod entry;
mod inexact;
mod inline;
mod listing;
pub(crate) mod module;
pub(crate) mod picture;
pub(crate) mod pipeline;
mod products;
pub(crate) mod specialisation;
pub(crate) mod spirv;
pub(crate) mod store;
pub(crate) mod variant;
