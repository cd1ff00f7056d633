//! What the experiments share: the sweeps with the paper's protocol, and the calibration fitted on them.

use isolux::calibrate::{self, CalibrateSettings, DistanceSweep, ExposureSweep, FitReport};
use isolux::standardize::{DistanceStep, SpecularStep, TimeStep};
use isolux::{Calibration, Channels, Choice, Frame, IntegrationTime, Standardized, Standardizer, Window};
use isolux_camera::{CameraModel, Simulation};

use crate::error::ExperimentError;
use crate::measure::{WINDOW_PX, for_each, mean_amplitude, mean_distance_m, regions, simulation};

/// The laboratory: sweeps and calibration.
#[derive(Debug)]
pub struct Lab {
    /// Seed of all noise.
    pub seed: u64,
    /// The simulated SR-3100.
    pub camera: CameraModel,
    /// A white wall over the register.
    pub wall: WallSweep,
    /// A board over distances, at several integration times, before anything is left out.
    pub board: Vec<BoardMean>,
    /// Fitted on the two sweeps.
    pub calibration: Calibration,
    /// What the fits said.
    pub report: FitReport,
}

/// Mean amplitudes of the wall at each integration time.
#[derive(Clone, Debug, PartialEq)]
pub struct WallSweep {
    /// Integration times, µs, increasing.
    pub times_us: Vec<f64>,
    /// The whole image, then windows of 20×20.
    pub regions: Vec<RegionMeans>,
}

/// Mean amplitudes of one region.
#[derive(Clone, Debug, PartialEq)]
pub struct RegionMeans {
    /// Where.
    pub name: &'static str,
    /// Mean over its valid pixels and all frames of the time, DN.
    pub means_dn: Vec<f64>,
}

/// The board at one distance and one integration time, mean over the frames.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoardMean {
    /// Integration time, µs.
    pub integration_time_us: f64,
    /// True distance, m.
    pub true_distance_m: f64,
    /// Mean measured distance in the window, m.
    pub distance_m: f64,
    /// Mean amplitude in the window, DN.
    pub amplitude_dn: f64,
}

impl Lab {
    /// Simulates the sweeps and fits the calibration.
    ///
    /// # Errors
    /// [`ExperimentError`], which no seed should bring about.
    pub fn new(seed: u64, progress: &mut dyn FnMut(&str)) -> Result<Self, ExperimentError> {
        // The sweeps are measured here and not by the pipeline, since the page shows their means too: one pass over the
        // frames serves both. Both stages at once, since the paper's terms need no linear amplitudes.
        let settings = CalibrateSettings::default();
        progress("wall over the integration times");
        let simulated = simulation("wall-sweep", seed)?;
        let mut exposure = ExposureSweep::new("wall-sweep", &settings);
        let wall = WallSweep::measure(&simulated, |frame| exposure.push(frame))?;
        progress("board over the distances");
        let board_simulation = simulation("board-distances", seed)?;
        let mut distance = DistanceSweep::new("board-distances", &settings);
        let board = measure_board(&board_simulation, |frame| distance.push(frame))?;
        progress("calibration");
        let camera = simulated.model().clone();
        let name = Some(camera.name.clone());
        let (calibration, report) =
            calibrate::fit(&settings, name, vec![exposure.finish()], vec![distance.finish()])?;
        Ok(Self { seed, camera, wall, board, calibration, report })
    }

    /// Plans these steps with the calibration.
    pub(crate) fn plan(
        &self,
        time: TimeStep,
        distance: DistanceStep,
        specular: SpecularStep,
    ) -> Result<Standardizer, ExperimentError> {
        let choice = Choice {
            time: Some(time),
            distance: Some(distance),
            specular: Some(specular),
            ..Choice::default()
        };
        let channels = Channels::AMPLITUDE | Channels::DISTANCE | Channels::INTEGRATION_TIME;
        Ok(Standardizer::plan(&choice, Some(&self.calibration), channels)?)
    }

    /// Applies these steps to one frame.
    pub(crate) fn apply(
        &self,
        frame: &Frame,
        time: TimeStep,
        distance: DistanceStep,
        specular: SpecularStep,
    ) -> Result<Standardized, ExperimentError> {
        Ok(self.plan(time, distance, specular)?.stream().push(frame)?.clone())
    }
}

type Push<'a> = &'a mut dyn FnMut(&isolux::Frame) -> Result<(), calibrate::MeasureError>;

impl WallSweep {
    fn measure(
        simulated: &Simulation,
        mut push: impl FnMut(&isolux::Frame) -> Result<(), calibrate::MeasureError>,
    ) -> Result<Self, ExperimentError> {
        let regions = regions(simulated.shape());
        let mut sweep = Self {
            times_us: Vec::new(),
            regions: regions.iter().map(|(name, _)| RegionMeans { name, means_dn: Vec::new() }).collect(),
        };
        let mut frames = 0.0;
        let push: Push = &mut push;
        for_each(simulated, |_, simulated| {
            let frame = &simulated.frame;
            push(frame)?;
            let IntegrationTime::PerFrame(time_us) = frame.integration_time_us else { return Ok(()) };
            if sweep.times_us.last() != Some(&time_us) {
                sweep.times_us.push(time_us);
                sweep.regions.iter_mut().for_each(|region| region.means_dn.push(0.0));
                frames = 0.0;
            }
            frames += 1.0;
            for (region, (_, window)) in sweep.regions.iter_mut().zip(&regions) {
                if let Some(mean) = region.means_dn.last_mut() {
                    *mean += (mean_amplitude(frame, *window) - *mean) / frames;
                }
            }
            Ok(())
        })?;
        Ok(sweep)
    }
}

fn measure_board(
    simulated: &Simulation,
    mut push: impl FnMut(&isolux::Frame) -> Result<(), calibrate::MeasureError>,
) -> Result<Vec<BoardMean>, ExperimentError> {
    let window = Window::centred(simulated.shape(), WINDOW_PX);
    let centre = simulated.shape().width * (simulated.shape().height / 2) + simulated.shape().width / 2;
    let mut means: Vec<(BoardMean, f64)> = Vec::new();
    for_each(simulated, |_, simulated| {
        let frame = &simulated.frame;
        push(frame)?;
        let IntegrationTime::PerFrame(integration_time_us) = frame.integration_time_us else { return Ok(()) };
        let true_distance_m = f64::from(simulated.truth.true_distance_m.values()[centre]);
        let (distance_m, amplitude_dn) = (mean_distance_m(frame, window), mean_amplitude(frame, window));
        match means.last_mut() {
            Some((mean, frames))
                if mean.integration_time_us == integration_time_us
                    && mean.true_distance_m == true_distance_m =>
            {
                *frames += 1.0;
                mean.distance_m += (distance_m - mean.distance_m) / *frames;
                mean.amplitude_dn += (amplitude_dn - mean.amplitude_dn) / *frames;
            }
            _ => means
                .push((BoardMean { integration_time_us, true_distance_m, distance_m, amplitude_dn }, 1.0)),
        }
        Ok(())
    })?;
    Ok(means.into_iter().map(|(mean, _)| mean).collect())
}
