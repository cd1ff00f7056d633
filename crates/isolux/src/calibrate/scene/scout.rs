//! A first look at a recording: where will its poses come from?

use super::CameraMotion;
use crate::frame::{Frame, IntegrationTime};
use crate::still_scene::MotionWatch;

/// Goes through a recording before it is measured.
#[derive(Clone, Debug, Default)]
pub struct MotionScout {
    frames: usize,
    posed: usize,
    watch: MotionWatch,
}

impl MotionScout {
    /// Looks at the next frame: its distances, amplitude, integration time and pose.
    pub fn push(&mut self, frame: &Frame) {
        self.frames += 1;
        self.posed += usize::from(frame.world_from_camera.is_some());
        let time_us = match frame.integration_time_us {
            IntegrationTime::PerFrame(time_us) => time_us,
            // A time that never changes serves as well.
            IntegrationTime::Unknown | IntegrationTime::PerPixel(_) => 1.0,
        };
        self.watch.push(time_us, frame);
    }

    /// Poses where every frame has one; no motion where the distances stay as they are; otherwise to be estimated.
    #[must_use]
    pub fn verdict(&self) -> CameraMotion {
        if self.frames > 0 && self.posed == self.frames {
            CameraMotion::Recorded
        } else if self.watch.verdict().is_none() {
            CameraMotion::Still
        } else {
            CameraMotion::Estimated
        }
    }
}
