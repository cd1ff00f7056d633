//! `isolux calibrate`: sweeps, targets and scenes in, `CAMERA.json` out.

mod describe;
mod findings;
mod linear;
mod scenes;
mod targets;

use std::path::{Path, PathBuf};

use isolux::calibrate::{
    CalibrateError, CalibrateSettings, DistanceSweep, ExposureCurve, ExposureFit, ExposureSweep, FitReport,
    FitWarning, MeasureError, Measurements, ReferenceDecays, TargetSweep, TargetWindows,
};
use isolux::calibration::Terms;
use isolux::terms::Response;
use isolux::{Calibration, Channels, Frame, Reference};

use crate::args::CalibrateArgs;
use crate::console;
use crate::failure::{Failure, Outcome};
use crate::{advice, frames, output};

pub(crate) use describe::describe;
use linear::Linear;

pub(crate) fn run(args: &CalibrateArgs) -> Outcome {
    let inputs = Inputs {
        exposure_sweeps: &args.exposure_sweep,
        distance_sweeps: &args.distance_sweep,
        targets: &args.target,
        scenes: &args.scene,
    };
    if inputs.all().next().is_none() {
        return Err(Failure::usage(
            "nothing to fit: give --exposure-sweep REC, --distance-sweep REC, --target REC or --scene REC, or several",
        ));
    }
    output::keep_clear_of(&args.output, inputs.all())?;
    output::expect_calibration_or_nothing(&args.output)?;
    let settings = CalibrateSettings {
        reference: Reference {
            integration_time_us: Some(args.reference_time_us),
            distance_m: args.reference_distance_m,
        },
        window_px: usize::from(args.window),
        skip_frames: args.skip_frames,
        exclude_time_us: args.exclude_time_us.clone(),
        modulation_frequency_hz: None,
    };
    let (calibration, report) = fit(&settings, args.camera.clone(), inputs)?;
    report.warnings.iter().for_each(warn);
    if calibration.terms == Terms::default() {
        return Err(Failure::data(
            "no term could be fitted from these recordings, for the reasons above: no calibration is written",
        ));
    }
    isolux_io::write_calibration(&calibration, &args.output)?;
    if args.json {
        return console::print_json(&calibration);
    }
    console::print(describe(&calibration, &report))?;
    console::print(format!("written: {}", args.output.display()))
}

/// Recordings, by what they are.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Inputs<'a> {
    pub(crate) exposure_sweeps: &'a [PathBuf],
    pub(crate) distance_sweeps: &'a [PathBuf],
    pub(crate) targets: &'a [PathBuf],
    pub(crate) scenes: &'a [PathBuf],
}

impl<'a> Inputs<'a> {
    fn all(self) -> impl Iterator<Item = &'a Path> {
        let sweeps = self.exposure_sweeps.iter().chain(self.distance_sweeps);
        sweeps.chain(self.targets).chain(self.scenes).map(PathBuf::as_path)
    }
}

/// Measures the recordings and fits what they determine. Distance sweeps tell the modulation frequency, targets where
/// there are none, scenes where there are neither, unless the settings do.
pub(crate) fn fit(
    settings: &CalibrateSettings,
    camera: Option<String>,
    inputs: Inputs<'_>,
) -> Outcome<(Calibration, FitReport)> {
    let Inputs { exposure_sweeps, distance_sweeps, targets, scenes } = inputs;
    let mut settings = settings.clone();
    if settings.modulation_frequency_hz.is_none() {
        let kinds = [distance_sweeps, targets, scenes, exposure_sweeps];
        let told_by = kinds.into_iter().find(|paths| !paths.is_empty());
        settings.modulation_frequency_hz = modulation_frequency_hz(told_by.unwrap_or_default())?;
    }
    let mut cameras = Vec::new();
    let curves = exposure_sweeps.iter().map(|path| exposure_curve(path, &settings, &mut cameras));
    let exposure = ExposureFit::new(&settings, curves.collect::<Outcome<Vec<_>>>()?)
        .inspect_err(|error| error.warnings().iter().for_each(warn))
        .map_err(|error| Failure::data(advice::with(&error, error.advice())))?;
    let mut measured = Measurements::default();
    for path in distance_sweeps {
        let (delivered, linear) = reference_decays(path, &settings, exposure.response(), &mut cameras)?;
        measured.add_distance_sweep(delivered, linear);
    }
    for path in targets {
        measured.add_target(target_windows(path, &settings, exposure.response(), &mut cameras)?);
    }
    for path in scenes {
        measured.add_scene(scenes::observations(path, &settings, exposure.response(), &mut cameras)?);
    }
    cameras.dedup();
    if camera.is_none() && cameras.len() > 1 {
        let names = cameras.join("`, `");
        console::warn(format!(
            "the recordings name different cameras (`{names}`): say which with --camera NAME"
        ));
    }
    let camera = camera.or_else(|| cameras.into_iter().next());
    exposure.complete(camera, measured).map_err(|error| {
        error.warnings().iter().for_each(warn);
        let advised = match &error {
            // Pooled from all distance sweeps, so the error knows none of them.
            CalibrateError::Cubic { source, .. } => {
                let names: Vec<_> = distance_sweeps.iter().map(|path| path.display().to_string()).collect();
                let found = format!("distance sweep `{}`: {source}", names.join("`, `"));
                advice::with(found, source.advice())
            }
            other => advice::with(other, other.advice()),
        };
        Failure::data(advised)
    })
}

fn warn(warning: &FitWarning) {
    console::warn(advice::with(warning, warning.advice()));
}

/// The frequency that all of these recordings name; one that does not leaves it open.
fn modulation_frequency_hz(paths: &[PathBuf]) -> Outcome<Option<f64>> {
    let mut frequencies = Vec::new();
    for path in paths {
        frequencies.push(isolux_io::open(path)?.metadata().info.modulation_frequency_hz);
    }
    frequencies.dedup();
    if frequencies.len() > 1 {
        console::warn(
            "the recordings name different modulation frequencies, or some of them none: the spline goes without the \
             harmonic, and the response repairs no distance",
        );
        return Ok(None);
    }
    Ok(frequencies.first().copied().flatten())
}

/// What tells the fill of a pixel, where it is recorded.
const RESPONSE_CHANNELS: Channels = Channels::INTENSITY.union(Channels::PHASE_SAMPLES);

fn exposure_curve(
    path: &Path,
    settings: &CalibrateSettings,
    cameras: &mut Vec<String>,
) -> Outcome<ExposureCurve> {
    let mut sweep = ExposureSweep::new(path.display().to_string(), settings);
    measure(path, "exposure sweep", RESPONSE_CHANNELS, cameras, |frame| sweep.push(frame))?;
    Ok(sweep.finish())
}

/// The decays as they were delivered, and linear where the response allows it.
fn reference_decays(
    path: &Path,
    settings: &CalibrateSettings,
    response: Option<&Response>,
    cameras: &mut Vec<String>,
) -> Outcome<(ReferenceDecays, Option<ReferenceDecays>)> {
    let mut delivered = DistanceSweep::new(path.display().to_string(), settings);
    let mut linear_sweep = delivered.clone();
    let mut linear = Linear::new(path, response)?;
    measure(path, "distance sweep", linear.channels(), cameras, |frame| {
        delivered.push(frame)?;
        if linear.is_possible() { linear_sweep.push(linear.frame(frame)?) } else { Ok(()) }
    })?;
    Ok((delivered.finish(), linear.is_possible().then(|| linear_sweep.finish())))
}

fn target_windows(
    path: &Path,
    settings: &CalibrateSettings,
    response: Option<&Response>,
    cameras: &mut Vec<String>,
) -> Outcome<TargetWindows> {
    let intrinsics = frames::stream(isolux_io::open(path)?.metadata()).intrinsics;
    let mut sweep = TargetSweep::new(path.display().to_string(), settings, intrinsics);
    let mut linear = Linear::new(path, response)?;
    if linear.is_possible() {
        sweep = sweep.of_linear_frames();
    }
    measure(path, "target", Channels::TARGET | linear.channels(), cameras, |frame| {
        sweep.push(linear.frame(frame)?)
    })?;
    Ok(sweep.finish())
}

fn measure(
    path: &Path,
    what: &str,
    besides: Channels,
    cameras: &mut Vec<String>,
    mut push: impl FnMut(&Frame) -> Result<(), MeasureError>,
) -> Outcome {
    let mut recording = isolux_io::open(path)?;
    cameras.extend(recording.metadata().info.camera.clone());
    let wanted = Channels::AMPLITUDE | Channels::DISTANCE | Channels::INTEGRATION_TIME | besides;
    frames::for_each(&mut *recording, wanted, what, |_, frame| {
        push(frame).map_err(|error| {
            let found = format!("`{}`: {error}", path.display());
            Failure::data(advice::with(found, error.advice()))
        })
    })
}
