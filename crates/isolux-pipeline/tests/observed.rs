//! Whoever looks on: is told every frame, is told what was noticed, and may stop the work, which then leaves nothing.

#![allow(clippy::unwrap_used, reason = "tests fail by panicking")]

use std::cell::RefCell;
use std::path::Path;

use isolux::calibrate::CalibrateSettings;
use isolux::standardize::{DenoiseStep, DistanceStep, SigmaStep, TimeStep};
use isolux::{Channels, Choice, DenoiseRule, Frame};
use isolux_camera::{CameraModel, Scene, Simulation};
use isolux_pipeline::calibrate::measure;
use isolux_pipeline::simulate::{Extras, SimulatedFrames, record};
use isolux_pipeline::standardize::{FrameSink, OutputFormat, OutputFrame};
use isolux_pipeline::{
    AssessOptions, Brackets, CalibrationPaths, CalibrationSources, FrameSource, FramesInMemory, NativeSink,
    Observer, PipelineError, Remark, SourceFacts, StandardizeOptions, Unobserved, Work, assess, calibrate,
    diagnose, overview, plan, standardize,
};

const SCENE: &str = "office-desk";

fn simulation(scene: &str) -> Simulation {
    let scene = Scene::builtin(scene).unwrap();
    Simulation::new(CameraModel::preset(&scene.camera).unwrap(), scene, 1).unwrap()
}

/// Writes down what it is told, and cancels after so many frames.
#[derive(Default)]
struct Witness {
    progress: RefCell<Vec<(Work, usize, Option<usize>)>>,
    remarks: RefCell<Vec<Remark>>,
    cancel_after: Option<usize>,
}

impl Witness {
    fn cancelling(after: usize) -> Self {
        Self { cancel_after: Some(after), ..Self::default() }
    }

    /// The numbers of frames that were done, of each pass over such work.
    fn counted(&self, work: Work) -> Vec<usize> {
        self.progress.borrow().iter().filter(|(found, ..)| *found == work).map(|(_, done, _)| *done).collect()
    }
}

impl Observer for Witness {
    fn progress(&self, work: Work, done: usize, total: Option<usize>) {
        self.progress.borrow_mut().push((work, done, total));
    }

    fn cancelled(&self) -> bool {
        let last = self.progress.borrow().last().map_or(0, |(_, done, _)| *done);
        self.cancel_after.is_some_and(|after| last >= after)
    }

    fn remark(&self, remark: Remark) {
        self.remarks.borrow_mut().push(remark);
    }
}

/// Keeps what it is given.
#[derive(Default)]
struct Kept {
    format: Option<OutputFormat>,
    values: Vec<Vec<u32>>,
    flags: Vec<Vec<u16>>,
    finished: bool,
}

impl FrameSink for Kept {
    fn begin(&mut self, format: &OutputFormat) -> Result<(), PipelineError> {
        self.format = Some(format.clone());
        Ok(())
    }

    fn push(&mut self, frame: OutputFrame<'_>) -> Result<(), PipelineError> {
        let (values, flags) = (&frame.standardized.amplitude, &frame.standardized.flags);
        self.values.push(values.values().iter().map(|value| value.to_bits()).collect());
        self.flags.push(flags.values().iter().map(|flags| flags.bits()).collect());
        Ok(())
    }

    fn finish(&mut self, info: &isolux_io::RecordingInfo) -> Result<(), PipelineError> {
        assert!(info.other.contains_key("standardization"));
        self.finished = true;
        Ok(())
    }
}

fn entries(folder: &Path) -> usize {
    std::fs::read_dir(folder).unwrap().count()
}

#[test]
fn every_frame_is_told_from_none_to_all() {
    let (simulation, witness) = (simulation(SCENE), Witness::default());
    let mut frames = SimulatedFrames::new(&simulation);
    let chain = plan(&Choice::default(), None, &mut frames, &witness).unwrap();
    let mut sink = Kept::default();
    let summary =
        standardize(&mut frames, &chain, &StandardizeOptions::default(), &mut sink, &witness).unwrap();
    assert_eq!(summary.frames, simulation.len());
    assert_eq!(witness.counted(Work::Standardizing), (0..=simulation.len()).collect::<Vec<_>>());
    assert!(witness.progress.borrow().iter().all(|(_, _, total)| *total == Some(simulation.len())));
    assert!(sink.finished && sink.values.len() == simulation.len());
    assess(&mut frames, &chain, &AssessOptions::default(), &witness).unwrap();
    assert_eq!(witness.counted(Work::Evaluating).len(), simulation.len() + 1);
    diagnose(&mut frames, &witness).unwrap();
    assert_eq!(witness.counted(Work::Diagnosing).last(), Some(&simulation.len()));
}

/// Simulated frames that tell other facts than their own.
struct Telling<'a> {
    facts: SourceFacts,
    frames: SimulatedFrames<'a>,
}

impl FrameSource for Telling<'_> {
    fn facts(&self) -> SourceFacts {
        self.facts.clone()
    }

    fn read(&mut self, index: usize, wanted: Channels, frame: &mut Frame) -> Result<bool, PipelineError> {
        self.frames.read(index, wanted, frame)
    }
}

#[test]
fn frames_of_unknown_number_give_the_same() {
    let (simulation, witness) = (simulation(SCENE), Witness::default());
    let mut known = SimulatedFrames::new(&simulation);
    let facts = SourceFacts { frame_count: None, ..known.facts() };
    let mut unknown = Telling { facts, frames: SimulatedFrames::new(&simulation) };
    let chain = plan(&Choice::default(), None, &mut known, &Unobserved).unwrap();
    let options = StandardizeOptions::default();
    let (mut expected, mut found) = (Kept::default(), Kept::default());
    standardize(&mut known, &chain, &options, &mut expected, &Unobserved).unwrap();
    standardize(&mut unknown, &chain, &options, &mut found, &witness).unwrap();
    assert!(expected.values == found.values && expected.flags == found.flags);
    assert_eq!(
        witness.progress.borrow().last(),
        Some(&(Work::Standardizing, simulation.len(), Some(simulation.len())))
    );
    let folder = tempfile::tempdir().unwrap();
    // A recording can be written all the same: its files learn the number at the end.
    let path = folder.path().join("out");
    let mut native = NativeSink::new(&path, false);
    let written = standardize(&mut unknown, &chain, &options, &mut native, &Unobserved).unwrap();
    assert_eq!(written.frames, simulation.len());
    assert_eq!(isolux_io::open(&path).unwrap().metadata().frame_count, Some(simulation.len()));
    let refused = Brackets::plan(&mut unknown, Some(3), &Unobserved).unwrap_err();
    assert!(matches!(refused, PipelineError::LengthUnknown { .. }), "{refused}");
    assert_eq!(overview(&mut known, &Unobserved).unwrap().integration_times_us.len(), {
        overview(&mut unknown, &Unobserved).unwrap().integration_times_us.len()
    });
}

#[test]
fn an_observer_that_cancels_leaves_no_output() {
    let simulation = simulation(SCENE);
    let folder = tempfile::tempdir().unwrap();
    let recorded =
        record(&simulation, Extras::default(), &folder.path().join("rec"), false, &Witness::cancelling(1));
    assert!(matches!(recorded, Err(PipelineError::Interrupted)));
    assert_eq!(entries(folder.path()), 0);
    let mut frames = SimulatedFrames::new(&simulation);
    let chain = plan(&Choice::default(), None, &mut frames, &Unobserved).unwrap();
    for after in [0, 1, simulation.len() - 1] {
        let mut sink = NativeSink::new(&folder.path().join("out"), false);
        let options = StandardizeOptions { threads: Some(1), ..StandardizeOptions::default() };
        let observer = Witness::cancelling(after);
        let stopped = standardize(&mut frames, &chain, &options, &mut sink, &observer);
        assert!(matches!(stopped, Err(PipelineError::Interrupted)));
        drop(sink);
        assert_eq!(entries(folder.path()), 0, "cancelled after {after} frames");
    }
}

#[test]
fn any_number_of_threads_gives_the_same_bytes() {
    let simulation = simulation(SCENE);
    let mut frames = SimulatedFrames::new(&simulation);
    let denoise = Some(DenoiseStep::Smooth(DenoiseRule::Temporal));
    let choice = Choice { denoise, sigma: SigmaStep::Required, ..Choice::default() };
    let chain = plan(&choice, None, &mut frames, &Unobserved).unwrap();
    let brackets = Brackets::plan(&mut frames, Some(3), &Unobserved).unwrap();
    for brackets in [None, Some(&brackets)] {
        let standardized = |threads: usize| {
            let folder = tempfile::tempdir().unwrap();
            let path = folder.path().join("out.npz");
            let mut sink = NativeSink::new(&path, false);
            let options = StandardizeOptions { threads: Some(threads), brackets, ..Default::default() };
            let mut frames = SimulatedFrames::new(&simulation);
            standardize(&mut frames, &chain, &options, &mut sink, &Unobserved).unwrap();
            (std::fs::read(&path).unwrap(), std::fs::read(path.with_extension("json")).unwrap())
        };
        let one = standardized(1);
        assert!(standardized(3) == one);
    }
}

#[test]
fn remarks_are_delivered() {
    let (desk, witness) = (simulation(SCENE), Witness::default());
    let mut frames = SimulatedFrames::new(&desk);
    plan(&Choice::default(), None, &mut frames, &witness).unwrap();
    let remarks = witness.remarks.take();
    assert!(remarks.iter().any(|remark| matches!(remark, Remark::Plan(_))), "{remarks:?}");
    assert!(remarks.iter().all(|remark| !remark.to_string().contains("--")), "{remarks:?}");

    let settings = CalibrateSettings::default();
    let sweeps = ["wall-sweep-smoke", "board-distances-smoke"].map(simulation);
    let sources = || {
        let [wall, board] = [0, 1].map(|index: usize| {
            let frames = SimulatedFrames::new(&sweeps[index]);
            let mut facts = frames.facts();
            facts.info.camera = Some(format!("camera {index}"));
            Box::new(Telling { facts, frames }) as Box<dyn FrameSource + '_>
        });
        CalibrationSources { exposure_sweeps: vec![wall], distance_sweeps: vec![board], ..Default::default() }
    };
    calibrate(&settings, None, sources(), &witness).unwrap();
    let remarks = witness.remarks.take();
    let [Remark::CamerasDiffer { cameras }] = remarks.as_slice() else { panic!("{remarks:?}") };
    assert_eq!(cameras, &["camera 0", "camera 1"]);
    assert_eq!(remarks[0].advice(), Some(isolux::Advice::NameCamera));
    // Who names the camera is not told.
    calibrate(&settings, Some("mine".to_owned()), sources(), &witness).unwrap();
    assert!(witness.remarks.take().is_empty());
}

#[test]
fn frames_in_memory_calibrate_like_their_recording() {
    let wall = simulation("wall-sweep-smoke");
    let board = simulation("board-distances-smoke");
    let folder = tempfile::tempdir().unwrap();
    let settings = CalibrateSettings::default();
    let extras = Extras { phase_samples: true, truth: false };
    let mut held = Vec::new();
    for (simulation, name) in [(&wall, "wall"), (&board, "board")] {
        record(simulation, extras, &folder.path().join(name), false, &Unobserved).unwrap();
        let mut recording = isolux_io::open(&folder.path().join(name)).unwrap();
        let facts = recording.facts();
        let (mut frames, mut frame) = (Vec::new(), Frame::new(facts.shape));
        while recording.read(frames.len(), Channels::all(), &mut frame).unwrap() {
            frames.push(frame.clone());
        }
        held.push((facts, frames));
    }
    let (from_wall, from_board) = ([folder.path().join("wall")], [folder.path().join("board")]);
    let paths =
        CalibrationPaths { exposure_sweeps: &from_wall, distance_sweeps: &from_board, ..Default::default() };
    let (recorded, _) = calibrate(&settings, None, paths.open().unwrap(), &Unobserved).unwrap();
    let in_memory = || {
        let [wall, board] = [0, 1].map(|index: usize| {
            let (facts, frames) = &held[index];
            Box::new(FramesInMemory::new(facts.clone(), frames)) as Box<dyn FrameSource + '_>
        });
        CalibrationSources { exposure_sweeps: vec![wall], distance_sweeps: vec![board], ..Default::default() }
    };
    let measured = measure(&settings, in_memory(), &Unobserved).unwrap();
    let (fitted, _) = measured.clone().fit(None, &Unobserved).unwrap();
    assert!(fitted == recorded);
    // Without linear amplitudes, the law over distance is another one.
    let (delivered, _) = measured.of_delivered_amplitudes().fit(None, &Unobserved).unwrap();
    assert!(delivered.terms.cubic == fitted.terms.cubic);
    assert!(delivered.terms.response.is_some());
    assert!(delivered.terms.spline != fitted.terms.spline);
}

#[test]
fn errors_name_the_recording_and_speak_no_command_line() {
    let simulation = simulation("wall-sweep-smoke");
    let mut frames = SimulatedFrames::new(&simulation);
    // One time, frame after frame: no bracket.
    let mut shown = Frame::new(simulation.shape());
    assert!(frames.read(0, Channels::all(), &mut shown).unwrap());
    let mut same = FramesInMemory::new(frames.facts(), [&shown, &shown]);
    let error = Brackets::plan(&mut same, None, &Unobserved).unwrap_err();
    assert!(matches!(error, PipelineError::NoBrackets { .. }));
    assert_eq!(error.advice(), Some(isolux::Advice::GiveBracketLength));
    let mut without_time = shown.clone();
    without_time.integration_time_us = isolux::IntegrationTime::Unknown;
    let mut timeless = FramesInMemory::new(frames.facts(), [&without_time]);
    let error = Brackets::plan(&mut timeless, None, &Unobserved).unwrap_err();
    let text = error.to_string();
    assert!(text.contains("`wall-sweep-smoke`, frame 0") && !text.contains("--"), "{text}");
    let chain = plan(&Choice::default(), None, &mut frames, &Unobserved).unwrap();
    let brackets = Brackets::plan(&mut same, Some(2), &Unobserved).unwrap();
    let options = StandardizeOptions { brackets: Some(&brackets), ..Default::default() };
    let error = standardize(&mut same, &chain, &options, &mut Kept::default(), &Unobserved).unwrap_err();
    assert_eq!(error.advice(), Some(isolux::Advice::GiveOrEstimateNoise), "{error}");
    let options = StandardizeOptions { keep_input: true, ..options };
    let error = standardize(&mut same, &chain, &options, &mut Kept::default(), &Unobserved).unwrap_err();
    assert!(matches!(error, PipelineError::KeptOfMerged), "{error}");
}

#[test]
fn the_textbook_goes_as_far_as_the_channels() {
    let choice = Choice::textbook(Channels::AMPLITUDE | Channels::DISTANCE);
    assert_eq!((choice.time, choice.distance), (Some(TimeStep::None), Some(DistanceStep::Square)));
    let choice = Choice::textbook(Channels::AMPLITUDE | Channels::INTEGRATION_TIME);
    assert_eq!((choice.time, choice.distance), (Some(TimeStep::Linear), Some(DistanceStep::None)));
}
