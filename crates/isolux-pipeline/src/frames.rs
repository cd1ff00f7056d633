//! Going through frames in their order.

use isolux::standardize::Prepared;
use isolux::{Channels, Frame, Stream};

use crate::error::PipelineError;
use crate::observer::{Observer, Progress, Work};
use crate::source::FrameSource;

/// Reads every frame into the same memory and hands it over with its index, until the frames end.
///
/// # Errors
/// Those of the source and of `visit`; [`PipelineError::Interrupted`] once the observer has cancelled.
pub(crate) fn for_each(
    source: &mut dyn FrameSource,
    wanted: Channels,
    work: Work,
    observer: &dyn Observer,
    mut visit: impl FnMut(usize, &Frame) -> Result<(), PipelineError>,
) -> Result<(), PipelineError> {
    let facts = source.facts();
    let mut progress = Progress::start(observer, work, facts.frame_count);
    let mut frame = Frame::new(facts.shape);
    for index in 0.. {
        progress.check()?;
        if !source.read(index, wanted, &mut frame)? {
            break;
        }
        visit(index, &frame)?;
        progress.step();
    }
    progress.finish();
    Ok(())
}

/// Reads frame `index` out of order. The earlier frames that its result depends on are pushed into `stream` first,
/// so that the frame itself can be pushed next.
pub(crate) fn read_alone(
    source: &mut dyn FrameSource,
    index: usize,
    wanted: Channels,
    stream: &mut Stream,
    frame: &mut Frame,
) -> Result<(), PipelineError> {
    let name = source.facts().name;
    let wanted = wanted | stream.standardizer().needed();
    let first = index.saturating_sub(stream.standardizer().frames_before());
    stream.continue_at(first);
    let mut prepared = Prepared::default();
    for earlier in first..index {
        read_present(source, earlier, wanted, frame)?;
        let taken = stream.prepare(frame, &mut prepared);
        taken.map_err(|error| PipelineError::frame(&name, earlier)(error.into()))?;
    }
    read_present(source, index, wanted, frame)
}

/// Reads a frame that the source is known to have.
fn read_present(
    source: &mut dyn FrameSource,
    index: usize,
    wanted: Channels,
    frame: &mut Frame,
) -> Result<(), PipelineError> {
    if source.read(index, wanted, frame)? {
        return Ok(());
    }
    Err(PipelineError::FrameMissing { recording: source.facts().name, frame: index })
}
