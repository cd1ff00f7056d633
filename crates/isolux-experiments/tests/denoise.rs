//! What denoising the distance is worth, and what it may not do. `cargo test -p isolux-experiments --test denoise --
//! --nocapture` prints the figures.
#![allow(clippy::unwrap_used, reason = "tests fail by panicking")]

use isolux::DenoiseRule::{self, Median, Plane, Temporal, Wiener};
use isolux_camera::scene::object::{Form, Object};
use isolux_camera::scene::texture::Texture;
use isolux_experiments::unseen::denoise::{
    Bars, RULES, at_snr, distance_bias_m, flat_noise, texture_leak_m, wall,
};

/// No denoising, then every rule.
fn all() -> Vec<Option<DenoiseRule>> {
    std::iter::once(None).chain(RULES.map(Some)).collect()
}

/// The methods' prototypes: median 1.08, wiener 1.036, plane 1.014, temporal 1.07. The mean of 8 leaves (2/φ)²/8 of the
/// square.
#[test]
fn noise_on_flat_areas_is_near_that_of_a_perfect_distance() {
    let ratios = flat_noise(&all()).unwrap();
    println!("noise of A' on flat areas beside that with the true distance: {ratios:.3?}");
    let bound = |rule| match rule {
        Wiener | Plane => 1.05,
        Median | Temporal => 1.12,
        other => unreachable!("{other:?}"),
    };
    assert!(ratios[0] > 1.3);
    assert!(RULES.iter().zip(&ratios[1..]).all(|(rule, ratio)| *ratio <= bound(*rule)), "{ratios:?}");
}

/// At most 5 % from steps on that stand out of the noise of one pixel (σ_d = 0.27 m) in one way or the other.
#[test]
fn three_pixel_bars_keep_their_distance() {
    for (wall_m, equal_amplitude) in
        [(2.75, true), (3.25, true), (3.75, true), (4.45, true), (5.45, true), (3.25, false), (4.45, false)]
    {
        let bars = Bars { wall_m, equal_amplitude };
        let rules = [None, Some(Wiener), Some(Plane), Some(Median), Some(Temporal)];
        let bias = bars.bias(&rules).unwrap();
        println!(
            "{:.1} m before a wall, {bars:?}: none, wiener, plane, median, temporal {bias:+.4?}",
            bars.step_m()
        );
        if wall_m >= 3.75 {
            assert!(bias[1].abs() <= 0.05 && bias[2].abs() <= 0.05, "{bias:?}");
        }
        assert!(bias[4].abs() <= 0.01, "{bias:?}");
    }
}

/// The two means of 8000 pixels and 17 frames or more at σ_d = 0.3 m differ by 0.3 √(2/136 000) = 1.2 mm; smoothing may
/// pass what one square has to the other, never add to it. Four of these.
#[test]
fn the_amplitudes_texture_does_not_leak_into_the_distance() {
    let leaks = texture_leak_m(&RULES).unwrap();
    println!("checkerboard, bright less dark squares, m: {leaks:+.5?}");
    assert!(leaks.iter().all(|leak| leak.abs() <= 0.005), "{leaks:?}");
}

/// A wall turned by 50° with a checkerboard on it, and a ball: no systematic departure beyond 0.5 % of the distance.
#[test]
fn slanted_and_round_surfaces_keep_their_distance() {
    let texture = Texture::Checkerboard { cell_m: 0.1, reflectivities: [0.5, 0.9] };
    let mut slant = wall(2.45, texture);
    slant.yaw_deg = 50.0;
    let ball = Object::new("ball", Form::Sphere { radius_m: 0.8 }, [0.0, 0.0, 3.0], Texture::Uniform(0.9));
    let middle = |row: usize, column: usize| (42..102).contains(&row) && (58..118).contains(&column);
    for (name, object) in [("slant", slant), ("ball", ball)] {
        let frames = at_snr(&[object], middle).unwrap();
        for rule in RULES {
            let bias = distance_bias_m(&frames, rule, middle).unwrap();
            println!("{name}, {}: {:+.2} mm", rule.name(), 1000.0 * bias);
            assert!(bias.abs() <= 0.005 * 2.2, "{name} {rule:?} {bias}");
        }
    }
}
