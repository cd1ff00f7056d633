//! A format in less than a hundred lines: a folder of raw 16-bit images that are read once, from the first to the
//! last, without knowing how many there are. Its frames are those of its native twin.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests fail by panicking")]

mod common;
mod toy;

use common::Folder;
use isolux::{Channels, Frame, IntegrationTime, PixelFlags};
use isolux_io::recording::Access;
use isolux_io::{
    Assembled, ChannelSpec, ElementType, Recording, RecordingError, RecordingInfo, RecordingWriter,
    for_each_frame, open,
};
use toy::{SHAPE, Toy, info};

/// Frame `index`: an amplitude with the code for saturated, depths in millimetres.
fn images(index: u16) -> [Vec<u16>; 2] {
    [vec![100 + index, 0, 65535, 7, 8, 9], vec![1000, 2000, 0, 4000, 5000, 6000 + index]]
}

/// The toy and its native twin in one folder, four frames each.
fn twins() -> (Folder, Assembled<Toy>, Box<dyn Recording>) {
    let folder = Folder::new();
    let image = |name: &str| ChannelSpec::image(name, ElementType::U16, SHAPE);
    let channels = vec![image("amplitude"), image("distance")];
    let mut writer = RecordingWriter::create(&folder.join("native"), None, channels, false).unwrap();
    for index in 0..4 {
        let [amplitude, distance] = images(index);
        let both: Vec<u8> = amplitude.iter().chain(&distance).flat_map(|v| v.to_be_bytes()).collect();
        folder.write(&format!("{index:03}.raw"), &both);
        writer.push("amplitude", &amplitude).unwrap();
        writer.push("distance", &distance).unwrap();
    }
    writer.finish(&info()).unwrap();
    let toy = Assembled::new(Toy::open(folder.path())).unwrap();
    let native = open(&folder.join("native")).unwrap();
    (folder, toy, native)
}

#[test]
fn frames_are_those_of_the_native_twin() {
    let (_folder, mut toy, mut native) = twins();
    assert_eq!((toy.metadata().frame_count, toy.metadata().access), (None, Access::Once));
    assert_eq!(toy.metadata().available, native.metadata().available);
    let mut expected = Frame::new(SHAPE);
    let mut raw = [Vec::new(), Vec::new()];
    for index in 0..4 {
        let mut frame = Frame::new(SHAPE);
        assert!(toy.read_frame_if_there(index, Channels::all(), &mut frame).unwrap());
        native.read_frame(index, Channels::all(), &mut expected).unwrap();
        assert_eq!(frame.amplitude.values()[0], 100.0 + index as f32);
        assert!(frame.flags.values()[2].contains(PixelFlags::SATURATED));
        assert_eq!(frame.integration_time_us, IntegrationTime::PerFrame(500.0));
        // NaN appears nowhere, so that frames compare equal.
        assert_eq!(frame, expected);
        // The frame that is current may be read again, verbatim.
        toy.read_raw("distance", index, &mut raw[0]).unwrap();
        native.read_raw("distance", index, &mut raw[1]).unwrap();
        assert_eq!(raw[0], raw[1]);
    }
}

#[test]
fn the_end_is_no_error_and_tells_the_length() {
    let (_folder, mut toy, mut native) = twins();
    let count = |recording: &mut dyn Recording| {
        let mut brightness = 0.0;
        let count = for_each_frame(recording, Channels::AMPLITUDE, |_, frame| {
            brightness += frame.amplitude.values()[0];
            Ok::<(), RecordingError>(())
        });
        (count.unwrap(), brightness)
    };
    assert!(matches!(toy.metadata().require_frame_count(), Err(RecordingError::UnknownLength { .. })));
    assert_eq!(count(&mut toy), (4, 406.0));
    assert_eq!(count(&mut *native), (4, 406.0));
    assert_eq!(toy.metadata().frame_count, Some(4));
    let mut frame = Frame::new(SHAPE);
    let message = toy.read_frame(4, Channels::AMPLITUDE, &mut frame).unwrap_err().to_string();
    assert!(message.contains("has no frame 4: it holds 4, counted from 0"), "{message}");
    let message = toy.read_frame(0, Channels::AMPLITUDE, &mut frame).unwrap_err().to_string();
    assert!(message.contains("frame 0 was asked for after it had been passed"), "{message}");
}

#[test]
fn frames_may_be_passed_over_and_damage_is_an_error() {
    let (folder, mut toy, _) = twins();
    let mut frame = Frame::new(SHAPE);
    toy.read_frame(2, Channels::DISTANCE, &mut frame).unwrap();
    folder.write("003.raw", b"cut");
    let message = toy.read_frame(3, Channels::DISTANCE, &mut frame).unwrap_err().to_string();
    assert!(message.contains("003.raw") && message.contains("found 3 bytes, expected 24"), "{message}");
}

#[test]
fn a_writer_needs_no_number_of_frames() {
    let (folder, _, _) = twins();
    let twin = |count: Option<usize>, name: &str| {
        let path = folder.join(name);
        let channels = vec![ChannelSpec::image("amplitude", ElementType::U16, SHAPE)];
        let mut writer = RecordingWriter::create(&path, count, channels, false).unwrap();
        (0..3).for_each(|index| writer.push("amplitude", &images(index)[0]).unwrap());
        writer.finish(&RecordingInfo::default()).unwrap();
        let file = if name.ends_with(".npz") { path } else { path.join("amplitude.npy") };
        std::fs::read(file).unwrap()
    };
    assert!(twin(Some(3), "told") == twin(None, "untold"));
    assert!(twin(Some(3), "told.npz") == twin(None, "untold.npz"));
}
