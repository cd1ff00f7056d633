//! Turns results into self-contained HTML pages.
pub mod page;
