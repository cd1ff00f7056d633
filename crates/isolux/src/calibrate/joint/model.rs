//! Observations, the model that is fitted to them, and why a fit fails.

use crate::terms::profile::Places;

/// Standard deviation of the curvature of ln h over ln d: a source as large as the distance bends it by 1, an
/// aliased harmonic of 1 % at eight radians per octave by as much.
pub(super) const LAW_CURVATURE: f64 = 1.0;
/// Standard deviation of the curvature of ln v beside r² and r⁴, per squared half diagonal.
pub(super) const PROFILE_CURVATURE: f64 = 0.5;

/// One amplitude of one surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Observation {
    /// Which surface: equal numbers share one unknown brightness e_i. Numbers should be dense: memory grows with
    /// the largest.
    pub surface: u32,
    /// Number of the frame, counted through all recordings. The observations of one frame may share errors: those of
    /// its pose.
    pub frame: u32,
    /// Which integration time, or which of the frames whose time is unknown; 0 where [`JointModel::time`] is absent.
    pub time: u16,
    /// ln of the amplitude (DN), corrected for saturation where that is possible.
    pub ln_amplitude: f32,
    /// Radial distance, m; not used where [`JointModel::distance`] is absent.
    pub distance_m: f32,
    /// [`Places::at`] of the pixel; not used where [`JointModel::profile`] is absent.
    pub place: [f32; 2],
    /// Cosine of the angle of incidence; not used where [`AngleModel::Absent`].
    pub cosine: f32,
    /// Relative weight, proportional to the inverse variance; 1 for an ordinary observation. With the weight 0 the
    /// observation does not enter the fit, but gets a residual, which tests the prediction.
    pub weight: f32,
}

/// The factors that are fitted. A factor that is left out is assumed to be constant, or to be removed from
/// `ln_amplitude` already.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct JointModel {
    /// Integration times.
    pub time: Option<TimeModel>,
    /// Law over distance.
    pub distance: Option<DistanceModel>,
    /// Illumination profile, with the coordinates of `place`.
    pub profile: Option<Places>,
    /// Angle of incidence.
    pub angle: AngleModel,
    /// Factor on the weight of the curvatures' prior, 1 for independent errors. Use more where many observations
    /// (those of one frame, say) share errors.
    pub smoothness: f64,
}

/// One factor s_j per integration time, and for each frame whose time is unknown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct TimeModel {
    /// Number of integration times.
    pub count: usize,
    /// The one at which s = 0.
    pub reference: usize,
    /// True where factors are those of frames: then they are no curve over the time.
    pub of_frames: bool,
}

/// `ln h = −2 ln(d/d_ref) + Σ c_k B_k(ln d) + w_c cos 4φ + w_s sin 4φ`, slope −2 outside the observed distances.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct DistanceModel {
    /// Distance at which h = 1, m.
    pub reference_m: f64,
    /// Modulation frequency, Hz, for the aliased harmonic; `None` goes without it.
    pub modulation_frequency_hz: Option<f64>,
}

/// The exponent k of cosθ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum AngleModel {
    /// Fitted.
    Free,
    /// Known; 1 is Lambert's.
    Fixed(f64),
    /// The angle has no effect (k = 0), and no cosine is needed.
    Absent,
}

/// Why the model cannot be fitted at all.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum JointError {
    /// Nothing to fit, or a model that contradicts itself.
    #[error("{found} found, {expected} expected")]
    Model {
        /// The model that was asked for.
        found: String,
        /// What can be fitted.
        expected: &'static str,
    },
    /// Too few observations.
    #[error(
        "{found} usable observations of surfaces that are seen more than once found, at least {expected} expected"
    )]
    TooFew {
        /// Number found.
        found: usize,
        /// Unknowns beside the surfaces' brightnesses.
        expected: usize,
    },
    /// The arithmetic failed.
    #[error(
        "the observations cannot be fitted: the normal equations of {unknowns} unknowns have no solution"
    )]
    Unsolvable {
        /// Number of unknowns.
        unknowns: usize,
    },
}
