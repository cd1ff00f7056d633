//! The fitted factors, each normalized to its gauge (1 at its reference).

use super::determine::{Fall, Found, findings};
use super::factor::Factor;
use super::finding::Finding;
use super::model::{AngleModel, JointModel, LAW_CURVATURE};
use super::problem::Problem;
use super::refusal::Refusal;
use super::robust::Robust;
use crate::terms::profile::Map;
use crate::terms::spline::{Harmonic, Law};

/// The fitted factors. Each is `None` where it was not asked for or is refused.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct JointFit {
    /// What was fitted.
    pub model: JointModel,
    /// s of every integration time, 0 at the reference.
    pub ln_time: Option<Vec<f64>>,
    /// The law over distance.
    pub distance: Option<Law>,
    /// The illumination profile.
    pub profile: Option<ProfileFit>,
    /// k, where it was fitted.
    pub angle_exponent: Option<f64>,
    /// How well the observations determine each fitted factor, and which factors are refused.
    pub findings: Vec<Finding>,
    /// How far the law falls, also where it is refused; `None` where it was not asked for.
    pub fall: Option<Fall>,
    /// Number of unknowns, without the surfaces' levels.
    pub unknowns: usize,
    /// Rank of the reduced normal matrix, columns of unit length, eigenvalues above 1e-9 of the largest. Constants,
    /// which the levels take up, and r² and r⁴, which the tensor nearly holds, are expected to be missing.
    pub rank: usize,
    /// Surfaces with two observations or more.
    pub surfaces: usize,
    /// Robust standard deviation of an observation of weight 1, in ln.
    pub sigma: f64,
    /// Residual of each observation, in ln, in the order given; NaN where it did not count.
    pub residuals: Vec<f64>,
    /// Its robust weight, 0 to 1 times its own.
    pub weights: Vec<f64>,
}

/// A fitted illumination profile.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ProfileFit {
    /// The map, in gauge: ln v is 0 at the origin.
    pub map: Map,
    /// Standard error of ln v in each of the [`Places::CELLS`](crate::terms::profile::Places::CELLS); `None` where
    /// nothing was seen.
    pub cell_errors: Vec<Option<f64>>,
}

impl JointFit {
    /// Why a fitted factor is withheld; `None` where it is not.
    #[must_use]
    pub(crate) fn refusal(&self, factor: Factor) -> Option<&Refusal> {
        self.findings.iter().find(|finding| finding.factor == factor).and_then(|f| f.refusal.as_ref())
    }

    /// True when no fitted factor is refused.
    #[cfg(test)]
    #[must_use]
    pub(crate) fn is_determined(&self) -> bool {
        self.findings.iter().all(|finding| finding.refusal.is_none())
    }
}

pub(super) fn conclude(problem: &Problem, robust: Robust) -> JointFit {
    let Found { findings, cell_errors, fall } = findings(problem, &robust);
    let model = problem.columns.model;
    let given =
        |factor: Factor| findings.iter().any(|finding| finding.factor == factor && finding.refusal.is_none());
    let (residuals, weights) = scattered(problem, &robust);
    JointFit {
        ln_time: given(Factor::Time).then(|| ln_time(problem, &robust)),
        distance: given(Factor::Distance).then(|| law(problem, &robust)).flatten(),
        profile: given(Factor::Profile).then(|| profile(problem, &robust, cell_errors)).flatten(),
        angle_exponent: given(Factor::Angle)
            .then(|| robust.coefficients[problem.columns.angle.start])
            .filter(|_| model.angle == AngleModel::Free),
        model,
        fall,
        unknowns: problem.columns.len,
        rank: rank(&robust),
        surfaces: problem.surfaces(),
        sigma: robust.sigma,
        residuals,
        weights,
        findings,
    }
}

fn ln_time(problem: &Problem, robust: &Robust) -> Vec<f64> {
    let times = &robust.coefficients.as_slice()[problem.columns.times.clone()];
    let reference = problem.columns.model.time.map_or(0, |time| time.reference);
    times.iter().map(|s| s - times[reference]).collect()
}

fn law(problem: &Problem, robust: &Robust) -> Option<Law> {
    let columns = &problem.columns;
    let (ends, _) = columns.distance?;
    let law = columns.model.distance?;
    let coefficients = robust.coefficients.as_slice();
    // B-splines sum to 1: subtracting a constant from all coefficients subtracts it from ln h.
    let gauge = columns.at_distance(law.reference_m).dot(coefficients);
    let harmonic = law.modulation_frequency_hz.map(|modulation_frequency_hz| Harmonic {
        modulation_frequency_hz,
        cosine: coefficients[columns.harmonic.start],
        sine: coefficients[columns.harmonic.start + 1],
    });
    Some(Law {
        reference_distance_m: law.reference_m,
        valid_distance_m: ends.map(f64::exp),
        coefficients: coefficients[columns.law.clone()].iter().map(|c| c - gauge).collect(),
        harmonic,
        curvature_weight: columns.model.smoothness * (robust.sigma / LAW_CURVATURE).powi(2)
            / robust.normal.total,
    })
}

fn profile(problem: &Problem, robust: &Robust, cell_errors: Vec<Option<f64>>) -> Option<ProfileFit> {
    let columns = &problem.columns;
    columns.surface?;
    let coefficients = robust.coefficients.as_slice();
    let gauge = columns.at_place([0.0; 2]).dot(coefficients);
    let map = Map {
        places: columns.model.profile?,
        radial: [coefficients[columns.radial.start], coefficients[columns.radial.start + 1]],
        tensor: coefficients[columns.tensor.clone()].iter().map(|c| c - gauge).collect(),
    };
    Some(ProfileFit { map, cell_errors })
}

fn rank(robust: &Robust) -> usize {
    const LEAST: f64 = 1e-9;
    let gram = &robust.normal.gram;
    // Columns are at most about 1; what the elimination leaves of a constant column is rounding.
    let rounding = 1e-10 * robust.normal.total;
    let length = |i: usize| Some(gram[(i, i)]).filter(|square| *square > rounding).map_or(0.0, f64::sqrt);
    let unit = nalgebra::DMatrix::from_fn(gram.nrows(), gram.ncols(), |i, j| {
        let lengths = length(i) * length(j);
        if lengths > 0.0 { gram[(i, j)] / lengths } else { 0.0 }
    });
    let eigenvalues = unit.symmetric_eigenvalues();
    let largest = eigenvalues.max();
    eigenvalues.iter().filter(|value| **value > LEAST * largest).count()
}

/// Residuals and weights in the caller's order.
fn scattered(problem: &Problem, robust: &Robust) -> (Vec<f64>, Vec<f64>) {
    let (mut residuals, mut weights) = (vec![f64::NAN; problem.given], vec![0.0; problem.given]);
    for ((&number, residual), weight) in problem.numbers.iter().zip(&robust.residuals).zip(&robust.weights) {
        residuals[number as usize] = *residual;
        weights[number as usize] = *weight;
    }
    (residuals, weights)
}
