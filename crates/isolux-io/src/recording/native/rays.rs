//! The table of rays of a native recording: one array (H, W, 3), the same for all frames.

use std::sync::Arc;

use isolux::{RayTable, Shape};

use super::channel::ArrayFile;
use crate::error::{RecordingError, dims_text};
use crate::recording::channels;

/// Name of the array.
const NAME: &str = "rays";

/// Takes the table out of the arrays, which otherwise are channels, and reads it.
///
/// # Errors
/// [`RecordingError::ChannelShape`] and [`RecordingError::Content`] for what is no table of directions; those of
/// reading it.
pub(super) fn take(arrays: &mut Vec<ArrayFile>) -> Result<Option<Arc<RayTable>>, RecordingError> {
    let Some(place) = arrays.iter().position(|array| array.name == NAME) else { return Ok(None) };
    let array = arrays.remove(place);
    let (path, dims) = (array.path.clone(), array.header.dims.clone());
    let &[height, width, 3] = dims.as_slice() else {
        let expected = "(H, W, 3): x, y and z of each pixel, the same for all frames".to_owned();
        return Err(RecordingError::ChannelShape {
            file: path,
            found: dims_text(&dims),
            expected,
            advice: String::new(),
        });
    };
    let count = channels::frame_values(&path, &dims)?;
    // Row by row: to the reader, an array is a channel whose first dimension counts its frames.
    let mut rows = array.into_channel(ROW_BATCH_BYTES)?;
    let mut values = vec![0.0; count];
    for (row, values) in values.chunks_exact_mut((3 * width).max(1)).enumerate() {
        rows.load(row)?;
        rows.raw().read_f64(values);
    }
    let table = RayTable::new(Shape::new(height, width), &values);
    table
        .map(|table| Some(Arc::new(table)))
        .map_err(|error| RecordingError::content(&path, error.found(), error.expected()))
}

/// Memory for a table in Fortran order.
const ROW_BATCH_BYTES: usize = 32 << 20;
