//! Ordinary recordings without a rig: the same surfaces at several distances, places in the image, angles
//! and integration times, each of a reflectivity that nobody knows (methods, section 4).
//!
//! Every frame is cut into facets (planes through neighbours). Facets that are plain, neither dim nor saturated nor
//! at an edge, become surfaces; later frames look for known surfaces where the camera's motion puts them and take
//! what they see there for the same, if distance and normal agree. Places and normals are means over all frames,
//! because the noise of a single distance would bend the law over distance. One pass; memory is bounded.

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
