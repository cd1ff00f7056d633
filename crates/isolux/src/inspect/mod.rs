//! Does a recording mean what it says? A quick look at some of its frames, before anything is computed from them.
//!
//! Codes that no description names, distances in another unit, exposures that changed unrecorded: each makes every
//! result wrong without an error. An [`Inspector`] takes a few frames, compares them with what the recording
//! [claims](Claims) and with physics, and names each contradiction as a [`Suspicion`], with the figure that shows it and
//! the [`Advice`](crate::Advice) that says what to write or do. [`diagnose`](crate::diagnose) looks at all frames and
//! tells more.
//!
//! One file for each kind of suspicion. A recording that means what it says raises none: the limits are set so that
//! what noise and scenes do stays below them.
//!
//! ```
//! use isolux::inspect::{Claims, Inspector, Suspicion};
//! use isolux::{Frame, Plane, Shape};
//!
//! let shape = Shape::new(32, 32);
//! let mut frame = Frame::new(shape);
//! let value = |row: usize, column: usize| (100 + 7 * row + 3 * column) as f32;
//! frame.amplitude = Plane::from_fn(shape, |row, column| if row == 5 { 65535.0 } else { value(row, column) });
//! frame.flag_amplitude(None);
//! let mut inspector = Inspector::new(shape, Claims::default());
//! inspector.push(&frame)?;
//! assert!(matches!(inspector.finish()[..], [Suspicion::AmplitudeCode { value_dn: 65535.0, .. }]));
//! # Ok::<(), isolux::ShapeError>(())
//! ```

mod claims;
mod clip;
mod dark;
mod distances;
mod exponents;
mod exposure;
mod extreme;
mod inspector;
mod lens;
mod phase;
mod suspicion;
mod times;

pub use claims::Claims;
pub use inspector::Inspector;
pub use phase::{PhaseEvidence, PhaseFault};
pub use suspicion::Suspicion;
