//! Arrays and archives built byte by byte, independently of the crate's own writer.
#![allow(dead_code, unreachable_pub, reason = "each test binary uses its own part")]

use std::fs::{self, File};
use std::io::Write;
use std::path::{Path, PathBuf};

use isolux::{Channels, Frame};
use isolux_io::{Recording, RecordingError, open};
use tempfile::TempDir;
use zip::CompressionMethod;
use zip::write::SimpleFileOptions;

/// An array as NumPy would save it; the values are given in C order.
#[derive(Clone, Debug)]
pub struct Array {
    pub descr: String,
    pub fortran: bool,
    pub dims: Vec<usize>,
    pub values: Vec<f64>,
}

impl Array {
    pub fn new(descr: &str, dims: &[usize], values: &[f64]) -> Self {
        assert_eq!(values.len(), dims.iter().product::<usize>());
        Self { descr: descr.to_owned(), fortran: false, dims: dims.to_vec(), values: values.to_vec() }
    }

    /// Values 1, 2, 3, ... in C order.
    pub fn counting(descr: &str, dims: &[usize]) -> Self {
        let count = dims.iter().product();
        let values: Vec<_> = (1..=count).map(|value: usize| value as f64).collect();
        Self::new(descr, dims, &values)
    }

    pub fn fortran(self) -> Self {
        Self { fortran: true, ..self }
    }

    pub fn bytes(&self) -> Vec<u8> {
        let mut bytes = header(&self.descr, self.fortran, &self.dims);
        for position in self.storage_order() {
            bytes.extend(encode(&self.descr, self.values[position]));
        }
        bytes
    }

    /// Positions in C order, in the order of storage.
    fn storage_order(&self) -> Vec<usize> {
        if !self.fortran {
            return (0..self.values.len()).collect();
        }
        (0..self.values.len())
            .map(|mut rest| {
                let index: Vec<_> = self
                    .dims
                    .iter()
                    .map(|&dim| {
                        let index = rest % dim;
                        rest /= dim;
                        index
                    })
                    .collect();
                index.iter().zip(&self.dims).fold(0, |position, (&index, &dim)| position * dim + index)
            })
            .collect()
    }
}

pub fn header(descr: &str, fortran: bool, dims: &[usize]) -> Vec<u8> {
    let shape: String = dims.iter().map(|dim| format!("{dim},")).collect();
    let fortran = if fortran { "True" } else { "False" };
    let text = format!("{{'descr': '{descr}', 'fortran_order': {fortran}, 'shape': ({shape}), }}\n");
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((text.len() as u16).to_le_bytes());
    bytes.extend(text.as_bytes());
    bytes
}

fn encode(descr: &str, value: f64) -> Vec<u8> {
    let little = match &descr[1..] {
        "b1" => vec![u8::from(value != 0.0)],
        "u1" => (value as u8).to_le_bytes().to_vec(),
        "u2" => (value as u16).to_le_bytes().to_vec(),
        "u4" => (value as u32).to_le_bytes().to_vec(),
        "u8" => (value as u64).to_le_bytes().to_vec(),
        "i1" => (value as i8).to_le_bytes().to_vec(),
        "i2" => (value as i16).to_le_bytes().to_vec(),
        "i4" => (value as i32).to_le_bytes().to_vec(),
        "i8" => (value as i64).to_le_bytes().to_vec(),
        "f4" => (value as f32).to_le_bytes().to_vec(),
        "f8" => value.to_le_bytes().to_vec(),
        other => panic!("no encoding for {other}"),
    };
    if descr.starts_with('>') { little.into_iter().rev().collect() } else { little }
}

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
