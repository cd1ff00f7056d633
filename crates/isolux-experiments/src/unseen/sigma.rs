//! Coverage of the predicted standard deviations on held-out cameras, against the known truth.

use isolux::calibrate::NoiseSurvey;
use isolux::evaluate::SigmaTally;
use isolux::standardize::{DenoiseStep, DistanceStep, SigmaStep, SpecularStep};
use isolux::terms::NoiseModel;
use isolux::{Channels, Choice, DenoiseRule, PixelFlags, Plane, RecordingTraits, Standardized, Standardizer};
use isolux_camera::{CameraModel, Scene, SimulatedFrame, Simulation};

use super::held_out::{HeldOut, MEASURED};
use super::noise_free::without_noise;
use crate::error::ExperimentError;
use crate::measure::for_each;

/// Lower ends of the strata of the signal-to-noise ratio.
pub const SNR_FROM: [f64; 4] = [5.0, 7.0, 10.0, 20.0];
/// Pixels nearer to either end of the ambiguity range than this share of it may wrap around, which is no noise.
const WRAP_SHARE: f64 = 0.1;

/// What is measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SigmaCase {
    /// Built-in scene.
    pub scene: &'static str,
    /// Law over distance.
    pub distance: DistanceStep,
    /// Denoising of the distance.
    pub denoise: Option<DenoiseRule>,
    /// Is the DC image there?
    pub intensity: bool,
    /// Is the modulation frequency known?
    pub frequency: bool,
    /// Is the noise estimated from the scene's own frames, not that of the calibration?
    pub noise_from_scene: bool,
}

impl SigmaCase {
    /// A still desk, scaled by the fitted law with all that helps a prediction.
    pub const PLAIN: Self = Self {
        scene: "office-desk",
        distance: DistanceStep::Spline,
        denoise: None,
        intensity: true,
        frequency: true,
        noise_from_scene: false,
    };
}

/// What was found: errors from a signal-to-noise ratio of 5 on, of the amplitude without noise over its true σ.
#[derive(Clone, Debug, PartialEq)]
pub struct SigmaFigures {
    /// Share of the errors within one σ, 0..=1.
    pub within_one_sigma: f64,
    /// Expected normalized calibration error, dimensionless.
    pub ence: f64,
    /// Errors.
    pub errors: u64,
    /// Errors / pixels that are neither INVALID nor SATURATED, 0..=1.
    pub counted_share: f64,
    /// Share within one σ and number of errors, from each of [`SNR_FROM`] to the next.
    pub strata: [(f64, u64); SNR_FROM.len()],
    /// Mean error over root mean square of σ: the bias that is left.
    pub bias: f64,
    /// Share of the errors beyond three σ, 0..=1: of all, and from each of [`SNR_FROM`] to the next. Normal errors:
    /// 0.27 %.
    pub beyond_three_sigma: (f64, [f64; SNR_FROM.len()]),
}

/// Collects errors.
#[derive(Debug, Default)]
pub(super) struct Collector {
    all: SigmaTally,
    strata: [SigmaTally; SNR_FROM.len()],
    usable: u64,
    error: f64,
    variance: f64,
}

impl Collector {
    /// Takes in a frame: its values beside those without noise. `like` is the σ that would be predicted without noise,
    /// by which errors are grouped. `snr` tells the ratio of a pixel, NaN where it is not to count.
    pub(super) fn push(
        &mut self,
        noisy: &Standardized,
        clean: &Standardized,
        like: &Plane<f32>,
        snr: impl Fn(usize) -> f64,
    ) {
        let Some(sigma) = &noisy.sigma else { return };
        for (index, flags) in noisy.flags.values().iter().enumerate() {
            if flags.intersects(PixelFlags::INVALID | PixelFlags::SATURATED) {
                continue;
            }
            self.usable += 1;
            let error =
                f64::from(noisy.amplitude.values()[index]) - f64::from(clean.amplitude.values()[index]);
            let [sigma, like] = [sigma, like].map(|plane| f64::from(plane.values()[index]));
            let ratio = snr(index);
            let stratum = SNR_FROM.iter().rposition(|from| ratio >= *from);
            if let Some(stratum) = stratum.filter(|_| error.is_finite() && sigma.is_finite()) {
                self.all.push(error, sigma, like);
                self.strata[stratum].push(error, sigma, like);
                self.error += error;
                self.variance += sigma * sigma;
            }
        }
    }

    pub(super) fn finish(&self) -> SigmaFigures {
        let count = self.all.errors() as f64;
        let beyond = |tally: &SigmaTally| tally.beyond_three_sigma().unwrap_or(f64::NAN);
        SigmaFigures {
            within_one_sigma: self.all.within_one_sigma().unwrap_or(f64::NAN),
            ence: self.all.ence().unwrap_or(f64::NAN),
            errors: self.all.errors(),
            counted_share: count / self.usable as f64,
            strata: self
                .strata
                .each_ref()
                .map(|tally| (tally.within_one_sigma().unwrap_or(f64::NAN), tally.errors())),
            bias: self.error / count / (self.variance / count).sqrt(),
            beyond_three_sigma: (beyond(&self.all), self.strata.each_ref().map(beyond)),
        }
    }
}

/// True signal-to-noise ratio of the amplitude of a pixel, NaN near the ends of the ambiguity range.
pub(super) fn true_snr(simulated: &SimulatedFrame, model: &CameraModel, index: usize) -> f64 {
    let range_m = model.ambiguity_range_m();
    let place = f64::from(simulated.truth.true_distance_m.values()[index]) % range_m / range_m;
    let intensity =
        simulated.frame.intensity.as_ref().map_or(f64::NAN, |plane| f64::from(plane.values()[index]));
    let electrons = (intensity / model.gain_dn_per_electron).max(0.0);
    let sigma_dn = model.gain_dn_per_electron * model.bin_noise_electrons(electrons) / 2f64.sqrt();
    let inside = (WRAP_SHARE..1.0 - WRAP_SHARE).contains(&place);
    if inside { f64::from(simulated.truth.noise_free_amplitude.values()[index]) / sigma_dn } else { f64::NAN }
}

/// The plan of a case; without noise, the values that its predictions are about.
pub(super) fn plan(
    camera: &HeldOut,
    case: &SigmaCase,
    noise: Option<NoiseModel>,
    sigma: bool,
) -> Result<Standardizer, ExperimentError> {
    let choice = Choice {
        distance: Some(case.distance),
        denoise: case.denoise.filter(|_| sigma).map(DenoiseStep::Smooth),
        specular: Some(SpecularStep::None),
        sigma: if sigma { SigmaStep::Required } else { SigmaStep::None },
        noise,
        ..Choice::default()
    };
    let mut channels = Channels::AMPLITUDE | Channels::DISTANCE | Channels::INTEGRATION_TIME;
    channels.set(Channels::INTENSITY, case.intensity);
    let modulation_frequency_hz = case.frequency.then_some(camera.model.modulation_frequency_hz);
    let traits = RecordingTraits { modulation_frequency_hz, ..channels.into() };
    Ok(Standardizer::plan(&choice, Some(&camera.calibration), traits)?)
}

/// The plan that predicts σ of frames without noise.
pub(super) fn like_plan(camera: &HeldOut, case: &SigmaCase) -> Result<Standardizer, ExperimentError> {
    // Without noise, that of the distance cannot be estimated, and there is nothing to denoise.
    plan(camera, &SigmaCase { denoise: None, frequency: true, ..*case }, None, true)
}

/// The noise that the frames themselves show.
fn survey(simulated: &Simulation) -> Result<Option<NoiseModel>, ExperimentError> {
    let mut survey = NoiseSurvey::new();
    let mut last = None;
    for_each(simulated, |index, simulated_frame| {
        if last.replace(simulated.frames()[index].pose) != Some(simulated.frames()[index].pose) {
            survey.interrupt();
        }
        survey.push(&simulated_frame.frame);
        Ok(())
    })?;
    Ok(survey.finish().fit(Vec::new()).map(|noise| noise.model()))
}

/// Standardizes every frame of the scene with predictions, and compares the errors with them.
///
/// # Errors
/// [`ExperimentError`] when a simulation or a plan fails.
pub fn measure(camera: &HeldOut, case: &SigmaCase) -> Result<SigmaFigures, ExperimentError> {
    let simulated = Simulation::new(camera.model.clone(), Scene::builtin(case.scene)?, MEASURED)?;
    let noise = if case.noise_from_scene { survey(&simulated)? } else { None };
    let mut noisy = plan(camera, case, noise, true)?.stream();
    let mut clean = plan(camera, case, None, false)?.stream();
    let mut like = like_plan(camera, case)?.stream();
    let mut collector = Collector::default();
    let mut last = None;
    for_each(&simulated, |index, simulated_frame| {
        let frame = &simulated_frame.frame;
        let pose = simulated.frames()[index].pose;
        if last.replace(pose) != Some(pose) {
            noisy.reset();
        }
        let noisy = noisy.push(frame)?;
        let noise_free = without_noise(simulated_frame, &camera.model);
        let clean = clean.push(&noise_free)?;
        if let Some(like) = &like.push(&noise_free)?.sigma {
            collector.push(noisy, clean, like, |index| true_snr(simulated_frame, &camera.model, index));
        }
        Ok(())
    })?;
    Ok(collector.finish())
}
