//! Valid files, cut and flipped at every byte: an error or frames, never a panic, never a huge allocation.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests fail by panicking")]

mod common;

use std::fs;
use std::path::Path;

use common::{Array, Folder, archive, read};
use isolux_io::open;
use zip::CompressionMethod::{Deflated, Stored};

/// Opens and reads; true when all went well.
fn survives(path: &Path) -> bool {
    let Ok(mut recording) = open(path) else { return false };
    (0..recording.metadata().frame_count.unwrap().min(8)).all(|index| read(&mut *recording, index).is_ok())
}

/// Every truncation of `bytes`, and every byte changed in three ways.
fn mutants(bytes: &[u8]) -> impl Iterator<Item = Vec<u8>> {
    let cuts = (0..bytes.len()).map(|length| bytes[..length].to_vec());
    let flips = (0..bytes.len()).flat_map(|position| {
        [0x01, 0x80, 0xff].map(|mask| {
            let mut mutant = bytes.to_vec();
            mutant[position] ^= mask;
            mutant
        })
    });
    cuts.chain(flips)
}

#[test]
fn damaged_arrays_never_panic() {
    let folder = Folder::new();
    for fortran in [false, true] {
        let mut array = Array::counting("<f4", &[2, 2, 2]);
        array.fortran = fortran;
        let bytes = array.bytes();
        for mutant in mutants(&bytes) {
            folder.write("amplitude.npy", &mutant);
            let survived = survives(folder.path());
            assert!(!survived || mutant.len() == bytes.len(), "a truncated array was read");
        }
    }
}

#[test]
fn damaged_archives_never_panic() {
    let folder = Folder::new();
    let path = folder.join("rec.npz");
    let members = [
        ("amplitude.npy", Array::counting(">u2", &[2, 2, 3]).bytes()),
        ("distance.npy", Array::counting("<f4", &[2, 2, 3]).fortran().bytes()),
    ];
    for method in [Stored, Deflated] {
        archive(&path, &members, method);
        let bytes = fs::read(&path).unwrap();
        for mutant in mutants(&bytes) {
            fs::write(&path, &mutant).unwrap();
            let survived = survives(&path);
            assert!(!survived || mutant.len() == bytes.len(), "a truncated archive was read");
        }
    }
}

#[test]
fn damaged_descriptions_never_panic() {
    let amplitude = ("amplitude", Array::counting("<u2", &[1, 2, 3]));
    let json = r#"{"camera":"C","distance_kind":"z","distance_unit":"mm","saturated_amplitude":9,
        "intrinsics":{"fx":1e2,"fy":1,"cx":0,"cy":0},"phase_convention":{"order":[3,2,1,0],"reversed":true}}"#;
    let folder = Folder::described(&[amplitude], json);
    for mutant in mutants(json.as_bytes()) {
        folder.write("recording.json", &mutant);
        survives(folder.path());
    }
}
