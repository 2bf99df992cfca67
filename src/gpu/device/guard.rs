//! Failures of a device that the libraries on the way to its driver answer with a panic.
//!
//! A device is most often lost while one waits for it, and memory runs out anywhere. In both cases wgpu panics. Here that becomes
//! an error again. A panic of any other code stays one: that is a fault of this program.

use std::cell::{Cell, RefCell};
use std::panic::{AssertUnwindSafe, PanicHookInfo, catch_unwind, resume_unwind, set_hook, take_hook};
use std::path::Path;
use std::sync::Once;

thread_local! {
    /// Whether a panic on this thread will be caught here.
    static IS_GUARDED: Cell<bool> = const { Cell::new(false) };
    /// What a library has said in its panic.
    static SAID: RefCell<Option<String>> = const { RefCell::new(None) };
}

/// Whether the code of this file is part of the way to the driver.
fn is_on_the_way(file: &str) -> bool {
    let parts = Path::new(file).components().filter_map(|part| part.as_os_str().to_str());
    parts.into_iter().any(|part| ["wgpu", "naga", "gpu-allocator", "ash-"].iter().any(|name| part.starts_with(name)))
}

fn said(info: &PanicHookInfo) -> String {
    let payload = info.payload();
    let text = payload.downcast_ref::<&str>().copied().or_else(|| payload.downcast_ref::<String>().map(String::as_str));
    text.unwrap_or("a panic without words").to_owned()
}

/// Panics that are caught below print nothing.
fn install_hook() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        let before = take_hook();
        set_hook(Box::new(move |info: &PanicHookInfo| {
            let is_theirs = info.location().is_some_and(|place| is_on_the_way(place.file()));
            if IS_GUARDED.get() && is_theirs {
                SAID.set(Some(said(info)));
            } else {
                before(info);
            }
        }));
    });
}

/// What `action` returns; where a library on the way to the driver panics, what it says.
pub(super) fn guarded<T>(action: impl FnOnce() -> T) -> Result<T, String> {
    install_hook();
    let outer = IS_GUARDED.replace(true);
    // Whoever gets the error leaves the device alone from then on.
    let result = catch_unwind(AssertUnwindSafe(action));
    IS_GUARDED.set(outer);
    result.map_err(|panic| match SAID.take() {
        // The first line says what, the others in which call of which object.
        Some(said) => said.lines().find(|line| !line.trim().is_empty()).unwrap_or_default().trim().to_owned(),
        None => resume_unwind(panic),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn other_panics_go_on() {
        assert_eq!(guarded(|| 1), Ok(1));
        assert!(catch_unwind(|| guarded(|| panic!("a fault of this program"))).is_err());
        assert!(!IS_GUARDED.get());
    }

    #[test]
    fn files_of_libraries_are_known() {
        for file in [
            "/r/wgpu-30.0.1/src/backend/wgpu_core.rs",
            "/r/wgpu-core-30.0.1/src/device.rs",
            "/r/naga-30.0.1/src/lib.rs",
        ] {
            assert!(is_on_the_way(file), "{file}");
        }
        for file in ["src/gpu/render.rs", "/r/rayon-core-1.13.0/src/job.rs", "/rustc/1/library/core/src/option.rs"] {
            assert!(!is_on_the_way(file), "{file}");
        }
    }
}
