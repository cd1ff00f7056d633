//! What a person sees: results on stdout, progress and notes on stderr.

pub(crate) mod interrupt;
mod observer;
mod print;
mod spinner;
mod table;

pub(crate) use observer::Terminal;
pub(crate) use print::{print, print_json, warn};
pub(crate) use spinner::spinner;
pub(crate) use table::table;
