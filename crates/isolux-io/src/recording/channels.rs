//! The channels that have a meaning: the name, the dimensions of one frame and the flag of [`Channels`] of each.

use std::path::Path;

use isolux::{Channels, Shape};

use super::element::ElementType;
use crate::error::{RecordingError, dims_text, listing};

/// The largest cameras have a few million pixels: a claim of more than this is damage, or an attack on memory.
const MOST_FRAME_VALUES: usize = 1 << 26;

/// Dimensions of one frame of a channel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum FrameDims {
    Number,
    Image,
    NumberOrImage,
    Bins,
    /// Complex phase samples.
    Iq,
    Pose,
    /// A channel without a meaning to isolux, which is carried along.
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

/// The channels from which the shape of the frames is taken, most important first. A standardized recording without
/// its input has only the last of them.
const LEADING: [&str; 3] = ["amplitude", "phase_samples", "standardized_amplitude"];

/// Number of flags that [`Channels`] has.
const FLAGS: usize = Channels::all().bits().count_ones() as usize;

/// The flag of the channel of this name; none for a channel that no frame carries.
pub(crate) fn flag(name: &str) -> Channels {
    KNOWN.iter().find(|row| row.0 == name).map_or(Channels::empty(), |row| row.2)
}

/// The name of the channel with this flag.
pub(crate) fn name(flag: Channels) -> &'static str {
    KNOWN.iter().find(|row| row.2 == flag).map_or("", |row| row.0)
}

/// The place of the channel from which the shape of the frames is taken.
pub(crate) fn leading<'a>(
    path: &Path,
    names: impl Iterator<Item = &'a str> + Clone,
) -> Result<usize, RecordingError> {
    let place = LEADING.iter().find_map(|leading| names.clone().position(|name| name == *leading));
    place.ok_or_else(|| RecordingError::MissingAmplitude { path: path.to_owned(), found: listing(names) })
}

/// Number of values in a frame of these dimensions, as far as a camera can deliver it.
pub(crate) fn frame_values(path: &Path, dims: &[usize]) -> Result<usize, RecordingError> {
    let values = dims.iter().try_fold(1usize, |product, &dim| product.checked_mul(dim));
    values.filter(|&values| values <= MOST_FRAME_VALUES).ok_or_else(|| {
        let found = format!("frames of {}", dims_text(dims));
        RecordingError::content(path, found, format!("at most {MOST_FRAME_VALUES} values in a frame"))
    })
}

impl FrameDims {
    /// Those that the channel of this name and type must have.
    pub(crate) fn of(name: &str, element: ElementType) -> Self {
        match KNOWN.iter().find(|row| row.0 == name).map_or(Self::Anything, |row| row.1) {
            Self::Bins if element.is_complex() => Self::Iq,
            dims => dims,
        }
    }

    /// How a frame is written where the shape is not known, and with `lead` before it.
    pub(crate) fn written(self, lead: &str) -> String {
        match self {
            Self::Bins => {
                format!("({lead}4, H, W), ({lead}8, H, W) of two frequencies, or ({lead}2, H, W) of I and Q")
            }
            Self::Iq => format!("({lead}H, W) of complex numbers, or ({lead}2, H, W) of two frequencies"),
            _ => format!("({lead}H, W)"),
        }
    }

    /// The dimensions that fit a recording of this shape; none are listed where anything fits.
    pub(crate) fn allowed(self, shape: Shape) -> Vec<Vec<usize>> {
        let Shape { height, width } = shape;
        match self {
            Self::Number => vec![vec![]],
            Self::Image => vec![vec![height, width]],
            Self::NumberOrImage => vec![vec![], vec![height, width]],
            Self::Bins => [4, 8, 2].map(|samples| vec![samples, height, width]).to_vec(),
            Self::Iq => vec![vec![height, width], vec![2, height, width]],
            Self::Pose => vec![vec![4, 4]],
            Self::Anything => vec![],
        }
    }

    /// True where frames of these dimensions fit a recording of this shape.
    pub(crate) fn allows(self, dims: &[usize], shape: Shape) -> bool {
        match self {
            Self::Anything => !dims.contains(&0),
            _ => self.allowed(shape).iter().any(|allowed| allowed == dims),
        }
    }

    /// The shape of a frame of these dimensions; `None` for what is neither an image nor phase samples.
    pub(crate) fn shape(self, dims: &[usize]) -> Option<Shape> {
        match (self, dims) {
            (Self::Bins, &[2 | 4 | 8, height, width])
            | (Self::Iq, &[2, height, width])
            | (Self::Image | Self::Iq, &[height, width]) => Some(Shape::new(height, width)),
            _ => None,
        }
    }
}

/// Where each channel that a frame can carry stands in a list of channels: looked up once, when a recording is
/// opened, so that reading a frame compares no names.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Places([Option<usize>; FLAGS]);

impl Places {
    pub(crate) fn of<'a>(names: impl Iterator<Item = &'a str>) -> Self {
        let mut places = [None; FLAGS];
        for (place, name) in names.enumerate() {
            if let Some(slot) = places.get_mut(position(flag(name))) {
                *slot = Some(place);
            }
        }
        Self(places)
    }

    /// The place of the channel with this flag, a single one.
    pub(crate) fn get(&self, flag: Channels) -> Option<usize> {
        self.0.get(position(flag)).copied().flatten()
    }

    pub(crate) fn has(&self, flag: Channels) -> bool {
        self.get(flag).is_some()
    }
}

/// The number of the flag's bit; beyond the last one for no flag.
fn position(flag: Channels) -> usize {
    flag.bits().trailing_zeros() as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_flag_has_one_name_and_is_found_at_its_place() {
        let names: Vec<_> = Channels::all().iter().map(name).collect();
        let places = Places::of(names.iter().copied());
        for (place, flag) in Channels::all().iter().enumerate() {
            assert_eq!(super::flag(name(flag)), flag);
            assert_eq!(places.get(flag), Some(place), "{}", name(flag));
        }
        assert!(Places::of(["flags", "notes"].into_iter()).0.iter().all(Option::is_none));
        assert!(!places.has(Channels::empty()));
    }
}
