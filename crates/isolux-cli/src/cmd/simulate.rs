//! `isolux simulate`: a scene in, a recording of the simulated camera out.

use isolux_camera::{CameraModel, Scene, Simulation};
use isolux_pipeline::simulate::{Extras, record};

use crate::failure::{Failure, Outcome};
use crate::options::SimulateArgs;
use crate::terminal::{self, Terminal, interrupt};

pub(crate) fn run(args: &SimulateArgs) -> Outcome {
    if args.list {
        return list();
    }
    if let Some(name) = &args.print {
        let text = Scene::builtin_toml(name).or_else(|_| CameraModel::preset_toml(name));
        let known = Scene::builtin_names().chain(CameraModel::preset_names()).collect::<Vec<_>>().join(", ");
        let text = text
            .map_err(|_| Failure::usage(format!("no built-in scene or camera is named `{name}`: {known}")))?;
        return terminal::print(text.trim_end());
    }
    let (Some(scene), Some(output)) = (&args.scene, &args.output) else {
        return Err(Failure::usage("SCENE and -o REC expected"));
    };
    let simulation = simulation(scene, args.camera.as_deref(), args.ambient, args.seed)?;
    let extras = Extras { phase_samples: args.phase_samples, truth: args.truth };
    interrupt::watch();
    record(&simulation, extras, output, args.force, &Terminal::default())?;
    terminal::print(format!(
        "{} frames of {} by `{}`\nwritten: {}",
        simulation.len(),
        simulation.shape(),
        simulation.model().name,
        output.display()
    ))
}

/// The simulation of a scene, built in or from a file, with its own camera or another, its own ambient light or another.
pub(crate) fn simulation(
    scene: &str,
    camera: Option<&str>,
    ambient: Option<f64>,
    seed: u64,
) -> Outcome<Simulation> {
    let mut scene = match scene.ends_with(".toml") {
        true => Scene::from_toml(scene, &read(scene)?)?,
        false => Scene::builtin(scene).map_err(Failure::usage)?,
    };
    scene.ambient = ambient.unwrap_or(scene.ambient);
    let camera = camera.unwrap_or(&scene.camera);
    let model = match camera.ends_with(".toml") {
        true => CameraModel::from_toml(camera, &read(camera)?)?,
        false => CameraModel::preset(camera).map_err(Failure::usage)?,
    };
    Ok(Simulation::new(model, scene, seed)?)
}

fn read(path: &str) -> Outcome<String> {
    std::fs::read_to_string(path).map_err(|error| Failure::data(format!("cannot read `{path}`: {error}")))
}

fn list() -> Outcome {
    let names = |names: Vec<&str>| names.join("\n  ");
    terminal::print(format!(
        "scenes:\n  {}\ncameras:\n  {}",
        names(Scene::builtin_names().collect()),
        names(CameraModel::preset_names().collect())
    ))
}
