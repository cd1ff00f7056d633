//! The joint model: time, distance, illumination profile and angle of incidence, fitted together (methods,
//! section 4): `ln A_n = e_i(n) + s_j(n) + ln h(d_n) + ln v(x_n, y_n) + k ln cosθ_n + ε`.
//!
//! Every surface (a material, or one point of a scene) has a level e_i of its own, which is eliminated from the
//! normal equations exactly (Schur complement); what is left has some seventy unknowns, however many observations
//! and surfaces there are. Robust: iteratively reweighted, Huber's weights first, then Tukey's biweight
//! (c = 4.685 σ, σ = 1.4826 MAD).
//!
//! Smoothness is a prior on curvature (Wahba's reading of smoothing splines): that of ln h over ln d has a standard
//! deviation of about [`LAW_CURVATURE`], that of the profile's tensor about [`PROFILE_CURVATURE`] per squared half
//! diagonal. The weight against the observations follows from their own σ.
//!
//! A recording need not determine every factor. [`JointFit::findings`] says for each what the observations know of it,
//! and why it is refused where they do not; the numbers of a refused factor are not given out.

mod columns;
mod determine;
mod fit;
mod problem;
mod robust;
#[cfg(test)]
mod tests;

pub use determine::{Factor, Finding, Refusal};
pub use fit::{JointFit, LawFit, ProfileFit};

use crate::terms::profile::Places;

/// Standard deviation of the curvature of ln h over ln d: a source as large as the distance bends it by 1, an
/// aliased harmonic of 1 % at eight radians per octave by as much.
pub const LAW_CURVATURE: f64 = 1.0;
/// Standard deviation of the curvature of ln v beside r² and r⁴, per squared half diagonal.
pub const PROFILE_CURVATURE: f64 = 0.5;

/// One amplitude of one surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Observation {
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
pub struct JointModel {
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
pub struct TimeModel {
    /// Number of integration times.
    pub count: usize,
    /// The one at which s = 0.
    pub reference: usize,
}

/// `ln h = −2 ln(d/d_ref) + Σ c_k B_k(ln d) + w_c cos 4φ + w_s sin 4φ`, slope −2 outside the observed distances.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DistanceModel {
    /// Distance at which h = 1, m.
    pub reference_m: f64,
    /// Modulation frequency, Hz, for the aliased harmonic; `None` goes without it.
    pub modulation_frequency_hz: Option<f64>,
}

/// The exponent k of cosθ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AngleModel {
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

/// Fits the model to the observations. Those with a value that is not finite and positive where the model needs it
/// are left out. Memory: 60 bytes per observation.
///
/// # Errors
/// [`JointError`] when there is nothing to fit, or too little to fit it to. A factor that the observations do not
/// determine is no error: see [`JointFit::findings`].
pub fn solve(observations: &[Observation], model: &JointModel) -> Result<JointFit, JointError> {
    let problem = problem::Problem::new(observations, model)?;
    let robust = robust::solve(&problem)?;
    Ok(fit::conclude(&problem, robust))
}
