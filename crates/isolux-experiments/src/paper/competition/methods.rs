//! The competitors: a step over the integration time, a step over the distance.

use isolux::standardize::{Choice, DistanceStep, SpecularStep, TimeStep};
use isolux::{Calibration, Channels, Standardizer};

use crate::error::ExperimentError;

/// One competitor. Highlights are left alone, so that the steps are compared and nothing else.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Competitor {
    /// As the page names it.
    pub(super) name: &'static str,
    time: TimeStep,
    distance: DistanceStep,
}

const fn competitor(name: &'static str, time: TimeStep, distance: DistanceStep) -> Competitor {
    Competitor { name, time, distance }
}

/// The raw amplitude.
pub(super) const RAW: Competitor = competitor("raw", TimeStep::None, DistanceStep::None);
/// `t_ref / t` (Ritt).
pub(super) const LINEAR: Competitor = competitor("linear time (Ritt)", TimeStep::Linear, DistanceStep::None);
/// The paper's table.
pub(super) const LUT: Competitor = competitor("LUT (paper)", TimeStep::Lut, DistanceStep::None);
/// `(d / d_ref)²` (Oprisescu).
pub(super) const SQUARE: Competitor = competitor("d² (Oprisescu)", TimeStep::None, DistanceStep::Square);
/// Eq. 5 of the paper.
pub(super) const EQ5: Competitor = competitor("eq. 5", TimeStep::None, DistanceStep::Eq5);
/// The paper's cubic.
pub(super) const CUBIC: Competitor = competitor("cubic (paper)", TimeStep::None, DistanceStep::Cubic);
/// What everybody writes.
pub(super) const TEXTBOOK: Competitor = competitor("A·d²/t", TimeStep::Linear, DistanceStep::Square);
/// The paper's chain.
pub(super) const PAPER: Competitor = competitor("LUT + cubic (paper)", TimeStep::Lut, DistanceStep::Cubic);

/// Every competitor, in the order of the tables.
pub(super) const ALL: [Competitor; 10] = [
    RAW,
    LINEAR,
    LUT,
    SQUARE,
    EQ5,
    CUBIC,
    TEXTBOOK,
    competitor("LUT + d²", TimeStep::Lut, DistanceStep::Square),
    competitor("linear + cubic", TimeStep::Linear, DistanceStep::Cubic),
    PAPER,
];
/// Those that differ in the distance step alone.
pub(super) const OVER_DISTANCE: [Competitor; 4] = [RAW, SQUARE, EQ5, CUBIC];

impl Competitor {
    /// True when it takes the integration time out.
    pub(super) fn uses_time(self) -> bool {
        self.time != TimeStep::None
    }

    /// True when it takes the distance out.
    pub(super) fn uses_distance(self) -> bool {
        self.distance != DistanceStep::None
    }

    /// The chain of these two steps.
    ///
    /// # Errors
    /// [`ExperimentError::Plan`], which a complete calibration does not bring about.
    pub(super) fn standardizer(self, calibration: &Calibration) -> Result<Standardizer, ExperimentError> {
        let choice = Choice {
            time: Some(self.time),
            distance: Some(self.distance),
            specular: Some(SpecularStep::None),
            ..Choice::paper()
        };
        let channels = Channels::AMPLITUDE | Channels::DISTANCE | Channels::INTEGRATION_TIME;
        Ok(Standardizer::plan(&choice, Some(calibration), channels)?)
    }
}
