//! The toy format: `000.raw`, `001.raw`, …, each an amplitude and a depth image of 16-bit big-endian values.

use std::fs;
use std::path::{Path, PathBuf};

use isolux::{Intrinsics, Shape};
use isolux_io::recording::{
    Access, ByteOrder, ChannelSource, DistanceKind, ElementType, RawFrame, RecordingInfo, SourceDescription,
    StoredChannel,
};
use isolux_io::{RecordingError, recording};

pub(crate) const SHAPE: Shape = Shape::new(2, 3);
const DIMS: [usize; 2] = [SHAPE.height, SHAPE.width];
const IMAGE_BYTES: usize = 2 * SHAPE.pixels();

/// What the maker of the camera tells.
pub(crate) fn info() -> RecordingInfo {
    RecordingInfo {
        distance_kind: Some(DistanceKind::Z),
        distance_unit: Some(recording::DistanceUnit::Millimetre),
        intrinsics: Some(Intrinsics { fx: 2.0, fy: 2.0, cx: 1.0, cy: 0.5 }.into()),
        saturated_amplitude: Some(65535.0),
        integration_time_us: Some(500.0),
        ..RecordingInfo::default()
    }
}

pub(crate) struct Toy {
    folder: PathBuf,
    /// The file of the current frame.
    file: Vec<u8>,
    next: usize,
}

impl Toy {
    pub(crate) fn open(folder: &Path) -> Self {
        Self { folder: folder.to_owned(), file: Vec::new(), next: 0 }
    }
}

impl ChannelSource for Toy {
    fn describe(&self) -> SourceDescription {
        let channel = |name: &str| StoredChannel {
            name: name.to_owned(),
            path: self.folder.clone(),
            element: ElementType::U16,
            frame_dims: DIMS.to_vec(),
            note: String::new(),
        };
        SourceDescription {
            path: self.folder.clone(),
            frame_count: None,
            access: Access::Once,
            channels: vec![channel("amplitude"), channel("distance")],
            info: info(),
            info_path: self.folder.clone(),
        }
    }

    fn load(&mut self, index: usize, channels: &[usize]) -> Result<bool, RecordingError> {
        assert!([index, index + 1].contains(&self.next), "asked for {index}, standing before {}", self.next);
        let path = self.folder.join(format!("{index:03}.raw"));
        self.next = index + 1;
        if channels.is_empty() || !path.exists() {
            return Ok(path.exists());
        }
        let error = |source| RecordingError::Io { action: "read", path: path.clone(), source };
        self.file = fs::read(&path).map_err(error)?;
        if self.file.len() == 2 * IMAGE_BYTES {
            return Ok(true);
        }
        let found = format!("{} bytes", self.file.len());
        Err(RecordingError::Content { file: path, found, expected: (2 * IMAGE_BYTES).to_string() })
    }

    fn raw(&self, channel: usize) -> RawFrame<'_> {
        let bytes = &self.file[channel * IMAGE_BYTES..(channel + 1) * IMAGE_BYTES];
        RawFrame { element: ElementType::U16, byte_order: ByteOrder::Big, dims: &DIMS, bytes }
    }
}
