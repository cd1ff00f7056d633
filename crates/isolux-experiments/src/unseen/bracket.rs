//! Merged brackets on held-out cameras: how much less noise, which pixels are filled, and whether the predicted
//! standard deviation is right.

use isolux::standardize::DistanceStep;
use isolux::{DenoiseRule, PixelFlags, Standardized};
use isolux_camera::scene::run::Run;
use isolux_camera::{Scene, Simulation};

use super::held_out::{HeldOut, MEASURED};
use super::noise_free::without_noise;
use super::sigma::{Collector, SigmaCase, SigmaFigures, like_plan, plan, true_snr};
use crate::error::ExperimentError;
use crate::measure::for_each;

/// What is measured.
#[derive(Clone, Debug, PartialEq)]
pub struct BracketCase {
    /// Built-in scene, whose first pose stands still.
    pub scene: &'static str,
    /// Integration times of a bracket, µs, increasing.
    pub times_us: Vec<f64>,
    /// Brackets, at least 2.
    pub brackets: usize,
    /// Law over distance.
    pub distance: DistanceStep,
    /// Denoising of the distance.
    pub denoise: Option<DenoiseRule>,
    /// Is the DC image there?
    pub intensity: bool,
}

impl BracketCase {
    /// Twelve brackets of four times in ratios of about 3, scaled by the fitted law.
    #[must_use]
    pub fn of(scene: &'static str) -> Self {
        let times_us = vec![500.0, 1500.0, 5000.0, 15_000.0];
        Self { scene, times_us, brackets: 12, distance: DistanceStep::Spline, denoise: None, intensity: true }
    }
}

/// What was found.
#[derive(Clone, Debug, PartialEq)]
pub struct BracketFigures {
    /// Predictions of the merged frames, against the merged frames without noise. The signal-to-noise ratio is that of
    /// the longest time.
    pub sigma: SigmaFigures,
    /// Median over pixels of the noise of the merged value over that of the best single time: the root mean square of
    /// the errors over the brackets, the least of the times. Pixels that are valid at every time.
    pub noise_of_best: f64,
    /// Share of these pixels where it is below 1.
    pub improved_share: f64,
    /// Share of the pixels that are INVALID or SATURATED at the longest time and neither in the merged frame.
    pub filled_share: f64,
    /// Share of the pixels that are valid and not SATURATED at the longest time, and in the merged frames.
    pub usable_share: [f64; 2],
}

/// Squared errors of one pixel over the brackets.
#[derive(Clone, Debug, Default)]
struct Squares {
    times: Vec<f64>,
    merged: f64,
    brackets: usize,
}

/// Standardizes and merges bracket after bracket.
///
/// # Errors
/// [`ExperimentError`] when a simulation or a plan fails.
pub fn measure(camera: &HeldOut, case: &BracketCase) -> Result<BracketFigures, ExperimentError> {
    let mut scene = Scene::builtin(case.scene)?;
    let run = Run { integration_times_us: case.times_us.clone(), skip_frames: 50, ..Run::default() };
    scene.runs = vec![run; case.brackets];
    let simulated = Simulation::new(camera.model.clone(), scene, MEASURED)?;
    let of_frames = SigmaCase {
        scene: case.scene,
        distance: case.distance,
        denoise: case.denoise,
        intensity: case.intensity,
        frequency: true,
        noise_from_scene: false,
    };
    let (noisy_plan, clean_plan) =
        (plan(camera, &of_frames, None, true)?, plan(camera, &of_frames, None, false)?);
    let (noisy_plan, mut merge) = noisy_plan.bracket()?;
    let mut merge_clean = merge.clone();
    let (mut noisy_frames, mut clean_frames) = (noisy_plan.stream(), clean_plan.stream());
    let mut like_frames = like_plan(camera, &of_frames)?.stream();
    let new = || Standardized::new(simulated.shape());
    let (mut clean, mut merged, mut merged_clean) = (new(), new(), new());
    let mut collector = Collector::default();
    let mut squares = vec![Squares::default(); simulated.shape().pixels()];
    let (mut unusable, mut filled, mut usable) = (0u64, 0u64, 0u64);
    for_each(&simulated, |index, simulated_frame| {
        let frame = &simulated_frame.frame;
        let noisy = noisy_frames.push(frame)?;
        let noise_free = without_noise(simulated_frame, &camera.model);
        clean.clone_from(clean_frames.push(&noise_free)?);
        for (pixel, squares) in squares.iter_mut().enumerate() {
            squares.times.resize(case.times_us.len(), 0.0);
            squares.times[index % case.times_us.len()] += error(noisy, &clean, pixel).powi(2);
        }
        merge.push(noisy)?;
        // The same weights, so that the difference is noise alone.
        clean.sigma.clone_from(&noisy.sigma);
        clean.flags.clone_from(&noisy.flags);
        merge_clean.push(&clean)?;
        if (index + 1) % case.times_us.len() != 0 {
            return Ok(());
        }
        merge.finish(&mut merged);
        merge_clean.finish(&mut merged_clean);
        // What groups are formed by need not be the merged σ, but must not know the errors: that of the longest time.
        if let Some(like) = &like_frames.push(&noise_free)?.sigma {
            collector
                .push(&merged, &merged_clean, like, |pixel| true_snr(simulated_frame, &camera.model, pixel));
        }
        for (pixel, squares) in squares.iter_mut().enumerate() {
            squares.merged += error(&merged, &merged_clean, pixel).powi(2);
            squares.brackets += 1;
            let [longest, all] = [noisy, &merged].map(|frame| is_usable(frame, pixel));
            unusable += u64::from(!longest);
            filled += u64::from(!longest && all);
            usable += u64::from(all);
        }
        Ok(())
    })?;
    let mut ratios: Vec<f64> = squares.iter().filter_map(Squares::ratio).collect();
    let improved = ratios.iter().filter(|ratio| **ratio < 1.0).count() as f64 / ratios.len() as f64;
    let pixels = (squares.len() * case.brackets) as f64;
    Ok(BracketFigures {
        sigma: collector.finish(),
        noise_of_best: isolux::statistics::median(&mut ratios).unwrap_or(f64::NAN),
        improved_share: improved,
        filled_share: filled as f64 / unusable as f64,
        usable_share: [1.0 - unusable as f64 / pixels, usable as f64 / pixels],
    })
}

impl Squares {
    /// Noise of the merged value over that of the best time; `None` where a value is missing.
    fn ratio(&self) -> Option<f64> {
        let best = self.times.iter().copied().reduce(f64::min)?;
        let ratio = (self.merged / best).sqrt();
        let complete = self.times.iter().all(|squares| squares.is_finite());
        (self.brackets > 0 && complete && ratio.is_finite()).then_some(ratio)
    }
}

fn error(noisy: &Standardized, clean: &Standardized, pixel: usize) -> f64 {
    f64::from(noisy.amplitude.values()[pixel]) - f64::from(clean.amplitude.values()[pixel])
}

fn is_usable(frame: &Standardized, pixel: usize) -> bool {
    !frame.flags.values()[pixel].intersects(PixelFlags::INVALID | PixelFlags::SATURATED)
}
