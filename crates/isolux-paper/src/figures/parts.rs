//! Small pieces that several sections use.

use isolux_report::page::{Axis, Scale, Verdict};

/// An axis that follows its data.
pub(super) fn axis(label: &str, scale: Scale) -> Axis {
    Axis { label: label.to_owned(), scale, range: None }
}

/// Holds, or fails because of `otherwise`.
pub(super) fn verdict(holds: bool, otherwise: &str) -> Verdict {
    if holds { Verdict::Holds } else { Verdict::Fails(otherwise.to_owned()) }
}
