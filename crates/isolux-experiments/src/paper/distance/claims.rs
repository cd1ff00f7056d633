//! What the paper states about the decay over the distance, against the numbers.

use isolux::terms::Cubic;
use isolux_report::page::Claim;

use super::curves::{
    Curve, FLAT_WITHIN, STRAY_US, cubic, median, multiplier, reference_amplitude_dn, time_multiplier,
};
use super::rician;
use crate::error::ExperimentError;
use crate::paper::lab::{BoardMean, Lab};
use crate::paper::parts::verdict;

/// A curve strays that deviates this many times more than the rest.
const STRAYS_TIMES: f64 = 3.0;
/// Below this ratio of signal and noise distances are not reliable (methods, section 3).
const LEAST_SIGNAL_TO_NOISE: f64 = 10.0;
/// The floor is measured on the wall, whose own light adds shot noise: 5 % more than on the far board.
const FLOOR_WITHIN: f64 = 0.05;
/// Curves within this (root mean square) of the pooled cubic count as one.
const CLUSTERED_WITHIN: f64 = 0.05;

pub(super) fn claims(lab: &Lab, curves: &[Curve]) -> Result<Vec<Claim>, ExperimentError> {
    let pooled = cubic(lab)?;
    let missing = ExperimentError::Scene { scene: "board-distances", missing: "a decay at 0.2 ms" };
    let stray = curves.iter().find(|curve| curve.integration_time_us == STRAY_US).ok_or(missing)?;
    let fitted: Vec<&Curve> = curves.iter().filter(|curve| curve.is_fitted).collect();
    let (normalized, farther): (Vec<&Curve>, Vec<&Curve>) =
        fitted.iter().partition(|curve| curve.reaches_reference);
    let mut claims = vec![
        starts(curves),
        clustered(&normalized, pooled),
        strays(stray, &fitted, pooled),
        floor_explains(lab, curves, stray, pooled)?,
        little_signal(lab, curves, stray, pooled),
        distances(stray, &fitted),
        flat(&normalized, pooled),
    ];
    claims.extend(farther.iter().map(|curve| flat_near_over_saturation(curve, pooled)));
    claims.push(joined(lab, curves, &normalized, pooled));
    Ok(claims)
}

fn starts(curves: &[Curve]) -> Claim {
    let start = |curve: &Curve| curve.points.first().map_or(f64::NAN, |point| point.true_distance_m);
    let list: Vec<String> =
        curves.iter().map(|curve| format!("{} from {:.2} m", curve.name(), start(curve))).collect();
    let in_order = curves.windows(2).all(|pair| start(&pair[0]) <= start(&pair[1]));
    Claim {
        id: "longer-times-start-farther".to_owned(),
        statement: "Over-saturation bounds the start: shorter integration times start at shorter distances."
            .to_owned(),
        measured: format!("{}.", list.join(", ")),
        value: curves.last().map_or(f64::NAN, start),
        verdict: verdict(in_order, "a longer time starts nearer"),
    }
}

fn clustered(normalized: &[&Curve], pooled: &Cubic) -> Claim {
    let spreads = normalized.iter().map(|curve| root_mean_square(&curve.deviations(pooled)));
    let spread = spreads.fold(0.0, f64::max);
    Claim {
        id: "curves-are-not-tightly-clustered".to_owned(),
        statement:
            "Normalized at 750 mm, the decays of different integration times are not tightly clustered."
                .to_owned(),
        measured: format!(
            "Root mean square deviation from the pooled cubic, worst of the {} curves that reach 750 mm and were \
             fitted: {:.1} %.",
            normalized.len(),
            100.0 * spread
        ),
        value: spread,
        verdict: verdict(
            spread > CLUSTERED_WITHIN,
            "here they are: below saturation the simulated pixel is linear and its distance has no error that \
             depends on the integration time. The real camera has both; the paper gives no number",
        ),
    }
}

fn strays(stray: &Curve, fitted: &[&Curve], pooled: &Cubic) -> Claim {
    let value = mean_deviation(stray, pooled);
    let rest: Vec<f64> = fitted.iter().flat_map(|curve| curve.deviations(pooled)).collect();
    let rest = rest.iter().map(|deviation| deviation.abs()).sum::<f64>() / rest.len() as f64;
    let worst = fitted.iter().map(|curve| (mean_deviation(curve, pooled), curve.name()));
    let (worst, worst_name) = worst.max_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or_default();
    let last = stray.deviations(pooled).last().copied().unwrap_or(f64::NAN);
    Claim {
        id: "shortest-time-strays".to_owned(),
        statement: "The 0.2 ms curve deviates strongly from the rest.".to_owned(),
        measured: format!(
            "Its mean deviation from the pooled cubic is {:.1} % ({:+.0} % at 3 m), that of all other points {:.1} % \
             ({:.1} % at {worst_name}, the worst of them).",
            100.0 * value,
            100.0 * last,
            100.0 * rest,
            100.0 * worst,
        ),
        value,
        verdict: verdict(value > STRAYS_TIMES * rest, "it deviates little more than the others"),
    }
}

fn floor_explains(
    lab: &Lab,
    curves: &[Curve],
    stray: &Curve,
    pooled: &Cubic,
) -> Result<Claim, ExperimentError> {
    let expected = expected_stray(lab, curves, stray)?;
    let errors = stray.points.iter().zip(&expected).map(|(point, dn)| (point.amplitude_dn / dn - 1.0).abs());
    let value = errors.sum::<f64>() / expected.len() as f64;
    let (light, distance) = stray.points.last().map_or((f64::NAN, f64::NAN), |farthest| {
        let without_noise = noise_free_dn(lab, curves, stray, pooled, farthest);
        let at = |distance_m| multiplier(pooled, distance_m);
        (farthest.amplitude_dn / without_noise, at(farthest.distance_m) / at(farthest.true_distance_m))
    });
    Ok(Claim {
        id: "noise-floor-explains-the-stray-curve".to_owned(),
        statement: "Beyond the paper: noise that lengthens the amplitude explains the stray curve."
            .to_owned(),
        measured: format!(
            "The Rician mean, with the noise floor of {:.1} DN that the calibration measured, predicts the 0.2 ms \
             amplitudes to {:.1} % in the mean. At 3 m they are {:.0} % too high for it, and the measured distance \
             asks for {:.0} % too much scaling on top.",
            floor_dn(lab),
            100.0 * value,
            100.0 * (light - 1.0),
            100.0 * (distance - 1.0)
        ),
        value,
        verdict: verdict(value < FLOOR_WITHIN, "the floor predicts other amplitudes"),
    })
}

fn little_signal(lab: &Lab, curves: &[Curve], stray: &Curve, pooled: &Cubic) -> Claim {
    let ratio = |point: &BoardMean| noise_free_dn(lab, curves, stray, pooled, point) / floor_dn(lab);
    let weak = stray.points.iter().find(|point| ratio(point) < LEAST_SIGNAL_TO_NOISE);
    let from_m = weak.map_or(f64::NAN, |point| point.true_distance_m);
    Claim {
        id: "shortest-time-has-little-signal".to_owned(),
        statement: format!(
            "Beyond the paper: at 0.2 ms the signal is less than {LEAST_SIGNAL_TO_NOISE} times the noise."
        ),
        measured: format!(
            "From {from_m:.2} m on; {:.1} times at 3 m.",
            stray.points.last().map_or(f64::NAN, ratio)
        ),
        value: from_m,
        verdict: verdict(from_m.is_finite(), "it is not, at any distance"),
    }
}

fn distances(stray: &Curve, fitted: &[&Curve]) -> Claim {
    let value = largest_distance_error_m(stray);
    let normalized = fitted.iter().filter(|curve| curve.reaches_reference);
    let others = normalized.map(|curve| largest_distance_error_m(curve)).fold(0.0, f64::max);
    Claim {
        id: "shortest-time-has-unreliable-distances".to_owned(),
        statement: "At very short integration times the distances are less reliable.".to_owned(),
        measured: format!(
            "From 0.75 m on, the mean distance of the window at 0.2 ms is wrong by up to {:.0} mm; at the longer \
             times that reach 750 mm by up to {:.0} mm.",
            1000.0 * value,
            1000.0 * others
        ),
        value,
        verdict: verdict(value > STRAYS_TIMES * others, "its distances are as good as the others'"),
    }
}

fn flat(normalized: &[&Curve], pooled: &Cubic) -> Claim {
    let each: Vec<(String, f64)> =
        normalized.iter().map(|curve| (curve.name(), largest_deviation_from_level(curve, pooled))).collect();
    let value = each.iter().map(|(_, deviation)| *deviation).fold(0.0, f64::max);
    let list: Vec<String> =
        each.iter().map(|(name, deviation)| format!("{name} {:.1} %", 100.0 * deviation)).collect();
    Claim {
        id: "decay-is-flat-after-scaling".to_owned(),
        statement: "The scaled decay is flat within 10 % from 0.5 to 3 m.".to_owned(),
        measured: format!(
            "Largest deviation of any position from its curve's median, for the curves that reach 750 mm as the \
             paper's all do: {}.",
            list.join(", ")
        ),
        value,
        verdict: verdict(value <= FLAT_WITHIN, "a curve leaves the band"),
    }
}

/// The curve that starts beyond 750 mm: compressed where it starts.
fn flat_near_over_saturation(curve: &Curve, pooled: &Cubic) -> Claim {
    let value = largest_deviation_from_level(curve, pooled);
    let flat = curve.flattened(pooled);
    let middle = median(flat.iter().map(|(_, dn)| *dn).collect());
    let outside = |(_, dn): &&(f64, f64)| (dn / middle - 1.0).abs() > FLAT_WITHIN;
    let last_outside_m = flat.iter().filter(outside).map(|(distance_m, _)| *distance_m).fold(0.0, f64::max);
    let from_m =
        flat.iter().map(|(distance_m, _)| *distance_m).find(|distance_m| *distance_m > last_outside_m);
    Claim {
        id: format!("decay-is-flat-at-{}-us", curve.integration_time_us),
        statement: format!("The same at {}, which is over-saturated up to 750 mm.", curve.name()),
        measured: format!(
            "It starts at {:.2} m, {:.1} % off its median; from {:.2} m on it stays within 10 %.",
            flat.first().map_or(f64::NAN, |(distance_m, _)| *distance_m),
            100.0 * value,
            from_m.unwrap_or(f64::NAN)
        ),
        value,
        verdict: verdict(
            value <= FLAT_WITHIN,
            "at its brightest position the wells are nearly full: the amplitude is compressed there, and a factor of \
             the distance alone cannot restore it",
        ),
    }
}

fn joined(lab: &Lab, curves: &[Curve], normalized: &[&Curve], pooled: &Cubic) -> Claim {
    let reference_dn = reference_amplitude_dn(lab, curves);
    let deviations = normalized.iter().flat_map(|curve| {
        let time = time_multiplier(lab, curve.integration_time_us);
        curve.flattened(pooled).into_iter().map(move |(_, dn)| (dn * time / reference_dn - 1.0).abs())
    });
    let value = deviations.fold(0.0, f64::max);
    Claim {
        id: "time-scaling-joins-the-curves".to_owned(),
        statement: "With the integration time scaled on top, all curves lie together (dashed, about 0.5)."
            .to_owned(),
        measured: format!(
            "Largest deviation of any position of the curves that reach 750 mm from the amplitude at 8.2 ms and 0.75 m: \
             {:.1} %.",
            100.0 * value
        ),
        value,
        verdict: verdict(value <= FLAT_WITHIN, "a position leaves the band"),
    }
}

/// Mean amplitudes that the noise floor predicts at the shortest time, DN, point by point.
pub(super) fn expected_stray(
    lab: &Lab,
    curves: &[Curve],
    stray: &Curve,
) -> Result<Vec<f64>, ExperimentError> {
    let pooled = cubic(lab)?;
    let expected = |point| rician::mean(noise_free_dn(lab, curves, stray, pooled, point), floor_dn(lab));
    Ok(stray.points.iter().map(expected).collect())
}

/// Amplitude without noise as the calibration has it: that at the reference, over both multipliers, DN.
fn noise_free_dn(lab: &Lab, curves: &[Curve], curve: &Curve, pooled: &Cubic, point: &BoardMean) -> f64 {
    let gain = time_multiplier(lab, curve.integration_time_us) * multiplier(pooled, point.true_distance_m);
    reference_amplitude_dn(lab, curves) / gain
}

/// Noise of the amplitude without light, DN.
fn floor_dn(lab: &Lab) -> f64 {
    lab.calibration.noise_floor.map_or(f64::NAN, |floor| floor.amplitude_sd_dn)
}

/// Mean of the absolute relative deviations of the inverted points from the pooled cubic.
pub(super) fn mean_deviation(curve: &Curve, pooled: &Cubic) -> f64 {
    let deviations = curve.deviations(pooled);
    deviations.iter().map(|deviation| deviation.abs()).sum::<f64>() / deviations.len() as f64
}

/// Largest relative deviation of the scaled points from their median, true distances 0.5 to 3 m.
pub(super) fn largest_deviation_from_level(curve: &Curve, pooled: &Cubic) -> f64 {
    let flat: Vec<f64> = curve.flattened(pooled).into_iter().map(|(_, dn)| dn).collect();
    let middle = median(flat.clone());
    flat.iter().map(|dn| (dn / middle - 1.0).abs()).fold(0.0, f64::max)
}

/// Largest error of a point's mean distance, from 0.75 m on, m.
pub(super) fn largest_distance_error_m(curve: &Curve) -> f64 {
    let far = curve.points.iter().filter(|point| point.true_distance_m > 0.7499);
    far.map(|point| (point.distance_m - point.true_distance_m).abs()).fold(0.0, f64::max)
}

fn root_mean_square(values: &[f64]) -> f64 {
    (values.iter().map(|value| value * value).sum::<f64>() / values.len() as f64).sqrt()
}
