//! Laws of standardizing and fitting that hold for every frame and every sweep.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests fail by panicking")]

mod common;

use common::standardize::{next, standardize};
use common::strategies::{PIXELS, bits, cases, distance_steps, frames, specular_steps, steps, time_steps};
use isolux::standardize::{DistanceStep, SpecularStep, TimeStep};
use isolux::terms::cubic::{Decay, DecayPoint};
use isolux::terms::lut::{ExposureSample, LutAnswer};
use isolux::terms::{Cubic, Lut};
use isolux::{Frame, IntegrationTime, PixelFlags, Plane, Standardized};
use proptest::prelude::*;

fn scale(plane: &mut Plane<f32>, factor: f32) {
    plane.values_mut().iter_mut().for_each(|value| *value *= factor);
}

fn scale_time(frame: &mut Frame, factor: f32) {
    match &mut frame.integration_time_us {
        IntegrationTime::PerFrame(time) => *time *= f64::from(factor),
        IntegrationTime::PerPixel(map) => scale(map, factor),
        IntegrationTime::Unknown => {}
    }
}

/// The same flags, and values within `roundings` half ulps, of pixels that are valid in both.
fn assert_near(found: &Standardized, expected: &[f32], roundings: f32) -> Result<(), TestCaseError> {
    for (found, &expected) in found.amplitude.values().iter().zip(expected) {
        prop_assert_eq!(found.is_nan(), expected.is_nan());
        let deviation = (found / expected - 1.0).abs();
        prop_assert!(found.is_nan() || deviation <= 0.5 * roundings * f32::EPSILON, "{} {}", found, expected);
    }
    Ok(())
}

proptest! {
    #![proptest_config(cases(256))]

    /// The law of the flags, for every chain; and the input stays as it is.
    #[test]
    fn a_value_is_nan_exactly_where_invalid_is_flagged(
        frame in frames(), time in time_steps(), distance in distance_steps(), specular in specular_steps(),
    ) {
        let before = (bits(&frame.amplitude), bits(frame.distance_m.as_ref().unwrap()), frame.flags.clone());
        let standardizer = steps(time, distance, specular);
        let out = standardize(&standardizer, &frame);
        for (index, (&value, flags)) in out.amplitude.values().iter().zip(out.flags.values()).enumerate() {
            prop_assert_eq!(value.is_nan(), flags.contains(PixelFlags::INVALID));
            prop_assert!(value.is_nan() || (value > 0.0 && value.is_finite()));
            prop_assert!(flags.contains(frame.flags.values()[index]), "a flag was lost");
        }
        let valid = out.amplitude.values().iter().filter(|value| !value.is_nan()).count();
        prop_assert_eq!((out.summary.valid, out.summary.pixels), (valid, PIXELS));
        prop_assert_eq!(before, (bits(&frame.amplitude), bits(frame.distance_m.as_ref().unwrap()), frame.flags));
    }

    /// A gain that is a power of two changes exponents only, so it passes through every step and every cutoff
    /// without a rounding: bit for bit. (Of another gain that cannot be said: a value at the edge of a bin may
    /// be rounded into its neighbour, and a bin at the threshold then decides.)
    #[test]
    fn twice_the_amplitude_is_twice_the_value(
        frame in frames(), time in time_steps(), distance in distance_steps(), specular in specular_steps(),
        exponent in -6i32..=6,
    ) {
        let gain = 2f32.powi(exponent);
        let standardizer = steps(time, distance, specular);
        let mut expected = standardize(&standardizer, &frame);
        let mut louder = frame.clone();
        scale(&mut louder.amplitude, gain);
        let found = standardize(&standardizer, &louder);
        scale(&mut expected.amplitude, gain);
        prop_assert_eq!(bits(&found.amplitude), bits(&expected.amplitude));
        prop_assert_eq!(found.flags, expected.flags);
    }

    /// Any gain: two roundings of the gain's products, two of the chain on either side.
    #[test]
    fn a_gain_passes_through(
        frame in frames(), time in time_steps(), distance in distance_steps(), gain in 1e-2..1e2f32,
    ) {
        let standardizer = steps(time, distance, SpecularStep::None);
        let mut expected = standardize(&standardizer, &frame);
        let mut louder = frame.clone();
        scale(&mut louder.amplitude, gain);
        let found = standardize(&standardizer, &louder);
        scale(&mut expected.amplitude, gain);
        assert_near(&found, expected.amplitude.values(), 8.0)?;
        prop_assert_eq!(found.flags, expected.flags);
    }

    /// Linear time: `c` times the light in `c` times the time. Rounded: both products, the multiplier and its
    /// product, on either side.
    #[test]
    fn light_and_time_cancel(frame in frames(), distance in distance_steps(), factor in 0.05..20f32) {
        let standardizer = steps(TimeStep::Linear, distance, SpecularStep::None);
        let expected = standardize(&standardizer, &frame);
        let mut longer = frame.clone();
        scale(&mut longer.amplitude, factor);
        scale_time(&mut longer, factor);
        let found = standardize(&standardizer, &longer);
        assert_near(&found, expected.amplitude.values(), 8.0)?;
        prop_assert_eq!(found.flags, expected.flags);
    }

    /// Square: a surface `c` times as far away returns 1/c². Rounded: c², the quotient, the distance (twice, as
    /// it enters squared); the polynomial's two products and one more on either side.
    #[test]
    fn amplitude_and_distance_cancel(frame in frames(), time in time_steps(), factor in 0.2..5f32) {
        let standardizer = steps(time, DistanceStep::Square, SpecularStep::None);
        let expected = standardize(&standardizer, &frame);
        let mut farther = frame.clone();
        scale(&mut farther.amplitude, 1.0 / (factor * factor));
        scale(farther.distance_m.as_mut().unwrap(), factor);
        let found = standardize(&standardizer, &farther);
        assert_near(&found, expected.amplitude.values(), 12.0)?;
        prop_assert_eq!(found.flags, expected.flags);
    }

    /// Point-wise steps look at no neighbour: spoiling a pixel changes that pixel alone.
    #[test]
    fn spoilt_pixels_leave_their_neighbours_bit_for_bit(
        frame in frames(), time in time_steps(), distance in distance_steps(),
        spoilt in prop::collection::vec((0..PIXELS, prop::sample::select(vec![f32::NAN, 0.0]), any::<bool>()), 1..9),
    ) {
        let standardizer = steps(time, distance, SpecularStep::None);
        let expected = standardize(&standardizer, &frame);
        let mut damaged = frame.clone();
        for &(index, value, in_distance) in &spoilt {
            let distance_m = damaged.distance_m.as_mut().unwrap();
            let plane = if in_distance { distance_m } else { &mut damaged.amplitude };
            plane.values_mut()[index] = value;
        }
        damaged.flag_amplitude(None);
        let found = standardize(&standardizer, &damaged);
        for index in (0..PIXELS).filter(|index| spoilt.iter().all(|(i, ..)| i != index)) {
            let value = |out: &Standardized| out.amplitude.values()[index].to_bits();
            prop_assert_eq!(value(&found), value(&expected));
            prop_assert_eq!(found.flags.values()[index], expected.flags.values()[index]);
        }
    }

    /// What was standardized before, of whatever shape, leaves no trace in reused memory.
    #[test]
    fn frames_are_independent_of_each_other(
        sequence in prop::collection::vec(frames(), 2..5), time in time_steps(), distance in distance_steps(),
        specular in specular_steps(),
    ) {
        let standardizer = steps(time, distance, specular);
        let mut stream = standardizer.stream();
        for frame in sequence.iter().chain(sequence.iter().rev()) {
            let reused = next(&mut stream, frame).unwrap();
            let fresh = standardize(&standardizer, frame);
            prop_assert_eq!(fresh.summary, reused.summary);
            prop_assert_eq!(bits(&reused.amplitude), bits(&fresh.amplitude));
            prop_assert_eq!(&reused.flags, &fresh.flags);
        }
    }

    /// A table knows ratios only: neither the wall's brightness nor the unit of time enters.
    #[test]
    fn a_table_does_not_depend_on_units(
        steps_ in prop::collection::vec((1.05..2.5f64, 0.9..2.5f64), 3..12), gain in 1e-3..1e3f64,
        unit in 1e-3..1e3f64, place in 0.0..1.0f64,
    ) {
        let mut sample = ExposureSample { integration_time_us: 100.0, mean_amplitude_dn: 7.0, frame_spread: 0.01 };
        let samples: Vec<ExposureSample> = steps_.iter().map(|(time, growth)| {
            sample.integration_time_us *= time;
            sample.mean_amplitude_dn *= growth;
            sample
        }).collect();
        let reference = samples[0].integration_time_us * 1.01;
        let scaled: Vec<_> = samples.iter().map(|s| ExposureSample {
            integration_time_us: s.integration_time_us * unit,
            mean_amplitude_dn: s.mean_amplitude_dn * gain,
            ..*s
        }).collect();
        let (first, second) = (Lut::fit(&samples, reference), Lut::fit(&scaled, reference * unit));
        let (Ok(first), Ok(second)) = (&first, &second) else {
            // The peak may be the first sample: then neither is a table.
            prop_assert!(first.is_err() && second.is_err());
            return Ok(());
        };
        let [min, max] = first.valid_integration_time_us;
        // Inside the range, so that rounding of the scaled time does not leave it.
        let time = min + (max - min) * (0.001 + 0.998 * place);
        let (LutAnswer::Inside(a), LutAnswer::Inside(b)) = (first.at(time), second.at(time * unit)) else {
            panic!("{time} is inside")
        };
        // Quotients and logarithms of numbers up to e¹⁴: some tens of roundings.
        prop_assert!((a / b - 1.0).abs() < 100.0 * f64::EPSILON * 14.0, "{} {}", a, b);
    }

    /// Neither does a cubic: not on the target's brightness, and with the unit of length as a cubic must.
    #[test]
    fn a_cubic_does_not_depend_on_units(
        wiggle in prop::collection::vec(0.95..1.05f64, 12), gain in 1e-3..1e3f64, unit in 1e-2..1e2f64,
    ) {
        let decay = |gain: f64, unit: f64| {
            let point = |(i, wiggle): (usize, &f64)| {
                let distance_m = 0.4 + 0.25 * i as f64;
                let amplitude_dn = gain * wiggle * 300.0 / (distance_m * distance_m + 0.05);
                DecayPoint { distance_m: distance_m * unit, amplitude_dn }
            };
            Decay { integration_time_us: None, points: wiggle.iter().enumerate().map(point).collect() }
        };
        let (Ok((first, _)), Ok((second, _))) =
            (Cubic::fit(&[decay(1.0, 1.0)], 0.75), Cubic::fit(&[decay(gain, unit)], 0.75 * unit))
        else {
            panic!("both fit")
        };
        let at = |cubic: &Cubic, x: f64| {
            let [c0, c1, c2, c3] = cubic.coefficients;
            c0 + x * (c1 + x * (c2 + x * c3))
        };
        for step in 0..=20 {
            let distance = 0.4 + 2.75 * f64::from(step) / 20.0;
            let (a, b) = (at(&first, distance), at(&second, distance * unit));
            // Condition of the scaled design below 10⁵, in f64.
            prop_assert!((a / b - 1.0).abs() < 1e6 * f64::EPSILON, "{distance} m: {a} {b}");
        }
    }
}
