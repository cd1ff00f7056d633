//! Small pieces that several sections use.

use isolux_report::page::{Axis, Block, Cell, Scale, Verdict};

/// An axis that follows its data.
pub(super) fn axis(label: &str, scale: Scale) -> Axis {
    Axis { label: label.to_owned(), scale, range: None }
}

/// Holds, or fails because of `otherwise`.
pub(super) fn verdict(holds: bool, otherwise: &str) -> Verdict {
    if holds { Verdict::Holds } else { Verdict::Fails(otherwise.to_owned()) }
}

/// A number in a table.
pub(super) fn number(value: f64, decimals: usize) -> Cell {
    Cell::Number { value, decimals }
}

/// Words in a table.
pub(super) fn text(words: &str) -> Cell {
    Cell::Text(words.to_owned())
}

/// What the paper says, and where.
pub(super) fn quote(text: &str, source: &str) -> Block {
    Block::Quote { text: text.to_owned(), source: source.to_owned() }
}
