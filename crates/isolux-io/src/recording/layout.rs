//! Which shape each channel must have, and what a set of channels makes available.

use std::path::PathBuf;

use isolux::{Channels, Shape};

use super::element::ElementType;
use super::info::{DistanceKind, RecordingInfo};
use super::metadata::dims_text;
use crate::error::{RecordingError, listing};

/// Dimensions of one frame of a channel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum FrameDims {
    Number,
    Image,
    NumberOrImage,
    Bins,
    Pose,
    Anything,
}

const KNOWN: [(&str, FrameDims, Channels); 13] = [
    ("amplitude", FrameDims::Image, Channels::AMPLITUDE),
    ("distance", FrameDims::Image, Channels::DISTANCE),
    ("integration_time_us", FrameDims::NumberOrImage, Channels::INTEGRATION_TIME),
    ("phase_samples", FrameDims::Bins, Channels::PHASE_SAMPLES),
    ("intensity", FrameDims::Image, Channels::INTENSITY),
    ("timestamp_us", FrameDims::Number, Channels::TIMESTAMP),
    ("target", FrameDims::Image, Channels::TARGET),
    ("vendor_amplitude", FrameDims::Image, Channels::VENDOR_AMPLITUDE),
    ("vendor_confidence", FrameDims::Image, Channels::VENDOR_CONFIDENCE),
    ("world_from_camera", FrameDims::Pose, Channels::POSE),
    ("standardized_amplitude", FrameDims::Image, Channels::empty()),
    ("sigma", FrameDims::Image, Channels::empty()),
    ("flags", FrameDims::Image, Channels::empty()),
];

/// The channels that tell the number of frames and their shape, most important first. A standardized recording
/// without its input has only the last of them.
const LEADING: [&str; 3] = ["amplitude", "phase_samples", "standardized_amplitude"];

/// What the checks need to know of an array.
#[derive(Clone, Debug)]
pub(crate) struct ArrayShape<'a> {
    pub(crate) name: &'a str,
    pub(crate) path: PathBuf,
    pub(crate) element: ElementType,
    pub(crate) dims: &'a [usize],
}

/// Number of frames, their shape, and the channels that reading can fill.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Layout {
    pub(crate) frame_count: usize,
    pub(crate) shape: Shape,
    pub(crate) available: Channels,
}

fn known(name: &str) -> (FrameDims, Channels) {
    KNOWN
        .iter()
        .find(|row| row.0 == name)
        .map_or((FrameDims::Anything, Channels::empty()), |row| (row.1, row.2))
}

/// Checks that the arrays make one recording.
pub(crate) fn check(
    path: &std::path::Path,
    arrays: &[ArrayShape<'_>],
    info: &RecordingInfo,
    info_path: &std::path::Path,
) -> Result<Layout, RecordingError> {
    let leading = LEADING.iter().find_map(|name| arrays.iter().find(|array| array.name == *name));
    let leading = leading.ok_or_else(|| RecordingError::MissingAmplitude {
        path: path.to_owned(),
        found: listing(arrays.iter().map(|array| array.name)),
    })?;
    let (frame_count, shape) = leading_shape(leading)?;
    let mut available = Channels::empty();
    for array in arrays {
        check_array(array, frame_count, shape)?;
        available |= known(array.name).1;
    }
    check_info(info, info_path, available)?;
    if info.integration_time_us.is_some() {
        available |= Channels::INTEGRATION_TIME;
    }
    if available.contains(Channels::PHASE_SAMPLES) {
        available |= Channels::AMPLITUDE;
        available.set(
            Channels::DISTANCE,
            available.contains(Channels::DISTANCE) || info.modulation_frequency_hz.is_some(),
        );
    }
    Ok(Layout { frame_count, shape, available })
}

fn leading_shape(array: &ArrayShape<'_>) -> Result<(usize, Shape), RecordingError> {
    let bins = known(array.name).0 == FrameDims::Bins;
    let fits = match *array.dims {
        [frames, height, width] if !bins => Some((frames, Shape::new(height, width))),
        [frames, 4, height, width] if bins => Some((frames, Shape::new(height, width))),
        _ => None,
    };
    let single = if bins { matches!(array.dims, [4, _, _]) } else { array.dims.len() == 2 };
    let advice = if single {
        "; for a single frame, add the first dimension: numpy.save(file, array[numpy.newaxis])"
    } else {
        ""
    };
    let expected = if bins { "(N, 4, H, W)" } else { "(N, H, W)" };
    let error = |expected: &str| RecordingError::ChannelShape {
        file: array.path.clone(),
        found: dims_text(array.dims),
        expected: expected.to_owned(),
        advice: advice.to_owned(),
    };
    let (frames, shape) = fits.ok_or_else(|| error(expected))?;
    if frames == 0 || shape.height == 0 || shape.width == 0 {
        return Err(error(&format!("{expected} with at least one frame and one pixel")));
    }
    Ok((frames, shape))
}

fn check_array(array: &ArrayShape<'_>, frames: usize, shape: Shape) -> Result<(), RecordingError> {
    let Shape { height, width } = shape;
    let (kind, _) = known(array.name);
    let image = vec![frames, height, width];
    let allowed = match kind {
        FrameDims::Number => vec![vec![frames]],
        FrameDims::Image => vec![image],
        FrameDims::NumberOrImage => vec![vec![frames], image],
        FrameDims::Bins => vec![vec![frames, 4, height, width]],
        FrameDims::Pose => vec![vec![frames, 4, 4]],
        FrameDims::Anything => Vec::new(),
    };
    let fits = match kind {
        FrameDims::Anything => array.dims.first() == Some(&frames) && !array.dims.contains(&0),
        _ => allowed.iter().any(|dims| dims == array.dims),
    };
    if fits {
        return check_element(array);
    }
    let expected = match allowed.as_slice() {
        [] => format!("{frames} as its first dimension, the number of frames, and no dimension of 0"),
        shapes => shapes.iter().map(|dims| dims_text(dims)).collect::<Vec<_>>().join(" or "),
    };
    let missing_first = allowed.iter().any(|dims| dims[0] == 1 && &dims[1..] == array.dims);
    let advice = match (missing_first, kind) {
        (true, _) => "; add the first dimension: numpy.save(file, array[numpy.newaxis])",
        (_, FrameDims::Anything) => "; files that are no channels belong elsewhere",
        _ => "",
    };
    Err(RecordingError::ChannelShape {
        file: array.path.clone(),
        found: dims_text(array.dims),
        expected,
        advice: advice.to_owned(),
    })
}

fn check_element(array: &ArrayShape<'_>) -> Result<(), RecordingError> {
    if array.name == "target" && !array.element.is_integer() {
        let found = format!("labels of type {}", array.element);
        return Err(RecordingError::content(&array.path, found, "uint8"));
    }
    Ok(())
}

/// Checks what `recording.json` says against the channels that are stored.
fn check_info(info: &RecordingInfo, path: &std::path::Path, stored: Channels) -> Result<(), RecordingError> {
    let error = |field: &str, found: &str, expected: &str| {
        Err(RecordingError::Info {
            path: path.to_owned(),
            field: field.to_owned(),
            found: found.to_owned(),
            expected: expected.to_owned(),
        })
    };
    let depth = info.distance_kind == Some(DistanceKind::Z) && stored.contains(Channels::DISTANCE);
    if depth && info.intrinsics.is_none() {
        let expected = "{fx, fy, cx, cy}: without them the z distance cannot be made radial";
        return error("intrinsics", "nothing", expected);
    }
    if info.integration_time_us.is_some() && stored.contains(Channels::INTEGRATION_TIME) {
        let expected = "either the constant or the channel `integration_time_us`; remove one";
        return error("integration_time_us", "both", expected);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn array<'a>(name: &'a str, dims: &'a [usize]) -> ArrayShape<'a> {
        ArrayShape { name, path: format!("{name}.npy").into(), element: ElementType::U16, dims }
    }

    fn layout(arrays: &[ArrayShape<'_>], json: &str) -> Result<Layout, RecordingError> {
        let path = std::path::Path::new("recording.json");
        let info = RecordingInfo::from_json(json.as_bytes(), path).unwrap();
        check(std::path::Path::new("rec"), arrays, &info, path)
    }

    #[test]
    fn phase_samples_stand_in_for_amplitude_and_with_a_frequency_for_distance() {
        let bins = [array("phase_samples", &[5, 4, 2, 3])];
        let layout_without = layout(&bins, "{}").unwrap();
        assert_eq!((layout_without.frame_count, layout_without.shape), (5, Shape::new(2, 3)));
        assert_eq!(layout_without.available, Channels::PHASE_SAMPLES | Channels::AMPLITUDE);
        let layout_with =
            layout(&bins, r#"{"modulation_frequency_hz": 2e7, "integration_time_us": 3}"#).unwrap();
        let more = Channels::DISTANCE | Channels::INTEGRATION_TIME;
        assert_eq!(layout_with.available, layout_without.available | more);
    }

    #[test]
    fn shapes_that_do_not_fit_are_named_with_what_would() {
        let amplitude = array("amplitude", &[1, 2, 3]);
        let cases = [
            (
                array("distance", &[2, 3]),
                "`distance.npy`: found an array of shape (2, 3), expected (1, 2, 3); add",
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
            let message = layout(&[amplitude.clone(), other], "{}").unwrap_err().to_string();
            assert!(message.contains(expected), "{message}");
        }
    }

    #[test]
    fn a_single_frame_without_its_first_dimension_is_refused_with_the_way_out() {
        for (name, dims) in [("amplitude", &[480, 640][..]), ("phase_samples", &[4, 48, 64])] {
            let message = layout(&[array(name, dims)], "{}").unwrap_err().to_string();
            assert!(message.contains("array[numpy.newaxis]"), "{message}");
        }
    }

    #[test]
    fn nothing_is_no_recording() {
        for dims in [[0, 2, 3], [1, 0, 3], [1, 2, 0]] {
            let message = layout(&[array("amplitude", &dims)], "{}").unwrap_err().to_string();
            assert!(message.contains("at least one frame and one pixel"), "{message}");
        }
        let message = layout(&[array("distance", &[1, 2, 3])], "{}").unwrap_err().to_string();
        assert!(
            message.contains("found no `amplitude` and no `phase_samples`, only `distance`"),
            "{message}"
        );
    }

    #[test]
    fn z_needs_intrinsics_and_times_come_from_one_place() {
        let arrays = [
            array("amplitude", &[1, 2, 3]),
            array("distance", &[1, 2, 3]),
            array("integration_time_us", &[1]),
        ];
        let message = layout(&arrays, r#"{"distance_kind": "z"}"#).unwrap_err().to_string();
        assert!(message.contains("field `intrinsics`: found nothing"), "{message}");
        assert!(layout(&arrays[..1], r#"{"distance_kind": "z"}"#).is_ok());
        let message = layout(&arrays, r#"{"integration_time_us": 5}"#).unwrap_err().to_string();
        assert!(message.contains("field `integration_time_us`: found both"), "{message}");
    }
}
