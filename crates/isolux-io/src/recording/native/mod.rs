//! The native format: a folder of `.npy` files, or one `.npz`.

mod archive;
mod channel;
mod find;
mod folder;
mod gathered;
mod mapped;
mod rays;
mod sequential;
mod shapes;
mod source;
mod stream;

use std::path::Path;

use self::source::NativeSource;
use super::assemble::Assembled;
use super::reading::Recording;
use crate::error::RecordingError;

/// Opens a native recording; what holds none is an error, which says why.
pub(crate) fn open(path: &Path) -> Result<Option<Box<dyn Recording>>, RecordingError> {
    Ok(Some(Box::new(Assembled::new(NativeSource::open(path)?)?)))
}
