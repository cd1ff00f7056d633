//! Any bytes as an archive.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    isolux_fuzz::with_file("recording.npz", bytes, |_, file| isolux_fuzz::read_some(file));
});
