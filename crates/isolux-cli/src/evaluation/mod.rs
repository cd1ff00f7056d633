//! What an evaluation found, in tables and on a page.

mod figures_table;
mod page;
mod rivals_table;
mod words;

pub(crate) use figures_table::figures_table;
pub(crate) use page::{page, pictures, section};
pub(crate) use rivals_table::rivals_table;
