//! Any bytes as `recording.json`.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let _ = isolux_io::RecordingInfo::from_json(bytes, "recording.json".as_ref());
});
