//! What is observed, what is fitted to it, and why it cannot be.

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
    /// Which integration time; 0 where [`JointModel::time`] is absent.
    pub time: u16,
    /// ln of the amplitude (DN), linearised where it compresses.
    pub ln_amplitude: f32,
    /// Radial distance, m; not used where [`JointModel::distance`] is absent.
    pub distance_m: f32,
    /// [`Places::at`] of the pixel; not used where [`JointModel::profile`] is absent.
    pub place: [f32; 2],
    /// Cosine of the angle of incidence; not used where [`AngleModel::Absent`].
    pub cosine: f32,
    /// Relative weight, 1 for an ordinary observation: inverse variance against the others'. With 0 it takes no part,
    /// but its residual is told: a prediction.
    pub weight: f32,
}

/// What is fitted. What is left out is taken to be constant, or to be in `ln_amplitude` already.
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
    /// Factor on the weight of the curvatures' prior, 1 for independent errors. Errors that many observations share
    /// (those of one frame, say) ask for more.
    pub smoothness: f64,
}

/// One factor s_j per integration time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct TimeModel {
    /// Number of integration times.
    pub count: usize,
    /// The one at which s = 0.
    pub reference: usize,
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
    /// The angle plays no part (k = 0), and no cosine is needed.
    Absent,
}

/// Why there is no fit at all.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum JointError {
    /// Nothing to fit, or a model that contradicts itself.
    #[error("{found} found, {expected} expected")]
    Model {
        /// What was asked for.
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
