//! Single frames before and after standardization, for pictures.

use isolux::{Channels, Frame, IntegrationTime, Plane, Standardizer};

use crate::error::PipelineError;
use crate::frames;
use crate::observer::{Observer, Work};
use crate::source::FrameSource;

/// One frame, raw and standardized; NaN where there is no measurement or no value.
#[derive(Clone, Debug)]
pub struct SampleFrame {
    /// Its index, from 0.
    pub index: usize,
    /// Its one integration time, µs, where it has one.
    pub integration_time_us: Option<f64>,
    /// Amplitude as it was recorded, DN.
    pub raw: Plane<f32>,
    /// Standardized amplitude, DN.
    pub standardized: Plane<f32>,
}

/// Standardizes single frames of a recording, each with those before it that it depends on.
///
/// # Errors
/// [`PipelineError::FrameMissing`], [`PipelineError::Frame`], and those of reading.
pub fn sample_frames(
    source: &mut dyn FrameSource,
    standardizer: &Standardizer,
    indices: &[usize],
) -> Result<Vec<SampleFrame>, PipelineError> {
    let facts = source.facts();
    let mut frame = Frame::new(facts.shape);
    let mut stream = standardizer.stream();
    let mut samples = Vec::new();
    for &index in indices {
        frames::read_alone(source, index, Channels::INTEGRATION_TIME, &mut stream, &mut frame)?;
        let out = stream.push(&frame);
        let out = out.map_err(|error| PipelineError::frame(&facts.name, index)(error.into()))?;
        samples.push(SampleFrame {
            index,
            integration_time_us: single_time_us(&frame),
            raw: measured(&frame),
            standardized: out.amplitude.clone(),
        });
    }
    Ok(samples)
}

/// The raw amplitude, NaN where it is no measurement.
fn measured(frame: &Frame) -> Plane<f32> {
    let mut plane = frame.amplitude.clone();
    for (index, value) in plane.values_mut().iter_mut().enumerate() {
        if !frame.is_valid(index) {
            *value = f32::NAN;
        }
    }
    plane
}

/// The first frame of each of the wanted integration times, µs, as far as there is one.
///
/// # Errors
/// Those of reading, and [`PipelineError::Interrupted`] once the observer has cancelled.
pub fn first_frames_at(
    source: &mut dyn FrameSource,
    times_us: &[f64],
    observer: &dyn Observer,
) -> Result<Vec<usize>, PipelineError> {
    let times = frame_times(source, observer)?;
    let first = |wanted: &f64| times.iter().position(|time_us| *time_us == Some(*wanted));
    Ok(times_us.iter().filter_map(first).collect())
}

/// The one time of each frame, µs, where it has one.
pub(super) fn frame_times(
    source: &mut dyn FrameSource,
    observer: &dyn Observer,
) -> Result<Vec<Option<f64>>, PipelineError> {
    let mut times = Vec::new();
    frames::for_each(source, Channels::INTEGRATION_TIME, Work::ReadingTimes, observer, |_, frame| {
        times.push(single_time_us(frame));
        Ok(())
    })?;
    Ok(times)
}

fn single_time_us(frame: &Frame) -> Option<f64> {
    match frame.integration_time_us {
        IntegrationTime::PerFrame(time_us) => Some(time_us),
        IntegrationTime::Unknown | IntegrationTime::PerPixel(_) => None,
    }
}
