//! Standardizing frames: plan once, then apply to each frame without allocating.

mod choice;
mod illumination;
mod kernel;
mod linear_frame;
mod linearise;
mod merge;
mod plan;
mod report;
mod sigma;
mod time;

pub use choice::{
    AngleStep, Choice, DenoiseStep, DistanceStep, Method, ProfileStep, SigmaStep, SpecularStep, Stream,
    TimeStep,
};
pub use linear_frame::FrameLineariser;
pub use merge::{BracketMerge, MergeError};
pub use report::{AppliedStep, Note, PlanError};

use crate::calibration::Calibration;
use crate::denoise::{DenoiseError, DenoiseRule, Denoiser, TemporalMean};
use crate::frame::{Channels, Frame, PixelFlags, Plane, Shape, ShapeError};
use crate::numerics::quantile::PositiveQuantiles;
use crate::specular::SpecularRule;
use crate::surface::Incidence;
use crate::terms::DistanceGain;
use illumination::Illumination;
use kernel::{BLOCK, Block};
use linearise::{Linearised, Lineariser, Repaired};
use plan::Plan;
use sigma::Predictor;
use time::TimeGain;

/// Distances to scale by in place of the frame's own, and the share of their variance that is left.
type Denoised<'a> = (&'a Plane<f32>, Option<&'a Plane<f32>>);

/// A chain of corrections, ready to apply to any frame of a recording. Shareable between threads.
#[derive(Clone, Debug)]
pub struct Standardizer {
    plan: Plan,
}

/// A standardized frame and the working memory to make it; reuse one for a whole recording.
#[derive(Clone, Debug)]
pub struct Standardized {
    /// Amplitude expected at the reference time and distance, DN; NaN exactly where INVALID is flagged.
    pub amplitude: Plane<f32>,
    /// The frame's flags, with those of the correction.
    pub flags: Plane<PixelFlags>,
    /// Predicted standard deviation of each amplitude before highlights were limited, DN; NaN where INVALID is
    /// flagged or the noise is unknown. `None` where the plan predicts none.
    pub sigma: Option<Plane<f32>>,
    quantiles: PositiveQuantiles,
    denoiser: Denoiser,
    linearised: Linearised,
    incidence: Incidence,
}

/// What happened to one frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FrameSummary {
    /// Pixels with a value.
    pub valid: usize,
    /// All pixels.
    pub pixels: usize,
    /// Measured pixels whose integration time is above the table's range, or unknown: refused.
    pub time_refused: usize,
    /// Measured pixels whose integration time is below the table: continued as 1/t and flagged.
    pub time_extrapolated: usize,
    /// Pixels whose distance is outside the fitted range: continued as d² and flagged.
    pub distance_extrapolated: usize,
    /// Pixels outside the support of the profile or steeper than the angle term has seen: continued and flagged.
    pub illumination_extrapolated: usize,
    /// Pixels limited as specular.
    pub specular: usize,
    /// The value they were limited to, DN; `None` when the rule found no cutoff or there is no such step.
    pub specular_cutoff: Option<f32>,
}

/// Why a frame cannot be standardized.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum StandardizeError {
    /// Planes that do not fit together.
    #[error(transparent)]
    Shape(#[from] ShapeError),
    /// The integration time that the plan needs is not there.
    #[error(
        "integration time found unknown (NaN or missing), a positive number of µs expected: the time step needs \
         it; use `--time none` to leave it out"
    )]
    TimeUnknown,
    /// The distance that the plan needs is not there.
    #[error("distance found missing, a plane of metres expected: the distance step needs it")]
    DistanceMissing,
    /// The channel by which the response tells the fill of a pixel is not there.
    #[error("no {channel} found, one value for each pixel expected: the response's tier needs it")]
    FillMissing {
        /// The channel.
        channel: &'static str,
    },
    /// The response's map is that of a scene of another shape.
    #[error(
        "the frame is {found}, {expected} expected, the shape of the scene that the response's tier `pixel` was \
         fitted on: it holds for that scene alone"
    )]
    AnotherScene {
        /// Shape of the frame.
        found: Shape,
        /// Shape of the map.
        expected: Shape,
    },
    /// The frame is not of the format that the illumination profile holds for.
    #[error(
        "a frame of {found} found, {expected} expected: the illumination profile holds for that format alone"
    )]
    ProfileFormat {
        /// Shape of the frame.
        found: Shape,
        /// Shape that the profile was fitted on.
        expected: Shape,
    },
    /// The plan smooths over frames, and only one was given.
    #[error(
        "one frame found, the mean distance over the last ones expected: the denoising step `temporal` needs it; \
         feed every frame to the planned `history` and use `apply_at`"
    )]
    HistoryMissing,
}

impl From<DenoiseError> for StandardizeError {
    fn from(error: DenoiseError) -> Self {
        match error {
            DenoiseError::Shape(error) => Self::Shape(error),
            DenoiseError::DistanceMissing => Self::DistanceMissing,
        }
    }
}

impl Standardized {
    /// Memory for frames of `shape`.
    #[must_use]
    pub fn new(shape: Shape) -> Self {
        Self {
            amplitude: Plane::filled(shape, f32::NAN),
            flags: Plane::filled(shape, PixelFlags::empty()),
            sigma: None,
            quantiles: PositiveQuantiles::new(),
            denoiser: Denoiser::default(),
            linearised: Linearised::new(),
            incidence: Incidence::default(),
        }
    }

    /// Follows a frame of another shape; does not allocate when the shape is unchanged.
    fn reshape(&mut self, shape: Shape) {
        self.amplitude.reshape(shape, f32::NAN);
        self.flags.reshape(shape, PixelFlags::empty());
        self.quantiles.reserve(shape.pixels());
    }

    /// Limits the highlights; the cutoff, where the rule found one.
    fn limit(&mut self, rule: SpecularRule) -> Option<f32> {
        let cutoff = rule.cutoff(self.amplitude.values(), &mut self.quantiles)?;
        rule.limit(&mut self.amplitude, &mut self.flags, cutoff);
        Some(cutoff)
    }
}

impl Standardizer {
    /// Plans the chain: the choice's steps, with the terms of `calibration`, for recordings that have the
    /// `available` channels.
    ///
    /// # Errors
    /// [`PlanError`] when something asked for by name cannot be done.
    pub fn plan(
        choice: &Choice,
        calibration: Option<&Calibration>,
        available: Channels,
    ) -> Result<Self, PlanError> {
        Self::plan_for(choice, calibration, available.into())
    }

    /// Like [`Self::plan`], for a recording of which more is known than its channels: the step `angle` needs its
    /// intrinsics, and the profile is for one image format.
    ///
    /// # Errors
    /// [`PlanError`] when something asked for by name cannot be done.
    pub fn plan_for(
        choice: &Choice,
        calibration: Option<&Calibration>,
        stream: Stream,
    ) -> Result<Self, PlanError> {
        Ok(Self { plan: Plan::new(choice, calibration, stream)? })
    }

    /// The steps, in the order in which they are applied.
    #[must_use]
    pub fn steps(&self) -> &[AppliedStep] {
        &self.plan.steps
    }

    /// What the user should know of the plan.
    #[must_use]
    pub fn notes(&self) -> &[Note] {
        &self.plan.notes
    }

    /// Channels that the chain reads.
    #[must_use]
    pub fn needed(&self) -> Channels {
        let mut needed = Channels::AMPLITUDE;
        needed.set(Channels::INTEGRATION_TIME, self.plan.time != plan::TimePlan::None);
        let by_distance = self.plan.distance.is_some() || self.plan.illumination.angle.is_some();
        needed.set(Channels::DISTANCE, by_distance);
        needed
            | self.plan.lineariser.as_ref().map_or(Channels::empty(), Lineariser::channels)
            | self.plan.sigma.map_or(Channels::empty(), |sigma| sigma.needed)
    }

    /// Standardizes one frame into `out`; the frame itself stays as it is. Allocates only when the shape differs
    /// from that of the last frame.
    ///
    /// # Errors
    /// [`StandardizeError`] when the frame lacks what the plan needs, or its planes differ in shape.
    pub fn apply(&self, frame: &Frame, out: &mut Standardized) -> Result<FrameSummary, StandardizeError> {
        if self.plan.denoise == Some(DenoiseRule::Temporal) {
            return Err(StandardizeError::HistoryMissing);
        }
        self.correct(frame, None, out)
    }

    /// The history that the plan needs, where it denoises over frames: [`TemporalMean::push`] every frame in order,
    /// and [`Self::apply_at`] with what it writes.
    #[must_use]
    pub fn history(&self) -> Option<TemporalMean> {
        (self.plan.denoise == Some(DenoiseRule::Temporal)).then(TemporalMean::new)
    }

    /// Like [`Self::apply`], but scales by `distance_m` (metres) in place of the frame's own distance, and denoises
    /// nothing more. Predictions take it to be as noisy as the frame's own.
    ///
    /// # Errors
    /// [`StandardizeError`] when the frame lacks what the plan needs, or the planes differ in shape.
    pub fn apply_at(
        &self,
        frame: &Frame,
        distance_m: &Plane<f32>,
        out: &mut Standardized,
    ) -> Result<FrameSummary, StandardizeError> {
        distance_m.expect_shape("distance", frame.shape())?;
        self.correct(frame, Some((distance_m, None)), out)
    }

    /// Like [`Self::apply_at`]; `variance_left` is the share, 0..=1, of the variance of the frame's own distance that
    /// each has, as [`TemporalMean::variance_left`] tells it.
    ///
    /// # Errors
    /// [`StandardizeError`] when the frame lacks what the plan needs, or the planes differ in shape.
    pub fn apply_denoised(
        &self,
        frame: &Frame,
        distance_m: &Plane<f32>,
        variance_left: &Plane<f32>,
        out: &mut Standardized,
    ) -> Result<FrameSummary, StandardizeError> {
        distance_m.expect_shape("distance", frame.shape())?;
        variance_left.expect_shape("variance_left", frame.shape())?;
        self.correct(frame, Some((distance_m, Some(variance_left))), out)
    }

    /// True where [`Standardized::sigma`] is predicted.
    #[must_use]
    pub fn predicts_sigma(&self) -> bool {
        self.plan.sigma.is_some()
    }

    fn correct(
        &self,
        frame: &Frame,
        denoised: Option<Denoised<'_>>,
        out: &mut Standardized,
    ) -> Result<FrameSummary, StandardizeError> {
        frame.check_shapes()?;
        out.reshape(frame.shape());
        if self.plan.sigma.is_none() {
            out.sigma = None;
        }
        out.flags.values_mut().copy_from_slice(frame.flags.values());
        let lineariser = self.plan.lineariser.as_ref();
        let repaired = lineariser
            .map(|lineariser| out.linearised.fill(lineariser, frame, out.flags.values_mut()))
            .transpose()?;
        let time = time::gains(&self.plan.time, frame, out.amplitude.values_mut(), out.flags.values_mut())?;
        self.scale(frame, denoised, repaired, time.gain, out)?;
        let specular_cutoff = self.plan.specular.and_then(|rule| out.limit(rule));
        Ok(FrameSummary {
            specular_cutoff,
            time_refused: time.refused,
            time_extrapolated: time.extrapolated,
            ..count(out)
        })
    }

    /// Runs the point-wise loop block by block. A step that is left out reads a block of ones from the cache.
    fn scale(
        &self,
        frame: &Frame,
        denoised: Option<Denoised<'_>>,
        repaired: Option<Repaired>,
        gain: TimeGain,
        out: &mut Standardized,
    ) -> Result<(), StandardizeError> {
        const ONES: [f32; BLOCK] = [1.0; BLOCK];
        let law = self.plan.distance.unwrap_or(DistanceGain::ONE);
        let table = self.plan.distance_table.as_ref();
        let amplitudes = repaired.map_or(frame.amplitude.values(), |_| out.linearised.amplitude());
        let mut predictor = self.plan.sigma.as_ref().map(|plan| {
            let law = self.plan.distance.as_ref().map(|law| (law, table));
            let scratch = sigma::plane(&mut out.sigma, frame.shape()).values_mut();
            Predictor::new(plan, frame, amplitudes, law, &mut out.denoiser, scratch)
        });
        let own_distance_m = match repaired {
            Some(Repaired::AmplitudeAndDistance) => Some(out.linearised.distance_m()),
            _ => frame.distance_m.as_ref(),
        };
        let distances = match (&self.plan.distance, denoised, own_distance_m, self.plan.denoise) {
            (None, ..) => None,
            (Some(_), Some((distance_m, left)), ..) => {
                predictor =
                    predictor.zip(left).map(|(p, left)| p.after_denoising(left.values())).or(predictor);
                Some(distance_m.values())
            }
            (Some(_), None, None, _) => return Err(StandardizeError::DistanceMissing),
            (Some(_), None, Some(delivered), None) => Some(delivered.values()),
            (Some(_), None, Some(delivered), Some(rule)) => {
                let denoised = out.denoiser.denoise(rule, frame, delivered, predictor.is_some());
                predictor = predictor.map(|p| p.after_denoising(denoised.variance_left));
                Some(denoised.distance_m)
            }
        };
        let sigma = predictor.as_ref().and(out.sigma.as_mut());
        let mut sigma = sigma.map(|plane| plane.values_mut().chunks_mut(BLOCK));
        let surfaces = denoised.map(|(distance_m, _)| distance_m).or(own_distance_m);
        let illumination = Illumination::new(&self.plan.illumination, frame, surfaces, &mut out.incidence)?;
        let varies = table.is_some() || illumination.is_needed();
        let mut gains = [1.0; BLOCK];
        if let TimeGain::Uniform(gain) = gain {
            gains.fill(gain);
        }
        let blocks = amplitudes.chunks(BLOCK).enumerate();
        let outputs =
            out.amplitude.values_mut().chunks_mut(BLOCK).zip(out.flags.values_mut().chunks_mut(BLOCK));
        for ((index, amplitude), (values, flags)) in blocks.zip(outputs) {
            let (start, count) = (index * BLOCK, amplitude.len());
            if matches!(gain, TimeGain::PerPixel) {
                gains[..count].copy_from_slice(values);
            }
            let distance_m = distances.map_or(&ONES[..count], |distances| &distances[start..start + count]);
            if varies && let TimeGain::Uniform(gain) = gain {
                gains[..count].fill(gain);
            }
            if let Some(table) = table {
                table.scale(distance_m, &mut gains[..count]);
            }
            illumination.scale(start, &mut gains[..count], flags);
            let block = Block { amplitude, distance_m, time_gain: &gains[..count] };
            kernel::pointwise(block, &law, self.plan.low_signal_below_dn, values, flags);
            if let (Some(predictor), Some(sigma)) = (&predictor, sigma.as_mut().and_then(Iterator::next)) {
                predictor.predict(start, distance_m, values, sigma);
            }
        }
        Ok(())
    }
}

fn count(out: &Standardized) -> FrameSummary {
    let flags = out.flags.values();
    let mut tally = [0; kernel::TALLIES.len()];
    flags.chunks(BLOCK).for_each(|block| kernel::tally(block, &mut tally));
    let [invalid, distance_extrapolated, specular, illumination_extrapolated] = tally;
    FrameSummary {
        valid: flags.len() - invalid,
        pixels: flags.len(),
        distance_extrapolated,
        illumination_extrapolated,
        specular,
        ..FrameSummary::default()
    }
}
