//! One file per command.

pub(crate) mod calibrate;
pub(crate) mod completions;
pub(crate) mod demo;
pub(crate) mod diagnose;
pub(crate) mod evaluate;
pub(crate) mod figures;
pub(crate) mod info;
pub(crate) mod paper;
pub(crate) mod simulate;
pub(crate) mod standardize;
