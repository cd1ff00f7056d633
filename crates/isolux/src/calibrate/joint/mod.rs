//! The joint model: time, distance, illumination profile and angle of incidence, fitted together (methods,
//! section 4): `ln A_n = e_i(n) + s_j(n) + ln h(d_n) + ln v(x_n, y_n) + k ln cosθ_n + ε`.
//!
//! A is the amplitude (DN), s the effect of the integration time, h that of the distance d (m), v the illumination
//! profile over the image, and k the exponent of the cosine of the angle of incidence. Every surface (a material,
//! or one point of a scene) has a level e_i of its own, which is eliminated exactly from the normal equations
//! (Schur complement). The remaining unknowns are about seventy, whatever the number of observations and surfaces.
//! The fit is robust: iteratively reweighted, with Huber's weights first, then Tukey's biweight (c = 4.685 σ, σ =
//! 1.4826 MAD).
//!
//! Smoothness is a prior on curvature (Wahba's reading of smoothing splines): that of ln h over ln d has a standard
//! deviation of about 1, that of the profile's tensor about 0.5 per squared half
//! diagonal. The weight against the observations follows from their own σ.
//!
//! Errors of the factors are those of a fit whose observations share errors within their frame (`Observation::frame`).
//!
//! A recording need not determine every factor. A [`Finding`] says how well the observations determine
//! each factor, and why a factor is refused. The numbers of a refused factor are withheld.

mod columns;
mod conclusion;
#[cfg(test)]
mod coverage_tests;
mod determine;
mod factor;
mod finding;
mod model;
mod problem;
mod refusal;
mod robust;
mod shared_errors;
#[cfg(test)]
mod tests;

pub(crate) use conclusion::JointFit;
pub use factor::Factor;
pub use finding::Finding;
pub use model::JointError;
pub(crate) use model::{AngleModel, DistanceModel, JointModel, Observation, TimeModel};
pub use refusal::{Refusal, Vary};

/// Fits the model to the observations. An observation is left out where a value that the model needs is not finite
/// and positive. Memory: 60 bytes per observation.
///
/// # Errors
/// [`JointError`] when there is nothing to fit, or there are too few observations. A factor that the observations
/// do not determine is no error: see [`JointFit::findings`].
pub(crate) fn solve(observations: &[Observation], model: &JointModel) -> Result<JointFit, JointError> {
    let problem = problem::Problem::new(observations, model)?;
    let robust = robust::solve(&problem)?;
    Ok(conclusion::conclude(&problem, robust))
}
