//! Patches of known reflectivity before cameras that nobody has seen: how far the standardized amplitude is from being
//! proportional to the reflectivity, over all patches, depths, tilts and places, against the noise floor.
//!
//! Each camera is calibrated with one recording, a white board in many poses (`target-board`); its patches (`patches`)
//! are other objects in other poses. The floor is what noise alone leaves: the same pixels, each divided by its true
//! noise-free linear amplitude. Frames in which fewer than 95 % of the labelled pixels are usable do not count: a pixel
//! is usable where the camera delivers a value and its well compresses the amplitude by at most 2 %.

use isolux::calibrate::{CalibrateSettings, FitReport};
use isolux::standardize::{AngleStep, DenoiseStep, DistanceStep, ProfileStep};
use isolux::statistics::{SIGMA_PER_MAD, median, median_absolute_deviation};
use isolux::{
    Calibration, Channels, Choice, DenoiseRule, PixelFlags, RecordingTraits, Standardized, Standardizer,
};
use isolux_camera::{CameraModel, Scene, SimulatedFrame, Simulation};
use isolux_pipeline::simulate::SimulatedFrames;
use isolux_pipeline::{CalibrationSources, FrameSource, Unobserved, calibrate};

use crate::error::ExperimentError;

/// Scene that is calibrated with.
const BOARD: &str = "target-board";
/// Scene that is measured.
const PATCHES: &str = "patches";
/// Compression that a usable pixel may have.
const COMPRESSION: f64 = 0.02;
/// Share of usable pixels of a frame that counts.
const USABLE: f64 = 0.95;

/// What one camera's patches show.
#[derive(Clone, Debug, PartialEq)]
pub struct PatchFigures {
    /// Seed of the camera.
    pub seed: u64,
    /// Standard deviation of ln(value / reflectivity) over all pixels that have a value.
    pub deviation: f64,
    /// The same of ln(amplitude / true linear amplitude) of these pixels: noise, and what little compression is left.
    pub floor: f64,
    /// 1.4826 MAD of the medians of patches, and of their floor.
    pub patch_robust: [f64; 2],
    /// Standard deviation by the textbook's chain, t_ref/t and d².
    pub textbook: f64,
    /// Share of the labelled pixels that have a value.
    pub valid: f64,
    /// Frames that count, and all.
    pub frames: [usize; 2],
}

/// Calibrates the random camera of this seed with the board.
///
/// # Errors
/// [`ExperimentError`] when the simulation or the fit fails.
pub fn calibrate_random(seed: u64) -> Result<(Calibration, FitReport), ExperimentError> {
    let simulation = Simulation::new(CameraModel::random(seed), Scene::builtin(BOARD)?, seed)?;
    let model = simulation.model();
    let settings = CalibrateSettings {
        modulation_frequency_hz: Some(model.modulation_frequency_hz),
        ..CalibrateSettings::default()
    };
    let targets: Vec<Box<dyn FrameSource + '_>> = vec![Box::new(SimulatedFrames::new(&simulation))];
    let sources = CalibrationSources { targets, ..CalibrationSources::default() };
    Ok(calibrate(&settings, Some(model.name.clone()), sources, &Unobserved)?)
}

/// Measures the patches before the random camera of this seed, with `calibration`, in every `step`-th frame of 135.
///
/// # Errors
/// [`ExperimentError`] when the simulation or a step fails.
pub fn patches(seed: u64, calibration: &Calibration, step: usize) -> Result<PatchFigures, ExperimentError> {
    let simulation = Simulation::new(CameraModel::random(seed), Scene::builtin(PATCHES)?, seed + 1000)?;
    let traits = RecordingTraits {
        shape: Some(simulation.shape()),
        lens: Some(simulation.model().intrinsics.into()),
        ..(Channels::AMPLITUDE | Channels::DISTANCE | Channels::INTEGRATION_TIME).into()
    };
    let textbook = Choice::textbook(traits.channels);
    let fitted = Choice {
        distance: Some(DistanceStep::Spline),
        profile: Some(ProfileStep::On),
        angle: Some(AngleStep::On),
        denoise: Some(DenoiseStep::Smooth(DenoiseRule::Wiener)),
        ..textbook
    };
    let mut chain = Standardizer::plan(&fitted, Some(calibration), traits.clone())?.stream();
    let mut plain = Standardizer::plan(&textbook, None, traits)?.stream();
    let mut sums = Sums::default();
    let mut simulated = SimulatedFrame::new(simulation.shape());
    for index in (0..simulation.len()).step_by(step.max(1)) {
        simulation.render_frame(index, &mut simulated)?;
        sums.frames[1] += 1;
        if usable(&simulated) >= USABLE {
            sums.add(&simulated, chain.push(&simulated.frame)?, plain.push(&simulated.frame)?);
        }
    }
    Ok(sums.figures(seed))
}

/// Labelled pixels of a frame.
fn labelled(simulated: &SimulatedFrame) -> impl Iterator<Item = (usize, u8)> + '_ {
    let target = simulated.frame.target.iter().flat_map(|target| target.values().iter().copied().enumerate());
    target.filter(|(_, label)| *label > 0)
}

fn usable(simulated: &SimulatedFrame) -> f64 {
    let truth = &simulated.truth;
    let good = |&(index, _): &(usize, u8)| {
        let linear = f64::from(truth.linear_amplitude.values()[index]);
        let kept = f64::from(truth.noise_free_amplitude.values()[index]) / linear;
        let flags = simulated.frame.flags.values()[index];
        kept >= 1.0 - COMPRESSION && !flags.intersects(PixelFlags::INVALID | PixelFlags::SATURATED)
    };
    let all = labelled(simulated).count().max(1);
    labelled(simulated).filter(good).count() as f64 / all as f64
}

#[derive(Default)]
struct Sums {
    ours: Vec<f64>,
    floor: Vec<f64>,
    textbook: Vec<f64>,
    patches: [Vec<f64>; 2],
    labelled: usize,
    frames: [usize; 2],
}

impl Sums {
    fn add(&mut self, simulated: &SimulatedFrame, out: &Standardized, without: &Standardized) {
        self.frames[0] += 1;
        let mut patches = vec![[Vec::new(), Vec::new()]; 256];
        for (index, label) in labelled(simulated) {
            self.labelled += 1;
            let reflectivity = f64::from(simulated.truth.reflectivity.values()[index]);
            let value = f64::from(out.amplitude.values()[index]);
            let amplitude = f64::from(simulated.frame.amplitude.values()[index]);
            let linear = f64::from(simulated.truth.linear_amplitude.values()[index]);
            if value > 0.0 {
                let (ours, floor) = ((value / reflectivity).ln(), (amplitude / linear).ln());
                self.ours.push(ours);
                self.floor.push(floor);
                self.textbook.push((f64::from(without.amplitude.values()[index]) / reflectivity).ln());
                patches[usize::from(label)][0].push(ours);
                patches[usize::from(label)][1].push(floor);
            }
        }
        for patch in &mut patches {
            for (medians, values) in self.patches.iter_mut().zip(patch) {
                medians.extend(median(values));
            }
        }
    }

    fn figures(mut self, seed: u64) -> PatchFigures {
        let robust =
            |values: &mut Vec<f64>| SIGMA_PER_MAD * median_absolute_deviation(values).unwrap_or(f64::NAN);
        let [ours, floor] = &mut self.patches;
        PatchFigures {
            seed,
            deviation: deviation(&self.ours),
            floor: deviation(&self.floor),
            patch_robust: [robust(ours), robust(floor)],
            textbook: deviation(&self.textbook),
            valid: self.ours.len() as f64 / self.labelled.max(1) as f64,
            frames: self.frames,
        }
    }
}

fn deviation(values: &[f64]) -> f64 {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    (values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / count).sqrt()
}
