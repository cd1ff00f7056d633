//! Standardizes the amplitude images of time-of-flight cameras.
pub mod flags;
pub mod frame;
pub mod geometry;
pub mod phase;
pub mod plane;
pub mod statistics;

pub use flags::PixelFlags;
pub use frame::{Channels, Frame, IntegrationTime};
pub use geometry::Intrinsics;
pub use phase::PhaseConvention;
pub use plane::{Plane, Shape, ShapeError, Window};
