//! Ctrl-C while a recording is written: stop between two frames, so that nothing half-written is left behind.

use std::sync::atomic::{AtomicBool, Ordering};

use crate::failure::{Failure, Outcome};

static INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// From now on, [`check`] fails after Ctrl-C or a request to terminate; a second one ends the process at once.
pub(crate) fn watch() {
    // Where no handler can be set, or one is set already, the process ends as it always did.
    let _ = ctrlc::set_handler(|| {
        if INTERRUPTED.swap(true, Ordering::Relaxed) {
            std::process::exit(i32::from(Failure::INTERRUPTED));
        }
    });
}

/// Fails once the user has interrupted.
pub(crate) fn check() -> Outcome {
    if INTERRUPTED.load(Ordering::Relaxed) { Err(Failure::interrupted()) } else { Ok(()) }
}
