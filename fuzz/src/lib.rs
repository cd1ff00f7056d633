//! What the targets share: a folder for the damaged file, and reading all that can be read.

use std::cell::OnceCell;
use std::path::Path;

use isolux::{Channels, Frame};
use tempfile::TempDir;

/// Writes `bytes` to a file of this name in a folder of the process, hands both paths over (folder, file).
pub fn with_file(name: &str, bytes: &[u8], test: impl FnOnce(&Path, &Path)) {
    thread_local!(static FOLDER: OnceCell<TempDir> = const { OnceCell::new() });
    FOLDER.with(|folder| {
        let folder = folder.get_or_init(|| tempfile::tempdir().expect("a temporary folder"));
        let file = folder.path().join(name);
        std::fs::write(&file, bytes).expect("room for a file");
        test(folder.path(), &file);
    });
}

/// Opens a recording and reads some frames, in an order that goes forth and back.
pub fn read_some(path: &Path) {
    let Ok(mut recording) = isolux_io::open(path) else { return };
    let Some(count) = recording.metadata().frame_count else { return };
    let mut frame = Frame::new(recording.metadata().shape);
    for index in [0, 1, count - 1, 0] {
        let _ = recording.read_frame(index, Channels::all(), &mut frame);
    }
}
