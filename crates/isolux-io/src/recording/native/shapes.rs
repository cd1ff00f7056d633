//! Whether whole arrays, frames first, make one recording; what to do about those that do not, in NumPy's words.

use std::path::Path;

use isolux::Shape;

use super::channel::ArrayFile;
use crate::error::{RecordingError, dims_text};
use crate::recording::channels::{self, FrameDims};

const ADD_DIMENSION: &str = "add the first dimension: numpy.save(file, array[numpy.newaxis])";

/// Checks that all arrays have the same number of frames, each with the dimensions that its name demands. Returns
/// the number of frames.
pub(super) fn check(path: &Path, arrays: &[ArrayFile]) -> Result<usize, RecordingError> {
    let arrays: Vec<_> = arrays
        .iter()
        .map(|array| {
            let (name, path) = (array.name.as_str(), array.path.as_path());
            let kind = FrameDims::of(name, array.header.element);
            ArrayShape { name, path, kind, dims: &array.header.dims }
        })
        .collect();
    check_shapes(path, &arrays)
}

/// An array, as far as it matters here.
#[derive(Clone, Copy, Debug)]
struct ArrayShape<'a> {
    name: &'a str,
    path: &'a Path,
    kind: FrameDims,
    dims: &'a [usize],
}

fn check_shapes(path: &Path, arrays: &[ArrayShape<'_>]) -> Result<usize, RecordingError> {
    let leading = channels::leading(path, arrays.iter().map(|array| array.name))?;
    let (frames, shape) = leading_shape(&arrays[leading])?;
    arrays.iter().try_for_each(|array| check_array(array, frames, shape))?;
    Ok(frames)
}

fn leading_shape(array: &ArrayShape<'_>) -> Result<(usize, Shape), RecordingError> {
    let kind = array.kind;
    let expected = kind.written("N, ");
    let fits = array.dims.split_first().and_then(|(&frames, dims)| Some((frames, kind.shape(dims)?)));
    let Some((frames, shape)) = fits else {
        let single = kind.shape(array.dims).is_some();
        let advice = if single { format!("; for a single frame, {ADD_DIMENSION}") } else { String::new() };
        return Err(array.error(expected, advice));
    };
    if frames == 0 || shape.height == 0 || shape.width == 0 {
        return Err(array.error(format!("{expected} with at least one frame and one pixel"), String::new()));
    }
    Ok((frames, shape))
}

fn check_array(array: &ArrayShape<'_>, frames: usize, shape: Shape) -> Result<(), RecordingError> {
    let kind = array.kind;
    if array.dims.split_first().is_some_and(|(&first, dims)| first == frames && kind.allows(dims, shape)) {
        return Ok(());
    }
    let allowed = kind.allowed(shape);
    let whole = |dims: &Vec<usize>| dims_text(&[&[frames], dims.as_slice()].concat());
    let expected = match allowed.as_slice() {
        [] => format!("{frames} as its first dimension, the number of frames, and no dimension of 0"),
        dims => dims.iter().map(whole).collect::<Vec<_>>().join(" or "),
    };
    let missing_first = frames == 1 && allowed.iter().any(|dims| dims == array.dims);
    let advice = match (missing_first, kind) {
        (true, _) => format!("; {ADD_DIMENSION}"),
        (_, FrameDims::Anything) => "; files that are no channels belong elsewhere".to_owned(),
        _ => String::new(),
    };
    Err(array.error(expected, advice))
}

impl ArrayShape<'_> {
    fn error(&self, expected: String, advice: String) -> RecordingError {
        let (file, found) = (self.path.to_owned(), dims_text(self.dims));
        RecordingError::ChannelShape { file, found, expected, advice }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::element::ElementType;

    fn array<'a>(name: &'a str, dims: &'a [usize]) -> ArrayShape<'a> {
        ArrayShape { name, path: Path::new(name), kind: FrameDims::of(name, ElementType::U16), dims }
    }

    fn check(arrays: &[ArrayShape<'_>]) -> Result<usize, RecordingError> {
        check_shapes(Path::new("rec"), arrays)
    }

    #[test]
    fn the_first_dimension_is_the_number_of_frames() {
        assert_eq!(check(&[array("notes", &[5, 7]), array("phase_samples", &[5, 4, 2, 3])]).unwrap(), 5);
    }

    #[test]
    fn shapes_that_do_not_fit_are_named_with_what_would() {
        let amplitude = array("amplitude", &[1, 2, 3]);
        let cases = [
            (
                array("distance", &[2, 3]),
                "`distance`: found an array of shape (2, 3), expected (1, 2, 3); add the first dimension",
            ),
            (array("distance", &[2, 2, 3]), "expected (1, 2, 3)"),
            (array("integration_time_us", &[2]), "found an array of shape (2,), expected (1,) or (1, 2, 3)"),
            (array("phase_samples", &[1, 3, 2, 3]), "expected (1, 4, 2, 3)"),
            (array("world_from_camera", &[1, 3, 4]), "expected (1, 4, 4)"),
            (array("notes", &[7]), "expected 1 as its first dimension"),
            (array("notes", &[]), "found an array of shape ()"),
            (array("notes", &[1, 0]), "no dimension of 0"),
        ];
        for (other, expected) in cases {
            let message = check(&[amplitude, other]).unwrap_err().to_string();
            assert!(message.contains(expected), "{message}");
        }
    }

    #[test]
    fn a_single_frame_without_its_first_dimension_is_refused_with_the_way_out() {
        for (name, dims) in [("amplitude", &[480, 640][..]), ("phase_samples", &[4, 48, 64])] {
            let message = check(&[array(name, dims)]).unwrap_err().to_string();
            assert!(message.contains("for a single frame, add the first dimension"), "{message}");
            assert!(message.contains("array[numpy.newaxis]"), "{message}");
        }
    }

    #[test]
    fn nothing_is_no_recording() {
        for dims in [[0, 2, 3], [1, 0, 3], [1, 2, 0]] {
            let message = check(&[array("amplitude", &dims)]).unwrap_err().to_string();
            assert!(message.contains("at least one frame and one pixel"), "{message}");
        }
        let message = check(&[array("distance", &[1, 2, 3])]).unwrap_err().to_string();
        assert!(
            message.contains("found no `amplitude` and no `phase_samples`, only `distance`"),
            "{message}"
        );
    }
}
