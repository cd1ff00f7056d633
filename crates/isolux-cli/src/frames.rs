//! Going through the frames of a recording.

use std::path::Path;

use isolux::standardize::Stream;
use isolux::{Calibration, Channels, Frame};
use isolux_io::{Metadata, Recording};

use crate::failure::{Failure, Outcome};
use crate::{console, interrupt};

/// Reads every frame into the same memory and hands it over with its number. `what` names the work beside the
/// progress bar.
pub(crate) fn for_each(
    recording: &mut dyn Recording,
    wanted: Channels,
    what: &str,
    mut visit: impl FnMut(usize, &Frame) -> Outcome,
) -> Outcome {
    let count = recording.metadata().require_frame_count()?;
    let progress = console::progress(what, count);
    let mut frame = Frame::new(recording.metadata().shape);
    for index in 0..count {
        interrupt::check()?;
        recording.read_frame(index, wanted, &mut frame)?;
        visit(index, &frame)?;
        progress.inc(1);
    }
    progress.finish_and_clear();
    Ok(())
}

/// Reads the calibration, if one is given.
pub(crate) fn calibration(path: Option<&Path>) -> Outcome<Option<Calibration>> {
    path.map(isolux_io::read_calibration).transpose().map_err(Failure::from)
}

/// What a plan must know of a recording.
pub(crate) fn stream(metadata: &Metadata) -> Stream {
    Stream {
        channels: metadata.available,
        shape: Some(metadata.shape),
        intrinsics: metadata.info.intrinsics.as_ref().map(|intrinsics| intrinsics.pinhole),
    }
}
