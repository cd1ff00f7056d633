//! The camera's motion: recorded, none, or estimated from the surfaces.

use std::collections::BTreeMap;

use super::align::{Lost, align};
use super::obstacle::{MotionObstacle, MotionRefusal};
use super::rigid::Rigid;
use super::surfaces::Surfaces;
use super::view::View;
use crate::calibrate::MeasureError;
use crate::frame::Frame;

/// Where the poses come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CameraMotion {
    /// Every frame has its `world_from_camera`.
    Recorded,
    /// The camera stood still.
    Still,
    /// From the distances: the surfaces of each frame are aligned with those of the frames before.
    Estimated,
}

/// The camera's motion, as it was used.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum MotionFinding {
    /// Poses of the recording.
    Recorded(Travel),
    /// No motion.
    Still,
    /// Poses estimated from the distances.
    Estimated {
        /// How far the camera moved.
        travel: Travel,
        /// Frames that could not be aligned and were left out.
        frames_lost: usize,
        /// Scatter of the surfaces about their places, in expected standard errors, median over the frames.
        residual: f64,
    },
    /// The motion could not be estimated; the recording is not used.
    Refused(MotionRefusal),
}

/// How far a camera moved.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Travel {
    /// Largest distance from its first place, m.
    pub away_m: f64,
    /// Largest turn from its first direction, degrees.
    pub turned_deg: f64,
}

/// Largest share of the frames that may fail to align.
const LOST_SHARE: f64 = 0.5;

/// Recorded poses that differ by less are those of a camera that stands still.
const LEAST_TRAVEL_M: f64 = 1e-3;
const LEAST_TURN_DEG: f64 = 0.05;

/// The poses so far.
#[derive(Clone, Debug)]
pub(super) struct Path {
    motion: CameraMotion,
    /// World from camera, by the number of the frame.
    pub(super) poses: BTreeMap<u32, Rigid>,
    /// The last two poses, the latest first: the next one is where they lead.
    recent: Vec<Rigid>,
    scales: Vec<f64>,
    lost: Vec<Lost>,
}

impl Path {
    pub(super) fn new(motion: CameraMotion) -> Self {
        Self { motion, poses: BTreeMap::new(), recent: Vec::new(), scales: Vec::new(), lost: Vec::new() }
    }

    pub(super) fn is_still(&self) -> bool {
        self.motion == CameraMotion::Still
    }

    /// The next frame's pose, world from camera; `None` where it cannot be estimated. If only the first frame is
    /// known and this one cannot be aligned with it, `surfaces` are cleared and this frame becomes the first.
    pub(super) fn next(
        &mut self,
        number: usize,
        frame: &Frame,
        view: &View,
        surfaces: &mut Surfaces,
    ) -> Result<Option<Rigid>, MeasureError> {
        let pose = match self.motion {
            CameraMotion::Still => Some(Rigid::identity()),
            CameraMotion::Recorded => {
                let rows = frame.world_from_camera.ok_or(MeasureError::NoPose { frame: number })?;
                Some(Rigid::from_rows(&rows).ok_or(MeasureError::NotRigid { frame: number })?)
            }
            CameraMotion::Estimated => self.estimate(view, surfaces),
        };
        if let Some(pose) = pose {
            self.poses.insert(number as u32, pose);
        }
        Ok(pose)
    }

    fn estimate(&mut self, view: &View, surfaces: &mut Surfaces) -> Option<Rigid> {
        let Some(&last) = self.recent.first() else {
            self.recent.push(Rigid::identity());
            return Some(Rigid::identity());
        };
        let led = self.recent.get(1).map(|before| last.after(&before.inverse()).after(&last));
        let guesses: Vec<Rigid> = [last].into_iter().chain(led).collect();
        match align(surfaces, view, &guesses) {
            Ok(aligned) => {
                self.scales.push(aligned.scale);
                self.recent.insert(0, aligned.world_from_camera);
                self.recent.truncate(2);
                Some(aligned.world_from_camera)
            }
            Err(lost) => {
                self.lost.push(lost);
                // After a jump, the motion cannot be predicted: the next frame starts from the last known pose.
                self.recent.truncate(1);
                if self.poses.len() > 1 {
                    return None;
                }
                *surfaces = Surfaces::default();
                self.poses.clear();
                Some(last)
            }
        }
    }

    pub(super) fn finding(&self) -> MotionFinding {
        match self.motion {
            CameraMotion::Recorded => {
                let travel = self.travel();
                let still = travel.away_m < LEAST_TRAVEL_M && travel.turned_deg < LEAST_TURN_DEG;
                if still { MotionFinding::Still } else { MotionFinding::Recorded(travel) }
            }
            CameraMotion::Still => MotionFinding::Still,
            CameraMotion::Estimated => {
                let (aligned, lost) = (self.poses.len(), self.lost.len());
                if lost as f64 > LOST_SHARE * (aligned + lost) as f64 {
                    let reason = MotionObstacle::most_frequent(&self.lost);
                    return MotionFinding::Refused(MotionRefusal { aligned, frames: aligned + lost, reason });
                }
                let residual = crate::numerics::statistics::median(&mut self.scales.clone()).unwrap_or(0.0);
                MotionFinding::Estimated { travel: self.travel(), frames_lost: lost, residual }
            }
        }
    }

    fn travel(&self) -> Travel {
        let Some(first) = self.poses.values().next().map(Rigid::inverse) else { return Travel::default() };
        let mut travel = Travel::default();
        for pose in self.poses.values() {
            let motion = first.after(pose);
            let cosine = (0.5 * (motion.rotation.trace() - 1.0)).clamp(-1.0, 1.0);
            travel.away_m = travel.away_m.max(motion.translation.norm());
            travel.turned_deg = travel.turned_deg.max(cosine.acos().to_degrees());
        }
        travel
    }
}
