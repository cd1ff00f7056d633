//! What the user decides about a calibration.

use crate::calibration::{REFERENCE_TIME_US, Reference};

/// What the user decides about a calibration.
#[derive(Clone, Debug, PartialEq)]
pub struct CalibrateSettings {
    /// The conditions under which every multiplier is 1. Without an integration time, it is the nearest to that of the
    /// paper, 8200 µs, that all exposure sweeps cover.
    pub reference: Reference,
    /// Side of the central measurement window of a distance sweep, pixels; 20 in the paper.
    pub window_px: usize,
    /// Number of frames that are left out after each change of the integration time; 50 in the paper.
    pub skip_frames: usize,
    /// Integration times to leave out, µs.
    pub exclude_time_us: Vec<f64>,
    /// Modulation frequency of the sweeps, Hz, where it is known. The spline then models the aliased harmonic, and
    /// the response of the raw bins corrects the distance too.
    pub modulation_frequency_hz: Option<f64>,
    /// Whether a calibration is given although its [`Verdict`](super::Verdict) is poor. Else the reason is given
    /// instead.
    pub accept_poor_fit: bool,
}

impl Default for CalibrateSettings {
    fn default() -> Self {
        Self {
            reference: Reference::default(),
            window_px: 20,
            skip_frames: 0,
            exclude_time_us: Vec::new(),
            modulation_frequency_hz: None,
            accept_poor_fit: false,
        }
    }
}

impl CalibrateSettings {
    /// A time is excluded when it equals one of the list to 0.01 %, more than f32 rounding and less than any
    /// camera's step.
    pub(super) fn excludes(&self, integration_time_us: f64) -> bool {
        let same = |excluded: &f64| (integration_time_us / excluded - 1.0).abs() < 1e-4;
        self.exclude_time_us.iter().any(same)
    }

    /// The same with a reference time: that of the user, or else the nearest to the paper's that all ranges (µs) cover;
    /// the paper's where they have nothing in common.
    pub(super) fn with_reference_time(&self, ranges_us: impl Iterator<Item = [f64; 2]>) -> Self {
        let common = |[a, b]: [f64; 2], [c, d]: [f64; 2]| [a.max(c), b.min(d)];
        let covered = ranges_us.reduce(common).filter(|[from, to]| from <= to);
        let nearest = covered.map_or(REFERENCE_TIME_US, |[from, to]| REFERENCE_TIME_US.clamp(from, to));
        let mut settings = self.clone();
        settings.reference.integration_time_us.get_or_insert(nearest);
        settings
    }

    /// The reference time, µs; the paper's where the user gives none.
    pub(super) fn reference_time_us(&self) -> f64 {
        self.reference.integration_time_us.unwrap_or(REFERENCE_TIME_US)
    }
}
