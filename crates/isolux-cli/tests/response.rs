//! The response on cameras that nobody has fitted it to: simulate a sweep, fit, compare with the truth.

use isolux::calibrate::{self, CalibrateSettings, ExposureCurve, ExposureSweep};
use isolux::terms::Response;
use isolux_camera::{CameraModel, Scene, SimulatedFrame, Simulation};

/// Integration times of the sweeps, evenly spread in ln t up to where the brightest pixels clip.
fn times_us(longest_us: f64) -> Vec<f64> {
    (0..24).map(|i| longest_us * 0.01f64.powf(1.0 - f64::from(i) / 23.0)).collect()
}

/// A built-in scene in this light over these times, by a camera.
fn simulation(scene: &str, model: &CameraModel, ambient: f64, times_us: Vec<f64>, seed: u64) -> Simulation {
    let mut scene = Scene::builtin(scene).unwrap();
    scene.ambient = ambient;
    scene.runs.truncate(1);
    scene.runs[0].registers = None;
    scene.runs[0].integration_times_us = times_us;
    scene.runs[0].frames_per_time = 2;
    scene.runs[0].skip_frames = 400;
    Simulation::new(model.clone(), scene, seed).unwrap()
}

fn curve(simulation: &Simulation) -> ExposureCurve {
    let mut sweep = ExposureSweep::new("sweep", &CalibrateSettings::default());
    let mut out = SimulatedFrame::new(simulation.shape());
    for index in 0..simulation.len() {
        simulation.render_frame(index, &mut out).unwrap();
        sweep.push(&out.frame).unwrap();
    }
    sweep.finish()
}

fn response(curve: ExposureCurve, model: &CameraModel) -> Response {
    let settings = CalibrateSettings {
        modulation_frequency_hz: Some(model.modulation_frequency_hz),
        ..CalibrateSettings::default()
    };
    let (calibration, report) = calibrate::fit(&settings, None, vec![curve], Vec::new()).unwrap();
    println!("{:?}", report.warnings);
    calibration.terms.response.unwrap()
}

#[test]
fn sweeps_of_unseen_cameras_give_their_well() {
    for seed in [101, 102, 103, 104] {
        let model = CameraModel::random(seed);
        for ambient in [0.0, 4.0] {
            let longest_us = 50_000.0;
            let simulation = simulation("wall-sweep", &model, ambient, times_us(longest_us), seed);
            let response = response(curve(&simulation), &model);
            let gain = model.gain_dn_per_electron;
            let truth = (gain * model.full_well_electrons, model.softness, model.black_level_dn);
            println!("{seed} {ambient} truth {truth:?} clip {}", model.clip_dn());
            println!("  T3 {:?}", response.phase_samples);
            println!("  T2 {:?}", response.intensity);
            println!("  T0 {:?}", response.scalar);
        }
    }
}
