//! Decides where the poses of a recording come from, in a pass before it is measured.

use super::CameraMotion;
use crate::frame::{Frame, IntegrationTime};
use crate::still_scene::MotionWatch;

/// Looks through a recording before it is measured, to find out where its poses come from.
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

    /// Recorded poses if every frame has one; no motion if the distances do not change; else poses that must be
    /// estimated.
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
