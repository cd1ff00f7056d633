//! The simulated camera as a source of frames, and as a recording.

use std::path::Path;

use isolux::{Channels, Frame, IntegrationTime};
use isolux_camera::{SimulatedFrame, Simulation};
use isolux_io::{ChannelSpec, ElementType, RecordingInfo, RecordingWriter};
use serde_json::json;

use crate::error::PipelineError;
use crate::observer::{Observer, Progress, Work};
use crate::source::{FrameSource, SourceFacts};

/// Channels of a simulated recording beyond those that every one has.
#[derive(Clone, Copy, Debug, Default)]
pub struct Extras {
    /// The four raw bins.
    pub phase_samples: bool,
    /// The truth: `true_distance_m` and `reflectivity`.
    pub truth: bool,
}

/// Renders every frame into a recording of the native format at `output`.
///
/// # Errors
/// Those of the camera and of writing, and [`PipelineError::Interrupted`] once the observer has cancelled: nothing is
/// left behind then.
pub fn record(
    simulation: &Simulation,
    extras: Extras,
    output: &Path,
    overwrite: bool,
    observer: &dyn Observer,
) -> Result<(), PipelineError> {
    let channels = channels(simulation, extras);
    let mut writer = RecordingWriter::create(output, simulation.len(), channels, overwrite)?;
    let mut progress = Progress::start(observer, Work::Simulating, Some(simulation.len()));
    // As many frames at a time as there are threads: their order, not their timing, decides the file.
    let (mut batch, step) = (Vec::new(), rayon::current_num_threads().max(1));
    for start in (0..simulation.len()).step_by(step) {
        progress.check()?;
        let indices = start..(start + step).min(simulation.len());
        let count = indices.len();
        simulation.render_frames(indices, &mut batch)?;
        for simulated in &batch[..count] {
            push(&mut writer, simulated, extras)?;
            progress.step();
        }
    }
    progress.finish();
    Ok(writer.finish(&info(simulation, extras))?)
}

fn channels(simulation: &Simulation, extras: Extras) -> Vec<ChannelSpec> {
    let shape = simulation.shape();
    let array = |name: &str, element, frame_dims| ChannelSpec { name: name.to_owned(), element, frame_dims };
    let mut channels = vec![
        ChannelSpec::image("amplitude", ElementType::F32, shape),
        ChannelSpec::image("distance", ElementType::F32, shape),
        ChannelSpec::image("intensity", ElementType::F32, shape),
        ChannelSpec::number("integration_time_us", ElementType::F64),
        ChannelSpec::image("target", ElementType::U8, shape),
        array("world_from_camera", ElementType::F64, vec![4, 4]),
    ];
    if extras.phase_samples {
        channels.push(array("phase_samples", ElementType::U16, vec![4, shape.height, shape.width]));
    }
    if extras.truth {
        channels.push(ChannelSpec::image("true_distance_m", ElementType::F32, shape));
        channels.push(ChannelSpec::image("reflectivity", ElementType::F32, shape));
    }
    channels
}

fn push(
    writer: &mut RecordingWriter,
    simulated: &SimulatedFrame,
    extras: Extras,
) -> Result<(), PipelineError> {
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

/// What is known of the camera and of what it sees.
fn info(simulation: &Simulation, extras: Extras) -> RecordingInfo {
    let model = simulation.model();
    let mut info = RecordingInfo {
        camera: Some(format!("{} (simulated)", model.name)),
        modulation_frequency_hz: Some(model.modulation_frequency_hz.into()),
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

/// A simulation's frames, rendered when they are read: several at a time, on all threads.
#[derive(Debug)]
pub struct SimulatedFrames<'a> {
    simulation: &'a Simulation,
    facts: SourceFacts,
    first: usize,
    rendered: Vec<SimulatedFrame>,
}

impl<'a> SimulatedFrames<'a> {
    /// All frames of a simulation, with all their channels.
    #[must_use]
    pub fn new(simulation: &'a Simulation) -> Self {
        let facts = SourceFacts {
            frame_count: Some(simulation.len()),
            info: info(simulation, Extras { phase_samples: true, truth: false }),
            ..SourceFacts::new(simulation.scene().name.clone(), simulation.shape(), Self::CHANNELS)
        };
        Self { simulation, facts, first: 0, rendered: Vec::new() }
    }

    /// What simulated frames have.
    const CHANNELS: Channels = Channels::AMPLITUDE
        .union(Channels::DISTANCE)
        .union(Channels::INTENSITY)
        .union(Channels::INTEGRATION_TIME)
        .union(Channels::PHASE_SAMPLES)
        .union(Channels::TARGET)
        .union(Channels::POSE);
}

impl FrameSource for SimulatedFrames<'_> {
    fn facts(&self) -> SourceFacts {
        self.facts.clone()
    }

    fn read(&mut self, index: usize, _: Channels, frame: &mut Frame) -> Result<bool, PipelineError> {
        if index >= self.simulation.len() {
            return Ok(false);
        }
        if !(self.first..self.first + self.rendered.len()).contains(&index) {
            let end = (index + 4 * rayon::current_num_threads().max(1)).min(self.simulation.len());
            self.simulation.render_frames(index..end, &mut self.rendered)?;
            self.rendered.truncate(end - index);
            self.first = index;
        }
        frame.clone_from(&self.rendered[index - self.first].frame);
        Ok(true)
    }
}
