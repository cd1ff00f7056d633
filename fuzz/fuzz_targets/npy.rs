//! Any bytes as the amplitude of a folder.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    isolux_fuzz::with_file("amplitude.npy", bytes, |folder, _| isolux_fuzz::read_some(folder));
});
