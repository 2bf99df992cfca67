//! What `--version` says: enough to tell which program a report is about, without a look at any device.

use std::env::consts::{ARCH, OS};
use std::sync::LazyLock;

use crate::origin::{BUILD, COMMIT, NO_COMMIT};

static LONG: LazyLock<String> = LazyLock::new(|| {
    let version = env!("CARGO_PKG_VERSION");
    let commit = COMMIT.unwrap_or(NO_COMMIT);
    let view = if cfg!(feature = "view") { "view" } else { "none" };
    format!(
        "{version}\ncommit    {commit}\nbuild     {BUILD}, {OS} {ARCH}\nfeatures  {view}\n\
         `trueray devices` lists the devices and their drivers."
    )
});

/// The long form.
pub(super) fn long() -> &'static str {
    &LONG
}
