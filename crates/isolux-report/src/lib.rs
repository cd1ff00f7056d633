//! Turns results into self-contained HTML pages.
//!
//! A [`page::Page`] says what a report holds, without any looks. [`render`] makes one HTML document of it: styles,
//! script, charts (SVG) and pictures (PNG) are inside, so that it can be sent as it is and asks no network.
//! [`write_report`] lays the numbers of each chart and table beside it as CSV, and the pictures as PNG.
//! [`png::encode`] and [`png::montage`] make pictures alone.
//!
//! Charts are drawn with the `plotters` library, onto a backend of our own whose colours are the style sheet's.

mod chart;
mod check;
mod colours;
mod csv;
mod error;
mod markup;
pub mod page;
mod picture;
pub mod png;
mod render;
mod table;
mod write;

pub use csv::{chart_csv, table_csv};
pub use error::ReportError;
pub use render::{Companions, render, render_with};
pub use write::write_report;
