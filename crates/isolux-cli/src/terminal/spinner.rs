//! A sign of life beside the step at hand.

use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};

/// A spinner whose message is the step at hand; invisible unless stderr is a terminal.
pub(crate) fn spinner() -> ProgressBar {
    let spinner = ProgressBar::new_spinner();
    if let Ok(style) = ProgressStyle::with_template("{spinner} {elapsed} {msg}") {
        spinner.set_style(style);
    }
    spinner.enable_steady_tick(Duration::from_millis(200));
    spinner
}
