//! Standardizes a recording: on all threads, in bounded memory, with the results in order.

mod batch;
mod provenance;
mod sink;
mod summary;

use isolux::{Calibration, Standardized, Standardizer};
use isolux_io::recording::ChannelInfo;

use self::batch::Batch;
use crate::brackets::{Brackets, Merging};
use crate::error::PipelineError;
use crate::observer::{Observer, Progress, Work};
use crate::source::{FrameSource, SourceFacts};

pub use self::provenance::{PROVENANCE, step_json, steps};
pub use self::sink::{FLAGS, FrameSink, NativeSink, OutputFormat, OutputFrame, SIGMA, VALUES};
pub use self::summary::Summary;

/// Options of standardizing.
#[derive(Clone, Copy, Debug, Default)]
pub struct StandardizeOptions<'a> {
    /// The calibration that the chain was planned with, for the output's record.
    pub calibration: Option<&'a Calibration>,
    /// Hand the source's stored channels on, verbatim.
    pub keep_input: bool,
    /// Number of threads; `None` uses all cores. The output does not depend on it.
    pub threads: Option<usize>,
    /// Brackets whose frames are merged into one; `None` keeps each frame.
    pub brackets: Option<&'a Brackets>,
}

/// Standardizes every frame of `source` into `sink`. On an error the sink is not finished; drop it, and nothing is left
/// behind.
///
/// # Errors
/// Those of the source and the sink; [`PipelineError::Frame`] for frames that the chain cannot standardize;
/// [`PipelineError::TimesRefused`] when no pixel has a value because of the integration times;
/// [`PipelineError::ChannelKept`], [`PipelineError::KeptOfMerged`] and [`PipelineError::Merge`] for options that do
/// not fit the source or the chain; [`PipelineError::Interrupted`] once the observer has cancelled.
pub fn standardize(
    source: &mut dyn FrameSource,
    standardizer: &Standardizer,
    options: &StandardizeOptions<'_>,
    sink: &mut dyn FrameSink,
    observer: &dyn Observer,
) -> Result<Summary, PipelineError> {
    let facts = source.facts();
    let kept = kept_channels(source, &facts, options)?;
    // Where frames are merged, their own chain ends before the highlights.
    let merging = options.brackets.map(|brackets| Merging::start(standardizer, brackets)).transpose()?;
    let (frames, merging) = merging.map_or((None, None), |(frames, merging)| (Some(frames), Some(merging)));
    sink.begin(&OutputFormat {
        source: facts.name.clone(),
        shape: facts.shape,
        frame_count: options.brackets.map_or(facts.frame_count, |brackets| Some(brackets.count())),
        sigma: standardizer.predicts_sigma(),
        kept: kept.clone(),
        rays: facts.rays.clone(),
    })?;
    let pool = rayon::ThreadPoolBuilder::new().num_threads(options.threads.unwrap_or(0)).build()?;
    let chain = frames.as_ref().unwrap_or(standardizer);
    let batch = Batch::new(&facts, chain, &kept);
    let output = Output { sink: &mut *sink, merging, summary: Summary::default() };
    let summary = each_batch(source, &facts, batch, &pool, output, observer)?;
    if summary.valid == 0 && summary.time_refused > 0 {
        return Err(PipelineError::TimesRefused { recording: facts.name });
    }
    sink.finish(&provenance::record(&facts, standardizer, options.brackets, options.calibration))?;
    Ok(summary)
}

/// Fills a batch, standardizes it, hands it out, until the frames end.
fn each_batch(
    source: &mut dyn FrameSource,
    facts: &SourceFacts,
    mut batch: Batch<'_>,
    pool: &rayon::ThreadPool,
    mut output: Output<'_>,
    observer: &dyn Observer,
) -> Result<Summary, PipelineError> {
    let mut progress = Progress::start(observer, Work::Standardizing, facts.frame_count);
    let mut next = 0;
    loop {
        progress.check()?;
        let count = batch.fill(source, next, &facts.name)?;
        if count == 0 {
            break;
        }
        for (index, slot) in (next..).zip(batch.standardize(pool, count)) {
            let outcome = slot.outcome.clone().map_err(|error| error.into());
            outcome.map_err(PipelineError::frame(&facts.name, index))?;
            output.take(&slot.out, &slot.kept, &facts.name, index)?;
            progress.step();
        }
        if next == 0 {
            batch.grow(pool.current_num_threads(), output.merging.as_ref().map_or(0, Merging::bytes));
        }
        next += count;
    }
    progress.finish();
    Ok(output.summary)
}

/// Hands frames to the sink, merged where there are brackets.
struct Output<'a> {
    sink: &'a mut dyn FrameSink,
    merging: Option<Merging>,
    summary: Summary,
}

impl Output<'_> {
    fn take(
        &mut self,
        standardized: &Standardized,
        kept: &[Vec<u8>],
        name: &str,
        index: usize,
    ) -> Result<(), PipelineError> {
        let Some(merging) = &mut self.merging else {
            self.summary.add(standardized.summary);
            return self.sink.push(OutputFrame { standardized, kept });
        };
        let merged = merging.push(standardized).map_err(PipelineError::frame(name, index))?;
        if let Some(merged) = merged {
            self.summary.add(merged.summary);
            self.sink.push(OutputFrame { standardized: merged, kept: &[] })?;
        }
        Ok(())
    }
}

/// The source's channels that are copied to the output. They must not have the names of the new channels, so that a
/// recording that is standardized again cannot keep its earlier results.
fn kept_channels(
    source: &dyn FrameSource,
    facts: &SourceFacts,
    options: &StandardizeOptions<'_>,
) -> Result<Vec<ChannelInfo>, PipelineError> {
    if !options.keep_input {
        return Ok(Vec::new());
    }
    if options.brackets.is_some() {
        return Err(PipelineError::KeptOfMerged);
    }
    let kept = source.stored_channels();
    match kept.iter().find(|channel| [VALUES, FLAGS, SIGMA].contains(&channel.name.as_str())) {
        Some(channel) => {
            Err(PipelineError::ChannelKept { recording: facts.name.clone(), channel: channel.name.clone() })
        }
        None => Ok(kept),
    }
}
