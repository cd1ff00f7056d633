//! Recordings and archives built byte by byte, independently of the crate's own writer.
#![allow(dead_code, unused_imports, unreachable_pub, reason = "each test binary uses its own part")]

mod npy;

use std::fs::{self, File};
use std::io::Write;
use std::path::{Path, PathBuf};

use isolux::{Channels, Frame};
use isolux_io::{Recording, RecordingError, open};
use tempfile::TempDir;
use zip::CompressionMethod;
use zip::write::SimpleFileOptions;

pub use npy::{Array, header};

/// A folder that is removed at the end of the test.
pub struct Folder(TempDir);

impl Folder {
    pub fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    pub fn with(arrays: &[(&str, Array)]) -> Self {
        let folder = Self::new();
        for (name, array) in arrays {
            folder.write(&format!("{name}.npy"), &array.bytes());
        }
        folder
    }

    /// A folder with `recording.json` too.
    pub fn described(arrays: &[(&str, Array)], json: &str) -> Self {
        let folder = Self::with(arrays);
        folder.write("recording.json", json.as_bytes());
        folder
    }

    pub fn path(&self) -> &Path {
        self.0.path()
    }

    pub fn join(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub fn write(&self, name: &str, bytes: &[u8]) {
        fs::write(self.join(name), bytes).unwrap();
    }

    pub fn open(&self) -> Result<Box<dyn Recording>, RecordingError> {
        open(self.path())
    }

    /// Names of everything in the folder, sorted.
    pub fn names(&self) -> Vec<String> {
        let mut names: Vec<_> = fs::read_dir(self.path())
            .unwrap()
            .map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned())
            .collect();
        names.sort();
        names
    }
}

pub fn archive(path: &Path, members: &[(&str, Vec<u8>)], method: CompressionMethod) {
    let mut zip = zip::ZipWriter::new(File::create(path).unwrap());
    let options = SimpleFileOptions::default().compression_method(method);
    for (name, bytes) in members {
        zip.start_file(*name, options).unwrap();
        zip.write_all(bytes).unwrap();
    }
    zip.finish().unwrap();
}

/// Every channel of one frame in a frame of its own.
pub fn read(recording: &mut dyn Recording, index: usize) -> Result<Frame, RecordingError> {
    let mut frame = Frame::new(recording.metadata().shape);
    recording.read_frame(index, Channels::all(), &mut frame)?;
    Ok(frame)
}

/// The message of opening, or else of reading all frames.
pub fn failure(path: &Path) -> String {
    let result = open(path).and_then(|mut recording| {
        let count = recording.metadata().require_frame_count()?;
        (0..count).try_for_each(|index| read(&mut *recording, index).map(drop))
    });
    result.expect_err("it was read").to_string()
}
