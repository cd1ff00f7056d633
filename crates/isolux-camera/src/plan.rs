//! The list of frames that a scene asks for.

use crate::error::{CameraError, InvalidValue};
use crate::full_well::FullWell;
use crate::model::CameraModel;
use crate::scene::Scene;
use crate::scene::pose::Pose;
use crate::scene::run::Run;
use crate::view::{Setting, Tracer};

/// One frame that is to be recorded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlannedFrame {
    /// Which run of the scene it belongs to.
    pub run: usize,
    /// Which pose it is taken in, counted over all runs; frames of one number see the same.
    pub pose: usize,
    /// Integration time, µs.
    pub integration_time_us: f64,
    /// The camera's own count of frames since the start, unrecorded ones included.
    pub camera_frame: u64,
    /// Frames since the integration time was changed, unrecorded ones included.
    pub frames_since_change: u64,
}

/// Frames and the settings that their poses number.
#[derive(Debug)]
pub(crate) struct Plan {
    pub(crate) frames: Vec<PlannedFrame>,
    pub(crate) settings: Vec<Setting>,
}

/// Side of the window of the paper's measurements, pixels.
const WINDOW_SIDE: usize = 20;

/// Largest number of frames of a recording.
const FRAME_LIMIT: usize = 1_000_000;

pub(crate) fn plan(model: &CameraModel, scene: &Scene) -> Result<Plan, CameraError> {
    let mut plan = Plan { frames: Vec::new(), settings: Vec::new() };
    let mut clock = Clock::default();
    for (index, run) in scene.runs.iter().enumerate() {
        let times = integration_times_us(model, run, index)?;
        for (number, setting) in settings(scene, run).into_iter().enumerate() {
            let longest_us =
                if run.skip_over_saturated { longest_time_us(model, scene, &setting) } else { f64::INFINITY };
            let pose = plan.settings.len();
            plan.settings.push(setting);
            let (times, count) = exposures(run, &times, number);
            for &time_us in times.iter().filter(|&&time_us| time_us <= longest_us) {
                clock.change_to(time_us, u64::from(run.skip_frames));
                if plan.frames.len() + count > FRAME_LIMIT {
                    return Err(CameraError::TooManyFrames {
                        scene: scene.name.clone(),
                        found: frame_count(model, scene),
                        limit: FRAME_LIMIT,
                    });
                }
                plan.frames.extend((0..count).map(|_| clock.frame(index, pose)));
            }
        }
    }
    if plan.frames.is_empty() {
        return Err(CameraError::NoFrames { scene: scene.name.clone() });
    }
    Ok(plan)
}

/// The camera's time: it goes on while frames are skipped.
#[derive(Default)]
struct Clock {
    integration_time_us: f64,
    camera_frame: u64,
    frames_since_change: u64,
}

impl Clock {
    fn change_to(&mut self, integration_time_us: f64, skipped: u64) {
        if self.integration_time_us != integration_time_us {
            self.integration_time_us = integration_time_us;
            self.frames_since_change = 0;
        }
        self.camera_frame += skipped;
        self.frames_since_change += skipped;
    }

    fn frame(&mut self, run: usize, pose: usize) -> PlannedFrame {
        let planned = PlannedFrame {
            run,
            pose,
            integration_time_us: self.integration_time_us,
            camera_frame: self.camera_frame,
            frames_since_change: self.frames_since_change,
        };
        self.camera_frame += 1;
        self.frames_since_change += 1;
        planned
    }
}

fn integration_times_us(model: &CameraModel, run: &Run, index: usize) -> Result<Vec<f64>, InvalidValue> {
    let Some(range) = run.registers else { return Ok(run.integration_times_us.clone()) };
    let register = model.integration_register;
    let times = (range.first..=range.last)
        .step_by(range.step.max(1) as usize)
        .map(|n| register.integration_time_us(n))
        .collect::<Option<Vec<f64>>>();
    times.ok_or_else(|| InvalidValue {
        document: String::new(),
        line: None,
        field: format!("run[{index}].registers.last"),
        found: range.last.to_string(),
        expected: format!(
            "at most {}, the largest register of the camera `{}`",
            register.maximum, model.name
        ),
    })
}

/// The integration times at which pose `number` of a run is recorded, and the frames of each.
fn exposures<'a>(run: &Run, times: &'a [f64], number: usize) -> (&'a [f64], usize) {
    let count = run.frames_per_time as usize;
    if run.motion.is_none() || times.is_empty() {
        return (times, count);
    }
    let turn = number / count.max(1) % times.len();
    (&times[turn..=turn], 1)
}

/// The settings that a run goes through.
fn settings(scene: &Scene, run: &Run) -> Vec<Setting> {
    let place = |name: &str| scene.objects.iter().position(|object| object.name == name);
    let mut settings = Vec::new();
    if let Some(approach) = &run.approach
        && let Some(index) = place(&approach.object)
    {
        settings.extend(approach.distances_m.iter().map(|&z| {
            let pose = scene.objects[index].pose();
            let [x, y, _] = pose.center_m;
            Setting { moved: vec![(index, Pose { center_m: [x, y, z], ..pose })], ..Setting::default() }
        }));
    }
    settings.extend(run.moves.iter().map(|step| match place(&step.object) {
        Some(index) => {
            let pose = step.apply(scene.objects[index].pose());
            Setting { moved: vec![(index, pose)], ..Setting::default() }
        }
        None => Setting { camera: step.apply(Pose::default()), ..Setting::default() },
    }));
    settings.extend(run.motion.iter().flat_map(|motion| motion.poses()).map(|poses| {
        let mut setting = Setting::default();
        for (object, pose) in poses {
            match place(object) {
                Some(index) => setting.moved.push((index, pose)),
                None => setting.camera = pose,
            }
        }
        setting
    }));
    if settings.is_empty() {
        settings.push(Setting::default());
    }
    settings
}

/// Longest integration time at which no bin in the window is expected to reach the hard clip, µs.
fn longest_time_us(model: &CameraModel, scene: &Scene, setting: &Setting) -> f64 {
    let rate = Tracer::new(model, scene, setting).largest_rate_in_the_window(WINDOW_SIDE);
    FullWell::of(model).received_at_clip_electrons() / rate
}

/// Frames that the scene asks for when nothing is left out.
fn frame_count(model: &CameraModel, scene: &Scene) -> usize {
    let runs = scene.runs.iter().enumerate();
    runs.map(|(index, run)| {
        let times = integration_times_us(model, run, index).map_or(0, |times| times.len());
        let poses = settings(scene, run).len();
        let frames = times.saturating_mul(run.frames_per_time as usize).saturating_mul(poses);
        if run.motion.is_some() { poses } else { frames }
    })
    .fold(0, usize::saturating_add)
}
