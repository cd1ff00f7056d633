//! `isolux calibrate`: sweeps in, `CAMERA.json` out.

mod describe;

use std::path::{Path, PathBuf};

use isolux::calibrate::{
    self, CalibrateError, CalibrateSettings, DistanceSweep, ExposureCurve, ExposureSweep, FitReport,
    ReferenceDecays,
};
use isolux::{Calibration, Channels, Frame, Reference};

use crate::args::CalibrateArgs;
use crate::console;
use crate::failure::{Failure, Outcome};
use crate::{frames, output};

pub(crate) use describe::describe;

pub(crate) fn run(args: &CalibrateArgs) -> Outcome {
    if args.exposure_sweep.is_empty() && args.distance_sweep.is_empty() {
        return Err(Failure::usage(
            "nothing to fit: give --exposure-sweep REC or --distance-sweep REC, or both",
        ));
    }
    let inputs = args.exposure_sweep.iter().chain(&args.distance_sweep);
    output::keep_clear_of(&args.output, inputs.map(PathBuf::as_path))?;
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
    let (calibration, report) =
        fit(&settings, args.camera.clone(), &args.exposure_sweep, &args.distance_sweep)?;
    isolux_io::write_calibration(&calibration, &args.output)?;
    report.warnings.iter().for_each(console::warn);
    if args.json {
        return console::print_json(&calibration);
    }
    console::print(describe(&calibration, &report))?;
    console::print(format!("written: {}", args.output.display()))
}

/// Measures the sweeps and fits what they determine. They tell the modulation frequency, unless the settings do.
pub(crate) fn fit(
    settings: &CalibrateSettings,
    camera: Option<String>,
    exposure_sweeps: &[PathBuf],
    distance_sweeps: &[PathBuf],
) -> Outcome<(Calibration, FitReport)> {
    let mut cameras = Vec::new();
    let curves = exposure_sweeps.iter().map(|path| exposure_curve(path, settings, &mut cameras));
    let curves = curves.collect::<Outcome<Vec<_>>>()?;
    let decays = distance_sweeps.iter().map(|path| reference_decays(path, settings, &mut cameras));
    let decays = decays.collect::<Outcome<Vec<_>>>()?;
    cameras.dedup();
    if camera.is_none() && cameras.len() > 1 {
        let names = cameras.join("`, `");
        console::warn(format!(
            "the recordings name different cameras (`{names}`): say which with --camera NAME"
        ));
    }
    let camera = camera.or_else(|| cameras.into_iter().next());
    let mut settings = settings.clone();
    if settings.modulation_frequency_hz.is_none() {
        let told_by = if distance_sweeps.is_empty() { exposure_sweeps } else { distance_sweeps };
        settings.modulation_frequency_hz = modulation_frequency_hz(told_by)?;
    }
    calibrate::fit(&settings, camera, curves, decays).map_err(|error| {
        error.warnings().iter().for_each(console::warn);
        match error {
            // Pooled from all distance sweeps, so the error knows none of them.
            CalibrateError::Cubic { source, .. } => {
                let names: Vec<_> = distance_sweeps.iter().map(|path| path.display().to_string()).collect();
                Failure::data(format!("distance sweep `{}`: {source}", names.join("`, `")))
            }
            other => Failure::data(other),
        }
    })
}

/// The frequency that all these sweeps name; one that does not leaves it open.
fn modulation_frequency_hz(paths: &[PathBuf]) -> Outcome<Option<f64>> {
    let mut frequencies = Vec::new();
    for path in paths {
        frequencies.push(isolux_io::open(path)?.metadata().info.modulation_frequency_hz);
    }
    frequencies.dedup();
    if frequencies.len() > 1 {
        console::warn(
            "the sweeps name different modulation frequencies, or some of them none: the spline goes without the \
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

fn reference_decays(
    path: &Path,
    settings: &CalibrateSettings,
    cameras: &mut Vec<String>,
) -> Outcome<ReferenceDecays> {
    let mut sweep = DistanceSweep::new(path.display().to_string(), settings);
    measure(path, "distance sweep", Channels::empty(), cameras, |frame| sweep.push(frame))?;
    Ok(sweep.finish())
}

fn measure(
    path: &Path,
    what: &str,
    besides: Channels,
    cameras: &mut Vec<String>,
    mut push: impl FnMut(&Frame) -> Result<(), CalibrateError>,
) -> Outcome {
    let mut recording = isolux_io::open(path)?;
    cameras.extend(recording.metadata().info.camera.clone());
    let wanted = Channels::AMPLITUDE | Channels::DISTANCE | Channels::INTEGRATION_TIME | besides;
    frames::for_each(&mut *recording, wanted, what, |_, frame| {
        push(frame).map_err(|error| Failure::data(format!("`{}`: {error}", path.display())))
    })
}
