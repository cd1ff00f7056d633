//! Turns results into self-contained HTML pages.
//!
//! A [`page::Page`] holds the contents of a report without their appearance. [`render`] makes one HTML document of
//! it: styles, script, charts (SVG) and pictures (PNG) are inside, so that it can be sent as it is and needs no
//! network. [`write_report`] lays the numbers of each chart and table beside it as CSV, and the pictures as PNG.
//! [`png::encode`] and [`png::montage`] make pictures alone.

mod chart;
mod check;
mod claims;
mod colours;
mod companions;
mod csv;
mod error;
mod markup;
mod numbers;
pub mod page;
mod picture;
pub mod png;
mod render;
mod table;
mod write;

pub use companions::Companions;
pub use csv::{chart_csv, table_csv};
pub use error::ReportError;
pub use render::{render, render_with};
pub use write::write_report;
