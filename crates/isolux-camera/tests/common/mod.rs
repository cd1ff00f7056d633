//! What the tests share.
#![allow(dead_code, reason = "each test file uses its own part")]
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use isolux::{Plane, Shape, Window};
use isolux_camera::scene::object::{Form, Object};
use isolux_camera::scene::run::Run;
use isolux_camera::scene::texture::Texture;
use isolux_camera::{CameraModel, Scene, SimulatedFrame, Simulation};

/// The SR-3100 without drift and dead pixels: what a law without them is compared with.
pub(crate) fn settled_sr3100() -> CameraModel {
    let model = CameraModel::preset("sr3100").unwrap();
    CameraModel { warm_up_amplitude: 0.0, dead_pixel_fraction: 0.0, ..model }
}

/// The same without profile: every pixel is lit alike.
pub(crate) fn flat_sr3100() -> CameraModel {
    CameraModel { lobe_exponent: 0.0, lens_exponent: 0.0, ..settled_sr3100() }
}

/// A scene of these objects at these integration times, one frame each.
pub(crate) fn scene(objects: Vec<Object>, ambient: f64, integration_times_us: &[f64]) -> Scene {
    let run = Run { integration_times_us: integration_times_us.to_vec(), ..Run::default() };
    Scene {
        version: 1,
        name: "test".to_owned(),
        description: String::new(),
        camera: "sr3100".to_owned(),
        ambient,
        objects,
        runs: vec![run],
    }
}

/// A wall across the optical axis.
pub(crate) fn wall(depth_m: f64, reflectivity: f64) -> Object {
    let form = Form::Rectangle { size_m: [100.0, 100.0] };
    Object::new("wall", form, [0.0, 0.0, depth_m], Texture::Uniform(reflectivity))
}

/// A ball around the camera: every pixel sees the same distance at normal incidence.
pub(crate) fn surrounding(radius_m: f64, reflectivity: f64) -> Object {
    Object::new("ball", Form::Sphere { radius_m }, [0.0; 3], Texture::Uniform(reflectivity))
}

pub(crate) fn render(model: CameraModel, scene: Scene, index: usize) -> SimulatedFrame {
    let simulation = Simulation::new(model, scene, 11).unwrap();
    let mut out = SimulatedFrame::new(Shape::new(1, 1));
    simulation.render_frame(index, &mut out).unwrap();
    out
}

pub(crate) fn mean(values: impl IntoIterator<Item = f32>) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for value in values {
        sum += f64::from(value);
        count += 1.0;
    }
    sum / count
}

/// Sample standard deviation.
pub(crate) fn deviation(values: &[f32]) -> f64 {
    let mean = mean(values.iter().copied());
    let squares: f64 = values.iter().map(|&value| (f64::from(value) - mean).powi(2)).sum();
    (squares / (values.len() as f64 - 1.0)).sqrt()
}

pub(crate) fn window(plane: &Plane<f32>, window: Window) -> Vec<f32> {
    window.indices(plane.shape()).map(|index| plane.values()[index]).collect()
}

pub(crate) fn centre(plane: &Plane<f32>) -> Vec<f32> {
    window(plane, Window::centred(plane.shape(), 20))
}

/// FNV-1a of the four bins.
pub(crate) fn hash(frame: &SimulatedFrame) -> u64 {
    let bytes = frame.phase_samples.iter().flat_map(|plane| plane.values()).flat_map(|bin| bin.to_le_bytes());
    bytes.fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
}
