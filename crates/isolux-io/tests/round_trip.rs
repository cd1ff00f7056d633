//! Whatever is written reads back, and whatever order an array is stored in, its frames are the same.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests fail by panicking")]

mod common;

use common::{Array, Folder, archive, read};
use isolux::{Channels, Frame};
use isolux_io::{ChannelSpec, ElementType, RecordingInfo, RecordingWriter, open};
use proptest::prelude::*;
use zip::CompressionMethod::{Deflated, Stored};

fn element() -> impl Strategy<Value = ElementType> {
    (0..12usize).prop_map(|position| ElementType::all().nth(position).unwrap())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn bytes_that_are_written_are_read(
        element in element(),
        frames in 1usize..6,
        dims in prop::collection::vec(1usize..5, 0..4),
        seed in any::<u64>(),
        packed in any::<bool>(),
    ) {
        let folder = Folder::new();
        let path = folder.join(if packed { "out.npz" } else { "out" });
        let amplitude = ChannelSpec::image("amplitude", ElementType::U8, isolux::Shape::new(1, 1));
        let extra = ChannelSpec { name: "extra".to_owned(), element, frame_dims: dims };
        let size = extra.frame_dims.iter().product::<usize>() * element.size_bytes();
        let frame_bytes = |frame: usize| -> Vec<u8> {
            let byte = |at: usize| (seed.wrapping_mul(2 * (frame * size + at) as u64 + 1) >> 56) as u8;
            (0..size).map(byte).collect()
        };
        let mut writer = RecordingWriter::create(&path, frames, vec![amplitude, extra.clone()], false).unwrap();
        for frame in 0..frames {
            writer.push("amplitude", &[frame as u8]).unwrap();
            writer.push_bytes("extra", &frame_bytes(frame)).unwrap();
        }
        writer.finish(&RecordingInfo::default()).unwrap();

        let mut recording = open(&path).unwrap();
        let info = recording.metadata().require_channel("extra").unwrap();
        prop_assert_eq!(ChannelSpec::copy_of(info), extra);
        let mut bytes = Vec::new();
        for frame in (0..frames).rev() {
            recording.read_raw("extra", frame, &mut bytes).unwrap();
            prop_assert_eq!(&bytes, &frame_bytes(frame));
        }
    }

    #[test]
    fn storage_does_not_change_a_frame(
        descr in prop::sample::select(vec!["|u1", ">u2", "<i4", ">f4", "<f8"]),
        dims in prop::array::uniform3(1usize..7),
        fortran in any::<bool>(),
        storage in 0..3,
        order in prop::collection::vec(0usize..6, 1..8),
    ) {
        let mut array = Array::counting(descr, &dims);
        // 6³ values wrap around in a byte; that is as good as any.
        array.values.iter_mut().for_each(|value| *value %= 200.0);
        array.fortran = fortran;
        let folder = Folder::new();
        let path = folder.join("recording.npz");
        let members = [("amplitude.npy", array.bytes())];
        match storage {
            0 => folder.write("amplitude.npy", &members[0].1),
            1 => archive(&path, &members, Stored),
            _ => archive(&path, &members, Deflated),
        }
        let mut recording = folder.open().unwrap();
        let pixels = dims[1] * dims[2];
        for index in order.into_iter().map(|index| index % dims[0]) {
            let frame = read(&mut *recording, index).unwrap();
            let expected: Vec<_> =
                array.values[index * pixels..(index + 1) * pixels].iter().map(|&v| v as f32).collect();
            prop_assert_eq!(frame.amplitude.values(), expected);
        }
    }
}

#[test]
fn reading_does_not_move_the_frames_memory() {
    let folder = Folder::with(&[
        ("amplitude", Array::counting("<u2", &[3, 8, 8])),
        ("distance", Array::counting("<u2", &[3, 8, 8])),
        ("target", Array::of("|u1", &[3, 8, 8], &[1.0; 192])),
        ("integration_time_us", Array::counting("<f4", &[3, 8, 8])),
    ]);
    let mut recording = folder.open().unwrap();
    let mut frame = Frame::new(recording.metadata().shape);
    let mut addresses = Vec::new();
    for index in 0..3 {
        recording.read_frame(index, Channels::all(), &mut frame).unwrap();
        let isolux::IntegrationTime::PerPixel(time) = &frame.integration_time_us else { panic!("no map") };
        addresses.push((
            frame.amplitude.values().as_ptr(),
            frame.distance_m.as_ref().unwrap().values().as_ptr(),
            frame.target.as_ref().unwrap().values().as_ptr(),
            time.values().as_ptr(),
        ));
    }
    assert!(addresses.iter().all(|address| *address == addresses[0]));
}
