//! Measured recordings for the second stage of a calibration.

use super::distance::ReferenceDecays;
use super::scene::SceneObservations;
use super::target::TargetWindows;

/// Measured recordings for the second stage of a calibration, [`ExposureFit::complete`](super::ExposureFit::complete).
///
/// One law over distance cannot describe both linear and saturating amplitudes. The spline is therefore fitted to
/// linear frames if every distance sweep has them, else to the frames as delivered.
#[derive(Clone, Debug, Default)]
pub struct Measurements {
    delivered: Vec<ReferenceDecays>,
    /// The linear measurements of those sweeps that have them.
    linear: Vec<ReferenceDecays>,
    targets: Vec<TargetWindows>,
    scenes: Vec<SceneObservations>,
}

/// Distance sweeps, as they are fitted.
pub(super) struct DistanceSweeps {
    /// Measured on the frames as delivered.
    pub(super) delivered: Vec<ReferenceDecays>,
    /// The same sweeps, measured on linear frames; all of them or none.
    pub(super) linear: Vec<ReferenceDecays>,
}

impl Measurements {
    /// Adds a flat target at several distances, measured twice: on the frames as `delivered`, to which the paper's
    /// cubic is fitted, and, where the response allows it, on the `linear` frames of a
    /// [`FrameLineariser`](crate::standardize::FrameLineariser).
    pub fn add_distance_sweep(&mut self, delivered: ReferenceDecays, linear: Option<ReferenceDecays>) {
        self.delivered.push(delivered);
        self.linear.extend(linear);
    }

    /// Adds labelled targets in any pose, measured on linear frames where the response allows it; see
    /// [`TargetSweep::of_linear_frames`](super::TargetSweep::of_linear_frames).
    pub fn add_target(&mut self, windows: TargetWindows) {
        self.targets.push(windows);
    }

    /// Adds an ordinary recording, measured on linear frames where the response allows it.
    pub fn add_scene(&mut self, observations: SceneObservations) {
        self.scenes.push(observations);
    }

    /// True when nothing was added.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.delivered.is_empty() && self.targets.is_empty() && self.scenes.is_empty()
    }

    /// The same without the linear measurements of distance sweeps, as for a camera that delivers only amplitude
    /// and distance.
    #[must_use]
    pub fn of_delivered_amplitudes(self) -> Self {
        Self { linear: Vec::new(), ..self }
    }

    /// True when the spline will be fitted to linear amplitudes.
    #[must_use]
    pub fn distances_are_linear(&self) -> bool {
        !self.linear.is_empty() && self.linear.len() == self.delivered.len()
    }

    pub(super) fn into_parts(self) -> (DistanceSweeps, Vec<TargetWindows>, Vec<SceneObservations>) {
        let linear = if self.distances_are_linear() { self.linear } else { Vec::new() };
        (DistanceSweeps { delivered: self.delivered, linear }, self.targets, self.scenes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::terms::Source;

    fn decays(name: &str) -> ReferenceDecays {
        let source = Source { recording: name.to_owned(), frames_used: 1, frames_left_out: 0 };
        ReferenceDecays { source, decays: Vec::new(), samples: Vec::new(), warnings: Vec::new() }
    }

    #[test]
    fn distance_sweeps_are_linear_all_together_or_not_at_all() {
        let mut measured = Measurements::default();
        assert!(measured.is_empty() && !measured.distances_are_linear());
        measured.add_distance_sweep(decays("near"), Some(decays("near, linear")));
        assert!(measured.distances_are_linear());
        let (sweeps, ..) = measured.clone().into_parts();
        assert_eq!(sweeps.linear, [decays("near, linear")]);
        measured.add_distance_sweep(decays("far"), None);
        assert!(!measured.distances_are_linear());
        let (sweeps, ..) = measured.into_parts();
        assert_eq!((sweeps.delivered.len(), sweeps.linear.len()), (2, 0));
    }
}
