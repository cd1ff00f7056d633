//! A still scene over the integration times: means before and after the table.

use isolux::calibration::REFERENCE_TIME_US;
use isolux::standardize::{DistanceStep, SpecularStep, TimeStep};
use isolux::{IntegrationTime, Plane, Window};
use isolux_camera::Scene;
use isolux_camera::scene::run::RegisterRange;

use crate::error::ExperimentError;
use crate::measure::{coefficient_of_variation, for_each, mean, mean_amplitude, regions, simulation_of};
use crate::paper::lab::Lab;

/// Last register of the paper's table, 27.2 ms.
const LAST_REGISTER: u32 = 135;
/// Frames that pass unrecorded after each change.
const SKIPPED_FRAMES: u32 = 50;

/// The two scenes.
pub(super) const SCENES: [Subject; 2] = [
    Subject { scene: "office-desk", short: "scene 1", figure: 8, words: "scene 1, a desk" },
    Subject { scene: "office-shelf", short: "scene 2", figure: 9, words: "scene 2, a corner with a shelf" },
];

pub(super) struct Subject {
    pub(super) scene: &'static str,
    /// Its name in a table.
    pub(super) short: &'static str,
    /// Figure of its means.
    pub(super) figure: u32,
    pub(super) words: &'static str,
}

/// One scene over the integration times.
pub(super) struct Sweep {
    pub(super) subject: &'static Subject,
    pub(super) times_us: Vec<f64>,
    pub(super) regions: Vec<Region>,
    /// Raw amplitude at the reference time.
    pub(super) picture: Plane<f32>,
}

/// Means of one region, one per integration time, DN.
pub(super) struct Region {
    pub(super) name: &'static str,
    window: Window,
    pub(super) raw: Vec<f64>,
    pub(super) corrected: Vec<f64>,
    /// What the table makes of the amplitude without noise.
    pub(super) noise_free: Vec<f64>,
}

impl Sweep {
    /// Renders the scene over the registers and takes the means.
    pub(super) fn measure(lab: &Lab, subject: &'static Subject) -> Result<Self, ExperimentError> {
        let simulation = simulation_of(over_registers(lab, subject)?, lab.seed)?;
        let shape = simulation.shape();
        let region = |(name, window)| Region {
            name,
            window,
            raw: Vec::new(),
            corrected: Vec::new(),
            noise_free: Vec::new(),
        };
        let mut sweep = Self {
            subject,
            times_us: Vec::new(),
            regions: regions(shape).into_iter().map(region).collect(),
            picture: Plane::filled(shape, f32::NAN),
        };
        let table = lab.plan(TimeStep::Lut, DistanceStep::None, SpecularStep::None)?;
        let (mut corrected, mut noise_free) = (table.stream(), table.stream());
        for_each(&simulation, |_, simulated| {
            let mut frame = simulated.frame.clone();
            let IntegrationTime::PerFrame(time_us) = frame.integration_time_us else { return Ok(()) };
            let corrected = corrected.push(&frame)?;
            sweep.times_us.push(time_us);
            if Some(time_us) == lab.calibration.reference.integration_time_us {
                sweep.picture = frame.amplitude.clone();
            }
            let raw: Vec<f64> =
                sweep.regions.iter().map(|region| mean_amplitude(&frame, region.window)).collect();
            frame.amplitude = simulated.truth.noise_free_amplitude.clone();
            let noise_free = noise_free.push(&frame)?;
            for (region, raw) in sweep.regions.iter_mut().zip(raw) {
                region.raw.push(raw);
                region.corrected.push(mean(corrected.amplitude.values(), region.window.indices(shape)));
                region.noise_free.push(mean(noise_free.amplitude.values(), region.window.indices(shape)));
            }
            Ok(())
        })?;
        Ok(sweep)
    }

    /// CV before and after, over the times from `from_us` on.
    pub(super) fn variation(&self, region: &Region, from_us: f64) -> [f64; 2] {
        let skipped = self.times_us.iter().filter(|time_us| **time_us < from_us).count();
        [&region.raw, &region.corrected].map(|means| coefficient_of_variation(&means[skipped..]))
    }

    /// The integration times in words.
    pub(super) fn span(&self) -> String {
        let [first, last] = self.ends_ms();
        format!("{first:.1} to {last:.1} ms")
    }

    /// Shortest and longest integration time, ms.
    pub(super) fn ends_ms(&self) -> [f64; 2] {
        let ends = [self.times_us.first(), self.times_us.last()];
        ends.map(|time_us| time_us.map_or(f64::NAN, |time_us| time_us / 1000.0))
    }

    /// Index of the time at which the table is 1.
    pub(super) fn reference(&self) -> usize {
        self.times_us.iter().position(|time_us| *time_us == REFERENCE_TIME_US).unwrap_or(0)
    }

    /// `means` at the first (0) or last time, relative to the reference time's.
    pub(super) fn relative(&self, means: &[f64], index: usize) -> f64 {
        means[index] / means[self.reference()]
    }
}

/// The scene with the paper's integration times in place of its own few, as far as the table reaches.
fn over_registers(lab: &Lab, subject: &Subject) -> Result<Scene, ExperimentError> {
    let mut scene = Scene::builtin(subject.scene)?;
    let missing = ExperimentError::Scene { scene: subject.scene, missing: "a run over integration times" };
    let run = scene.runs.first_mut().ok_or(missing)?;
    let end_us =
        lab.calibration.terms.lut.as_ref().map_or(f64::INFINITY, |lut| lut.valid_integration_time_us[1]);
    let last = LAST_REGISTER.min(lab.camera.integration_register.nearest(end_us));
    run.integration_times_us.clear();
    run.registers = Some(RegisterRange { first: 0, last, step: 1 });
    run.frames_per_time = 1;
    run.skip_frames = SKIPPED_FRAMES;
    Ok(scene)
}
