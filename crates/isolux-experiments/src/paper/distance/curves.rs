//! The board's decays, one for each integration time: where over-saturation ends, and how a decay is turned over
//! and brought to the common scale.

use isolux::calibrate::CalibrateError;
use isolux::terms::Cubic;
use isolux::terms::cubic::{Decay, DecayPoint};
use isolux::terms::lut::LutAnswer;

use crate::error::ExperimentError;
use crate::paper::lab::{BoardMean, Lab};

/// The paper's stray integration time, µs.
pub(super) const STRAY_US: f64 = 200.0;
/// What the scaled decays may deviate by.
pub(super) const FLAT_WITHIN: f64 = 0.10;

/// The decay of one integration time, from where over-saturation ends.
pub(super) struct Curve {
    /// Integration time, µs.
    pub(super) integration_time_us: f64,
    /// Positions, the nearest first.
    pub(super) points: Vec<BoardMean>,
    /// Recorded positions before those: nearer than the brightest, so over-saturated.
    pub(super) over_saturated: usize,
    /// True when the curve reaches the reference distance and is normalized there; otherwise it is scaled onto
    /// the pooled cubic.
    pub(super) reaches_reference: bool,
    /// True when the calibration used it.
    pub(super) is_fitted: bool,
    /// Amplitude that the curve has, or would have, at the reference distance, DN.
    pub(super) reference_dn: f64,
    own: Cubic,
    own_scale: f64,
}

impl Curve {
    /// In milliseconds, as legends have it.
    pub(super) fn name(&self) -> String {
        format!("{} ms", self.integration_time_us / 1000.0)
    }

    /// Inverted and normalized amplitude of a point, dimensionless.
    pub(super) fn inverse(&self, point: &BoardMean) -> f64 {
        self.reference_dn / point.amplitude_dn
    }

    /// The curve's own cubic on the same scale.
    pub(super) fn own_cubic(&self, distance_m: f64) -> f64 {
        self.own_scale * multiplier(&self.own, distance_m)
    }

    /// Relative deviations of the inverted points from the pooled cubic.
    pub(super) fn deviations(&self, pooled: &Cubic) -> Vec<f64> {
        let deviation = |point: &BoardMean| self.inverse(point) / multiplier(pooled, point.distance_m) - 1.0;
        self.points.iter().map(deviation).collect()
    }

    /// Points after the distance scaling, DN, of the positions from 0.5 to 3 m.
    pub(super) fn flattened(&self, pooled: &Cubic) -> Vec<(f64, f64)> {
        let inside = self.points.iter().filter(|point| (0.5..=3.0).contains(&rounded(point.true_distance_m)));
        inside.map(|p| (p.distance_m, p.amplitude_dn * multiplier(pooled, p.distance_m))).collect()
    }
}

/// To the millimetre: the true distance comes from an f32 image.
fn rounded(distance_m: f64) -> f64 {
    (1000.0 * distance_m).round() / 1000.0
}

/// The curves, the shortest integration time first.
pub(super) fn curves(lab: &Lab) -> Result<Vec<Curve>, ExperimentError> {
    let mut times: Vec<f64> = lab.board.iter().map(|mean| mean.integration_time_us).collect();
    times.sort_by(f64::total_cmp);
    times.dedup();
    times.into_iter().map(|time_us| curve(lab, time_us)).collect()
}

fn curve(lab: &Lab, integration_time_us: f64) -> Result<Curve, ExperimentError> {
    let pooled = cubic(lab)?;
    let mut points: Vec<BoardMean> =
        lab.board.iter().copied().filter(|mean| mean.integration_time_us == integration_time_us).collect();
    points.sort_by(|a, b| a.true_distance_m.total_cmp(&b.true_distance_m));
    let brightest =
        (0..points.len()).max_by(|&a, &b| points[a].amplitude_dn.total_cmp(&points[b].amplitude_dn));
    let over_saturated = brightest.unwrap_or(0);
    points.drain(..over_saturated);
    let decay = Decay {
        integration_time_us: Some(integration_time_us),
        points: points
            .iter()
            .map(|p| DecayPoint { distance_m: p.distance_m, amplitude_dn: p.amplitude_dn })
            .collect(),
    };
    let reference_m = lab.calibration.reference.distance_m;
    let reaches_reference = points.first().is_some_and(|nearest| nearest.distance_m <= reference_m);
    let middle_m = points.get(points.len() / 2).map_or(f64::NAN, |point| point.distance_m);
    let anchor_m = if reaches_reference { reference_m } else { middle_m };
    let (own, _) = Cubic::fit(std::slice::from_ref(&decay), anchor_m)
        .map_err(|source| CalibrateError::Cubic { source, warnings: Vec::new() })?;
    let anchor_dn = anchor_amplitude_dn(&points, &own);
    let reference_dn = if reaches_reference { anchor_dn } else { onto(&points, pooled) };
    let is_fitted =
        lab.report.decays.iter().any(|(decay, _)| decay.integration_time_us == Some(integration_time_us));
    let own_scale = reference_dn / anchor_dn;
    Ok(Curve {
        integration_time_us,
        points,
        over_saturated,
        reaches_reference,
        is_fitted,
        reference_dn,
        own,
        own_scale,
    })
}

/// Amplitude at the distance where `own` is 1: least squares of the relative errors, as the cubic's fit has it.
fn anchor_amplitude_dn(points: &[BoardMean], own: &Cubic) -> f64 {
    let scaled = || points.iter().map(|p| p.amplitude_dn * multiplier(own, p.distance_m));
    scaled().map(|value| value * value).sum::<f64>() / scaled().sum::<f64>()
}

/// Amplitude at the reference with which the points lie on the pooled cubic, in the geometric mean.
fn onto(points: &[BoardMean], pooled: &Cubic) -> f64 {
    let logs = points.iter().map(|p| (p.amplitude_dn * multiplier(pooled, p.distance_m)).ln());
    (logs.sum::<f64>() / points.len() as f64).exp()
}

/// The fitted cubic.
pub(super) fn cubic(lab: &Lab) -> Result<&Cubic, ExperimentError> {
    let missing = ExperimentError::Scene { scene: "board-distances", missing: "a fitted cubic" };
    lab.calibration.terms.cubic.as_ref().ok_or(missing)
}

/// A cubic at one distance, with its continuation outside the fitted range.
pub(super) fn multiplier(cubic: &Cubic, distance_m: f64) -> f64 {
    f64::from(cubic.distance_law().at(distance_m as f32))
}

/// The table's multiplier for one integration time; NaN where it has none.
pub(super) fn time_multiplier(lab: &Lab, integration_time_us: f64) -> f64 {
    match lab.calibration.terms.lut.as_ref().map(|lut| lut.at(integration_time_us)) {
        Some(LutAnswer::Inside(multiplier) | LutAnswer::Below(multiplier)) => multiplier,
        _ => f64::NAN,
    }
}

/// Amplitude at the reference time and distance, DN.
pub(super) fn reference_amplitude_dn(lab: &Lab, curves: &[Curve]) -> f64 {
    let reference_us = lab.calibration.reference.integration_time_us;
    let curve = curves.iter().find(|curve| Some(curve.integration_time_us) == reference_us);
    curve.map_or(f64::NAN, |curve| curve.reference_dn)
}

/// Median; NaN for none.
pub(super) fn median(mut values: Vec<f64>) -> f64 {
    isolux::statistics::upper_median(&mut values).unwrap_or(f64::NAN)
}
