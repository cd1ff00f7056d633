//! Bins of scenes with a known convention, read by another one.

use std::f64::consts::FRAC_PI_2;

use super::*;
use crate::frame::{Frame, IntegrationTime, PhaseConvention, Plane, Shape, phase};
use crate::numerics::hash::splitmix64;

const SHAPE: Shape = Shape::new(32, 48);
const FREQUENCY_HZ: f64 = 15e6;
/// Of one bin, DN.
const NOISE_DN: f64 = 3.0;

/// A scene: distance (m) and reflectivity of each pixel.
type Scene = fn(usize, usize) -> (f64, f64);

/// A checkered wall that goes away to the right.
fn wall(row: usize, column: usize) -> (f64, f64) {
    let bright = (row / 8 + column / 8).is_multiple_of(2);
    (0.6 + 0.07 * column as f64, if bright { 0.8 } else { 0.3 })
}

/// A floor that rises to a wall at 3.5 m, with boxes of all kinds before them.
fn room(row: usize, column: usize) -> (f64, f64) {
    let floor_m = 24.0 / (row as f64 + 1.0);
    let (block_row, block_column) = (row / 5, column / 6);
    let random = splitmix64((block_row * 100 + block_column) as u64);
    if random.is_multiple_of(3) {
        let share = |shift: u32| ((random >> shift) & 0xff) as f64 / 255.0;
        return (floor_m.min(3.5) * (0.5 + 0.5 * share(8)), 0.1 + 0.8 * share(16));
    }
    (floor_m.min(3.5), if floor_m < 3.5 { 0.3 } else { 0.6 })
}

/// A wall at one distance.
fn flat(row: usize, column: usize) -> (f64, f64) {
    (2.0, if (row + column) % 16 < 8 { 0.7 } else { 0.4 })
}

/// A Gaussian number, about: the sum of four even ones.
fn noise(counter: u64) -> f64 {
    let even = |part: u64| (splitmix64(4 * counter + part) >> 11) as f64 / (1u64 << 53) as f64 - 0.5;
    NOISE_DN * 3f64.sqrt() * (0..4).map(even).sum::<f64>()
}

/// A frame of a camera of the convention `truth` that has been read by the paper's.
fn frame(scene: Scene, truth: PhaseConvention, recorded: bool) -> Frame {
    let mut frame = Frame::new(SHAPE);
    frame.flags = Plane::filled(SHAPE, crate::frame::PixelFlags::empty());
    frame.integration_time_us = IntegrationTime::PerFrame(500.0);
    let positions = truth.positions();
    let bin = |position: usize| {
        let Some(bin) = positions.iter().position(|&place| place == position) else { unreachable!() };
        Plane::from_fn(SHAPE, |row, column| {
            let (distance_m, reflectivity) = scene(row, column);
            let phase = phase::of_distance(FREQUENCY_HZ, distance_m);
            let amplitude = 900.0 * reflectivity / distance_m.powi(2);
            let noise = noise((position * 10_000 + row * 100 + column) as u64);
            let value = 2000.0 + amplitude * (phase - bin as f64 * FRAC_PI_2).cos() + noise;
            value.round() as f32
        })
    };
    let bins = [0, 1, 2, 3].map(bin);
    phase::amplitude_into(&bins, &mut frame.amplitude).unwrap();
    frame.distance_m =
        recorded.then(|| Plane::from_fn(SHAPE, |row, column| scene(row, column).0 as f32 + 0.05));
    frame.phase_samples = Some(bins);
    frame
}

fn fault(scene: Scene, truth: PhaseConvention, recorded: bool) -> Option<PhaseFault> {
    let claims = Claims {
        modulation_frequency_hz: Some(FREQUENCY_HZ),
        distance_from_phases: !recorded,
        ..Claims::default()
    };
    let mut sample = Sample::default();
    sample.push(&frame(scene, truth, recorded), &claims);
    sample.fault(&claims)
}

/// All conventions that differ, that of the paper first.
fn conventions() -> Vec<PhaseConvention> {
    Pairs::ALL
        .into_iter()
        .flat_map(Turn::all)
        .map(|turn| turn.convention(PhaseConvention::default()))
        .collect()
}

#[test]
fn bins_that_are_read_as_they_are_raise_no_suspicion() {
    for scene in [wall, room, flat] {
        for recorded in [false, true] {
            assert_eq!(fault(scene, PhaseConvention::default(), recorded), None);
        }
    }
}

#[test]
fn every_convention_is_found_where_distances_are_recorded() {
    for scene in [wall as Scene, room] {
        for truth in &conventions()[1..] {
            let found = fault(scene, *truth, true).unwrap();
            assert_eq!(found.fitting.positions(), truth.positions(), "{found}");
        }
    }
}

#[test]
fn without_recorded_distances_sums_and_the_law_tell() {
    for scene in [wall as Scene, room] {
        for truth in &conventions()[1..] {
            let found = fault(scene, *truth, false).unwrap();
            assert_eq!(found.fitting.positions(), truth.positions(), "{found}");
            let by_sums = matches!(found.evidence, PhaseEvidence::Sums { sign_known: true, .. });
            let by_law = matches!(found.evidence, PhaseEvidence::Law { .. });
            let opposite_kept = truth.order[0] % 2 == truth.order[2] % 2;
            assert!(if opposite_kept { by_law } else { by_sums }, "{found}");
        }
    }
}

#[test]
fn a_sign_is_told_with_both_exponents() {
    let truth = PhaseConvention { reversed: true, ..PhaseConvention::default() };
    let found = fault(wall, truth, false).unwrap();
    assert_eq!(found.fitting, truth);
    let PhaseEvidence::Law { stated, found: fitting } = found.evidence else { panic!("{found}") };
    // By hand: with φ from 0.38 to 2.4 rad, 2 ln(d/d') spreads over 4.2 to 31 of them; the wall falls with d⁻².
    assert!((4.2..31.0).contains(&stated) && (fitting + 2.0).abs() < 0.2, "{stated} {fitting}");
    let text = found.to_string();
    assert!(
        text.contains("the amplitude grows with d^7.") && text.contains("with the sign reversed, it falls")
    );
}

#[test]
fn a_wall_at_one_distance_tells_which_bins_are_opposite_and_no_more() {
    for truth in &conventions()[1..] {
        match fault(flat, *truth, false) {
            None => assert_eq!(truth.order[0] % 2, truth.order[2] % 2),
            Some(found) => {
                assert!(matches!(found.evidence, PhaseEvidence::Sums { sign_known: false, .. }), "{found}");
                let opposite = |a: usize, b: usize, of: [usize; 4]| {
                    let place = |bin| of.iter().position(|&found| found == bin).unwrap();
                    place(a).abs_diff(place(b)) == 2
                };
                for [a, b] in [[0, 1], [0, 2], [0, 3]] {
                    assert_eq!(opposite(a, b, found.fitting.order), opposite(a, b, truth.order));
                }
                assert!(found.to_string().contains("cannot be told"));
            }
        }
    }
}

#[test]
fn scenes_that_are_dark_in_front_or_behind_are_no_fault() {
    // The nearer, the darker: the amplitude grows with the distance.
    let dark_front = |row: usize, column: usize| {
        let (distance_m, reflectivity) = room(row, column);
        (distance_m, reflectivity * (distance_m / 3.5).powi(3))
    };
    let dark_back = |row: usize, column: usize| {
        let (distance_m, reflectivity) = wall(row, column);
        (distance_m, reflectivity / distance_m.powi(2))
    };
    for scene in [dark_front as Scene, dark_back] {
        assert_eq!(fault(scene, PhaseConvention::default(), false), None);
    }
}
