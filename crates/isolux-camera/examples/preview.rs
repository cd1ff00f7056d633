//! Writes frames of a scene as PNG images: `preview SCENE DIR [FRAME]...`
//!
//! SCENE is the name of a built-in scene or the path of a scene file. Each frame gives `SCENE-FRAME.png`: on the
//! left the amplitude, in the middle what it is without the influence of integration time and distance, on the
//! right the measured distance. White is the 99.5th percentile of each.
use std::error::Error;
use std::fs::{self, File};
use std::path::Path;

use isolux::Plane;
use isolux_camera::{CameraModel, Scene, SimulatedFrame, Simulation};

/// Every pixel of the camera is shown as a square of this side.
const ZOOM: usize = 3;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let usage = "usage: preview SCENE DIR [FRAME]...";
    let (name, folder) = (arguments.next().ok_or(usage)?, arguments.next().ok_or(usage)?);
    let frames = arguments.map(|text| text.parse()).collect::<Result<Vec<usize>, _>>()?;
    let scene = match fs::read_to_string(&name) {
        Ok(text) => Scene::from_toml(&name, &text)?,
        Err(_) => Scene::builtin(&name)?,
    };
    let simulation = Simulation::new(CameraModel::preset(&scene.camera)?, scene, 1)?;
    fs::create_dir_all(&folder)?;
    let mut out = SimulatedFrame::new(simulation.shape());
    for index in if frames.is_empty() { vec![simulation.len() / 2] } else { frames } {
        simulation.render_frame(index, &mut out)?;
        let path = Path::new(&folder).join(format!("{}-{index}.png", simulation.scene().name));
        write(&path, &simulation, &out)?;
    }
    Ok(())
}

fn write(path: &Path, simulation: &Simulation, out: &SimulatedFrame) -> Result<(), Box<dyn Error>> {
    let standardized = out.truth.true_standardized(simulation.model(), 8200.0, 0.75);
    let distance = out.frame.distance_m.as_ref().ok_or("the frame has no distance")?;
    let shape = simulation.shape();
    let panels = [&out.frame.amplitude, &standardized, distance].map(|plane| (plane, white(plane)));
    let (height, width) = (ZOOM * shape.height, ZOOM * shape.width * panels.len());
    let mut pixels = Vec::with_capacity(height * width);
    for row in 0..height {
        for (plane, white) in panels {
            pixels.extend((0..ZOOM * shape.width).map(|column| {
                let value = plane.get(row / ZOOM, column / ZOOM).unwrap_or(0.0) / white;
                (255.0 * value.clamp(0.0, 1.0).powf(1.0 / 2.2)) as u8
            }));
        }
    }
    let mut encoder = png::Encoder::new(File::create(path)?, width as u32, height as u32);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.write_header()?.write_image_data(&pixels)?;
    Ok(())
}

fn white(plane: &Plane<f32>) -> f32 {
    let mut values: Vec<f32> = plane.values().iter().copied().filter(|value| value.is_finite()).collect();
    values.sort_by(f32::total_cmp);
    values.get(values.len() * 995 / 1000).copied().unwrap_or(1.0).max(f32::MIN_POSITIVE)
}
