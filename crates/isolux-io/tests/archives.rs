//! Archives: stored and deflated, whole and damaged.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests fail by panicking")]

mod common;

use std::fs::{self, File};
use std::io::Write;
use std::path::PathBuf;

use common::{Array, Folder, archive, failure, read};
use isolux::Channels;
use isolux_io::open;
use isolux_io::recording::{Access, Storage};
use zip::CompressionMethod::{self, Deflated, Stored};
use zip::write::SimpleFileOptions;

fn arrays() -> Vec<(&'static str, Array)> {
    vec![
        ("amplitude.npy", Array::counting(">u2", &[5, 7, 9])),
        ("distance.npy", Array::counting("<f4", &[5, 7, 9]).fortran()),
        ("integration_time_us.npy", Array::counting("<i4", &[5])),
    ]
}

fn members() -> Vec<(&'static str, Vec<u8>)> {
    arrays().into_iter().map(|(name, array)| (name, array.bytes())).collect()
}

fn pack(folder: &Folder, method: CompressionMethod) -> PathBuf {
    let path = folder.join("rec.npz");
    archive(&path, &members(), method);
    path
}

#[test]
fn stored_and_deflated_archives_read_like_folders_in_any_order() {
    let as_folder = Folder::with(&arrays().map_names());
    let mut expected = as_folder.open().unwrap();
    for method in [Stored, Deflated] {
        let folder = Folder::new();
        let mut recording = open(&pack(&folder, method)).unwrap();
        let Storage::Stored { note } = &recording.metadata().channels[1].storage else {
            panic!("the distance is in a file")
        };
        assert_eq!(note, if method == Deflated { "Fortran order, deflated" } else { "Fortran order" });
        assert_eq!(recording.metadata().access, Access::Rewindable);
        for index in [0, 1, 2, 4, 3, 3, 0] {
            assert_eq!(read(&mut *recording, index).unwrap(), read(&mut *expected, index).unwrap());
        }
    }
}

trait MapNames {
    fn map_names(self) -> Vec<(&'static str, Array)>;
}

impl MapNames for Vec<(&'static str, Array)> {
    fn map_names(self) -> Self {
        self.into_iter().map(|(name, array)| (name.trim_end_matches(".npy"), array)).collect()
    }
}

#[test]
fn the_json_lies_beside_the_archive_or_in_the_folder() {
    let folder = Folder::new();
    let path = pack(&folder, Deflated);
    folder.write("rec.json", br#"{"camera": "beside"}"#);
    assert_eq!(open(&path).unwrap().metadata().info.camera.as_deref(), Some("beside"));
    let folder = Folder::new();
    fs::rename(path, folder.join("recording.npz")).unwrap();
    folder.write("recording.json", br#"{"camera": "inside"}"#);
    assert_eq!(folder.open().unwrap().metadata().info.camera.as_deref(), Some("inside"));
}

#[test]
fn archives_written_as_streams_or_for_large_files_are_read() {
    let folder = Folder::new();
    let streamed = folder.join("streamed.npz");
    let mut zip = zip::ZipWriter::new_stream(File::create(&streamed).unwrap());
    for (name, bytes) in members() {
        zip.start_file(name, SimpleFileOptions::default().compression_method(Deflated)).unwrap();
        zip.write_all(&bytes).unwrap();
    }
    zip.finish().unwrap();
    let large = folder.join("large.npz");
    let mut zip = zip::ZipWriter::new(File::create(&large).unwrap());
    for (name, bytes) in members() {
        let options = SimpleFileOptions::default().compression_method(Stored).large_file(true);
        zip.start_file(name, options).unwrap();
        zip.write_all(&bytes).unwrap();
    }
    zip.finish().unwrap();
    for path in [streamed, large] {
        let mut recording = open(&path).unwrap();
        assert_eq!(read(&mut *recording, 4).unwrap().amplitude.values()[62], 315.0);
    }
}

#[test]
fn members_that_are_no_channels_are_left_alone() {
    let folder = Folder::new();
    let path = folder.join("rec.npz");
    let mut all = members();
    all.push(("__MACOSX/._amplitude.npy", b"junk".to_vec()));
    all.push(("notes.txt", b"mine".to_vec()));
    archive(&path, &all, Stored);
    assert_eq!(open(&path).unwrap().metadata().channels.len(), 3);
}

#[test]
fn damaged_archives_say_so() {
    let folder = Folder::new();
    folder.write("empty.npz", b"");
    let message = failure(&folder.join("empty.npz"));
    assert!(message.contains("empty.npz`: found an empty file, expected a .npz archive"), "{message}");
    folder.write("text.npz", b"not an archive");
    let message = failure(&folder.join("text.npz"));
    assert!(message.contains("damaged data") && message.contains("expected a .npz archive"), "{message}");
    folder.write("array.npz", &members()[0].1);
    assert!(failure(&folder.join("array.npz")).contains("damaged data"));
    archive(&folder.join("none.npz"), &[], Stored);
    let message = failure(&folder.join("none.npz"));
    assert!(message.contains("only nothing"), "{message}");
    archive(&folder.join("object.npz"), &[("amplitude.npy", b"\x93NUMP".to_vec())], Deflated);
    let message = failure(&folder.join("object.npz"));
    assert!(message.contains("object.npz/amplitude.npy") && message.contains("signature"), "{message}");
}

#[test]
fn a_flipped_bit_in_deflated_data_does_not_pass_the_checksum() {
    let folder = Folder::new();
    let bytes = fs::read(pack(&folder, Deflated)).unwrap();
    let mut refused = 0;
    // The amplitude's deflated bytes lie behind the first local header.
    for position in (60..400).step_by(17) {
        let mut flipped = bytes.clone();
        flipped[position] ^= 1 << (position % 8);
        folder.write("rec.npz", &flipped);
        let result = open(&folder.join("rec.npz"))
            .and_then(|mut recording| (0..5).try_for_each(|index| read(&mut *recording, index).map(drop)));
        refused += usize::from(result.is_err());
    }
    assert_eq!(refused, 20);
}

#[test]
fn a_claim_beyond_what_deflate_can_hold_is_refused() {
    let folder = Folder::new();
    let bytes = fs::read(pack(&folder, Deflated)).unwrap();
    // The central directory repeats each member's size behind its signature, at byte 24.
    let entry = bytes.windows(4).position(|window| window == b"PK\x01\x02").unwrap();
    let mut claiming = bytes;
    claiming[entry + 24..entry + 28].copy_from_slice(&0x7fff_0000u32.to_le_bytes());
    folder.write("rec.npz", &claiming);
    let message = failure(&folder.join("rec.npz"));
    assert!(message.contains("a member of 2147418112 bytes from"), "{message}");
}

#[test]
fn one_channel_may_be_read_alone() {
    let folder = Folder::new();
    let mut recording = open(&pack(&folder, Deflated)).unwrap();
    let mut frame = isolux::Frame::new(recording.metadata().shape);
    recording.read_frame(3, Channels::INTEGRATION_TIME, &mut frame).unwrap();
    assert_eq!(frame.integration_time_us, isolux::IntegrationTime::PerFrame(4.0));
}
