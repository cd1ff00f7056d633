//! A still scene over integration times that does not saturate: how near a chain comes to what the camera's noise
//! allows.

use isolux::evaluate::{Comparison, EvaluationFrame, EvaluationSettings, Evaluator, SnrStratum};
use isolux::{PixelFlags, Plane, Stream};
use isolux_camera::{CameraModel, Scene, SimulatedFrame, Simulation};

use super::chains::Chain;
use super::held_out::{HeldOut, MEASURED};
use super::light;
use crate::error::ExperimentError;
use crate::measure::{for_each, time_us};

/// Integration times at which no random camera saturates on the desk, µs.
const TIMES_US: [f64; 6] = [1000.0, 2000.0, 4000.0, 8000.0, 12_000.0, 16_000.0];

/// What a chain leaves of a still scene over the integration times.
#[derive(Clone, Debug, PartialEq)]
pub struct Still {
    /// Median over the pixels of the coefficient of variation over integration times.
    pub median_cv: f64,
    /// The same, 95 % quantile.
    pub p95_cv: f64,
    /// Share of the pixels that the chain gives a value, of those that the camera measured.
    pub valid: f64,
    /// The median by the raw amplitude's signal-to-noise ratio; empty where that is not known.
    pub by_snr: Vec<SnrStratum>,
}

/// A held-out camera before the desk.
#[derive(Clone, Debug, PartialEq)]
pub struct StillScene {
    /// The same frames with the true factors: the noise floor.
    pub floor: Still,
    /// Every chain, in their order.
    pub chains: Vec<Still>,
    /// 5 % quantile of the share of its linear amplitude that a pixel keeps at the longest time.
    pub kept: f64,
}

/// Measures every chain on the same pixels.
///
/// # Errors
/// [`ExperimentError`], which no seed should bring about.
pub fn measure(held_out: &HeldOut, chains: &[Chain]) -> Result<StillScene, ExperimentError> {
    let mut scene = Scene::builtin("office-desk")?;
    for run in &mut scene.runs {
        run.integration_times_us = TIMES_US.to_vec();
    }
    let simulation = Simulation::new(held_out.model.clone(), scene, MEASURED)?;
    let light = light::estimate(&held_out.from_amplitude, &simulation, light::poses(&simulation))?;
    let plan = |chain: &Chain| Ok::<Stream, ExperimentError>(chain.plan(held_out, light.as_ref())?.stream());
    let mut streams: Vec<Stream> = chains.iter().map(plan).collect::<Result<_, _>>()?;
    let shape = simulation.shape();
    let evaluator = || Evaluator::new(shape, EvaluationSettings::default());
    let mut raw = evaluator();
    let mut evaluators: Vec<Evaluator> = (0..=chains.len()).map(|_| evaluator()).collect();
    let mut valid = vec![0usize; chains.len()];
    let (mut measured, mut kept) = (0, f64::NAN);
    for_each(&simulation, |_, simulated| {
        let frame = &simulated.frame;
        let mut shared: Plane<PixelFlags> = frame.flags.clone();
        measured += frame.flags.values().iter().filter(|flags| !flags.contains(PixelFlags::INVALID)).count();
        for (stream, valid) in streams.iter_mut().zip(&mut valid) {
            let out = stream.push(frame)?;
            *valid += out.summary.valid;
            shared.values_mut().iter_mut().zip(out.flags.values()).for_each(|(shared, own)| *shared |= *own);
        }
        let truth = true_factors(&held_out.model, &held_out.calibration, simulated);
        raw.push(&EvaluationFrame::of_standardized(frame, &frame.amplitude, &shared))?;
        let planes = std::iter::once(&truth).chain(streams.iter().map(|stream| &stream.last().amplitude));
        for (evaluator, plane) in evaluators.iter_mut().zip(planes) {
            evaluator.push(&EvaluationFrame::of_standardized(frame, plane, &shared))?;
        }
        kept = crate::measure::kept(&simulated.truth);
        Ok(())
    })?;
    let still = |evaluator: &Evaluator, valid: usize| {
        let evaluation = Comparison::new(&raw, evaluator).after;
        Still {
            median_cv: evaluation.pixel_cv.as_ref().map_or(f64::NAN, |cv| cv.median),
            p95_cv: evaluation.pixel_cv.as_ref().map_or(f64::NAN, |cv| cv.p95),
            valid: valid as f64 / measured as f64,
            by_snr: evaluation.pixel_cv_by_snr.unwrap_or_default(),
        }
    };
    let floor = still(&evaluators[0], measured);
    let chains =
        evaluators[1..].iter().zip(&valid).map(|(evaluator, valid)| still(evaluator, *valid)).collect();
    Ok(StillScene { floor, chains, kept })
}

/// The frame's own noisy amplitude, times the true factors of its time and true distance.
fn true_factors(
    model: &CameraModel,
    calibration: &isolux::Calibration,
    simulated: &SimulatedFrame,
) -> Plane<f32> {
    let mut out = simulated.frame.amplitude.clone();
    let Some(time_us) = time_us(&simulated.frame) else { return out };
    let reference_us = calibration.reference.integration_time_us.unwrap_or(f64::NAN);
    let reference_m = calibration.reference.distance_m;
    let time = reference_us / time_us;
    for (value, distance_m) in out.values_mut().iter_mut().zip(simulated.truth.true_distance_m.values()) {
        let response = model.distance_response(f64::from(*distance_m), reference_m);
        *value = (f64::from(*value) * time / response) as f32;
    }
    out
}
