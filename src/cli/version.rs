//! What `--version` says: enough to tell which program a report is about, without a look at any device.

use std::env::consts::{ARCH, OS};
use std::sync::LazyLock;

/// The commit, where whoever builds the program names it in `TRUERAY_COMMIT`.
const COMMIT: &str = match option_env!("TRUERAY_COMMIT") {
    Some(commit) => commit,
    None => "not named when it was built (TRUERAY_COMMIT)",
};

static LONG: LazyLock<String> = LazyLock::new(|| {
    let version = env!("CARGO_PKG_VERSION");
    let kind = if cfg!(debug_assertions) { "debug" } else { "release" };
    let view = if cfg!(feature = "view") { "view" } else { "none" };
    format!(
        "{version}\ncommit    {COMMIT}\nbuild     {kind}, {OS} {ARCH}\nfeatures  {view}\n\
         `trueray devices` lists the devices and their drivers."
    )
});

/// The long form.
pub(super) fn long() -> &'static str {
    &LONG
}
