//! `isolux calibrate`: sweeps in, `CAMERA.json` out.

use std::path::{Path, PathBuf};

use isolux::calibrate::{
    self, CalibrateError, CalibrateSettings, DistanceSweep, ExposureCurve, ExposureSweep, FitReport,
    ReferenceDecays,
};
use isolux::terms::cubic::Scaling;
use isolux::terms::{FitQuality, Lut, Spline};
use isolux::{Calibration, Channels, Frame, Reference};

use crate::args::CalibrateArgs;
use crate::console::{self, table};
use crate::failure::{Failure, Outcome};
use crate::{frames, output};

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

/// Measures the sweeps and fits what they determine. Distance sweeps tell the modulation frequency, unless the
/// settings do.
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
        settings.modulation_frequency_hz = modulation_frequency_hz(distance_sweeps)?;
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

/// The frequency that all distance sweeps name; one that does not leaves it open.
fn modulation_frequency_hz(paths: &[PathBuf]) -> Outcome<Option<f64>> {
    let mut frequencies = Vec::new();
    for path in paths {
        frequencies.push(isolux_io::open(path)?.metadata().info.modulation_frequency_hz);
    }
    frequencies.dedup();
    if frequencies.len() > 1 {
        console::warn(
            "the distance sweeps name different modulation frequencies, or some of them none: the spline goes \
             without the harmonic",
        );
        return Ok(None);
    }
    Ok(frequencies.first().copied().flatten())
}

fn exposure_curve(
    path: &Path,
    settings: &CalibrateSettings,
    cameras: &mut Vec<String>,
) -> Outcome<ExposureCurve> {
    let mut sweep = ExposureSweep::new(path.display().to_string(), settings);
    measure(path, "exposure sweep", cameras, |frame| sweep.push(frame))?;
    Ok(sweep.finish())
}

fn reference_decays(
    path: &Path,
    settings: &CalibrateSettings,
    cameras: &mut Vec<String>,
) -> Outcome<ReferenceDecays> {
    let mut sweep = DistanceSweep::new(path.display().to_string(), settings);
    measure(path, "distance sweep", cameras, |frame| sweep.push(frame))?;
    Ok(sweep.finish())
}

fn measure(
    path: &Path,
    what: &str,
    cameras: &mut Vec<String>,
    mut push: impl FnMut(&Frame) -> Result<(), CalibrateError>,
) -> Outcome {
    let mut recording = isolux_io::open(path)?;
    cameras.extend(recording.metadata().info.camera.clone());
    let wanted = Channels::AMPLITUDE | Channels::DISTANCE | Channels::INTEGRATION_TIME;
    frames::for_each(&mut *recording, wanted, what, |_, frame| {
        push(frame).map_err(|error| Failure::data(format!("`{}`: {error}", path.display())))
    })
}

/// The fit, for a person to judge.
pub(crate) fn describe(calibration: &Calibration, report: &FitReport) -> String {
    let mut text = vec![format!("camera: {}", calibration.camera.as_deref().unwrap_or("(not named)"))];
    if let Some(lut) = &calibration.terms.lut {
        text.push(format!("\nlut, multiplier over integration time: {}", quality(&lut.fit, "times")));
        text.push(lut_table(lut));
        let [min, max] = lut.valid_integration_time_us;
        text.push(format!("valid from {min} to {max} µs (peak of the mean amplitude)"));
    }
    if let Some(cubic) = &calibration.terms.cubic {
        let [c0, c1, c2, c3] = cubic.coefficients;
        text.push(format!("\ncubic, multiplier over distance: {}", quality(&cubic.fit, "positions")));
        text.push(format!("P(d) = {c0:.5} {c1:+.5} d {c2:+.5} d² {c3:+.5} d³, d in m"));
        text.push(decay_table(report));
        let [min, max] = cubic.valid_distance_m;
        text.push(format!("valid from {min:.3} to {max:.3} m"));
    }
    if let Some(spline) = &calibration.terms.spline {
        text.push(format!("\nspline, law over distance: {}", quality(&spline.fit, "positions")));
        text.push(spline_table(spline));
        text.push(spline_use_table(report));
        let [min, max] = spline.valid_distance_m;
        text.push(format!("valid from {min:.3} to {max:.3} m; {}", harmonic(spline)));
    }
    if let Some(floor) = calibration.noise_floor {
        text.push(format!(
            "\nnoise floor: {:.2} DN at {} µs; amplitudes below {:.1} DN are flagged LOW_SIGNAL",
            floor.amplitude_sd_dn, floor.integration_time_us, floor.low_signal_below_dn
        ));
    }
    text.join("\n")
}

fn quality(fit: &FitQuality, points: &str) -> String {
    let percent = |value: f64| format!("{:.2} %", 100.0 * value);
    let held_out = fit.held_out_residual.map_or_else(|| "not determined".to_owned(), percent);
    format!("{} {points}, residual {}, held out {held_out}", fit.points, percent(fit.residual))
}

/// At most a dozen of the table's times, evenly spread, the last among them.
fn lut_table(lut: &Lut) -> String {
    let count = lut.integration_time_us.len();
    let step = count.div_ceil(12).max(1);
    let mut rows = vec![vec!["  t in µs".to_owned(), "S(t)".to_owned()]];
    let shown = (0..count).filter(|i| i % step == 0 || i + 1 == count);
    rows.extend(
        shown.map(|i| vec![format!("  {}", lut.integration_time_us[i]), format!("{:.4}", lut.multiplier[i])]),
    );
    table(&rows)
}

fn decay_table(report: &FitReport) -> String {
    let mut rows = vec![["  t in µs", "positions", "residual", "use"].map(str::to_owned).to_vec()];
    rows.extend(report.decays.iter().map(|(decay, used)| {
        let time = decay.integration_time_us.map_or_else(|| "unknown".to_owned(), |time| time.to_string());
        let residual = used.residual.map_or_else(|| "-".to_owned(), |r| format!("{:.2} %", 100.0 * r));
        let scaling = used.scaling.describe().to_owned();
        vec![format!("  {time}"), decay.points.len().to_string(), residual, scaling]
    }));
    table(&rows)
}

/// The multiplier, and what it is beside the inverse square, at nine distances.
fn spline_table(spline: &Spline) -> String {
    const STEPS: u32 = 8;
    let [min_m, max_m] = spline.valid_distance_m;
    let mut rows = vec![["  d in m", "1/h(d)", "beside (d/d_ref)²"].map(str::to_owned).to_vec()];
    rows.extend((0..=STEPS).map(|step| {
        let distance_m = min_m * (max_m / min_m).powf(f64::from(step) / f64::from(STEPS));
        let multiplier = spline.multiplier(distance_m);
        let beside = multiplier / (distance_m / spline.reference_distance_m).powi(2) - 1.0;
        vec![format!("  {distance_m:.3}"), format!("{multiplier:.4}"), format!("{:+.2} %", 100.0 * beside)]
    }));
    table(&rows)
}

fn spline_use_table(report: &FitReport) -> String {
    let mut rows = vec![["  t in µs", "outliers", "residual", "use"].map(str::to_owned).to_vec()];
    rows.extend(report.spline_uses.iter().map(|used| {
        let time = used.integration_time_us.map_or_else(|| "unknown".to_owned(), |time| time.to_string());
        let residual = used.residual.map_or_else(|| "-".to_owned(), |r| format!("{:.2} %", 100.0 * r));
        let scaling = match used.scaling {
            Scaling::AtReference => "covers the reference distance",
            Scaling::OntoOthers | Scaling::LeftOut => used.scaling.describe(),
        };
        vec![format!("  {time}"), used.outliers.to_string(), residual, scaling.to_owned()]
    }));
    table(&rows)
}

fn harmonic(spline: &Spline) -> String {
    spline.harmonic.map_or_else(
        || "no harmonic".to_owned(),
        |harmonic| {
            let (percent, mhz) =
                (100.0 * harmonic.cosine.hypot(harmonic.sine), harmonic.modulation_frequency_hz / 1e6);
            format!("harmonic at {mhz:.4} MHz: {percent:.2} %")
        },
    )
}
