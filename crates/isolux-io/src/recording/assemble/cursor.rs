//! Reaches frames in whatever order they are asked for, as far as the source allows it.

use std::path::Path;

use crate::error::RecordingError;
use crate::recording::metadata::Access;
use crate::recording::source::ChannelSource;

/// A source and the frame that it stands at.
#[derive(Debug)]
pub(super) struct Cursor<S> {
    source: S,
    access: Access,
    frame_count: Option<usize>,
    position: Position,
}

/// Where a source stands that is read from front to back.
#[derive(Clone, Copy, Debug)]
enum Position {
    Start,
    At(usize),
    /// Behind the last frame, or behind an error.
    Lost,
}

/// What was found at an index.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Reached {
    Frame,
    /// The recording ended before this frame.
    End {
        frame_count: usize,
    },
}

impl<S: ChannelSource> Cursor<S> {
    pub(super) fn new(source: S, access: Access, frame_count: Option<usize>) -> Self {
        Self { source, access, frame_count, position: Position::Start }
    }

    pub(super) fn source(&self) -> &S {
        &self.source
    }

    /// Makes `index` the current frame, with these channels loaded. `path` is that of the recording, for messages.
    pub(super) fn load(
        &mut self,
        path: &Path,
        index: usize,
        channels: &[usize],
    ) -> Result<Reached, RecordingError> {
        match self.frame_count {
            Some(frame_count) if index >= frame_count => Ok(Reached::End { frame_count }),
            Some(frame_count) if self.access == Access::Random => {
                if self.source.load(index, channels)? {
                    return Ok(Reached::Frame);
                }
                Err(ended_early(path, index, frame_count))
            }
            _ => self.step_to(path, index, channels),
        }
    }

    /// Passes every frame on the way, so that the end is found exactly where it is.
    fn step_to(&mut self, path: &Path, index: usize, channels: &[usize]) -> Result<Reached, RecordingError> {
        let first = match self.position {
            Position::Start => 0,
            Position::At(current) if index == current => current,
            Position::At(current) if index > current => current + 1,
            _ if self.access == Access::Once => {
                return Err(RecordingError::Passed { path: path.to_owned(), index });
            }
            _ => {
                self.position = Position::Lost;
                self.source.rewind()?;
                0
            }
        };
        self.position = Position::Lost;
        for step in first..=index {
            let channels = if step == index { channels } else { &[] };
            if self.source.load(step, channels)? {
                continue;
            }
            return match self.frame_count {
                Some(frame_count) => Err(ended_early(path, step, frame_count)),
                None => {
                    self.frame_count = Some(step);
                    Ok(Reached::End { frame_count: step })
                }
            };
        }
        self.position = Position::At(index);
        Ok(Reached::Frame)
    }
}

fn ended_early(path: &Path, index: usize, frame_count: usize) -> RecordingError {
    RecordingError::content(path, format!("its end before frame {index}"), format!("{frame_count} frames"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::element::{ByteOrder, ElementType};
    use crate::recording::info::RecordingInfo;
    use crate::recording::source::{RawFrame, SourceDescription};

    /// Writes down what it is asked for; refuses what the trait rules out.
    #[derive(Debug, Default)]
    struct Sequence {
        frames: usize,
        next: usize,
        calls: Vec<String>,
    }

    impl ChannelSource for Sequence {
        fn describe(&self) -> SourceDescription {
            let (path, info_path) = Default::default();
            let (channels, info) = (Vec::new(), RecordingInfo::default());
            SourceDescription {
                path,
                frame_count: None,
                access: Access::Rewindable,
                channels,
                info,
                info_path,
            }
        }

        fn load(&mut self, index: usize, channels: &[usize]) -> Result<bool, RecordingError> {
            assert!(index == self.next || index + 1 == self.next, "{index} after {:?}", self.calls);
            self.calls.push(format!("{index}:{}", channels.len()));
            self.next = index + 1;
            Ok(index < self.frames)
        }

        fn raw(&self, _: usize) -> RawFrame<'_> {
            RawFrame { element: ElementType::U8, byte_order: ByteOrder::Little, dims: &[], bytes: &[] }
        }

        fn rewind(&mut self) -> Result<(), RecordingError> {
            self.calls.push("rewind".to_owned());
            self.next = 0;
            Ok(())
        }
    }

    fn visit(access: Access, indices: &[usize]) -> (Cursor<Sequence>, Vec<Result<Reached, RecordingError>>) {
        let mut cursor = Cursor::new(Sequence { frames: 3, ..Sequence::default() }, access, None);
        let reached = indices.iter().map(|&index| cursor.load(Path::new("rec"), index, &[7])).collect();
        (cursor, reached)
    }

    #[test]
    fn any_order_becomes_steps_forward_and_rewinds() {
        let (cursor, reached) = visit(Access::Rewindable, &[1, 1, 0, 2]);
        assert!(reached.iter().all(|reached| matches!(reached, Ok(Reached::Frame))));
        assert_eq!(cursor.source.calls, ["0:0", "1:1", "1:1", "rewind", "0:1", "1:0", "2:1"]);
    }

    #[test]
    fn the_end_is_found_where_it_is_and_then_known() {
        let (mut cursor, reached) = visit(Access::Rewindable, &[9, 3]);
        for reached in reached {
            assert_eq!(reached.unwrap(), Reached::End { frame_count: 3 });
        }
        assert_eq!(cursor.source.calls, ["0:0", "1:0", "2:0", "3:0"]);
        assert_eq!(cursor.load(Path::new("rec"), 0, &[]).unwrap(), Reached::Frame);
    }

    #[test]
    fn what_is_read_once_does_not_come_back() {
        let (_, reached) = visit(Access::Once, &[0, 2, 1, 3]);
        assert!(matches!(reached[2], Err(RecordingError::Passed { index: 1, .. })));
        assert_eq!(*reached[3].as_ref().unwrap(), Reached::End { frame_count: 3 });
    }

    #[test]
    fn a_recording_shorter_than_it_says_is_an_error() {
        for access in [Access::Random, Access::Rewindable, Access::Once] {
            let mut cursor = Cursor::new(Sequence { frames: 1, ..Sequence::default() }, access, Some(2));
            cursor.load(Path::new("rec"), 0, &[]).unwrap();
            let message = cursor.load(Path::new("rec"), 1, &[]).unwrap_err().to_string();
            assert_eq!(message, "`rec`: found its end before frame 1, expected 2 frames");
        }
    }
}
