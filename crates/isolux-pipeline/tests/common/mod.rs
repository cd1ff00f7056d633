//! Simulated sweeps in memory, and what a calibration makes of them.
#![allow(dead_code, unreachable_pub, reason = "each test binary uses its own part")]

use isolux::calibrate::{CalibrateSettings, FitReport};
use isolux::{Calibration, Channels, Frame, IntegrationTime};
use isolux_camera::{CameraModel, Scene, Simulation};
use isolux_pipeline::simulate::SimulatedFrames;
use isolux_pipeline::{
    CalibrationSources, FrameSource, FramesInMemory, PipelineError, SourceFacts, Unobserved, calibrate,
};

/// A recording in memory, to be spoilt.
#[derive(Clone)]
pub struct Take {
    pub facts: SourceFacts,
    pub frames: Vec<Frame>,
}

impl Take {
    /// A built-in scene before its camera: amplitude, distance, intensity and labels, as most cameras deliver them.
    pub fn builtin(scene: &str) -> Self {
        let camera = CameraModel::preset(&Scene::builtin(scene).unwrap().camera).unwrap();
        Self::of(camera, scene, 1)
    }

    /// A built-in scene before any camera.
    pub fn of(camera: CameraModel, scene: &str, seed: u64) -> Self {
        let simulation = Simulation::new(camera, Scene::builtin(scene).unwrap(), seed).unwrap();
        let mut source = SimulatedFrames::new(&simulation);
        let mut facts = source.facts();
        facts.available.remove(Channels::PHASE_SAMPLES);
        let (mut frames, mut frame) = (Vec::new(), Frame::new(facts.shape));
        while source.read(frames.len(), Channels::all(), &mut frame).unwrap() {
            let mut kept = frame.clone();
            kept.phase_samples = None;
            frames.push(kept);
        }
        Self { facts, frames }
    }

    pub fn len(&self) -> usize {
        self.frames.len()
    }

    pub fn source(&self) -> Box<dyn FrameSource + '_> {
        Box::new(FramesInMemory::new(self.facts.clone(), &self.frames))
    }

    /// The same after `change`, which takes the number of each frame, and the frame.
    pub fn spoilt(mut self, change: impl Fn(usize, &mut Frame)) -> Self {
        for (number, frame) in self.frames.iter_mut().enumerate() {
            change(number, frame);
            frame.flag_amplitude(None);
        }
        self
    }

    /// The same with the times of the frames that came `frames` earlier; the first ones keep theirs.
    pub fn lagging(mut self, frames: usize) -> Self {
        let times: Vec<IntegrationTime> =
            self.frames.iter().map(|frame| frame.integration_time_us.clone()).collect();
        for (number, frame) in self.frames.iter_mut().enumerate() {
            frame.integration_time_us = times[number.saturating_sub(frames)].clone();
        }
        self
    }
}

/// Every value of the light times a factor.
pub fn dim(frame: &mut Frame, factor: f32) {
    frame.amplitude.values_mut().iter_mut().for_each(|value| *value *= factor);
    if let Some(intensity) = &mut frame.intensity {
        intensity.values_mut().iter_mut().for_each(|value| *value *= factor);
    }
}

pub type Fitted = Result<(Calibration, FitReport), PipelineError>;

pub fn fit_sweeps(wall: Option<&Take>, board: Option<&Take>) -> Fitted {
    fit_with(&CalibrateSettings::default(), wall, board)
}

pub fn fit_with(settings: &CalibrateSettings, wall: Option<&Take>, board: Option<&Take>) -> Fitted {
    let sources = CalibrationSources {
        exposure_sweeps: wall.map(Take::source).into_iter().collect(),
        distance_sweeps: board.map(Take::source).into_iter().collect(),
        ..Default::default()
    };
    calibrate(settings, None, sources, &Unobserved)
}

pub fn fit_target(target: &Take) -> Fitted {
    let sources = CalibrationSources { targets: vec![target.source()], ..Default::default() };
    calibrate(&CalibrateSettings::default(), None, sources, &Unobserved)
}

/// Largest relative difference of the multipliers over time and distance between two calibrations, over the range of
/// the first.
pub fn largest_difference(of: &Calibration, from: &Calibration) -> f64 {
    let mut largest = 0.0f64;
    if let (Some(a), Some(b)) = (&of.terms.lut, &from.terms.lut) {
        for &time_us in &b.integration_time_us {
            use isolux::terms::lut::LutAnswer::{Below, Inside};
            let value = |lut: &isolux::terms::Lut| match lut.at(time_us) {
                Inside(multiplier) | Below(multiplier) => multiplier,
                isolux::terms::lut::LutAnswer::Refused => f64::INFINITY,
            };
            largest = largest.max((value(a) / value(b) - 1.0).abs());
        }
    }
    if let (Some(a), Some(b)) = (&of.terms.cubic, &from.terms.cubic) {
        for distance_m in steps(b.valid_distance_m) {
            let value = |cubic: &isolux::terms::Cubic| {
                cubic.coefficients.iter().rev().fold(0.0, |sum, c| sum * distance_m + c)
            };
            largest = largest.max((value(a) / value(b) - 1.0).abs());
        }
    }
    if let (Some(a), Some(b)) = (&of.terms.spline, &from.terms.spline) {
        for distance_m in steps(b.law.valid_distance_m) {
            largest = largest.max((a.multiplier(distance_m) / b.multiplier(distance_m) - 1.0).abs());
        }
    }
    largest
}

fn steps([from, to]: [f64; 2]) -> impl Iterator<Item = f64> {
    (0..=40).map(move |step| from * (to / from).powf(f64::from(step) / 40.0))
}
