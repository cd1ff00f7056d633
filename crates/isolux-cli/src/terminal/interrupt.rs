//! Ctrl-C while something is written: the work stops between two frames, so that nothing half-written is left behind.

use std::sync::atomic::{AtomicBool, Ordering};

use crate::failure::Failure;

static INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// From now on, Ctrl-C or a request to terminate is [`requested`]; a second one ends the process at once.
pub(crate) fn watch() {
    // Where no handler can be set, or one is set already, the process ends as it always did.
    let _ = ctrlc::set_handler(|| {
        if INTERRUPTED.swap(true, Ordering::Relaxed) {
            std::process::exit(i32::from(Failure::INTERRUPTED));
        }
    });
}

/// True once the user has interrupted.
pub(crate) fn requested() -> bool {
    INTERRUPTED.load(Ordering::Relaxed)
}
