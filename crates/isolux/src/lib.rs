//! Standardizes the amplitude images of time-of-flight cameras.
pub mod calibrate;
pub mod calibration;
pub mod flags;
pub mod frame;
pub mod geometry;
mod noise;
pub mod phase;
pub mod plane;
mod quantile;
pub mod specular;
pub mod terms;
pub use flags::PixelFlags;
pub use frame::{Channels, Frame, IntegrationTime};
pub use geometry::Intrinsics;
pub use phase::PhaseConvention;
pub use plane::{Plane, Shape, ShapeError, Window};
