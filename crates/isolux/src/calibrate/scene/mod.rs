//! Ordinary recordings without a rig: the same surfaces, each of unknown reflectivity, at several distances, places
//! in the image, angles and integration times (methods, section 4).
//!
//! Every frame is divided into facets, planes through neighbouring pixels. A facet of one reflectivity that is
//! neither dim nor saturated nor at an edge becomes a surface. Later frames look for each known surface where the
//! camera's motion puts it; a facet there is the same surface if distance and normal agree. Positions and normals
//! are means over all frames, because the noise of single distances would distort the law over distance. The
//! recording is read once, and memory is bounded.

mod align;
mod facets;
mod fit;
mod joint_input;
mod lambert;
mod motion;
mod obstacle;
mod report;
mod rigid;
mod scatter;
mod scout;
mod surfaces;
mod sweep;
#[cfg(test)]
mod tests;
mod view;
mod warning;

pub(super) use fit::fit;
pub use motion::{CameraMotion, MotionFinding, Travel};
pub use obstacle::{MotionObstacle, MotionRefusal};
pub use report::{SceneReport, SceneUse};
pub use scout::MotionScout;
pub use sweep::{SceneObservation, SceneObservations, SceneSweep};
pub use warning::SceneWarning;
