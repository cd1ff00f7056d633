//! `isolux info`: what a recording holds, and what can be done with it.

use isolux::Channels;
use isolux::inspect::Suspicion;
use isolux_io::Metadata;
use isolux_io::recording::{LensDescription, Storage};
use isolux_pipeline::inspect;
use isolux_pipeline::overview::{Overview, Spread, overview};
use serde::Serialize;

use crate::advice;
use crate::failure::Outcome;
use crate::options::InfoArgs;
use crate::terminal::{self, Terminal, table};

/// More different times than this are shown as a range.
const LISTED_TIMES: usize = 6;

#[derive(Debug, Serialize)]
struct Report {
    recording: String,
    camera: Option<String>,
    frames: usize,
    height: usize,
    width: usize,
    lens: Option<String>,
    channels: Vec<Channel>,
    #[serde(flatten)]
    overview: Overview,
    suspicions: Vec<Suspicion>,
    advice: Vec<String>,
}

#[derive(Debug, Serialize)]
struct Channel {
    name: String,
    element: &'static str,
    frame_dims: Vec<usize>,
    storage: String,
}

pub(crate) fn run(args: &InfoArgs) -> Outcome {
    let mut recording = isolux_io::open(&args.recording)?;
    let observer = Terminal::default();
    let suspicions = inspect(&mut recording, &observer)?;
    let overview = overview(&mut recording, &observer)?;
    let metadata = recording.metadata();
    let report = Report {
        recording: metadata.path.display().to_string(),
        camera: metadata.info.camera.clone(),
        frames: metadata.require_frame_count()?,
        height: metadata.shape.height,
        width: metadata.shape.width,
        lens: lens(metadata),
        channels: metadata.channels.iter().map(channel).collect(),
        advice: possible(metadata, &overview),
        overview,
        suspicions,
    };
    if args.json { terminal::print_json(&report) } else { terminal::print(describe(&report)) }
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

/// The lens in words, with what of it is not used.
fn lens(metadata: &Metadata) -> Option<String> {
    let LensDescription { lens, unused } = metadata.lens();
    let seen = lens.map(|lens| {
        let (blind, of) = (lens.pixel_rays(metadata.shape).blind_pixels(), metadata.shape.pixels());
        let source = if metadata.rays.is_some() { " (rays.npy)" } else { "" };
        let blind = if blind > 0 { format!(", {blind} of {of} pixels without a ray") } else { String::new() };
        format!("{lens}{source}{blind}")
    });
    let words: Vec<String> = seen.into_iter().chain(unused.map(|unused| unused.to_string())).collect();
    (!words.is_empty()).then(|| words.join("; "))
}

/// What can be done with the recording, and what it lacks.
fn possible(metadata: &Metadata, overview: &Overview) -> Vec<String> {
    let has = |channels| metadata.available.contains(channels);
    let (path, times) = (metadata.path.display(), overview.integration_times_us.len());
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
    } else if times >= 2 && !overview.integration_time_per_pixel {
        advice.push(format!(
            "{times} integration times: if the scene stood still, isolux calibrate --exposure-sweep {path} -o CAMERA.json; \
             --reference-time-us chooses the time at which amplitudes keep their value"
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
    lines.extend(report.lens.iter().map(|lens| format!("lens       {lens}")));
    let dims = |dims: &[usize]| dims.iter().map(usize::to_string).collect::<Vec<_>>().join("×");
    let rows: Vec<Vec<String>> = report
        .channels
        .iter()
        .map(|c| vec![format!("  {}", c.name), c.element.to_owned(), dims(&c.frame_dims), c.storage.clone()])
        .collect();
    lines.extend(["channels, values per frame".to_owned(), table(&rows)]);
    lines.push(format!("integration time  {}", describe_times(report)));
    let sampled = format!("of {} frames", report.overview.sampled_frames);
    let percent = |share: f64| format!("{:.2} %", 100.0 * share);
    let spread = |s: &Spread, digits: usize| {
        let Spread { minimum, p05, median, p95, maximum } = s;
        format!(
            "{minimum:.digits$} | {p05:.digits$} | {median:.digits$} | {p95:.digits$} | {maximum:.digits$} \
             (minimum | 5 % | median | 95 % | maximum)"
        )
    };
    if let Some(amplitude) = &report.overview.amplitude_dn {
        lines.push(format!("amplitude in DN   {}", spread(amplitude, 1)));
    }
    if let (Some(invalid), Some(saturated)) =
        (report.overview.invalid_amplitude_share, report.overview.saturated_share)
    {
        let (invalid, saturated) = (percent(invalid), percent(saturated));
        lines.push(format!("                  {invalid} invalid, {saturated} saturated, {sampled}"));
    }
    if let Some(distance) = &report.overview.distance_m {
        lines.push(format!("distance in m     {}", spread(distance, 3)));
    }
    if let Some(share) = report.overview.invalid_distance_share {
        lines.push(format!("                  {} invalid, {sampled}", percent(share)));
    }
    if !report.suspicions.is_empty() {
        lines.push("what looks wrong".to_owned());
    }
    let suspicions = report.suspicions.iter();
    lines.extend(suspicions.map(|found| format!("  {}", advice::with(found, found.advice()))));
    lines.push("what can be done".to_owned());
    lines.extend(report.advice.iter().map(|advice| format!("  {advice}")));
    lines.join("\n")
}

fn describe_times(report: &Report) -> String {
    let times = &report.overview.integration_times_us;
    let scope = if report.overview.integration_time_per_pixel { ", per pixel" } else { "" };
    match times.as_slice() {
        [] => "unknown".to_owned(),
        few if few.len() <= LISTED_TIMES => {
            format!("{} µs{scope}", few.iter().map(f64::to_string).collect::<Vec<_>>().join(", "))
        }
        [first, .., last] => format!("{first} to {last} µs, {} different{scope}", times.len()),
        [only] => format!("{only} µs{scope}"),
    }
}
