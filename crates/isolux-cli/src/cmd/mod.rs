//! One file per command.

pub mod calibrate;
pub mod completions;
pub mod demo;
pub mod evaluate;
pub mod info;
pub mod simulate;
pub mod standardize;
