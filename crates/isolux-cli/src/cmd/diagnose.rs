//! `isolux diagnose`: is it already corrected, and what does the vendor's scaling do?

use isolux::diagnose::{
    Diagnosis, Effect, Estimate, Evidence, Finding, MaterialFit, Outcome as Told, Scaling, State,
};
use isolux_pipeline::diagnose;
use serde_json::json;

use crate::advice;
use crate::failure::Outcome;
use crate::options::DiagnoseArgs;
use crate::terminal::{self, Terminal, table};

/// Longest line of running text.
const COLUMNS: usize = 100;
/// Name of a line of the table.
const DISTANCE: &str = "distance d";
/// Targets and integration times that are listed, at most.
const LISTED: usize = 4;

pub(crate) fn run(args: &DiagnoseArgs) -> Outcome {
    let mut recording = isolux_io::open(&args.recording)?;
    let diagnosis = diagnose(&mut recording, &Terminal::default())?;
    let (path, camera) = (args.recording.display().to_string(), recording.metadata().info.camera.clone());
    if args.json {
        let verdict = diagnosis.headline();
        let told = json!({"recording": path, "camera": camera, "verdict": verdict, "diagnosis": diagnosis});
        return terminal::print_json(&told);
    }
    let camera = camera.map_or_else(String::new, |camera| format!(", {camera}"));
    terminal::print(format!("{path}{camera}, {} frames\n\n{}", diagnosis.frames, describe(&diagnosis)))
}

/// Words first, then the figures, then what cannot be told.
fn describe(diagnosis: &Diagnosis) -> String {
    let mut parts = vec![format!("verdict: {}", diagnosis.headline())];
    let told = |finding: &Finding| wrapped(&advice::with(finding, finding.advice()), "  ");
    parts.extend(diagnosis.findings.iter().map(told));
    parts.push(String::new());
    parts.push(effects(diagnosis));
    parts.extend(by_amplitude(diagnosis));
    parts.extend(by_distance(diagnosis));
    if let Ok(scaling) = diagnosis.phase_samples.as_ref()
        && !(scaling.exact && diagnosis.findings.contains(&Finding::EqualsPhaseSamples))
    {
        parts.push(format!("\namplitude / eq. 1 of the phase samples\n{}", describe_scaling(scaling)));
    }
    if let Ok(scaling) = &diagnosis.vendor_scaling {
        parts.push(format!(
            "\nthe vendor's scaling, vendor_amplitude / amplitude\n{}",
            describe_scaling(scaling)
        ));
    }
    parts.extend(unavailable(diagnosis));
    parts.join("\n")
}

/// What is not told, each reason once.
fn unavailable(diagnosis: &Diagnosis) -> Option<String> {
    let mut reasons: Vec<(Vec<&str>, String)> = Vec::new();
    for (what, why) in diagnosis.unavailable() {
        let why = why.to_string();
        match reasons.iter_mut().find(|(_, known)| *known == why) {
            Some((names, _)) => names.push(what),
            None => reasons.push((vec![what], why)),
        }
    }
    let line = |(names, why): &(Vec<&str>, String)| wrapped(&format!("{}: {why}", names.join(", ")), "  ");
    let lines: Vec<String> = reasons.iter().map(line).collect();
    (!lines.is_empty()).then(|| format!("\nwhat this recording cannot tell\n{}", lines.join("\n")))
}

/// Breaks a paragraph at spaces; the lines after the first are indented twice.
fn wrapped(text: &str, indent: &str) -> String {
    let twice = indent.repeat(2);
    let options = textwrap::Options::new(COLUMNS)
        .initial_indent(indent)
        .subsequent_indent(&twice)
        .break_words(false)
        .word_separator(textwrap::WordSeparator::AsciiSpace)
        .word_splitter(textwrap::WordSplitter::NoHyphenation)
        .wrap_algorithm(textwrap::WrapAlgorithm::FirstFit);
    textwrap::fill(text, options)
}

/// Three decimals, without the sign of a negative zero.
fn decimal(value: f64) -> String {
    let text = format!("{value:.3}");
    if text == "-0.000" { "0.000".to_owned() } else { text }
}

fn interval(estimate: &Estimate) -> String {
    format!("{} to {}", decimal(estimate.low_95), decimal(estimate.high_95))
}

/// The exponents of the amplitude.
fn effects(diagnosis: &Diagnosis) -> String {
    let header =
        ["amplitude goes with", "exponent", "95 % interval", "raw", "state", "residual", "values", "from"];
    let mut rows = vec![header.map(str::to_owned).to_vec()];
    let curve = diagnosis.findings.iter().any(|finding| matches!(finding, Finding::DistanceCurve { .. }));
    let mut push = |name: &str, raw: &str, effect: &Told<Effect>| {
        let Ok(effect) = effect else { return };
        let from = match effect.evidence {
            Evidence::StillPixels => "same pixels".to_owned(),
            Evidence::Target { label } => format!("target {label}"),
            Evidence::VendorReflectivity => "one vendor reflectivity".to_owned(),
        };
        rows.push(vec![
            name.to_owned(),
            decimal(effect.exponent.value),
            interval(&effect.exponent),
            raw.to_owned(),
            if curve && name == DISTANCE { "no single power" } else { state(effect.state) }.to_owned(),
            format!("{:.1} %", 100.0 * effect.residual),
            effect.observations.to_string(),
            from,
        ]);
    };
    push("integration time t", "1", &diagnosis.time);
    push(DISTANCE, "-2", &diagnosis.distance);
    push("r² (log per half diagonal²)", "< 0", &diagnosis.radius);
    if let Ok(mixed) = &diagnosis.material.mixed {
        rows.extend(mixed_rows(diagnosis, mixed));
    }
    let valid = diagnosis.values.map_or(0.0, |values| values.valid_fraction);
    format!("{}\nvalid pixels: {:.1} %", table(&rows), 100.0 * valid)
}

fn state(state: State) -> &'static str {
    match state {
        State::Present => "in it",
        State::Removed => "gone",
        State::Reduced => "part of it",
        State::Exaggerated => "too much",
        State::Reversed => "reversed",
        State::Undetermined => "undetermined",
    }
}

/// What a regression over all pixels finds, where nothing better is known.
fn mixed_rows(diagnosis: &Diagnosis, mixed: &MaterialFit) -> Vec<Vec<String>> {
    let lines = [
        ("  t, all materials mixed", diagnosis.time.is_err(), &mixed.time),
        ("  d, all materials mixed", diagnosis.distance.is_err(), &mixed.distance),
        ("  r², all materials mixed", diagnosis.radius.is_err(), &mixed.radius),
    ];
    let line = |(name, wanted, exponent): (&str, bool, &Told<Estimate>)| {
        let exponent = exponent.as_ref().ok().filter(|_| wanted)?;
        Some(vec![
            name.to_owned(),
            decimal(exponent.value),
            interval(exponent),
            "-".to_owned(),
            "no verdict".to_owned(),
            format!("{:.1} %", 100.0 * mixed.residual),
            mixed.observations.to_string(),
            "all pixels".to_owned(),
        ])
    };
    lines.into_iter().filter_map(line).collect()
}

fn by_amplitude(diagnosis: &Diagnosis) -> Option<String> {
    let bands = &diagnosis.still_pixels.as_ref().ok()?.bands;
    let words: Vec<String> = bands
        .iter()
        .map(|band| format!("{:.2} near {:.0} DN", band.exponent.value, band.amplitude_dn))
        .collect();
    (!words.is_empty()).then(|| format!("exponent of t by amplitude: {}", words.join(", ")))
}

/// The exponent of d within ranges: a curve that is no power shows here.
fn by_distance(diagnosis: &Diagnosis) -> Option<String> {
    let material = &diagnosis.material;
    let mut targets: Vec<&MaterialFit> =
        material.targets.iter().filter(|target| target.distance.is_ok()).collect();
    targets.sort_by(|a, b| a.residual.total_cmp(&b.residual));
    let mut lines: Vec<String> = targets.iter().take(LISTED).map(|target| target_line(target)).collect();
    if targets.len() > LISTED {
        lines
            .push(format!("and {} targets more, with larger residuals (see --json)", targets.len() - LISTED));
    }
    if material.targets.is_empty()
        && let Ok(fit) = &material.vendor_reflectivity
    {
        lines.push(format!("exponent of d by range: {}", ranges(&fit.by_distance)));
        lines.push(
            "Pixels of one vendor amplitude count as one material, on the vendor's word: true where it is a\n\
             reflectivity, as lidars report."
                .to_owned(),
        );
    }
    (!lines.is_empty()).then(|| lines.join("\n"))
}

fn target_line(target: &MaterialFit) -> String {
    let label = target.label.unwrap_or(0);
    let number = |told: &Told<Estimate>| told.as_ref().map_or("-".to_owned(), |e| format!("{:.2}", e.value));
    let d = number(&target.distance);
    let residual = 100.0 * target.residual;
    let ranges = ranges(&target.by_distance);
    format!("target {label}: d^{d}, residual {residual:.1} %; by range: {ranges}")
}

fn ranges(by_distance: &[isolux::diagnose::RangeExponent]) -> String {
    if by_distance.is_empty() {
        return "too few pixels".to_owned();
    }
    let range = |r: &isolux::diagnose::RangeExponent| {
        format!("{:.2} at {:.2} to {:.2} m", r.exponent.value + 0.0, r.from_m, r.to_m)
    };
    by_distance.iter().map(range).collect::<Vec<_>>().join(", ")
}

fn describe_scaling(scaling: &Scaling) -> String {
    let header = ["goes with", "exponent", "95 % interval", "a full correction has"];
    let mut rows = vec![header.map(str::to_owned).to_vec()];
    let mut push = |name: &str, full: &str, estimate: &Estimate| {
        let value = decimal(estimate.value);
        rows.push(vec![name.to_owned(), value, interval(estimate), full.to_owned()]);
    };
    scaling.gamma.iter().for_each(|gamma| push("eq. 1 itself (gamma)", "1", gamma));
    scaling.time.iter().for_each(|time| push("integration time t", "-1", time));
    scaling.distance.iter().for_each(|distance| push("distance d", "2", distance));
    if let Ok(radial) = &scaling.radial {
        let names = ["r²", "r⁴", "r⁶"];
        names.iter().zip(&radial.coefficients).for_each(|(name, c)| push(name, "-", c));
        push("factor at r = 1 (corner)", "-", &radial.corner_factor);
    }
    let mut lines = vec![table(&rows)];
    if let [groups @ .., last] = scaling.time_groups.as_slice()
        && !groups.is_empty()
    {
        let longest = last.time_us;
        let of = |g: &isolux::diagnose::TimeGroup| {
            format!("{:.2} at {} µs (time ratio {:.2})", g.ratio, g.time_us, longest / g.time_us)
        };
        let words = groups.iter().take(LISTED).map(of).collect::<Vec<_>>().join(", ");
        let more = if groups.len() > LISTED { ", ..." } else { "" };
        lines.push(format!("factor relative to that at {longest} µs: {words}{more}"));
    }
    if scaling.by_distance.len() > 1 {
        lines.push(format!("exponent of d by range: {}", ranges(&scaling.by_distance)));
    }
    lines.push(format!(
        "residual {:.2} % (root mean square {:.2} %), {:.1} % of the valid pixels",
        100.0 * scaling.residual,
        100.0 * scaling.residual_rms,
        100.0 * scaling.used_fraction
    ));
    if scaling.exact {
        lines.push("The residual is mere rounding: one image was computed from the other.".to_owned());
    }
    lines.join("\n")
}
