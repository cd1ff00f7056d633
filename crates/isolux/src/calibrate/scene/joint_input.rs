//! Observations of all recordings as those of the joint model.

use super::sweep::SceneObservation;
use super::{MotionFinding, SceneObservations};
use crate::calibrate::CalibrateSettings;
use crate::calibrate::joint::{AngleModel, DistanceModel, JointModel, Observation};
use crate::calibrate::levels::Levels;
use crate::numerics::statistics::median;
use crate::terms::profile::Places;

/// Standard deviation that no amplitude is trusted beyond, in ln: surfaces are uneven, normals uncertain.
const UNEVENNESS: f64 = 0.01;

/// Observations, and what they may be explained by.
#[derive(Clone, Debug)]
pub(super) struct JointInput {
    pub(super) observations: Vec<Observation>,
    pub(super) model: JointModel,
    /// Their exposures.
    pub(super) levels: Levels,
}

impl JointInput {
    /// `None` when no recording has an observation.
    pub(super) fn new(settings: &CalibrateSettings, recordings: &[SceneObservations]) -> Option<Self> {
        let first = recordings.iter().find(|recording| !recording.observations.is_empty())?;
        let places = Places::new(first.shape, first.lens.as_ref());
        let levels = levels(recordings);
        let mut input =
            Self { observations: Vec::new(), model: model(settings, recordings, &levels, places), levels };
        let usual = usual_variance(recordings);
        let (mut first_surface, mut first_frame) = (0, 0);
        for recording in recordings {
            let (mut surfaces, mut frames) = (0, 0);
            for seen in &recording.observations {
                let frame = first_frame + seen.frame;
                let level = input.levels.of(seen.integration_time_us, frame);
                let [row, column] = seen.pixel.map(f64::from);
                input.observations.push(Observation {
                    surface: first_surface + seen.surface,
                    frame,
                    time: level.unwrap_or(0),
                    ln_amplitude: seen.ln_amplitude,
                    distance_m: seen.distance_m,
                    place: places.at(row, column).map(|value| value as f32),
                    cosine: seen.cosine,
                    weight: level.map_or(0.0, |_| (usual / variance(seen.sigma)) as f32),
                });
                (surfaces, frames) = (surfaces.max(seen.surface + 1), frames.max(seen.frame + 1));
            }
            (first_surface, first_frame) = (first_surface + surfaces, first_frame + frames);
        }
        Some(input)
    }

    /// The same where nothing is known of the exposures: each frame has a level of its own.
    pub(super) fn with_levels_of_frames(&self) -> Self {
        let levels = Levels::new(self.observations.iter().map(|seen| (f64::NAN, seen.frame)));
        let model = JointModel { time: levels.model(f64::NAN), ..self.model };
        let mut observations = self.observations.clone();
        for seen in &mut observations {
            let level = levels.of(f64::NAN, seen.frame);
            seen.time = level.unwrap_or(0);
            seen.weight *= f32::from(u8::from(level.is_some()));
        }
        Self { observations, model, levels }
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
    levels: &Levels,
    places: Places,
) -> JointModel {
    let used = recordings.iter().filter(|recording| !recording.observations.is_empty());
    let moved = used.into_iter().any(|recording| recording.motion != MotionFinding::Still);
    JointModel {
        // Where nothing else is asked for, levels of frames tell nothing.
        time: levels.model(settings.reference_time_us()).filter(|time| moved || !time.of_frames),
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

/// The exposures of all observations, frames counted through all recordings.
fn levels(recordings: &[SceneObservations]) -> Levels {
    let mut first_frame = 0;
    let of = |recording: &SceneObservations| {
        let first = first_frame;
        first_frame += recording.observations.iter().map(|seen| seen.frame + 1).max().unwrap_or(0);
        let of_frame = move |seen: &SceneObservation| (seen.integration_time_us, first + seen.frame);
        recording.observations.iter().map(of_frame).collect::<Vec<_>>()
    };
    Levels::new(recordings.iter().flat_map(of))
}
