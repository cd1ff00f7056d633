//! Observations of all recordings as those of the joint model.

use super::{MotionFinding, SceneObservations};
use crate::calibrate::CalibrateSettings;
use crate::calibrate::joint::{AngleModel, DistanceModel, JointModel, Observation, TimeModel};
use crate::numerics::statistics::median;
use crate::terms::profile::Places;

/// Standard deviation that no amplitude is trusted beyond, in ln: surfaces are uneven, normals uncertain.
const UNEVENNESS: f64 = 0.01;

/// Observations, and what they may be explained by.
#[derive(Clone, Debug)]
pub(super) struct JointInput {
    pub(super) observations: Vec<Observation>,
    pub(super) model: JointModel,
    /// Integration times, µs, increasing; empty where they are unknown.
    pub(super) times_us: Vec<f64>,
}

impl JointInput {
    /// `None` when no recording has an observation.
    pub(super) fn new(settings: &CalibrateSettings, recordings: &[SceneObservations]) -> Option<Self> {
        let first = recordings.iter().find(|recording| !recording.observations.is_empty())?;
        let places = Places::new(first.shape, first.lens.as_ref());
        let times_us = times_us(recordings);
        let mut input = Self {
            observations: Vec::new(),
            model: model(settings, recordings, &times_us, places),
            times_us,
        };
        let usual = usual_variance(recordings);
        let (mut first_surface, mut first_frame) = (0, 0);
        for recording in recordings {
            let (mut surfaces, mut frames) = (0, 0);
            for seen in &recording.observations {
                let time = input.times_us.iter().position(|time| *time == seen.integration_time_us);
                let [row, column] = seen.pixel.map(f64::from);
                input.observations.push(Observation {
                    surface: first_surface + seen.surface,
                    frame: first_frame + seen.frame,
                    time: time.unwrap_or(0) as u16,
                    ln_amplitude: seen.ln_amplitude,
                    distance_m: seen.distance_m,
                    place: places.at(row, column).map(|value| value as f32),
                    cosine: seen.cosine,
                    weight: (usual / variance(seen.sigma)) as f32,
                });
                (surfaces, frames) = (surfaces.max(seen.surface + 1), frames.max(seen.frame + 1));
            }
            (first_surface, first_frame) = (first_surface + surfaces, first_frame + frames);
        }
        Some(input)
    }
}

fn variance(sigma: f32) -> f64 {
    f64::from(sigma).powi(2) + UNEVENNESS * UNEVENNESS
}

/// Median variance: an ordinary observation has the weight 1.
fn usual_variance(recordings: &[SceneObservations]) -> f64 {
    let all = recordings.iter().flat_map(|recording| &recording.observations);
    median(&mut all.map(|seen| variance(seen.sigma)).collect::<Vec<_>>()).unwrap_or(1.0)
}

/// A camera that stands still says nothing of distance, profile and angle.
fn model(
    settings: &CalibrateSettings,
    recordings: &[SceneObservations],
    times_us: &[f64],
    places: Places,
) -> JointModel {
    let used = recordings.iter().filter(|recording| !recording.observations.is_empty());
    let moved = used.into_iter().any(|recording| recording.motion != MotionFinding::Still);
    let reference_us = settings.reference_time_us();
    let away = |index: &usize| (times_us[*index] / reference_us).ln().abs();
    let reference = (0..times_us.len()).min_by(|a, b| away(a).total_cmp(&away(b))).unwrap_or(0);
    JointModel {
        time: (times_us.len() > 1).then_some(TimeModel { count: times_us.len(), reference }),
        distance: moved.then_some(DistanceModel {
            reference_m: settings.reference.distance_m,
            modulation_frequency_hz: settings.modulation_frequency_hz,
        }),
        profile: moved.then_some(places),
        angle: if moved { AngleModel::Free } else { AngleModel::Absent },
        // Thousands of surfaces, each with an error of its own.
        smoothness: 1.0,
    }
}

/// The times of all observations; none where one of them is unknown: then each recording's time is taken to be
/// constant, and the surfaces' levels hold it.
fn times_us(recordings: &[SceneObservations]) -> Vec<f64> {
    let all = recordings.iter().flat_map(|recording| &recording.observations);
    let mut times: Vec<f64> = all.map(|seen| seen.integration_time_us).collect();
    times.sort_by(f64::total_cmp);
    times.dedup();
    if times.iter().all(|time| *time > 0.0 && time.is_finite()) { times } else { Vec::new() }
}
