//! Phases whose convention is not the stated one, bins that clip, two frequencies, and I/Q: what the program says and
//! computes.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests fail by panicking")]

mod common;

use common::{Array, Sandbox, header};

const ROWS: usize = 32;
const COLUMNS: usize = 48;
const FRAMES: usize = 3;

/// A camera and what it looks at.
struct Take {
    frequency_hz: f64,
    /// Amplitude at 1 m, DN.
    gain: f64,
    /// Light that is not modulated, DN.
    mean: f64,
    /// Position of A1..A4, and the direction of the phase.
    order: [usize; 4],
    reversed: bool,
    clip: [f64; 2],
    descr: &'static str,
    distance_m: fn(usize, usize) -> f64,
}

const TAKE: Take = Take {
    frequency_hz: 15e6,
    gain: 600.0,
    mean: 2000.0,
    order: [0, 1, 2, 3],
    reversed: false,
    clip: [0.0, 65535.0],
    descr: "<u2",
    distance_m: away,
};

/// A wall that goes away to the right.
fn away(_: usize, column: usize) -> f64 {
    0.6 + 0.07 * column as f64
}

/// A staircase of boards that comes nearer downwards.
fn stairs(row: usize, column: usize) -> f64 {
    4.2 - 0.4 * (row / 4) as f64 - 0.003 * column as f64
}

impl Take {
    fn phase(&self, row: usize, column: usize) -> f64 {
        4.0 * std::f64::consts::PI * self.frequency_hz * (self.distance_m)(row, column) / 299_792_458.0
    }

    fn amplitude(&self, row: usize, column: usize) -> f64 {
        let bright = (row / 8 + column / 8).is_multiple_of(2);
        self.gain * if bright { 0.9 } else { 0.4 } / (self.distance_m)(row, column).powi(2)
    }

    /// The bins with a noise of 2 DN, of whole numbers, clipped.
    fn bins(&self) -> Array {
        let mut values = vec![0.0; FRAMES * 4 * ROWS * COLUMNS];
        let mut state = 1u64;
        for frame in 0..FRAMES {
            for (k, position) in self.order.into_iter().enumerate() {
                for at in 0..ROWS * COLUMNS {
                    let (row, column) = (at / COLUMNS, at % COLUMNS);
                    let sign = if self.reversed { -1.0 } else { 1.0 };
                    let angle = sign * self.phase(row, column) - k as f64 * std::f64::consts::FRAC_PI_2;
                    let value = self.mean + self.amplitude(row, column) * angle.cos() + noise(&mut state);
                    let [low, high] = self.clip;
                    values[((frame * 4) + position) * ROWS * COLUMNS + at] = value.round().clamp(low, high);
                }
            }
        }
        Array::new(self.descr, &[FRAMES, 4, ROWS, COLUMNS], values)
    }

    fn described(&self, more: &str) -> Sandbox {
        let sandbox = Sandbox::new();
        let json = format!(
            r#"{{"modulation_frequency_hz": {}, "integration_time_us": 500{more}}}"#,
            self.frequency_hz
        );
        sandbox.described("rec", &[("phase_samples", self.bins())], &json);
        sandbox
    }
}

/// About Gaussian, of 2 DN: the sum of twelve even numbers.
fn noise(state: &mut u64) -> f64 {
    let mut even = || {
        *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (*state >> 33) as f64 / (1u64 << 31) as f64 - 0.5
    };
    2.0 * (0..12).map(|_| even()).sum::<f64>()
}

/// What every command that looks says of the phases.
fn remarks(sandbox: &Sandbox) -> String {
    let info = sandbox.run("info rec").done();
    let said = info.stdout + &info.stderr;
    let standardized = sandbox.run("standardize rec -o out --force").done().stderr;
    for text in [&standardized, &sandbox.run("diagnose rec").done().stdout.replace("\n    ", " ")] {
        for part in ["phase_convention", "saturated_phase_sample"] {
            assert_eq!(text.contains(part), said.contains(part), "{said}\n{text}");
        }
    }
    said
}

#[test]
fn phases_that_are_as_stated_raise_no_remark() {
    let takes = [
        TAKE,
        Take { distance_m: stairs, ..TAKE },
        Take { mean: 0.0, clip: [-2048.0, 2047.0], descr: "<i2", ..TAKE },
    ];
    for take in takes {
        let said = remarks(&take.described(""));
        assert!(!said.contains("phase_convention") && !said.contains("saturated_phase_sample"), "{said}");
    }
    // A convention that is stated is taken at its word, whatever it is.
    let take = Take { order: [2, 0, 1, 3], reversed: true, ..TAKE };
    let said = remarks(&take.described(r#", "phase_convention": {"order": [2, 0, 1, 3], "reversed": true}"#));
    assert!(!said.contains("phase_convention"), "{said}");
}

#[test]
fn the_sign_is_named_and_what_is_named_helps() {
    for take in [
        Take { reversed: true, ..TAKE },
        Take { reversed: true, distance_m: stairs, frequency_hz: 20e6, gain: 900.0, ..TAKE },
    ] {
        let said = remarks(&take.described(""));
        assert!(
            said.contains("the amplitude grows with d^") && said.contains("with the sign reversed"),
            "{said}"
        );
        let field = r#""phase_convention": {"order": [0, 1, 2, 3], "reversed": true}"#;
        assert!(said.contains(field), "{said}");
        let helped = remarks(&take.described(&format!(", {field}")));
        assert!(!helped.contains("phase_convention"), "{helped}");
    }
}

#[test]
fn another_order_is_named_by_the_sums_of_opposite_bins() {
    for (order, distance_m) in [([0, 2, 1, 3], away as fn(usize, usize) -> f64), ([3, 2, 0, 1], stairs)] {
        let take = Take { order, distance_m, ..TAKE };
        let said = remarks(&take.described(""));
        let field = format!(r#""phase_convention": {{"order": {order:?}, "reversed": false}}"#);
        assert!(said.contains("A1 + A3 and A2 + A4 differ by") && said.contains(&field), "{said}");
    }
}

#[test]
fn recorded_distances_tell_the_convention() {
    for (order, reversed) in [([1, 2, 3, 0], false), ([0, 1, 2, 3], true)] {
        let take = Take { order, reversed, ..TAKE };
        let sandbox = take.described("");
        let distances: Vec<f64> =
            (0..FRAMES * ROWS * COLUMNS).map(|at| away(0, at % COLUMNS) + 0.04).collect();
        let distance = Array::new("<f4", &[FRAMES, ROWS, COLUMNS], distances);
        sandbox.write("rec/distance.npy", distance.bytes());
        let said = remarks(&sandbox);
        let field = format!(r#""phase_convention": {{"order": {order:?}, "reversed": {reversed}}}"#);
        assert!(said.contains("differ from the recorded ones by") && said.contains(&field), "{said}");
    }
}

#[test]
fn bins_that_clip_are_told_with_the_value() {
    let near = |_: usize, column: usize| 0.25 + 0.06 * column as f64;
    for (take, value) in [
        (Take { mean: 0.0, clip: [-2047.0, 2047.0], descr: "<i2", distance_m: near, ..TAKE }, 2047),
        (Take { mean: 300.0, clip: [0.0, 1000.0], distance_m: near, gain: 300.0, ..TAKE }, 1000),
        (Take { clip: [0.0, 4095.0], distance_m: near, ..TAKE }, 4095),
    ] {
        let said = remarks(&take.described(""));
        assert!(said.contains(&format!(r#""saturated_phase_sample": {value}"#)), "{said}");
        assert!(!said.contains("phase_convention"), "{said}");
        let helped = remarks(&take.described(&format!(r#", "saturated_phase_sample": {value}"#)));
        assert!(!helped.contains("saturated_phase_sample"), "{helped}");
    }
}

#[test]
fn two_frequencies_are_standardized_beyond_the_range_of_each() {
    // 60 and 75 MHz reach 2.5 and 2.0 m each, 10 m together.
    let far: fn(usize, usize) -> f64 = |_, column| 1.0 + 0.08 * column as f64;
    let of = |frequency_hz| Take { frequency_hz, distance_m: far, gain: 9000.0, mean: 9500.0, ..TAKE }.bins();
    let (first, second) = (of(60e6), of(75e6));
    let set = 4 * ROWS * COLUMNS;
    let sets = first.values.chunks(set).zip(second.values.chunks(set));
    let values = sets.flat_map(|(first, second)| [first, second].concat()).collect();
    let bins = Array::new("<u2", &[FRAMES, 8, ROWS, COLUMNS], values);
    let sandbox = Sandbox::new();
    let json = r#"{"modulation_frequency_hz": [60e6, 75e6], "integration_time_us": 8200}"#;
    sandbox.described("rec", &[("phase_samples", bins)], json);
    let said = remarks(&sandbox);
    assert!(!said.contains("phase_convention"), "{said}");
    let values = sandbox.f32s("out/standardized_amplitude.npy");
    // One material has one value, 9000 DN at 1 m: 16000 or 0.44 of it at 0.75 m. Noise and rounding of 2 DN of 180.
    for (at, value) in values.into_iter().enumerate() {
        let (row, column) = (at / COLUMNS % ROWS, at % COLUMNS);
        let share = if (row / 8 + column / 8) % 2 == 0 { 0.9 } else { 0.4 };
        let expected = 9000.0 / 0.75f64.powi(2) * share;
        assert!((f64::from(value) / expected - 1.0).abs() < 0.1, "{row} {column}: {value} {expected}");
    }
}

#[test]
fn i_and_q_are_standardized_and_their_sign_is_told() {
    for (reversed, told) in [(false, false), (true, true)] {
        let take = Take { reversed, ..TAKE };
        let mut bytes = header("<c8", false, &[1, ROWS, COLUMNS]);
        for at in 0..ROWS * COLUMNS {
            let (row, column) = (at / COLUMNS, at % COLUMNS);
            let phase = if reversed { -take.phase(row, column) } else { take.phase(row, column) };
            let amplitude = take.amplitude(row, column);
            for part in [amplitude * phase.cos(), amplitude * phase.sin()] {
                bytes.extend((part as f32).to_le_bytes());
            }
        }
        let sandbox = Sandbox::new();
        sandbox.write("rec/phase_samples.npy", bytes);
        let json = r#"{"modulation_frequency_hz": 15e6, "integration_time_us": 500}"#;
        sandbox.write("rec/recording.json", json);
        let said = remarks(&sandbox);
        assert_eq!(said.contains(r#""reversed": true}"#), told, "{said}");
        if !reversed {
            let values = sandbox.f32s("out/standardized_amplitude.npy");
            let expected = 600.0 / 0.75f64.powi(2) * 8200.0 / 500.0 * 0.9;
            assert!((f64::from(values[0]) / expected - 1.0).abs() < 1e-4, "{} {expected}", values[0]);
        }
    }
}
