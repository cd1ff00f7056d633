//! How much a pixel still varies over integration times, by each way of taking the time out: the paper's table against
//! the tiers of the response, on unseen cameras and exposures that nothing was fitted on.

mod exposures;
mod stack;

use isolux::calibrate::{self, CalibrateSettings, ExposureSweep};
use isolux::standardize::{AmbientLight, DistanceStep, SpecularStep, TimeStep};
use isolux::terms::response::ResponseTier;
use isolux::{
    Calibration, Channels, Choice, PixelFlags, Plane, RecordingTraits, Reference, Standardizer, Stream,
};
use isolux_camera::{SimulatedFrame, Simulation};

use super::{held_out, light};
use crate::error::ExperimentError;
use crate::measure::time_us;
use exposures::{camera_of, for_each, longest_us, simulation};
use stack::{Stack, TEST_FRAMES};

pub use exposures::Light;

/// What the calibration was fitted on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FittedOn {
    /// Other exposures of the scene that is tested.
    Scene,
    /// A wall in the same light, as a laboratory has it.
    Wall,
}

/// One way of taking the time out, on one camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ResponseFigure {
    /// Which camera: [`isolux_camera::CameraModel::random`] of this.
    pub camera: u64,
    /// The light.
    pub light: Light,
    /// What the calibration was fitted on.
    pub fitted_on: FittedOn,
    /// `linear`, `lut` or the tier of the response.
    pub method: &'static str,
    /// Median over the pixels of the coefficient of variation over the test exposures.
    pub median_cv: f64,
    /// Its 95th percentile.
    pub p95_cv: f64,
    /// Share of the unclipped pixels of all test exposures that the method gives a value.
    pub valid_fraction: f64,
    /// Median of the table on exactly these pixels and exposures: no method gains by what it refuses.
    pub lut_median_cv: f64,
    /// Median of the true factors on them: the noise alone.
    pub floor_median_cv: f64,
}

/// Exposures of fit and test take turns, evenly spread in ln t over a factor of [`SPAN`] up to the longest.
const FITTED_TIMES: u32 = 16;
/// The longest time over the shortest.
const SPAN: f64 = 8.0;
/// Frames of each exposure that is fitted on.
const FITTED_FRAMES: u32 = 32;
/// Frames of each exposure that the ambient light is estimated from.
const SURVEYED_FRAMES: usize = 4;
const METHODS: [(&str, TimeStep, Option<ResponseTier>); 8] = [
    ("lut", TimeStep::Lut, None),
    ("linear", TimeStep::Linear, None),
    ("scalar", TimeStep::Response, Some(ResponseTier::Scalar)),
    ("amplitude", TimeStep::Response, Some(ResponseTier::Amplitude)),
    ("ambient", TimeStep::Response, Some(ResponseTier::Ambient)),
    ("pixel", TimeStep::Response, Some(ResponseTier::Pixel)),
    ("intensity", TimeStep::Response, Some(ResponseTier::Intensity)),
    ("phase_samples", TimeStep::Response, Some(ResponseTier::PhaseSamples)),
];

/// Measures every method on one camera in this light, the table first. A tier that the sweep does not determine is left
/// out, and so is the map of another scene.
///
/// # Errors
/// [`ExperimentError`] when a simulation or a fit fails, which no seed should bring about.
pub fn measure(
    camera: u64,
    light: Light,
    fitted_on: FittedOn,
) -> Result<Vec<ResponseFigure>, ExperimentError> {
    let model = camera_of(camera);
    let longest_us = longest_us(&model, light);
    let times = |first: f64| {
        let step = |i: u32| longest_us * SPAN.powf((first + f64::from(i)) / f64::from(FITTED_TIMES) - 1.0);
        (1..=FITTED_TIMES).map(step).collect::<Vec<_>>()
    };
    let (fitted_times, tested_times) = (times(0.0), times(-0.5));
    let scene = match fitted_on {
        FittedOn::Scene => "office-desk",
        FittedOn::Wall => "wall-sweep",
    };
    let sweep = simulation(scene, &model, light, &fitted_times, (FITTED_FRAMES, 2 * camera))?;
    let mut calibration = calibrate(&sweep, &fitted_times)?;
    if let Some(response) = &mut calibration.terms.response {
        response.ambient = held_out::ambient(camera)?;
    }
    let tested = simulation("office-desk", &model, light, &tested_times, (TEST_FRAMES, 2 * camera + 1))?;
    let exposures = (0..tested.len()).step_by(TEST_FRAMES as usize);
    let surveyed = exposures.map(|first| first..(first + SURVEYED_FRAMES).min(tested.len()));
    let ambient_light = light::estimate(&calibration, &tested, surveyed)?;
    let fitted = |tier| match (tier, &calibration.terms.response) {
        (None, _) => true,
        (Some(ResponseTier::Pixel), Some(response)) => {
            response.pixel.is_some() && fitted_on == FittedOn::Scene
        }
        (Some(ResponseTier::Ambient), Some(_)) => ambient_light.is_some(),
        (Some(tier), Some(response)) => response.tiers().any(|fitted| fitted == tier),
        (Some(_), None) => false,
    };
    let methods: Vec<_> = METHODS.into_iter().filter(|(_, _, tier)| fitted(*tier)).collect();
    let plans = methods.iter().map(|(_, time, tier)| plan(&calibration, *time, *tier, &ambient_light));
    let (stacks, truth) = measured(&tested, &plans.collect::<Result<Vec<_>, _>>()?)?;
    let figure = |(stack, (method, ..)): (&Stack, &(&'static str, TimeStep, Option<ResponseTier>))| {
        let [median_cv, p95_cv] = stack.variation(stack);
        ResponseFigure {
            camera,
            light,
            fitted_on,
            method,
            median_cv,
            p95_cv,
            valid_fraction: stack.valid as f64 / stack.unclipped as f64,
            lut_median_cv: stacks[0].variation(stack)[0],
            floor_median_cv: truth.variation(stack)[0],
        }
    };
    Ok(stacks.iter().zip(&methods).map(figure).collect())
}

/// The time step alone.
fn plan(
    calibration: &Calibration,
    time: TimeStep,
    response_tier: Option<ResponseTier>,
    ambient_light: &Option<AmbientLight>,
) -> Result<Standardizer, ExperimentError> {
    let choice = Choice {
        time: Some(time),
        response_tier,
        distance: Some(DistanceStep::None),
        specular: Some(SpecularStep::None),
        ..Choice::default()
    };
    let channels = Channels::AMPLITUDE
        | Channels::DISTANCE
        | Channels::INTEGRATION_TIME
        | Channels::INTENSITY
        | Channels::PHASE_SAMPLES;
    let traits = RecordingTraits { ambient_light: ambient_light.clone(), ..channels.into() };
    Ok(Standardizer::plan(&choice, Some(calibration), traits)?)
}

/// The reference time is one of the sweep's in the middle, which every camera's table covers. The sweep is measured here
/// and not by the pipeline: its simulated frames do not flag clipped bins.
fn calibrate(simulation: &Simulation, times_us: &[f64]) -> Result<Calibration, ExperimentError> {
    let reference = Reference { integration_time_us: times_us.get(6).copied(), ..Reference::default() };
    let settings = CalibrateSettings {
        reference,
        modulation_frequency_hz: Some(simulation.model().modulation_frequency_hz),
        ..CalibrateSettings::default()
    };
    let mut sweep = ExposureSweep::new("sweep", &settings);
    for_each(simulation, |simulated| Ok(sweep.push(&simulated.frame)?))?;
    Ok(calibrate::fit(&settings, None, vec![sweep.finish()], Vec::new())?.0)
}

/// What each plan makes of the exposures, and what the true factors of compression and time do.
fn measured(simulation: &Simulation, plans: &[Standardizer]) -> Result<(Vec<Stack>, Stack), ExperimentError> {
    let mut stacks = vec![Stack::default(); plans.len()];
    let mut truth = Stack::default();
    let mut streams: Vec<Stream> = plans.iter().map(Standardizer::stream).collect();
    let dead = simulation.dead_pixels();
    let (mut frames, mut clipped) = (0, vec![false; dead.len()]);
    for_each(simulation, |simulated| {
        if frames % TEST_FRAMES == 0 {
            clipped = dead.to_vec();
        }
        let flags = simulated.frame.flags.values().iter();
        clipped.iter_mut().zip(flags).for_each(|(clipped, f)| *clipped |= f.contains(PixelFlags::SATURATED));
        let place = frames % TEST_FRAMES;
        for (stack, stream) in stacks.iter_mut().zip(&mut streams) {
            let out = stream.push(&simulated.frame)?;
            stack.add(place, out.amplitude.values().iter().map(|&value| f64::from(value)), &clipped);
        }
        truth.add(place, true_values(simulated), &clipped);
        frames += 1;
        Ok(())
    })?;
    Ok((stacks, truth))
}

/// The amplitudes by the true factors of compression and time.
fn true_values(simulated: &SimulatedFrame) -> impl Iterator<Item = f64> {
    let time_us = time_us(&simulated.frame).unwrap_or(f64::NAN);
    let truth = &simulated.truth;
    let planes = [&simulated.frame.amplitude, &truth.linear_amplitude, &truth.noise_free_amplitude];
    let [measured, linear, compressed] = planes.map(Plane::values);
    let value =
        move |i: usize| f64::from(measured[i]) * f64::from(linear[i]) / f64::from(compressed[i]) / time_us;
    (0..measured.len()).map(value)
}
