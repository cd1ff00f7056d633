//! What an evaluation found, in tables for the terminal.

mod figures_table;
mod rivals_table;

pub(crate) use figures_table::figures_table;
pub(crate) use rivals_table::rivals_table;
