//! The frames that a section's numbers should come from, and comparing with them.
#![allow(dead_code, reason = "each test uses its part")]

use isolux::Plane;
use isolux_camera::{CameraModel, Scene, SimulatedFrame, Simulation};
use isolux_report::page::{Block, Picture, Section, Verdict};

use crate::sections::{claim, lab};

/// The scene before its own camera, with the laboratory's seed.
pub(crate) fn simulation(scene: Scene) -> Simulation {
    Simulation::new(CameraModel::preset(&scene.camera).unwrap(), scene, lab().seed).unwrap()
}

/// The first frame at this integration time.
pub(crate) fn frame(scene: Scene, time_us: f64) -> SimulatedFrame {
    let simulation = simulation(scene);
    let index = simulation.frames().iter().position(|frame| frame.integration_time_us == time_us).unwrap();
    let mut out = SimulatedFrame::new(simulation.shape());
    simulation.render_frame(index, &mut out).unwrap();
    out
}

pub(crate) fn f64s(plane: &Plane<f32>) -> Vec<f64> {
    plane.values().iter().copied().map(f64::from).collect()
}

pub(crate) fn picture<'a>(section: &'a Section, id: &str) -> &'a Picture {
    let pictures = section.blocks.iter().filter_map(|block| match block {
        Block::Pictures(pictures) => Some(pictures),
        _ => None,
    });
    pictures.flatten().find(|picture| picture.id == id).unwrap()
}

pub(crate) fn assert_holds(section: &Section, ids: &[&str]) {
    for id in ids {
        let claim = claim(section, id);
        assert_eq!(claim.verdict, Verdict::Holds, "{id}: {}", claim.measured);
    }
}

/// Equal up to `relative`, or both NaN.
pub(crate) fn assert_close(found: &[f64], expected: &[f64], relative: f64, what: &str) {
    assert_eq!(found.len(), expected.len(), "{what}");
    for (found, expected) in found.iter().zip(expected) {
        let close = (found - expected).abs() <= relative * expected.abs().max(1e-3);
        assert!(close || (found.is_nan() && expected.is_nan()), "{what}: {found} found, {expected} expected");
    }
}

pub(crate) fn median(mut values: Vec<f64>) -> f64 {
    isolux::statistics::median(&mut values).unwrap()
}
