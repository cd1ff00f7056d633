//! The pipeline's observer: progress bars, remarks, and Ctrl-C.

use std::cell::RefCell;
use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};
use isolux_pipeline::{Observer, Remark, Severity, Work};

use super::interrupt;
use super::print::{note, warn};
use crate::advice;

/// Shows progress on stderr where that is a terminal, prints remarks there, and stops the work after Ctrl-C where
/// [`interrupt::watch`] was called.
#[derive(Debug, Default)]
pub(crate) struct Terminal {
    /// That of the pass at work.
    bar: RefCell<Option<ProgressBar>>,
}

impl Observer for Terminal {
    fn progress(&self, work: Work, done: usize, total: Option<usize>) {
        let mut bar = self.bar.borrow_mut();
        if done == 0 {
            *bar = Some(progress_bar(work, total));
        }
        let Some(shown) = bar.as_ref() else { return };
        shown.set_position(done as u64);
        if total == Some(done) {
            shown.finish_and_clear();
            *bar = None;
        }
    }

    fn cancelled(&self) -> bool {
        interrupt::requested()
    }

    fn remark(&self, remark: Remark) {
        let text = advice::with(&remark, remark.advice());
        let print = || match remark.severity() {
            Severity::Note => note(&text),
            Severity::Warning => warn(&text),
        };
        match self.bar.borrow().as_ref() {
            Some(bar) => bar.suspend(print),
            None => print(),
        }
    }
}

fn progress_bar(work: Work, total: Option<usize>) -> ProgressBar {
    let (bar, template) = match total {
        Some(total) => (
            ProgressBar::new(total as u64),
            "{prefix:>22} [{bar:32}] {pos}/{len} frames, {per_sec}, {eta} left",
        ),
        None => (ProgressBar::new_spinner(), "{prefix:>22} {spinner} {pos} frames, {per_sec}"),
    };
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(style.progress_chars("=> "));
    }
    bar.set_prefix(work.to_string());
    bar.enable_steady_tick(Duration::from_millis(200));
    bar
}
