//! Recordings in, results out: the library between files and the core of isolux.
//!
//! | call | what goes in | what comes out | more in |
//! |---|---|---|---|
//! | [`plan()`] | a choice of steps, a recording | a planned chain | |
//! | [`standardize()`] | a recording, a chain | standardized frames, in order, in a [`standardize::FrameSink`] | [`mod@standardize`] |
//! | [`Brackets::plan`] | a recording | the groups of frames that are merged into one | |
//! | [`calibrate()`] | sweeps, targets, scenes | a calibration | [`mod@calibrate`] |
//! | [`assess()`] | a recording, a chain | figures before and after, beside the textbook's and the paper's chain | [`mod@assess`] |
//! | [`diagnose()`] | a recording | whether it is raw, corrected, clipped | |
//! | [`inspect()`] | a recording | what in a few of its frames contradicts what it says of itself | |
//! | [`overview()`] | a recording | its channels, times and ranges of values | [`mod@overview`] |
//! | [`page::page`] | an assessment | a page about it, or its figures in words | [`page`], [`figures`] |
//! | [`simulate::record`] | a simulated scene | a recording | [`simulate`] |
//!
//! Recordings are [`FrameSource`]s, as are frames in memory ([`FramesInMemory`]) and those of the simulated camera
//! ([`simulate::SimulatedFrames`]). The caller passes an [`Observer`], which receives
//! progress and remarks and may cancel. This crate does not print, parse a command line or end the process.
//!
//! ```
//! use isolux::Choice;
//! use isolux_camera::{CameraModel, Scene, Simulation};
//! use isolux_pipeline::{NativeSink, Observer, Remark, StandardizeOptions, Work, plan, standardize};
//!
//! /// Says on a terminal what goes on.
//! struct Terminal;
//!
//! impl Observer for Terminal {
//!     fn progress(&self, work: Work, done: usize, total: Option<usize>) {
//!         eprintln!("{work}: {done} of {total:?}");
//!     }
//!
//!     fn remark(&self, remark: Remark) {
//!         eprintln!("{remark}");
//!     }
//! }
//!
//! let folder = tempfile::tempdir()?;
//! # let scene = Scene::builtin("wall-sweep-smoke")?;
//! # let simulation = Simulation::new(CameraModel::preset(&scene.camera)?, scene, 1)?;
//! # let extras = isolux_pipeline::simulate::Extras::default();
//! # isolux_pipeline::simulate::record(&simulation, extras, &folder.path().join("wall"), false, &Terminal)?;
//! let mut recording = isolux_io::open(&folder.path().join("wall"))?;
//! let chain = plan(&Choice::default(), None, &mut recording, &Terminal)?;
//! let mut sink = NativeSink::new(&folder.path().join("standardized"), false);
//! let options = StandardizeOptions::default();
//! let summary = standardize(&mut recording, &chain, &options, &mut sink, &Terminal)?;
//! assert_eq!(Some(summary.frames), recording.metadata().frame_count);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod assess;
mod brackets;
pub mod calibrate;
mod diagnose;
mod error;
pub mod figures;
mod frames;
mod inspect;
mod observer;
pub mod overview;
pub mod page;
mod plan;
mod remark;
pub mod simulate;
mod source;
pub mod standardize;

pub use assess::{AssessOptions, Assessment, assess};
pub use brackets::Brackets;
pub use calibrate::{CalibrationPaths, CalibrationSources, calibrate};
pub use diagnose::diagnose;
pub use error::{FrameError, PipelineError};
pub use inspect::inspect;
pub use observer::{Observer, Unobserved, Work};
pub use overview::{Overview, overview};
pub use plan::{plan, plan_with};
pub use remark::{Remark, Severity};
pub use source::{FrameSource, FramesInMemory, SourceFacts};
pub use standardize::{NativeSink, StandardizeOptions, Summary, standardize};

/// The library example of the README, compiled as a test.
#[cfg(doctest)]
#[doc = include_str!("../../../README.md")]
struct Readme;
