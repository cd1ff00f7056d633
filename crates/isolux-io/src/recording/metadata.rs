//! What is known of a recording before its first frame is read.

use std::path::PathBuf;
use std::sync::Arc;

use isolux::{Channels, Lens, RayTable, Shape};

use super::element::ElementType;
use super::info::RecordingInfo;
use super::lens::{LensDescription, UnusedLens, UnusedReason};
use crate::error::{RecordingError, listing};

/// What a recording holds.
#[derive(Clone, Debug, PartialEq)]
pub struct Metadata {
    /// The path it was opened by.
    pub path: PathBuf,
    /// Number of frames; `None` where the recording does not state it. Once the end has been reached, it is known.
    pub frame_count: Option<usize>,
    /// In which order frames can be read.
    pub access: Access,
    /// Height and width of every frame.
    pub shape: Shape,
    /// The channels, stored ones first, then those that reading computes.
    pub channels: Vec<ChannelInfo>,
    /// The channels that [`read_frame`](super::Recording::read_frame) can fill.
    pub available: Channels,
    /// What is known besides the channels (of the native format, `recording.json`); all fields empty where
    /// nothing is.
    pub info: RecordingInfo,
    /// The direction of each pixel, where the recording holds a table of them (of the native format, `rays.npy`).
    pub rays: Option<Arc<RayTable>>,
}

/// In which order the frames of a recording can be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Access {
    /// Any order; every frame takes the same time.
    Random,
    /// Any order, but a frame is reached by passing all those before it; going back starts anew.
    Rewindable,
    /// From front to back, once: a frame that has been passed is gone.
    Once,
}

/// One channel of a recording.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ChannelInfo {
    /// Its name.
    pub name: String,
    /// Type of its values, as stored.
    pub element: ElementType,
    /// Dimensions of one frame: `[]` one number, `[H, W]` an image, `[4, H, W]` bins, `[4, 4]` a pose.
    pub frame_dims: Vec<usize>,
    /// Where its values come from.
    pub storage: Storage,
}

/// Where a channel's values come from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Storage {
    /// The recording holds a frame of it for each frame.
    Stored {
        /// What a reader may want to know of how it is stored, such as "deflated"; often empty.
        note: String,
    },
    /// One value for all frames, from [`Metadata::info`].
    Constant,
    /// Computed from the phase samples when a frame is read.
    FromPhaseSamples,
}

/// The lens of images of `shape`: a table of `rays` where there is one, otherwise what `info` describes and the shape
/// allows.
#[must_use]
pub fn lens_of(rays: Option<&Arc<RayTable>>, info: &RecordingInfo, shape: Shape) -> LensDescription {
    if let Some(rays) = rays {
        return LensDescription { lens: Some(Lens::Rays(Arc::clone(rays))), unused: None };
    }
    let described = info.lens();
    match &described.lens {
        Some(lens @ Lens::Spinning(_)) => match lens.check_shape(shape) {
            Ok(()) => described,
            Err(error) => {
                let fields = "beam_altitude_angles".to_owned();
                let unused = UnusedLens { fields, reason: UnusedReason::Lens(error) };
                LensDescription { lens: None, unused: Some(unused) }
            }
        },
        _ => described,
    }
}

impl ChannelInfo {
    /// Bytes of one frame.
    #[must_use]
    pub fn frame_bytes(&self) -> usize {
        self.frame_dims.iter().product::<usize>() * self.element.size_bytes()
    }

    /// True for a channel that is stored, not computed or constant: it can be read verbatim.
    #[must_use]
    pub fn is_stored(&self) -> bool {
        matches!(self.storage, Storage::Stored { .. })
    }
}

impl Metadata {
    /// The lens: the table of rays where there is one, otherwise what [`Self::info`] describes and the images allow.
    #[must_use]
    pub fn lens(&self) -> LensDescription {
        lens_of(self.rays.as_ref(), &self.info, self.shape)
    }

    /// The number of frames, for work that must know it before the first frame is read.
    ///
    /// # Errors
    /// [`RecordingError::UnknownLength`].
    pub fn require_frame_count(&self) -> Result<usize, RecordingError> {
        self.frame_count.ok_or_else(|| RecordingError::UnknownLength { path: self.path.clone() })
    }

    /// The stored channel of this name.
    #[must_use]
    pub fn channel(&self, name: &str) -> Option<&ChannelInfo> {
        self.channels.iter().find(|channel| channel.is_stored() && channel.name == name)
    }

    /// The stored channel of this name, or an error that lists those that are there.
    ///
    /// # Errors
    /// [`RecordingError::NoChannel`].
    pub fn require_channel(&self, name: &str) -> Result<&ChannelInfo, RecordingError> {
        self.channel(name).ok_or_else(|| RecordingError::NoChannel {
            path: self.path.clone(),
            channel: name.to_owned(),
            found: listing(self.channels.iter().filter(|c| c.is_stored()).map(|c| c.name.as_str())),
        })
    }
}
