//! Going through frames in their order.

use isolux::{Channels, Frame};

use crate::error::PipelineError;
use crate::observer::{Observer, Progress, Work};
use crate::source::FrameSource;

/// Reads every frame into the same memory and hands it over with its index, until the frames end.
///
/// # Errors
/// What the source and `visit` bring; [`PipelineError::Interrupted`] once the observer has cancelled.
pub fn for_each(
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

/// Reads a frame that the source is known to have.
pub(crate) fn read_present(
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
