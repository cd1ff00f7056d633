//! Summarizes a recording from a few of its frames.

use std::collections::BTreeSet;

use isolux::statistics::quantile;
use isolux::{Channels, Frame, IntegrationTime, PixelFlags};
use serde::Serialize;

use crate::error::PipelineError;
use crate::frames;
use crate::observer::{Observer, Work};
use crate::source::{FrameSource, SourceFacts};

/// Frames that are looked at; evenly spread, so that long recordings answer at once.
const SAMPLED_FRAMES: usize = 16;
/// Values that the quantiles rest on; more would take memory without making them better.
const SAMPLED_VALUES: usize = 1 << 20;

/// Summary of a recording. Shares (0..=1) and quantiles come from a few of its frames.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Overview {
    /// The figures below come from this many frames.
    pub sampled_frames: usize,
    /// The known integration times of all frames, increasing, µs; where each pixel has its own, those of sampled pixels.
    pub integration_times_us: Vec<f64>,
    /// True where each pixel has its own integration time.
    pub integration_time_per_pixel: bool,
    /// The valid amplitudes, DN.
    pub amplitude_dn: Option<Spread>,
    /// The valid distances, m.
    pub distance_m: Option<Spread>,
    /// Share of the pixels without an amplitude.
    pub invalid_amplitude_share: Option<f64>,
    /// Share of the pixels that are saturated.
    pub saturated_share: Option<f64>,
    /// Share of the pixels without a distance.
    pub invalid_distance_share: Option<f64>,
}

/// Quantiles over the valid pixels of the sampled frames.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Spread {
    /// The least.
    pub minimum: f64,
    /// 5 % are below it.
    pub p05: f64,
    /// Half are below it.
    pub median: f64,
    /// 95 % are below it.
    pub p95: f64,
    /// The greatest.
    pub maximum: f64,
}

/// Reads a few frames, from the first to the last, and all integration times.
///
/// # Errors
/// Those of reading, and [`PipelineError::Interrupted`] once the observer has cancelled.
pub fn overview(source: &mut dyn FrameSource, observer: &dyn Observer) -> Result<Overview, PipelineError> {
    let facts = source.facts();
    let sample = sample(source, &facts, observer)?;
    let share = |count: usize| count as f64 / sample.pixels.max(1) as f64;
    let has_amplitude = facts.available.contains(Channels::AMPLITUDE);
    let has_distance = facts.available.contains(Channels::DISTANCE);
    Ok(Overview {
        sampled_frames: sample.frames,
        integration_times_us: sample.times.iter().map(|bits| f64::from_bits(*bits)).collect(),
        integration_time_per_pixel: sample.per_pixel,
        invalid_amplitude_share: has_amplitude.then(|| share(sample.invalid)),
        saturated_share: has_amplitude.then(|| share(sample.saturated)),
        invalid_distance_share: has_distance.then(|| share(sample.invalid_distances)),
        amplitude_dn: spread(sample.amplitudes),
        distance_m: spread(sample.distances),
    })
}

#[derive(Default)]
struct Sample {
    frames: usize,
    pixels: usize,
    invalid: usize,
    saturated: usize,
    invalid_distances: usize,
    /// Bits of the known times, which order like the times.
    times: BTreeSet<u64>,
    per_pixel: bool,
    amplitudes: Vec<f64>,
    distances: Vec<f64>,
}

fn sample(
    source: &mut dyn FrameSource,
    facts: &SourceFacts,
    observer: &dyn Observer,
) -> Result<Sample, PipelineError> {
    let mut sample = Sample::default();
    let mut frame = Frame::new(facts.shape);
    let wanted = facts.available & (Channels::AMPLITUDE | Channels::DISTANCE | Channels::INTEGRATION_TIME);
    for step in 0..SAMPLED_FRAMES {
        let index = match facts.frame_count {
            Some(count) if count > SAMPLED_FRAMES => step * (count - 1) / (SAMPLED_FRAMES - 1),
            _ => step,
        };
        if !source.read(index, wanted, &mut frame)? {
            break;
        }
        sample.add(&frame, wanted);
    }
    if facts.available.contains(Channels::INTEGRATION_TIME) && !sample.per_pixel {
        frames::for_each(source, Channels::INTEGRATION_TIME, Work::ReadingTimes, observer, |_, frame| {
            sample.add_time(&frame.integration_time_us, 1);
            Ok(())
        })?;
    }
    Ok(sample)
}

impl Sample {
    fn add(&mut self, frame: &Frame, wanted: Channels) {
        self.frames += 1;
        self.pixels += frame.shape().pixels();
        let stride = (frame.shape().pixels() * SAMPLED_FRAMES).div_ceil(SAMPLED_VALUES);
        self.add_time(&frame.integration_time_us, stride);
        if wanted.contains(Channels::AMPLITUDE) {
            let count = |flag| frame.flags.values().iter().filter(|flags| flags.contains(flag)).count();
            self.invalid += count(PixelFlags::INVALID);
            self.saturated += count(PixelFlags::SATURATED);
            let valid = (0..frame.shape().pixels()).step_by(stride).filter(|&i| frame.is_valid(i));
            self.amplitudes.extend(valid.map(|i| f64::from(frame.amplitude.values()[i])));
        }
        if let Some(distances_m) = &frame.distance_m {
            let valid = |d: &&f32| **d > 0.0 && d.is_finite();
            self.invalid_distances += distances_m.values().iter().filter(|d| !valid(d)).count();
            let sampled = distances_m.values().iter().step_by(stride).filter(valid);
            self.distances.extend(sampled.map(|&d| f64::from(d)));
        }
    }

    /// Of a map, every `stride`th pixel, or the next odd number: cameras that mix times alternate them by columns.
    fn add_time(&mut self, time: &IntegrationTime, stride: usize) {
        let mut insert = |time: f64| {
            if time > 0.0 {
                self.times.insert(time.to_bits());
            }
        };
        match time {
            IntegrationTime::Unknown => {}
            IntegrationTime::PerFrame(time) => insert(*time),
            IntegrationTime::PerPixel(map) => {
                map.values().iter().step_by(stride | 1).for_each(|&time| insert(f64::from(time)));
                self.per_pixel = true;
            }
        }
    }
}

fn spread(mut values: Vec<f64>) -> Option<Spread> {
    let mut at = |fraction| quantile(&mut values, fraction);
    Some(Spread { minimum: at(0.0)?, p05: at(0.05)?, median: at(0.5)?, p95: at(0.95)?, maximum: at(1.0)? })
}
