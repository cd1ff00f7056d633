//! Runs the program in a temporary folder and looks at everything that it leaves there.
#![allow(dead_code, unused_imports, unreachable_pub, reason = "each test binary uses its own part")]

mod calls;
mod noise;
#[path = "../../../isolux-io/tests/common/npy.rs"]
mod npy;
mod readers;
mod resources;
mod run;
mod standardized;

use std::collections::BTreeMap;
use std::fs;
use std::io::{Cursor, Write};
use std::path::{Path, PathBuf};

use tempfile::TempDir;
use zip::CompressionMethod;
use zip::write::SimpleFileOptions;

pub use calls::{calibration, refused, sandbox};
pub use noise::Noise;
pub use npy::{Array, header};
pub use readers::{READERS, refused_by};
#[cfg(target_os = "linux")]
pub use resources::{limit_address_space, peak_memory};
pub use run::{Run, run, simulate};
pub use standardized::{bits, get, mask, standardize};

/// Channels by name.
pub type Channels = Vec<(&'static str, Array)>;

/// Every file and folder below a folder, with the files' bytes.
pub type Snapshot = BTreeMap<PathBuf, Option<Vec<u8>>>;

/// A temporary folder to work in; removed at the end of the test.
pub struct Sandbox(TempDir);

impl Sandbox {
    pub fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    pub fn path(&self) -> &Path {
        self.0.path()
    }

    pub fn join(&self, name: &str) -> PathBuf {
        self.path().join(name)
    }

    pub fn write(&self, name: &str, bytes: impl AsRef<[u8]>) {
        let path = self.join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, bytes).unwrap();
    }

    /// A folder recording without recording.json.
    pub fn recording(&self, name: &str, channels: &[(&str, Array)]) {
        fs::create_dir_all(self.join(name)).unwrap();
        for (channel, array) in channels {
            self.write(&format!("{name}/{channel}.npy"), array.bytes());
        }
    }

    pub fn described(&self, name: &str, channels: &[(&str, Array)], json: &str) {
        self.recording(name, channels);
        self.write(&format!("{name}/recording.json"), json);
    }

    /// Runs `isolux` in the folder.
    pub fn isolux(&self, arguments: &[&str]) -> Run {
        Run::new(self.command(arguments))
    }

    /// The same with the arguments in one text, separated by spaces.
    pub fn run(&self, arguments: &str) -> Run {
        self.isolux(&arguments.split_whitespace().collect::<Vec<_>>())
    }

    pub fn command(&self, arguments: &[&str]) -> std::process::Command {
        let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_isolux"));
        command.args(arguments).current_dir(self.path());
        command
    }

    pub fn json(&self, name: &str) -> serde_json::Value {
        serde_json::from_slice(&fs::read(self.join(name)).unwrap()).unwrap()
    }

    /// The values of a channel's file, and its header.
    pub fn array(&self, name: &str) -> (String, Vec<u8>) {
        npy::split(&fs::read(self.join(name)).unwrap())
    }

    pub fn f32s(&self, name: &str) -> Vec<f32> {
        let (header, bytes) = self.array(name);
        assert!(header.contains("'<f4'"), "{name}: {header}");
        bytes.as_chunks::<4>().0.iter().map(|bytes| f32::from_le_bytes(*bytes)).collect()
    }

    pub fn u16s(&self, name: &str) -> Vec<u16> {
        let (header, bytes) = self.array(name);
        assert!(header.contains("'<u2'"), "{name}: {header}");
        bytes.as_chunks::<2>().0.iter().map(|bytes| u16::from_le_bytes(*bytes)).collect()
    }

    /// Everything that is there now.
    pub fn snapshot(&self) -> Snapshot {
        let mut found = Snapshot::new();
        let mut folders = vec![self.path().to_owned()];
        while let Some(folder) = folders.pop() {
            for entry in fs::read_dir(folder).unwrap() {
                let entry = entry.unwrap();
                let kind = entry.file_type().unwrap();
                if kind.is_dir() {
                    folders.push(entry.path());
                }
                let bytes = kind.is_file().then(|| fs::read(entry.path()).unwrap());
                found.insert(entry.path(), bytes);
            }
        }
        found
    }

    /// Fails unless the folder holds what it held, byte by byte: no output, no temporary file, no input harmed.
    pub fn expect_unchanged(&self, before: &Snapshot, what: &str) {
        let after = self.snapshot();
        let names = |snapshot: &Snapshot| snapshot.keys().cloned().collect::<Vec<_>>();
        assert_eq!(names(&after), names(before), "{what}: files came or went");
        for (path, bytes) in before {
            assert!(after[path] == *bytes, "{what}: {} was changed", path.display());
        }
    }
}

/// The bytes of an archive.
pub fn archive(members: &[(&str, Vec<u8>)], method: CompressionMethod) -> Vec<u8> {
    let mut zip = zip::ZipWriter::new(Cursor::new(Vec::new()));
    let options = SimpleFileOptions::default().compression_method(method);
    for (name, bytes) in members {
        zip.start_file(*name, options).unwrap();
        zip.write_all(bytes).unwrap();
    }
    zip.finish().unwrap().into_inner()
}

/// The bytes of a recording as `.npz`.
pub fn npz(channels: &[(&str, Array)], method: CompressionMethod) -> Vec<u8> {
    let members: Vec<_> =
        channels.iter().map(|(name, array)| (format!("{name}.npy"), array.bytes())).collect();
    let members: Vec<_> = members.iter().map(|(name, bytes)| (name.as_str(), bytes.clone())).collect();
    archive(&members, method)
}

/// A small sweep of four integration times: a still chart, amplitudes in proportion to the time, whole numbers
/// below 256, so that every element type can hold them.
pub fn sweep() -> Channels {
    let (frames, height, width) = (4, 5, 6);
    let values = (0..frames * height * width).map(|i| ((i / (height * width) + 1) * (8 + i % 30)) as f64);
    vec![
        ("amplitude", Array::new("<f4", &[frames, height, width], values.collect())),
        ("distance", Array::filled("<f4", &[frames, height, width], 1.25)),
        ("integration_time_us", Array::new("<f8", &[frames], vec![1000.0, 2000.0, 3000.0, 4000.0])),
    ]
}

/// The channels with one of them replaced or added.
pub fn with(channels: &[(&'static str, Array)], name: &'static str, array: Array) -> Channels {
    let mut channels = without(channels, name);
    channels.push((name, array));
    channels
}

pub fn without(channels: &[(&'static str, Array)], name: &str) -> Channels {
    channels.iter().filter(|(other, _)| *other != name).cloned().collect()
}
