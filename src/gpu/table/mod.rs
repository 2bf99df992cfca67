//! A scene as kernels read it: the layout of its structs, their bytes, and where they are bound.

pub(crate) mod bind;
pub mod layout;
pub(crate) mod pack;
pub(crate) mod pool;
