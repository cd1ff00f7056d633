//! What `isolux standardize` writes.

use super::{Array, Channels, Sandbox};

/// Standardizes `rec` into `out`; fails unless every value is finite, or NaN with the flag INVALID.
pub fn standardize(sandbox: &Sandbox, options: &str) -> (Vec<f32>, Vec<u16>) {
    sandbox.run(&format!("standardize rec -o out --force {options}")).done();
    let (values, flags) = (sandbox.f32s("out/standardized_amplitude.npy"), sandbox.u16s("out/flags.npy"));
    let invalid = mask(sandbox, "INVALID");
    assert_eq!(values.len(), flags.len());
    for (value, flags) in values.iter().zip(&flags) {
        assert!(value.is_finite() != (flags & invalid != 0), "{value} with the flags {flags:b}");
        assert!(value.is_nan() || *value > 0.0, "{value}");
    }
    (values, flags)
}

/// The mask of a flag, from the number of its bit in the output's own legend.
pub fn mask(sandbox: &Sandbox, flag: &str) -> u16 {
    let legend = &sandbox.json("out/recording.json")["standardization"]["flag_bits"];
    1 << legend[flag].as_u64().unwrap()
}

/// NaN is not equal to itself, its bits are.
pub fn bits(values: &[f32]) -> Vec<u32> {
    values.iter().map(|value| value.to_bits()).collect()
}

pub fn get<'a>(channels: &'a Channels, name: &str) -> &'a Array {
    &channels.iter().find(|(other, _)| *other == name).unwrap().1
}
