//! Ends the run where a driver's call never returns.

use std::thread::{self, Builder};
use std::time::Duration;

use super::failure::{Failure, USAGE};
use crate::gpu::calls::{self, PATIENCE};
use crate::words::visible;

/// The time between two looks; time in which the process was stopped counts as one of them.
const LOOK: Duration = Duration::from_secs(1);

/// Takes over what the environment says, and starts the thread that looks, and may end the run with `code`; without one to be had,
/// nobody does.
pub(super) fn watch(code: u8) -> Result<(), Failure> {
    if let Some(value) = std::env::var_os(PATIENCE) {
        let seconds = value.to_str().and_then(|text| text.parse().ok()).filter(|&seconds| seconds > 0);
        let wrong = || {
            Failure::new(
                USAGE,
                format!(
                    "{PATIENCE} is `{}`: expected a whole number of seconds, 1 or more",
                    visible(&value.to_string_lossy())
                ),
            )
        };
        calls::set_patience(seconds.ok_or_else(wrong)?);
    }
    let _ = Builder::new().name("watchdog".into()).spawn(move || look(code));
    Ok(())
}

fn look(code: u8) {
    let (mut last, mut looks) = (None, 0);
    loop {
        thread::sleep(LOOK);
        let oldest = calls::oldest();
        looks = if oldest.is_some() && oldest == last { looks + 1 } else { 0 };
        last = oldest;
        // Waits end themselves at that time, with a better message.
        let most = calls::patience().as_secs() + 2;
        if looks > most {
            let why = format!(
                "the device was lost: a call of its driver has not returned for {looks} s ({PATIENCE} sets the limit)"
            );
            // What the other threads hold may be held for ever.
            crate::atomic::abandon_all();
            let code = Failure::new(code, why).report();
            std::process::exit(code.into());
        }
    }
}
