//! `isolux standardize`: a recording in, a standardized recording out.

mod brackets;

use std::path::Path;

use isolux::standardize::{AppliedStep, BracketMerge, FrameSummary};
use isolux::{Calibration, Frame, PixelFlags, Reference, Standardized, Standardizer};
use isolux_io::{ChannelSpec, ElementType, Metadata, Recording, RecordingInfo, RecordingWriter};
use rayon::prelude::*;
use serde::Serialize;
use serde_json::{Map, Value, json};

use self::brackets::Merging;
use crate::args::StandardizeArgs;
use crate::chain::{self, Chain, Smoothed};
use crate::console;
use crate::failure::{Failure, Outcome};
use crate::{frames, interrupt, output, sigma};

pub(crate) use self::brackets::Brackets;

/// Name of the output's main channel.
const VALUES: &str = "standardized_amplitude";
/// Name of its flags.
const FLAGS: &str = "flags";
/// Name of their predicted standard deviation.
const SIGMA: &str = "sigma";

/// Memory for the frames that are worked on at once, however many threads there are.
const BATCH_BYTES: usize = 128 << 20;
/// Amplitude, distance, integration times and flags of a frame; result, flags and the specular rule's scratch; up
/// to four planes of the denoising rules; intensity and raw bins, linear amplitude and distance of the response; four of
/// the angles.
const SLOT_BYTES_PER_PIXEL: usize = 4 + 4 + 4 + 2 + 4 + 2 + 4 + 4 * 4 + 5 * 4 + 2 * 4 + 4 * 4;
/// Intensity, result, and what denoising leaves of the distance's noise.
const SIGMA_BYTES_PER_PIXEL: usize = 4 + 4 + 4;

/// What to write besides the two channels, and how.
#[derive(Clone, Debug, Default)]
pub(crate) struct WriteOptions {
    pub(crate) keep_input: bool,
    pub(crate) overwrite: bool,
    pub(crate) threads: Option<u16>,
    /// Frames that are merged into one; none keeps each.
    pub(crate) brackets: Option<Brackets>,
}

/// Totals over all frames.
#[derive(Clone, Debug, Default, Serialize)]
pub(crate) struct Summary {
    pub(crate) frames: usize,
    pub(crate) pixels: usize,
    pub(crate) valid: usize,
    pub(crate) time_refused: usize,
    pub(crate) time_extrapolated: usize,
    pub(crate) distance_extrapolated: usize,
    pub(crate) illumination_extrapolated: usize,
    pub(crate) specular: usize,
    /// Frames in which the specular rule found no cutoff, or there was no such step.
    pub(crate) frames_without_cutoff: usize,
}

pub(crate) fn run(args: &StandardizeArgs) -> Outcome {
    let inputs = [Some(args.recording.as_path()), args.calibration.as_deref()];
    output::keep_clear_of(&args.output, inputs.into_iter().flatten())?;
    let calibration = frames::calibration(args.calibration.as_deref())?;
    let mut recording = isolux_io::open(&args.recording)?;
    let standardizer = sigma::plan(&args.steps, calibration.as_ref(), &mut *recording)?;
    let brackets = args.merge_bracket.map(|length| Brackets::plan(&mut *recording, length)).transpose()?;
    let (keep_input, overwrite, threads) = (args.keep_input, args.force, args.threads);
    let options = WriteOptions { keep_input, overwrite, threads, brackets };
    let summary = standardize(&mut *recording, &standardizer, calibration.as_ref(), &args.output, &options)?;
    let steps = steps(&standardizer, options.brackets.as_ref());
    if args.json {
        let steps: Vec<Value> = steps.iter().map(step_json).collect();
        return console::print_json(&json!({"steps": steps, "summary": summary}));
    }
    for step in steps {
        console::print(format!("{:>9}: {} ({})", step.effect, step.term, step.parameters))?;
    }
    console::print(describe(&summary))?;
    console::print(format!("written: {}", args.output.display()))
}

/// Standardizes every frame of `recording` into a new recording at `output`.
pub(crate) fn standardize(
    recording: &mut dyn Recording,
    standardizer: &Standardizer,
    calibration: Option<&Calibration>,
    output: &Path,
    options: &WriteOptions,
) -> Outcome<Summary> {
    interrupt::watch();
    let metadata = recording.metadata().clone();
    let kept = kept_channels(&metadata, options.keep_input)?;
    let mut channels = vec![
        ChannelSpec::image(VALUES, ElementType::F32, metadata.shape),
        ChannelSpec::image(FLAGS, ElementType::U16, metadata.shape),
    ];
    if standardizer.predicts_sigma() {
        channels.push(ChannelSpec::image(SIGMA, ElementType::F32, metadata.shape));
    }
    channels.extend(kept.iter().filter_map(|name| metadata.channel(name)).map(ChannelSpec::copy_of));
    let mut merging = match &options.brackets {
        Some(brackets) => Some(Merging::start(standardizer, brackets)?),
        None => None,
    };
    let planned = standardizer;
    let (standardizer, mut merging) = match &mut merging {
        Some((frames, merging)) => (&*frames, Some(merging)),
        None => (standardizer, None),
    };
    let input_frames = metadata.require_frame_count()?;
    let frame_count = options.brackets.as_ref().map_or(input_frames, |brackets| brackets.lengths.len());
    let mut writer = RecordingWriter::create(output, frame_count, channels, options.overwrite)?;
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(options.threads.map_or(0, usize::from))
        .build()
        .map_err(|error| Failure::data(format!("cannot start threads: {error}")))?;
    // Reading and writing go frame by frame and in order; only the arithmetic between is shared out.
    let mut chain = Chain::new(standardizer);
    let slots = pool.current_num_threads().min(affordable_slots(&metadata, &kept, &chain, merging.is_some()));
    let mut batch: Vec<Slot> = (0..slots).map(|_| Slot::new(&metadata, kept.len(), &chain)).collect();
    let mut summary = Summary::default();
    let progress = console::progress("standardizing", input_frames);
    for start in (0..input_frames).step_by(batch.len()) {
        interrupt::check()?;
        let count = batch.len().min(input_frames - start);
        for (offset, slot) in batch[..count].iter_mut().enumerate() {
            recording.read_frame(start + offset, standardizer.needed(), &mut slot.frame)?;
            chain
                .take(&slot.frame, &mut slot.smoothed)
                .map_err(|error| Failure::frame(&metadata.path, start + offset, error))?;
            // Now, not after the batch: a deflated channel that goes back a frame is decoded anew from its start.
            for (name, bytes) in kept.iter().zip(&mut slot.kept) {
                recording.read_raw(name, start + offset, bytes)?;
            }
        }
        pool.install(|| batch[..count].par_iter_mut().for_each(|slot| slot.apply(standardizer)));
        for (offset, slot) in batch[..count].iter_mut().enumerate() {
            let index = start + offset;
            let taken = slot.take(&metadata.path, index)?;
            match &mut merging {
                None => {
                    summary.add(taken);
                    write(&mut writer, &slot.out)?;
                }
                Some(merging) => {
                    if let Some(merged) = merging.push(&slot.out, &taken)? {
                        summary.add(merged);
                        write(&mut writer, &merging.out)?;
                    }
                }
            }
            for (name, bytes) in kept.iter().zip(&slot.kept) {
                writer.push_bytes(name, bytes)?;
            }
            progress.inc(1);
        }
    }
    progress.finish_and_clear();
    if summary.valid == 0 && summary.time_refused > 0 {
        let message = "every measured pixel's integration time is above the calibrated range or unknown, a time inside \
                       it expected: record within it, calibrate further, or use --time linear";
        return Err(Failure::data(format!("`{}`: {message}", metadata.path.display())));
    }
    let steps = steps(planned, options.brackets.as_ref());
    let mut info = record(&metadata.info, &metadata.path, planned, &steps, calibration);
    if options.brackets.is_some() {
        // A merged frame has no integration time.
        info.integration_time_us = None;
    }
    writer.finish(&info)?;
    Ok(summary)
}

fn write(writer: &mut RecordingWriter, out: &Standardized) -> Outcome {
    writer.push(VALUES, out.amplitude.values())?;
    writer.push(FLAGS, out.flags.values())?;
    if let Some(sigma) = &out.sigma {
        writer.push(SIGMA, sigma.values())?;
    }
    Ok(())
}

/// Frames that fit into [`BATCH_BYTES`], at least one.
fn affordable_slots(metadata: &Metadata, kept: &[String], chain: &Chain<'_>, merging: bool) -> usize {
    let kept = kept.iter().filter_map(|name| metadata.channel(name));
    let kept_bytes: usize = kept.map(isolux_io::recording::ChannelInfo::frame_bytes).sum();
    let (smoothed, history) = chain.bytes_per_pixel();
    let sigma = if chain.predicts_sigma() { SIGMA_BYTES_PER_PIXEL } else { 0 };
    let slot_bytes = metadata.shape.pixels() * (SLOT_BYTES_PER_PIXEL + sigma + smoothed) + kept_bytes;
    let merge = if merging { BracketMerge::BYTES_PER_PIXEL } else { 0 };
    (BATCH_BYTES.saturating_sub(metadata.shape.pixels() * (history + merge)) / slot_bytes).max(1)
}

/// A frame and its result; one for each thread, as far as memory allows.
struct Slot {
    frame: Frame,
    smoothed: Smoothed,
    out: Standardized,
    /// The frame of each kept channel, verbatim.
    kept: Vec<Vec<u8>>,
    outcome: Option<Result<FrameSummary, isolux::standardize::StandardizeError>>,
}

impl Slot {
    fn new(metadata: &Metadata, kept: usize, chain: &Chain<'_>) -> Self {
        let (frame, out) = (Frame::new(metadata.shape), Standardized::new(metadata.shape));
        Self { frame, smoothed: chain.smoothed(), out, kept: vec![Vec::new(); kept], outcome: None }
    }

    fn apply(&mut self, standardizer: &Standardizer) {
        self.outcome = Some(chain::apply(standardizer, &self.frame, &self.smoothed, &mut self.out));
    }

    fn take(&mut self, recording: &Path, index: usize) -> Outcome<FrameSummary> {
        match self.outcome.take() {
            Some(Ok(summary)) => Ok(summary),
            Some(Err(error)) => Err(Failure::frame(recording, index, error)),
            None => Err(Failure::frame(recording, index, "not processed")),
        }
    }
}

impl Summary {
    fn add(&mut self, frame: FrameSummary) {
        self.frames += 1;
        self.pixels += frame.pixels;
        self.valid += frame.valid;
        self.time_refused += frame.time_refused;
        self.time_extrapolated += frame.time_extrapolated;
        self.distance_extrapolated += frame.distance_extrapolated;
        self.illumination_extrapolated += frame.illumination_extrapolated;
        self.specular += frame.specular;
        self.frames_without_cutoff += usize::from(frame.specular_cutoff.is_none());
    }
}

/// The input's channels that go into the output. A recording that is standardized again keeps its own results
/// out of the way only by leaving them out.
fn kept_channels(metadata: &Metadata, keep_input: bool) -> Outcome<Vec<String>> {
    if !keep_input {
        return Ok(Vec::new());
    }
    let stored = metadata.channels.iter().filter(|channel| channel.is_stored());
    let names: Vec<String> = stored.map(|channel| channel.name.clone()).collect();
    match names.iter().find(|name| [VALUES, FLAGS, SIGMA].contains(&name.as_str())) {
        Some(name) => Err(Failure::usage(format!(
            "`{}` already has a channel `{name}`, which --keep-input cannot keep beside the new one",
            metadata.path.display()
        ))),
        None => Ok(names),
    }
}

/// The output's `recording.json`: the input's, and what was done to it.
fn record(
    info: &RecordingInfo,
    input: &Path,
    standardizer: &Standardizer,
    steps: &[AppliedStep],
    calibration: Option<&Calibration>,
) -> RecordingInfo {
    let legend: Map<String, Value> =
        PixelFlags::legend().map(|(name, bit)| (name.to_owned(), Value::from(bit))).collect();
    let notes: Vec<String> = standardizer.notes().iter().map(ToString::to_string).collect();
    let mut info = info.clone();
    info.other.insert(
        "standardization".to_owned(),
        json!({
            "program": concat!("isolux ", env!("CARGO_PKG_VERSION")),
            "input": input.display().to_string(),
            "calibrated_camera": calibration.map(|c| c.camera.clone()),
            "reference": calibration.map_or_else(Reference::default, |c| c.reference),
            "steps": steps.iter().map(step_json).collect::<Vec<_>>(),
            "notes": notes,
            "flag_bits": legend,
        }),
    );
    info
}

/// The steps of the chain; highlights are limited after merging.
fn steps(standardizer: &Standardizer, brackets: Option<&Brackets>) -> Vec<AppliedStep> {
    let mut steps = standardizer.steps().to_vec();
    if let Some(brackets) = brackets {
        let place = steps.iter().position(|step| step.effect == "specular").unwrap_or(steps.len());
        let parameters = brackets.describe();
        steps.insert(place, AppliedStep { effect: "merge", term: "bracket", parameters });
    }
    steps
}

fn step_json(step: &AppliedStep) -> Value {
    json!({"effect": step.effect, "term": step.term, "parameters": step.parameters})
}

fn describe(summary: &Summary) -> String {
    let share = |count: usize| format!("{:.2} %", 100.0 * count as f64 / summary.pixels.max(1) as f64);
    let mut lines = vec![format!("{} frames, {} of the pixels valid", summary.frames, share(summary.valid))];
    let remarks = [
        (summary.time_refused, "refused: integration time above the calibrated range, or unknown"),
        (summary.time_extrapolated, "below the calibrated integration times, continued as 1/t (flagged)"),
        (summary.distance_extrapolated, "outside the calibrated distances, continued as d² (flagged)"),
        (
            summary.illumination_extrapolated,
            "outside the profile's support or steeper than was seen (flagged)",
        ),
        (summary.specular, "limited as specular (flagged)"),
    ];
    lines.extend(
        remarks
            .into_iter()
            .filter(|(count, _)| *count > 0)
            .map(|(count, what)| format!("{:>9} {what}", share(count))),
    );
    lines.join("\n")
}
