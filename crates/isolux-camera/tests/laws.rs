//! Laws that hold for every camera.

use isolux_camera::{CameraModel, FullWell};
use proptest::prelude::*;

proptest! {
    #[test]
    fn the_linear_amplitude_is_proportional_to_time_and_reflectivity(
        seed in 0u64..1000, distance_m in 0.2f64..6.0, time_us in 10.0f64..50_000.0, factor in 0.01f64..100.0,
    ) {
        let model = CameraModel::random(seed);
        let amplitude = |reflectivity, time| {
            model.linear_amplitude_dn(model.light(reflectivity, 0.3, distance_m), time)
        };
        let expected = factor * amplitude(0.5, time_us);
        // A handful of f64 roundings.
        prop_assert!((amplitude(0.5, factor * time_us) / expected - 1.0).abs() < 1e-14);
        prop_assert!((amplitude(0.5 * factor, time_us) / expected - 1.0).abs() < 1e-14);
    }

    #[test]
    fn saturation_only_takes_away_and_nothing_is_left_in_the_end(
        seed in 0u64..1000, distance_m in 0.2f64..6.0, ambient in 0.0f64..2.0, time_us in 10.0f64..50_000.0,
    ) {
        let model = CameraModel::random(seed);
        let light = model.light(0.6, ambient, distance_m);
        let linear = model.linear_amplitude_dn(light, time_us);
        prop_assert!(model.noise_free_amplitude_dn(light, time_us) <= linear * (1.0 + 1e-9));
        let darkest = model.bin_rates_electrons_per_us(light).into_iter().fold(f64::INFINITY, f64::min);
        let over_us = 1.001 * FullWell::of(&model).received_at_clip_electrons() / darkest;
        prop_assert_eq!(model.noise_free_amplitude_dn(light, over_us), 0.0);
    }

    #[test]
    fn the_well_is_monotone_and_never_keeps_more_than_it_gets(
        seed in 0u64..1000, fill in 0.0f64..5.0, more in 0.0f64..1.0,
    ) {
        let model = CameraModel::random(seed);
        let well = FullWell::of(&model);
        let received = fill * model.full_well_electrons;
        prop_assert!(well.kept_electrons(received) <= received * (1.0 + 1e-15));
        prop_assert!(well.kept_electrons(received) <= well.kept_electrons(received * (1.0 + more)));
        prop_assert!((0.0..=1.0).contains(&well.slope(received)));
    }

    #[test]
    fn distance_responses_chain(
        seed in 0u64..1000, near in 0.2f64..6.0, middle in 0.2f64..6.0, far in 0.2f64..6.0,
    ) {
        let model = CameraModel::random(seed);
        let chained = model.distance_response(far, middle) * model.distance_response(middle, near);
        prop_assert!((model.distance_response(far, near) / chained - 1.0).abs() < 1e-13);
    }
}
