//! The writer: whole or not at all, and never over what is not its own.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests fail by panicking")]

mod common;

use std::fs;
use std::path::Path;

use common::{Folder, read};
use isolux::{PixelFlags, Shape};
use isolux_io::{ChannelSpec, ElementType, RecordingError, RecordingInfo, RecordingWriter, open};

const SHAPE: Shape = Shape::new(2, 3);

fn specs() -> Vec<ChannelSpec> {
    vec![
        ChannelSpec::image("amplitude", ElementType::F32, SHAPE),
        ChannelSpec::image("flags", ElementType::U16, SHAPE),
        ChannelSpec::number("integration_time_us", ElementType::F64),
    ]
}

/// A writer with both frames in it, not finished.
fn filled(path: &Path, overwrite: bool) -> Result<RecordingWriter, RecordingError> {
    let mut writer = RecordingWriter::create(path, 2, specs(), overwrite)?;
    for frame in [1.0f32, 2.0] {
        writer.push("amplitude", &[frame; 6])?;
        writer.push("flags", &[PixelFlags::SPECULAR; 6])?;
        writer.push("integration_time_us", &[f64::from(frame) * 1000.0])?;
    }
    Ok(writer)
}

fn camera(name: &str) -> RecordingInfo {
    RecordingInfo { camera: Some(name.to_owned()), ..RecordingInfo::default() }
}

#[test]
fn folders_and_archives_read_back_and_leave_nothing_beside() {
    for (name, left) in [("out", vec!["out"]), ("out.npz", vec!["out.json", "out.npz"])] {
        let folder = Folder::new();
        let path = folder.join(name);
        filled(&path, false).unwrap().finish(&camera("X")).unwrap();
        assert_eq!(folder.names(), left);
        let mut recording = open(&path).unwrap();
        assert_eq!(recording.metadata().info, camera("X"));
        assert_eq!(read(&mut *recording, 1).unwrap().amplitude.values(), [2.0; 6]);
        let mut bytes = Vec::new();
        recording.read_raw("flags", 0, &mut bytes).unwrap();
        assert_eq!(bytes, [32, 0].repeat(6));
    }
}

#[test]
fn the_bytes_are_those_that_numpy_writes() {
    let folder = Folder::new();
    filled(&folder.join("out"), false).unwrap().finish(&camera("X")).unwrap();
    let header = "{'descr': '<f8', 'fortran_order': False, 'shape': (2,), }";
    let mut expected = b"\x93NUMPY\x01\x00\x76\x00".to_vec();
    expected.extend(format!("{header:117}\n").bytes());
    expected.extend([1000f64, 2000.0].iter().flat_map(|value| value.to_le_bytes()));
    assert_eq!(fs::read(folder.join("out/integration_time_us.npy")).unwrap(), expected);
    assert_eq!(fs::read_to_string(folder.join("out/recording.json")).unwrap(), "{\n  \"camera\": \"X\"\n}\n");
}

#[test]
fn two_archives_of_the_same_frames_are_the_same_bytes() {
    let folder = Folder::new();
    let bytes = ["a.npz", "b.npz"].map(|name| {
        filled(&folder.join(name), false).unwrap().finish(&camera("X")).unwrap();
        fs::read(folder.join(name)).unwrap()
    });
    assert!(bytes[0] == bytes[1]);
}

#[test]
fn a_writer_that_is_dropped_leaves_nothing() {
    for name in ["out", "out.npz"] {
        let folder = Folder::new();
        let writer = filled(&folder.join(name), false).unwrap();
        assert_eq!(folder.names().len(), 1);
        drop(writer);
        assert_eq!(folder.names(), [""; 0]);
    }
}

#[test]
fn missing_frames_are_an_error_and_leave_nothing() {
    let folder = Folder::new();
    let mut writer = RecordingWriter::create(&folder.join("out"), 2, specs(), false).unwrap();
    writer.push("amplitude", &[1.0f32; 6]).unwrap();
    let message = writer.finish(&RecordingInfo::default()).unwrap_err().to_string();
    assert!(message.contains("out/amplitude`: 1 frames to be written, 2, as declared expected"), "{message}");
    assert_eq!(folder.names(), [""; 0]);
}

#[test]
fn what_is_there_is_kept_unless_it_may_be_overwritten() {
    for name in ["out", "out.npz"] {
        let folder = Folder::new();
        let path = folder.join(name);
        filled(&path, false).unwrap().finish(&camera("old")).unwrap();
        let error = filled(&path, false).unwrap_err();
        assert!(matches!(error, RecordingError::Exists { .. }), "{error}");
        assert_eq!(open(&path).unwrap().metadata().info, camera("old"));
        let mut still_open = open(&path).unwrap();
        filled(&path, true).unwrap().finish(&camera("new")).unwrap();
        assert_eq!(open(&path).unwrap().metadata().info, camera("new"));
        assert_eq!(read(&mut *still_open, 0).unwrap().amplitude.values(), [1.0; 6]);
        assert_eq!(folder.names().len(), if name == "out" { 1 } else { 2 });
    }
}

#[test]
fn what_is_no_recording_is_never_overwritten() {
    let folder = Folder::new();
    fs::create_dir(folder.join("photos")).unwrap();
    folder.write("photos/a.jpg", b"");
    folder.write("camera.json", b"{}");
    folder.write("file", b"");
    for (name, found) in [("photos", "`a.jpg`"), ("camera.npz", "JSON without the .npz"), ("file", "a file")]
    {
        let error = filled(&folder.join(name), true).unwrap_err();
        assert!(matches!(error, RecordingError::NotReplaced { .. }), "{error}");
        assert!(error.to_string().contains(found), "{error}");
    }
    assert_eq!(folder.names(), ["camera.json", "file", "photos"]);
}

#[test]
fn an_output_that_appears_meanwhile_is_kept() {
    for name in ["out", "out.npz"] {
        let folder = Folder::new();
        let path = folder.join(name);
        let writer = filled(&path, false).unwrap();
        folder.write(name, b"someone else's");
        assert!(matches!(writer.finish(&camera("X")), Err(RecordingError::Exists { .. })));
        assert_eq!(folder.names(), [name]);
    }
}

#[test]
fn frames_that_were_not_declared_are_refused() {
    let folder = Folder::new();
    let mut writer = filled(&folder.join("out"), false).unwrap();
    let messages = [
        writer.push("amplitude", &[1.0f32; 6]).unwrap_err(),
        writer.push("amplitude", &[1.0f64; 6]).unwrap_err(),
        writer.push("sigma", &[1.0f32; 6]).unwrap_err(),
    ]
    .map(|error| error.to_string());
    assert!(messages[0].contains("one frame more to be written, 2 frames expected"), "{}", messages[0]);
    assert!(
        messages[1].contains("values of type float64 to be written, float32 expected"),
        "{}",
        messages[1]
    );
    assert!(
        messages[2].contains("channel `sigma` to be written, `amplitude`, `flags` and"),
        "{}",
        messages[2]
    );
    let mut writer = RecordingWriter::create(&folder.join("other"), 2, specs(), false).unwrap();
    let message = writer.push("amplitude", &[1.0f32; 5]).unwrap_err().to_string();
    assert!(
        message.contains("a frame of 20 bytes to be written, 24: (2, 3) of float32 expected"),
        "{message}"
    );
}

#[test]
fn channels_that_make_no_recording_are_refused() {
    let folder = Folder::new();
    let image = |name: &str| ChannelSpec::image(name, ElementType::U8, SHAPE);
    let bad = [
        vec![],
        vec![image("a"), image("a")],
        vec![image("../a")],
        vec![image("")],
        vec![image(".hidden")],
        vec![ChannelSpec::image("a", ElementType::U8, Shape::new(0, 3))],
        vec![ChannelSpec::image("a", ElementType::F64, Shape::new(usize::MAX, 3))],
    ];
    for specs in bad {
        let error = RecordingWriter::create(&folder.join("out"), 1, specs.clone(), false).unwrap_err();
        assert!(matches!(error, RecordingError::Write { .. }), "{specs:?}: {error}");
    }
    assert!(RecordingWriter::create(&folder.join("out"), 0, vec![image("a")], false).is_err());
    assert!(RecordingWriter::create(Path::new("/"), 1, vec![image("a")], false).is_err());
    let error =
        RecordingWriter::create(&folder.join("no/where/out"), 1, vec![image("a")], false).unwrap_err();
    assert!(matches!(error, RecordingError::Io { .. }), "{error}");
    assert_eq!(folder.names(), [""; 0]);
}

#[test]
fn a_time_in_two_places_is_not_written() {
    let folder = Folder::new();
    let info = RecordingInfo { integration_time_us: Some(5.0), ..RecordingInfo::default() };
    let error = filled(&folder.join("out"), false).unwrap().finish(&info).unwrap_err();
    assert!(matches!(error, RecordingError::Write { .. }), "{error}");
}

#[test]
fn frames_of_an_unknown_number_must_be_as_many_in_every_channel() {
    let folder = Folder::new();
    let start = || RecordingWriter::create(&folder.join("out"), None, specs(), false).unwrap();
    let message = |writer: RecordingWriter| writer.finish(&camera("X")).unwrap_err().to_string();
    let found = message(start());
    assert!(found.contains("out`: 0 frames of 3 channels to be written, at least one of each"), "{found}");
    let mut writer = start();
    for frame in [1.0f32, 2.0] {
        writer.push("amplitude", &[frame; 6]).unwrap();
        writer.push("integration_time_us", &[f64::from(frame)]).unwrap();
    }
    writer.push("flags", &[PixelFlags::empty(); 6]).unwrap();
    let found = message(writer);
    assert!(
        found.contains("out/flags`: 1 frames to be written, 2, as of the other channels expected"),
        "{found}"
    );
    assert_eq!(folder.names(), [""; 0]);
}

#[test]
fn the_output_has_the_permissions_of_any_other_folder() {
    let folder = Folder::new();
    fs::create_dir(folder.join("usual")).unwrap();
    filled(&folder.join("out"), false).unwrap().finish(&camera("X")).unwrap();
    let permissions = |name: &str| fs::metadata(folder.join(name)).unwrap().permissions();
    assert_eq!(permissions("out"), permissions("usual"));
    assert_eq!(permissions("out/amplitude.npy").readonly(), permissions("usual").readonly());
}
