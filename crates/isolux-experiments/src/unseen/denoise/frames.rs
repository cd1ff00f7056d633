//! Frames at a wanted signal-to-noise ratio, scaled by d² with each rule.

use isolux::standardize::DenoiseStep;
use isolux::{Channels, Choice, DenoiseRule, Frame, Plane, Standardizer};
use isolux_camera::scene::object::Object;
use isolux_camera::scene::run::Run;
use isolux_camera::{CameraModel, Scene, SimulatedFrame, Simulation};

use crate::error::ExperimentError;

/// Signal-to-noise ratio of the amplitude at which the figures are taken.
const SNR: f64 = 4.5;
/// Frames that a figure is the mean of; the temporal rule needs eight before each.
const FRAMES: u32 = 24;
/// Frames before the temporal rule has its full history.
const WARMING: usize = 7;

/// An SR-3100 without profile, wiggling, drift and dead pixels: the noise alone is left.
///
/// # Errors
/// [`ExperimentError`], which nothing should bring about.
pub fn camera() -> Result<CameraModel, ExperimentError> {
    Ok(CameraModel {
        lobe_exponent: 0.0,
        lens_exponent: 0.0,
        third_harmonic: 0.0,
        warm_up_amplitude: 0.0,
        dead_pixel_fraction: 0.0,
        ..CameraModel::preset("sr3100")?
    })
}

fn record(objects: &[Object], time_us: f64, frames: u32) -> Result<Vec<SimulatedFrame>, ExperimentError> {
    let run = Run { integration_times_us: vec![time_us], frames_per_time: frames, ..Run::default() };
    let scene = Scene {
        version: 1,
        name: "denoise".to_owned(),
        description: String::new(),
        camera: "sr3100".to_owned(),
        ambient: 0.5,
        objects: objects.to_vec(),
        runs: vec![run],
    };
    let simulation = Simulation::new(camera()?, scene, 5)?;
    let mut frames = Vec::new();
    simulation.render_frames(0..simulation.len(), &mut frames)?;
    Ok(frames)
}

/// Frames whose amplitude has a signal-to-noise ratio of 4.5 in the pixels that `counts` (by row and column).
///
/// # Errors
/// [`ExperimentError`], which no seed should bring about.
pub fn at_snr(
    objects: &[Object],
    counts: impl Fn(usize, usize) -> bool,
) -> Result<Vec<SimulatedFrame>, ExperimentError> {
    let snr = |time_us: f64| {
        let frames = record(objects, time_us, 2)?;
        let [a, b] = [0, 1].map(|i| counted(&frames[i].frame.amplitude, &counts));
        let sums: Vec<f64> = a.iter().zip(&b).map(|(a, b)| a - b).collect();
        let variance = sums.iter().map(|difference| difference.powi(2)).sum::<f64>() / sums.len() as f64;
        Ok::<f64, ExperimentError>(mean(&a) / (variance / 2.0).sqrt())
    };
    let (mut low_us, mut high_us) = (1.0, 60_000.0f64);
    for _ in 0..20 {
        let middle_us = (low_us * high_us).sqrt();
        if snr(middle_us)? < SNR { low_us = middle_us } else { high_us = middle_us }
    }
    record(objects, high_us, FRAMES)
}

/// Frames scaled by (d / 0.75 m)².
pub(super) struct Scaled {
    pub(super) planes: Vec<Plane<f32>>,
}

impl Scaled {
    /// With the distance as the rule leaves it; with the temporal one those frames with a full history alone.
    pub(super) fn new(frames: &[SimulatedFrame], rule: Option<DenoiseRule>) -> Result<Self, ExperimentError> {
        let mut stream = standardizer(rule)?.stream();
        let mut planes = Vec::new();
        for SimulatedFrame { frame, .. } in frames {
            planes.push(stream.push(frame)?.amplitude.clone());
        }
        if rule == Some(DenoiseRule::Temporal) {
            planes.drain(..WARMING);
        }
        Ok(Self { planes })
    }

    /// With the true distance.
    pub(super) fn perfect(frames: &[SimulatedFrame]) -> Result<Self, ExperimentError> {
        let mut stream = standardizer(None)?.stream();
        let mut planes = Vec::new();
        for SimulatedFrame { frame, truth, .. } in frames {
            let frame = Frame { distance_m: Some(truth.true_distance_m.clone()), ..frame.clone() };
            planes.push(stream.push(&frame)?.amplitude.clone());
        }
        Ok(Self { planes })
    }

    pub(super) fn mean(&self, counts: impl Fn(usize, usize) -> bool + Copy) -> f64 {
        mean(&self.planes.iter().map(|plane| mean(&counted(plane, counts))).collect::<Vec<_>>())
    }

    /// The distance that scaled each frame, and the true one.
    pub(super) fn used_distances<'a>(
        &'a self,
        frames: &'a [SimulatedFrame],
    ) -> impl Iterator<Item = (Plane<f32>, &'a Plane<f32>)> {
        let frames = &frames[frames.len() - self.planes.len()..];
        frames.iter().zip(&self.planes).map(|(simulated, scaled)| {
            let mut used = scaled.clone();
            for (value, raw) in used.values_mut().iter_mut().zip(simulated.frame.amplitude.values()) {
                *value = 0.75 * (*value / raw).sqrt();
            }
            (used, &simulated.truth.true_distance_m)
        })
    }
}

fn standardizer(rule: Option<DenoiseRule>) -> Result<Standardizer, ExperimentError> {
    let channels = Channels::AMPLITUDE | Channels::DISTANCE;
    let choice = Choice { denoise: rule.map(DenoiseStep::Smooth), ..Choice::textbook(channels) };
    Ok(Standardizer::plan(&choice, None, channels)?)
}

/// The values that are there in the pixels that count.
pub(super) fn counted(plane: &Plane<f32>, counts: impl Fn(usize, usize) -> bool) -> Vec<f64> {
    let width = plane.shape().width;
    let values = plane.values().iter().enumerate();
    values.filter(|(i, v)| !v.is_nan() && counts(i / width, i % width)).map(|(_, v)| f64::from(*v)).collect()
}

pub(super) fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}
