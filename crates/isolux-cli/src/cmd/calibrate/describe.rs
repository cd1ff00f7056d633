//! What a fit found, in words and tables.

use isolux::Calibration;
use isolux::calibrate::{FitReport, Verdict};
use isolux::terms::cubic::Scaling;
use isolux::terms::{FitQuality, Lut, Response, Spline};

use super::{scenes, targets};
use crate::terminal::table;

/// The fit, for a person to judge.
pub(crate) fn describe(calibration: &Calibration, report: &FitReport) -> String {
    let mut text = vec![
        Verdict::of(calibration, report).to_string(),
        format!("camera: {}", calibration.camera.as_deref().unwrap_or("(not named)")),
    ];
    if let Some(lut) = &calibration.terms.lut {
        text.push(format!("\nlut, multiplier over integration time: {}", quality(&lut.fit, "times")));
        text.push(lut_table(lut));
        let [min, max] = lut.valid_integration_time_us;
        let end = if report.exposure_curves.is_empty() { "" } else { " (peak of the mean amplitude)" };
        text.push(format!("valid from {min} to {max} µs{end}"));
    }
    if let Some(response) = &calibration.terms.response {
        text.push("\nresponse, compression by the fill of each pixel, by tier of evidence:".to_owned());
        text.push(response_table(response));
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
        let points = if report.spline_uses.is_empty() { "observations" } else { "positions" };
        text.push(format!("\nspline, law over distance: {}", quality(&spline.fit, points)));
        text.push(spline_table(spline));
        if !report.spline_uses.is_empty() {
            text.push(spline_use_table(report));
        }
        let [min, max] = spline.law.valid_distance_m;
        text.push(format!("valid from {min:.3} to {max:.3} m; {}", harmonic(spline)));
    }
    if let Some(profile) = &calibration.terms.profile {
        text.push(format!("\nprofile, over the image: {}", quality(&profile.fit, "observations")));
        text.push(targets::profile(profile));
    }
    if let Some(angle) = &calibration.terms.angle {
        text.push(format!("\nangle, over the angle of incidence: {}", quality(&angle.fit, "observations")));
        text.push(targets::angle(angle));
    }
    if let Some(report) = &report.target {
        text.push(targets::report(report));
    }
    if let Some(report) = &report.scene {
        text.push(scenes::report(report));
    }
    if let Some(floor) = calibration.noise_floor {
        text.push(format!(
            "\nnoise floor: {:.2} DN at {} µs; amplitudes below {:.1} DN are flagged LOW_SIGNAL",
            floor.amplitude_sd_dn, floor.integration_time_us, floor.low_signal_below_dn
        ));
    }
    if let Some(noise) = &calibration.terms.noise {
        text.push(format!("\nnoise, variance of the amplitude: {}", quality(&noise.fit, "groups of pixels")));
        let by = noise.by_amplitude;
        text.push(format!(
            "{:.3} DN² + {:.4} DN² per DN of amplitude + {:.3e} DN² per µs",
            by.read_variance_dn2, by.shot_variance_dn2_per_dn, by.ambient_variance_dn2_per_us
        ));
        if let Some(by) = noise.by_intensity {
            let (read, shot) = (by.read_variance_dn2, by.shot_variance_dn2_per_dn);
            text.push(format!("with intensity: {read:.3} DN² + {shot:.4} DN² per DN of intensity"));
        }
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

/// One row for each tier.
fn response_table(response: &Response) -> String {
    let mut rows =
        vec![["  tier", "full well", "softness", "valid up to", "quality"].map(str::to_owned).to_vec()];
    let mut row = |tier: &str, full: String, softness: Option<f64>, valid: String, fit: &FitQuality| {
        let softness = softness.map_or_else(|| "-".to_owned(), |softness| format!("{softness:.2}"));
        rows.push(vec![format!("  {tier}"), full, softness, valid, quality(fit, "points")]);
    };
    let dn = |value: f64| format!("{value:.0} DN");
    if let Some(tier) = &response.scalar {
        let full = format!("after {:.0} µs", tier.full_well_time_us);
        let valid = format!("{} µs", tier.valid_integration_time_us[1]);
        row("scalar", full, Some(tier.softness), valid, &tier.fit);
    }
    if let Some(tier) = &response.amplitude {
        let full =
            format!("curve, bends at {} amplitudes", tier.increment.iter().filter(|c| **c > 0.0).count());
        row("amplitude", full, None, dn(tier.largest_dn), &tier.fit);
    }
    if let Some(tier) = &response.pixel {
        let taus = tier.full_well_time_us.iter().flatten();
        let full = format!("map, {} of {} pixels compressed", taus.flatten().count(), tier.shape().pixels());
        row(
            "pixel (that scene)",
            full,
            Some(tier.softness),
            format!("fill {:.2}", tier.largest_fill),
            &tier.fit,
        );
    }
    if let Some(tier) = &response.ambient {
        // Only the well over the charge per amplitude is measured.
        let full = format!("{:.0} DN of amplitude", tier.full_well_dn / tier.own_charge);
        let [min_m, max_m] = tier.law.valid_distance_m;
        row("ambient", full, Some(tier.softness), format!("{min_m:.2} to {max_m:.2} m"), &tier.fit);
    }
    if let Some(tier) = &response.intensity {
        row(
            "intensity",
            dn(tier.well.full_well_dn),
            Some(tier.well.softness),
            dn(tier.largest_dn),
            &tier.fit,
        );
    }
    if let Some(tier) = &response.phase_samples {
        row(
            "phase_samples",
            dn(tier.well.full_well_dn),
            Some(tier.well.softness),
            dn(tier.largest_dn),
            &tier.fit,
        );
    }
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
    let [min_m, max_m] = spline.law.valid_distance_m;
    let mut rows = vec![["  d in m", "1/h(d)", "beside (d/d_ref)²"].map(str::to_owned).to_vec()];
    rows.extend((0..=STEPS).map(|step| {
        let distance_m = min_m * (max_m / min_m).powf(f64::from(step) / f64::from(STEPS));
        let multiplier = spline.multiplier(distance_m);
        let beside = multiplier / (distance_m / spline.law.reference_distance_m).powi(2) - 1.0;
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
    spline.law.harmonic.map_or_else(
        || "no harmonic".to_owned(),
        |harmonic| {
            let (percent, mhz) =
                (100.0 * harmonic.cosine.hypot(harmonic.sine), harmonic.modulation_frequency_hz / 1e6);
            format!("harmonic at {mhz:.4} MHz: {percent:.2} %")
        },
    )
}
