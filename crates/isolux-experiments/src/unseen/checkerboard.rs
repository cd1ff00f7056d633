//! A checkerboard in many poses before a real camera: how much the amplitude of its white squares still varies over
//! distance, tilt and place, in frames that the calibration has not seen.

use isolux::calibrate::{CalibrateSettings, label_windows};
use isolux::calibration::REFERENCE_TIME_US;
use isolux::standardize::{AngleStep, DenoiseStep, DistanceStep, ProfileStep};
use isolux::statistics::{SIGMA_PER_MAD, median, median_absolute_deviation};
use isolux::{
    Calibration, Channels, Choice, DenoiseRule, Frame, IntegrationTime, Intrinsics, PixelFlags, Plane,
    RecordingTraits, Shape, Standardizer,
};
use isolux_io::RecordingInfo;
use isolux_pipeline::{CalibrationSources, FramesInMemory, SourceFacts, Unobserved, calibrate};

use crate::error::ExperimentError;

/// Frames are left out in turn in so many parts: every fifth frame.
const FOLDS: usize = 5;

/// What is measured, and where.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Protocol {
    /// Intrinsics of the camera.
    pub intrinsics: Intrinsics,
    /// Label of the squares that are measured.
    pub label: u8,
    /// Nearer windows do not count, m: there the squares saturate.
    pub nearest_m: f64,
}

/// Spread of ln A over the windows of all frames.
#[derive(Clone, Debug, PartialEq)]
pub struct Spread {
    /// What was done to the amplitude.
    pub name: &'static str,
    /// Standard deviation.
    pub deviation: f64,
    /// 1.4826 times the median absolute deviation.
    pub robust: f64,
    /// Windows with a value.
    pub windows: usize,
    /// All windows that could have one.
    pub of: usize,
}

/// The steps of one row of the table, with the calibration or without.
struct Method {
    name: &'static str,
    calibrated: bool,
    choice: Choice,
}

fn methods() -> [Method; 5] {
    let textbook = Choice {
        denoise: Some(DenoiseStep::Smooth(DenoiseRule::Wiener)),
        ..Choice::textbook(Channels::AMPLITUDE | Channels::DISTANCE)
    };
    let fitted = Choice { distance: Some(DistanceStep::Spline), profile: Some(ProfileStep::On), ..textbook };
    let by_angle = |choice: Choice| Choice { angle: Some(AngleStep::On), ..choice };
    let raw = Choice { distance: Some(DistanceStep::None), ..textbook };
    let method = |name, calibrated, choice| Method { name, calibrated, choice };
    [
        method("raw", false, raw),
        method("d²", false, textbook),
        method("d², Lambert", false, by_angle(textbook)),
        method("spline, profile", true, fitted),
        method("spline, profile, angle", true, by_angle(fitted)),
    ]
}

/// Spread of the white squares by each method. Calibrations are fitted to the other frames than those that are measured
/// with them.
///
/// # Errors
/// [`ExperimentError`] when a calibration cannot be fitted or applied.
pub fn spreads(frames: &[Frame], protocol: &Protocol) -> Result<Vec<Spread>, ExperimentError> {
    let methods = methods();
    let mut logs = vec![Vec::new(); methods.len()];
    let mut windows = 0;
    for fold in 0..FOLDS {
        let calibration = calibrate_without(frames, protocol, fold)?;
        let traits = RecordingTraits {
            shape: frames.first().map(Frame::shape),
            lens: Some(protocol.intrinsics.into()),
            ..(Channels::AMPLITUDE | Channels::DISTANCE).into()
        };
        let mut chains = Vec::new();
        for method in &methods {
            let terms = Some(&calibration).filter(|_| method.calibrated);
            chains.push(Standardizer::plan(&method.choice, terms, traits.clone())?.stream());
        }
        for frame in frames.iter().skip(fold).step_by(FOLDS) {
            let measured = measured_windows(frame, protocol);
            windows += measured.len();
            for (chain, logs) in chains.iter_mut().zip(&mut logs) {
                let out = chain.push(frame)?;
                logs.extend(measured.iter().filter_map(|window| ln_median(&out.amplitude, window)));
            }
        }
    }
    Ok(methods.iter().zip(logs).map(|(method, logs)| spread(method.name, &logs, windows)).collect())
}

fn calibrate_without(
    frames: &[Frame],
    protocol: &Protocol,
    fold: usize,
) -> Result<Calibration, ExperimentError> {
    let others = frames.iter().enumerate().filter(|(index, _)| index % FOLDS != fold);
    let others: Vec<Frame> = others.map(|(_, frame)| with_constant_time(frame)).collect();
    let shape = frames.first().map_or(Shape::new(0, 0), Frame::shape);
    let info = RecordingInfo { intrinsics: Some(protocol.intrinsics.into()), ..RecordingInfo::default() };
    let channels = Channels::AMPLITUDE | Channels::DISTANCE | Channels::TARGET | Channels::INTEGRATION_TIME;
    let facts = SourceFacts { info, ..SourceFacts::new("checkerboard", shape, channels) };
    let others = FramesInMemory::new(facts, &others);
    let sources = CalibrationSources { targets: vec![Box::new(others)], ..CalibrationSources::default() };
    Ok(calibrate(&CalibrateSettings::default(), None, sources, &Unobserved)?.0)
}

/// The times are not recorded. All frames together show that they are equal (d⁻², and frames that agree), some of them
/// alone need not.
fn with_constant_time(frame: &Frame) -> Frame {
    Frame { integration_time_us: IntegrationTime::PerFrame(REFERENCE_TIME_US), ..frame.clone() }
}

/// Indices of the windows of 5×5 pixels inside the squares, all of whose pixels are measured, far enough.
fn measured_windows(frame: &Frame, protocol: &Protocol) -> Vec<Vec<usize>> {
    let (Some(target), Some(distance_m)) = (&frame.target, &frame.distance_m) else { return Vec::new() };
    let indices = label_windows(target).into_iter().map(|window| window.indices(frame.shape()).collect());
    let counts = |window: &Vec<usize>| {
        let bad = PixelFlags::INVALID | PixelFlags::SATURATED;
        let whole = window.iter().all(|&i| {
            target.values()[i] == protocol.label
                && !frame.flags.values()[i].intersects(bad)
                && distance_m.values()[i] > 0.0
        });
        let mut distances: Vec<f64> = window.iter().map(|&i| f64::from(distance_m.values()[i])).collect();
        whole && median(&mut distances).is_some_and(|distance| distance > protocol.nearest_m)
    };
    indices.filter(counts).collect()
}

/// ln of the median of a window; `None` where half of it or more has no value.
fn ln_median(values: &Plane<f32>, window: &[usize]) -> Option<f64> {
    let mut valid: Vec<f64> =
        window.iter().map(|&i| f64::from(values.values()[i])).filter(|value| *value > 0.0).collect();
    (2 * valid.len() > window.len()).then(|| median(&mut valid).map(f64::ln)).flatten()
}

fn spread(name: &'static str, logs: &[f64], of: usize) -> Spread {
    let count = logs.len().max(1) as f64;
    let mean = logs.iter().sum::<f64>() / count;
    let deviation = (logs.iter().map(|log| (log - mean).powi(2)).sum::<f64>() / count).sqrt();
    let robust = SIGMA_PER_MAD * median_absolute_deviation(&mut logs.to_vec()).unwrap_or(f64::NAN);
    Spread { name, deviation, robust, windows: logs.len(), of }
}
