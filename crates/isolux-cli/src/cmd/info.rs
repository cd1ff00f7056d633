//! `isolux info`: what a recording holds, and what can be done with it.

use std::collections::BTreeSet;

use isolux::statistics::quantile;
use isolux::{Channels, Frame, IntegrationTime, PixelFlags};
use isolux_io::recording::Storage;
use isolux_io::{Metadata, Recording};
use serde::Serialize;

use crate::args::InfoArgs;
use crate::console::{self, table};
use crate::failure::Outcome;

/// Frames that are looked at; evenly spread, so that long recordings answer at once.
const SAMPLED_FRAMES: usize = 16;
/// Values that the quantiles rest on; more would take memory without making them better.
const SAMPLED_VALUES: usize = 1 << 20;
/// More different times than this are shown as a range.
const LISTED_TIMES: usize = 6;

#[derive(Debug, Serialize)]
struct Report {
    recording: String,
    camera: Option<String>,
    frames: usize,
    height: usize,
    width: usize,
    channels: Vec<Channel>,
    /// The figures below come from this many frames.
    sampled_frames: usize,
    integration_times_us: Vec<f64>,
    integration_time_per_pixel: bool,
    amplitude_dn: Option<Spread>,
    distance_m: Option<Spread>,
    invalid_amplitude_share: Option<f64>,
    saturated_share: Option<f64>,
    invalid_distance_share: Option<f64>,
    advice: Vec<String>,
}

#[derive(Debug, Serialize)]
struct Channel {
    name: String,
    element: &'static str,
    frame_dims: Vec<usize>,
    storage: String,
}

/// Quantiles over the valid pixels of the sampled frames.
#[derive(Debug, Serialize)]
struct Spread {
    minimum: f64,
    p05: f64,
    median: f64,
    p95: f64,
    maximum: f64,
}

pub(crate) fn run(args: &InfoArgs) -> Outcome {
    let mut recording = isolux_io::open(&args.recording)?;
    let report = report(&mut *recording)?;
    if args.json { console::print_json(&report) } else { console::print(describe(&report)) }
}

fn report(recording: &mut dyn Recording) -> Outcome<Report> {
    let metadata = recording.metadata().clone();
    let sample = sample(recording, &metadata)?;
    let times: Vec<f64> = sample.times.iter().map(|bits| f64::from_bits(*bits)).collect();
    let share = |count: usize| count as f64 / sample.pixels.max(1) as f64;
    let has_amplitude = metadata.available.contains(Channels::AMPLITUDE);
    Ok(Report {
        recording: metadata.path.display().to_string(),
        camera: metadata.info.camera.clone(),
        frames: metadata.require_frame_count()?,
        height: metadata.shape.height,
        width: metadata.shape.width,
        channels: metadata.channels.iter().map(channel).collect(),
        sampled_frames: sample.frames,
        advice: advice(&metadata, &times, sample.per_pixel),
        integration_times_us: times,
        integration_time_per_pixel: sample.per_pixel,
        invalid_amplitude_share: has_amplitude.then(|| share(sample.invalid)),
        saturated_share: has_amplitude.then(|| share(sample.saturated)),
        invalid_distance_share: metadata
            .available
            .contains(Channels::DISTANCE)
            .then(|| share(sample.invalid_distances)),
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

fn sample(recording: &mut dyn Recording, metadata: &Metadata) -> Outcome<Sample> {
    let mut sample = Sample::default();
    let mut frame = Frame::new(metadata.shape);
    let wanted = metadata.available & (Channels::AMPLITUDE | Channels::DISTANCE | Channels::INTEGRATION_TIME);
    let frame_count = metadata.require_frame_count()?;
    let count = frame_count.min(SAMPLED_FRAMES);
    for step in 0..count {
        // From the first to the last frame.
        let index = if count == 1 { 0 } else { step * (frame_count - 1) / (count - 1) };
        recording.read_frame(index, wanted, &mut frame)?;
        sample.add(&frame, wanted);
    }
    let scalar_times = metadata.available.contains(Channels::INTEGRATION_TIME) && !sample.per_pixel;
    for index in 0..if scalar_times { frame_count } else { 0 } {
        recording.read_frame(index, Channels::INTEGRATION_TIME, &mut frame)?;
        sample.add_time(&frame.integration_time_us, 1);
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

fn channel(channel: &isolux_io::recording::ChannelInfo) -> Channel {
    let storage = match &channel.storage {
        Storage::Constant => "constant in recording.json".to_owned(),
        Storage::FromPhaseSamples => "computed from phase_samples".to_owned(),
        Storage::Stored { note } => note.clone(),
    };
    let (name, frame_dims) = (channel.name.clone(), channel.frame_dims.clone());
    Channel { name, element: channel.element.name(), frame_dims, storage }
}

/// What can be done with the recording, and what it lacks.
fn advice(metadata: &Metadata, times_us: &[f64], per_pixel: bool) -> Vec<String> {
    let has = |channels| metadata.available.contains(channels);
    let path = metadata.path.display();
    let mut advice = Vec::new();
    if !has(Channels::AMPLITUDE) {
        advice.push("no amplitude and no phase samples: nothing to standardize".to_owned());
        return advice;
    }
    advice.push(format!(
        "isolux standardize {path} -o OUT: textbook physics, as far as the channels are there"
    ));
    if !has(Channels::DISTANCE) {
        advice.push("no distance: its effect stays in the amplitude".to_owned());
    }
    if !has(Channels::INTEGRATION_TIME) {
        advice.push(
            "no integration time: its effect stays in; if it was constant, add \"integration_time_us\" to recording.json"
                .to_owned(),
        );
    } else if times_us.len() >= 2 && !per_pixel {
        advice.push(format!(
            "{} integration times: if the scene stood still, isolux calibrate --exposure-sweep {path} -o CAMERA.json",
            times_us.len()
        ));
    }
    advice
}

fn describe(report: &Report) -> String {
    let mut lines = vec![
        format!("recording  {}", report.recording),
        format!("camera     {}", report.camera.as_deref().unwrap_or("(not named)")),
        format!("frames     {} of {}×{} (height×width)", report.frames, report.height, report.width),
    ];
    let dims = |dims: &[usize]| dims.iter().map(usize::to_string).collect::<Vec<_>>().join("×");
    let rows: Vec<Vec<String>> = report
        .channels
        .iter()
        .map(|c| vec![format!("  {}", c.name), c.element.to_owned(), dims(&c.frame_dims), c.storage.clone()])
        .collect();
    lines.extend(["channels, values per frame".to_owned(), table(&rows)]);
    lines.push(format!("integration time  {}", describe_times(report)));
    let sampled = format!("of {} frames", report.sampled_frames);
    let percent = |share: f64| format!("{:.2} %", 100.0 * share);
    let spread = |s: &Spread, digits: usize| {
        let Spread { minimum, p05, median, p95, maximum } = s;
        format!(
            "{minimum:.digits$} | {p05:.digits$} | {median:.digits$} | {p95:.digits$} | {maximum:.digits$} \
             (minimum | 5 % | median | 95 % | maximum)"
        )
    };
    if let Some(amplitude) = &report.amplitude_dn {
        lines.push(format!("amplitude in DN   {}", spread(amplitude, 1)));
    }
    if let (Some(invalid), Some(saturated)) = (report.invalid_amplitude_share, report.saturated_share) {
        let (invalid, saturated) = (percent(invalid), percent(saturated));
        lines.push(format!("                  {invalid} invalid, {saturated} saturated, {sampled}"));
    }
    if let Some(distance) = &report.distance_m {
        lines.push(format!("distance in m     {}", spread(distance, 3)));
    }
    if let Some(share) = report.invalid_distance_share {
        lines.push(format!("                  {} invalid, {sampled}", percent(share)));
    }
    lines.push("what can be done".to_owned());
    lines.extend(report.advice.iter().map(|advice| format!("  {advice}")));
    lines.join("\n")
}

fn describe_times(report: &Report) -> String {
    let times = &report.integration_times_us;
    let scope = if report.integration_time_per_pixel { ", per pixel" } else { "" };
    match times.as_slice() {
        [] => "unknown".to_owned(),
        few if few.len() <= LISTED_TIMES => {
            format!("{} µs{scope}", few.iter().map(f64::to_string).collect::<Vec<_>>().join(", "))
        }
        [first, .., last] => format!("{first} to {last} µs, {} different{scope}", times.len()),
        [only] => format!("{only} µs{scope}"),
    }
}
