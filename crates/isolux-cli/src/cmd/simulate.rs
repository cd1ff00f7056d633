//! `isolux simulate`: a scene in, a recording of the simulated camera out.

use std::path::Path;

use isolux::IntegrationTime;
use isolux_camera::{CameraModel, Scene, SimulatedFrame, Simulation};
use isolux_io::{ChannelSpec, ElementType, RecordingInfo, RecordingWriter};
use serde_json::json;

use crate::args::SimulateArgs;
use crate::failure::{Failure, Outcome};
use crate::{console, interrupt};

/// Channels beyond those that every recording has.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Extras {
    pub(crate) phase_samples: bool,
    pub(crate) truth: bool,
}

pub(crate) fn run(args: &SimulateArgs) -> Outcome {
    if args.list {
        return list();
    }
    if let Some(name) = &args.print {
        let text = Scene::builtin_toml(name).or_else(|_| CameraModel::preset_toml(name));
        let known = Scene::builtin_names().chain(CameraModel::preset_names()).collect::<Vec<_>>().join(", ");
        let text = text
            .map_err(|_| Failure::usage(format!("no built-in scene or camera is named `{name}`: {known}")))?;
        return console::print(text.trim_end());
    }
    let (Some(scene), Some(output)) = (&args.scene, &args.output) else {
        return Err(Failure::usage("SCENE and -o REC expected"));
    };
    let simulation = simulation(scene, args.camera.as_deref(), args.ambient, args.seed)?;
    let extras = Extras { phase_samples: args.phase_samples, truth: args.truth };
    record(&simulation, extras, output, args.force)?;
    console::print(format!(
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
    console::print(format!(
        "scenes:\n  {}\ncameras:\n  {}",
        names(Scene::builtin_names().collect()),
        names(CameraModel::preset_names().collect())
    ))
}

/// Renders every frame into a recording at `output`.
pub(crate) fn record(simulation: &Simulation, extras: Extras, output: &Path, overwrite: bool) -> Outcome {
    let shape = simulation.shape();
    let mut channels = vec![
        ChannelSpec::image("amplitude", ElementType::F32, shape),
        ChannelSpec::image("distance", ElementType::F32, shape),
        ChannelSpec::image("intensity", ElementType::F32, shape),
        ChannelSpec::number("integration_time_us", ElementType::F64),
        ChannelSpec::image("target", ElementType::U8, shape),
        ChannelSpec {
            name: "world_from_camera".to_owned(),
            element: ElementType::F64,
            frame_dims: vec![4, 4],
        },
    ];
    if extras.phase_samples {
        let frame_dims = vec![4, shape.height, shape.width];
        let name = "phase_samples".to_owned();
        channels.push(ChannelSpec { name, element: ElementType::U16, frame_dims });
    }
    if extras.truth {
        channels.push(ChannelSpec::image("true_distance_m", ElementType::F32, shape));
        channels.push(ChannelSpec::image("reflectivity", ElementType::F32, shape));
    }
    let mut writer = RecordingWriter::create(output, simulation.len(), channels, overwrite)?;
    let progress = console::progress("simulating", simulation.len());
    // As many frames at a time as there are threads: their order, not their timing, decides the file.
    let (mut batch, step) = (Vec::new(), rayon::current_num_threads().max(1));
    interrupt::watch();
    for start in (0..simulation.len()).step_by(step) {
        interrupt::check()?;
        let indices = start..(start + step).min(simulation.len());
        let count = indices.len();
        simulation.render_frames(indices, &mut batch)?;
        for simulated in &batch[..count] {
            push(&mut writer, simulated, extras)?;
            progress.inc(1);
        }
    }
    progress.finish_and_clear();
    Ok(writer.finish(&describe(simulation, extras))?)
}

fn push(writer: &mut RecordingWriter, simulated: &SimulatedFrame, extras: Extras) -> Outcome {
    let frame = &simulated.frame;
    writer.push("amplitude", frame.amplitude.values())?;
    for (name, plane) in [("distance", &frame.distance_m), ("intensity", &frame.intensity)] {
        if let Some(plane) = plane {
            writer.push(name, plane.values())?;
        }
    }
    if let IntegrationTime::PerFrame(time_us) = frame.integration_time_us {
        writer.push("integration_time_us", &[time_us])?;
    }
    if let Some(target) = &frame.target {
        writer.push("target", target.values())?;
    }
    if let Some(pose) = &frame.world_from_camera {
        writer.push("world_from_camera", pose.as_flattened())?;
    }
    if extras.phase_samples {
        let bins: Vec<u16> = simulated.phase_samples.iter().flat_map(|bin| bin.values()).copied().collect();
        writer.push("phase_samples", &bins)?;
    }
    if extras.truth {
        writer.push("true_distance_m", simulated.truth.true_distance_m.values())?;
        writer.push("reflectivity", simulated.truth.reflectivity.values())?;
    }
    Ok(())
}

fn describe(simulation: &Simulation, extras: Extras) -> RecordingInfo {
    let model = simulation.model();
    let mut info = RecordingInfo {
        camera: Some(format!("{} (simulated)", model.name)),
        modulation_frequency_hz: Some(model.modulation_frequency_hz),
        saturated_amplitude: model.saturated_amplitude,
        saturated_phase_sample: extras.phase_samples.then(|| model.clip_dn() as f32),
        intrinsics: Some(model.intrinsics.into()),
        ..RecordingInfo::default()
    };
    let (scene, seed) = (&simulation.scene().name, simulation.seed());
    let ambient = simulation.scene().ambient;
    info.other.insert("simulation".to_owned(), json!({"scene": scene, "ambient": ambient, "seed": seed}));
    info
}
