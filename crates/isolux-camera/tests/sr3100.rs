//! The SR-3100 preset and the paper's scenes: what the paper reports must be seen.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

mod common;

use common::{centre, deviation, mean, window};
use isolux::Window;
use isolux_camera::{CameraModel, Scene, SimulatedFrame, Simulation};

fn simulation(scene: &str) -> Simulation {
    let scene = Scene::builtin(scene).unwrap();
    Simulation::new(CameraModel::preset(&scene.camera).unwrap(), scene, 3).unwrap()
}

/// Integration time, mean amplitude of image, centre and corner of the wall, for the first frame of each time.
fn wall_curve() -> Vec<[f64; 4]> {
    let simulation = simulation("wall-sweep");
    let corner = Window { top: 0, left: 0, height: 20, width: 20 };
    let indices: Vec<usize> = (0..simulation.len()).step_by(3).collect();
    let mut out = SimulatedFrame::new(simulation.shape());
    let curve = indices.into_iter().map(|index| {
        simulation.render_frame(index, &mut out).unwrap();
        let amplitude = &out.frame.amplitude;
        [
            simulation.frames()[index].integration_time_us,
            mean(amplitude.values().iter().copied()),
            mean(centre(amplitude)),
            mean(window(amplitude, corner)),
        ]
    });
    curve.collect()
}

#[test]
fn the_wall_rises_compresses_peaks_at_27_ms_and_collapses() {
    let curve = wall_curve();
    assert_eq!((curve.len(), curve[0][0], curve[40][0], curve[135][0]), (256, 200.0, 8200.0, 27_200.0));
    let peak = |column: usize| curve.iter().max_by(|a, b| a[column].total_cmp(&b[column])).unwrap();
    let [peak_us, peak_dn, ..] = *peak(1);
    assert!((peak_us - 27_200.0).abs() < 1500.0, "{peak_us}");
    // Linear from 2 to 8 ms to 1 %, visibly compressed at the peak, nearly gone at the end.
    let slope = |register: usize| curve[register][1] / curve[register][0];
    assert!((slope(9) / slope(40) - 1.0).abs() < 0.01);
    assert!(peak_dn / peak_us < 0.9 * slope(40));
    assert!(curve[255][1] < 0.25 * peak_dn, "{}", curve[255][1] / peak_dn);
    // The bright centre saturates before the image, the corner after it; the centre ends at the noise floor.
    assert!(peak(2)[0] < peak_us && peak_us < peak(3)[0]);
    assert!(curve[255][2] < 0.01 * peak(2)[2]);
}

/// Integration time, depth, SNR and mean amplitude over truth in the window, for each step of the board.
fn board_curve() -> Vec<[f64; 4]> {
    let simulation = simulation("board-distances");
    let mut out = SimulatedFrame::new(simulation.shape());
    let curve = (0..simulation.len()).step_by(3).map(|index| {
        simulation.render_frame(index, &mut out).unwrap();
        let amplitude = centre(&out.frame.amplitude);
        let found = mean(amplitude.iter().copied());
        let truth = mean(centre(&out.truth.linear_amplitude));
        let distance = mean(centre(&out.truth.true_distance_m));
        [
            simulation.frames()[index].integration_time_us,
            distance,
            truth / deviation(&amplitude),
            found / truth,
        ]
    });
    curve.collect()
}

#[test]
fn the_shortest_time_strays_and_the_others_are_usable() {
    let curve = board_curve();
    let at = |time_us: f64| curve.iter().filter(move |point| point[0] == time_us && point[1] > 0.49);
    // 0.2 ms: mostly below SNR 10 from 0.5 to 3 m; far away its mean is lifted by the Rician floor.
    let weak = at(200.0).filter(|point| point[2] < 10.0).count();
    assert!(2 * weak > at(200.0).count(), "{weak} of {}", at(200.0).count());
    assert!(at(200.0).next_back().unwrap()[3] > 1.3);
    // From 1 ms on: mostly above SNR 10, and nowhere lifted by more than 10 %.
    for time_us in [1000.0, 2000.0, 4200.0, 8200.0] {
        let good = at(time_us).filter(|point| point[2] >= 10.0).count();
        assert!(2 * good > at(time_us).count(), "{time_us}: {good}");
        assert!(at(time_us).all(|point| point[3] < 1.1), "{time_us}");
    }
}

#[test]
fn each_time_starts_where_over_saturation_ends_unless_told_otherwise() {
    let curve = board_curve();
    let start = |time_us: f64| curve.iter().find(|point| point[0] == time_us).unwrap()[1];
    let starts = [200.0, 2000.0, 4200.0, 8200.0, 16_400.0].map(start);
    assert!(starts.windows(2).all(|pair| pair[0] <= pair[1]) && starts[0] < 0.31 && starts[4] > 0.6);
    // The reference distance of 0.75 m is measured at the reference time, but not at twice that time.
    assert!(starts[3] < 0.75 && starts[4] > 0.75, "{starts:?}");
    let unguarded = simulation("board-distances-unguarded");
    assert_eq!(unguarded.len(), 26 * 6 * 3);
    let mut out = SimulatedFrame::new(unguarded.shape());
    unguarded.render_frame(17, &mut out).unwrap();
    assert!(mean(centre(&out.frame.amplitude)) < 0.01 * mean(centre(&out.truth.linear_amplitude)));
}

#[test]
fn the_camera_settles_after_every_change_of_the_integration_time() {
    let mut scene = Scene::builtin("wall-sweep-smoke").unwrap();
    scene.runs[0].skip_frames = 0;
    scene.runs[0].frames_per_time = 60;
    scene.runs[0].integration_times_us = vec![2000.0, 4000.0];
    let model = CameraModel::preset("sr3100").unwrap();
    let simulation = Simulation::new(model.clone(), scene, 5).unwrap();
    let mut out = SimulatedFrame::new(simulation.shape());
    let mut level = |index: usize| {
        simulation.render_frame(index, &mut out).unwrap();
        mean(out.frame.amplitude.values().iter().copied())
    };
    let settled = level(59);
    // Mean of 25344 pixels of SNR > 10: 1e-3; the drift is 2 %.
    assert!((level(0) / settled - 1.0 - model.warm_up_amplitude).abs() < 3e-3);
    assert!((level(60) / (2.0 * settled) - 1.0 - model.warm_up_amplitude).abs() < 3e-3);
    assert!((level(119) / (2.0 * settled) - 1.0).abs() < 3e-3);
}
