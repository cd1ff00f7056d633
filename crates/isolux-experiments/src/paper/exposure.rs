//! Figures 1 to 3: mean amplitudes over the integration time, the part that makes the table, and how image
//! regions differ.

use isolux_report::page::{Axis, Block, Chart, Claim, Mark, MarkAxis, Scale, Section, Series, Stroke};

use super::parts::{axis, verdict};
use crate::error::ExperimentError;
use crate::paper::lab::Lab;

/// End of the table in the paper, ms.
const PAPER_END_MS: f64 = 27.2;
/// Two of the simulated wall's means lie this close near the peak, so that noise moves it by a few registers.
const END_TOLERANCE_MS: f64 = 1.5;

/// The section of figures 1 to 3.
///
/// # Errors
/// None so far.
pub(super) fn section(lab: &Lab) -> Result<Section, ExperimentError> {
    Ok(Section {
        id: "exposure".to_owned(),
        title: "Figures 1–3: integration time".to_owned(),
        blocks: vec![
            Block::Quote {
                text: "Amplitudes grow with the integration time, ever more slowly, until all bins are saturated and the \
                       amplitude collapses. Above 27.2 ms (register 135) the means cannot be used for the table."
                    .to_owned(),
                source: "section 2.1, figures 1 and 2".to_owned(),
            },
            Block::Text(
                "A white wall, registers 0 to 255 in steps of 200 µs, 50 frames skipped after each change, windows of \
                 20×20 pixels."
                    .to_owned(),
            ),
            Block::Chart(figure_1(lab)),
            Block::Chart(figure_2(lab)),
            Block::Chart(figure_3(lab)),
            Block::Claims(claims(lab)),
        ],
    })
}

fn figure_1(lab: &Lab) -> Chart {
    let series = lab.wall.regions.iter().map(|region| Series {
        name: region.name.to_owned(),
        points: milliseconds(&lab.wall.times_us, &region.means_dn),
        stroke: Stroke::Solid,
    });
    Chart {
        id: "fig-1".to_owned(),
        caption: "Figure 1. Mean amplitude over the integration time, whole image and windows.".to_owned(),
        alt: "Four curves rise almost linearly, bend, peak and collapse; the centre first, the corner last."
            .to_owned(),
        x: time_axis(),
        y: axis("mean amplitude in DN", Scale::Linear),
        series: series.collect(),
        marks: vec![end_mark(lab)],
    }
}

fn figure_2(lab: &Lab) -> Chart {
    let end_us = end_us(lab);
    let whole = milliseconds(&lab.wall.times_us, &lab.wall.regions[0].means_dn);
    let used = whole.iter().copied().filter(|(time_ms, _)| *time_ms <= end_us / 1000.0).collect();
    Chart {
        id: "fig-2".to_owned(),
        caption: "Figure 2. The part of the whole image's curve that makes the table: up to its peak."
            .to_owned(),
        alt: "The curve of the whole image from 0.2 ms to its peak near 27 ms.".to_owned(),
        x: time_axis(),
        y: axis("mean amplitude in DN", Scale::Linear),
        series: vec![Series { name: "whole image".to_owned(), points: used, stroke: Stroke::SolidPoints }],
        marks: vec![end_mark(lab)],
    }
}

fn figure_3(lab: &Lab) -> Chart {
    let end_us = end_us(lab);
    let series = lab.wall.regions.iter().map(|region| {
        let at_reference = at_reference(lab, &region.means_dn);
        let used = lab.wall.times_us.iter().zip(&region.means_dn).filter(|(time_us, _)| **time_us <= end_us);
        let points = used.map(|(time_us, mean)| (time_us / 1000.0, mean / at_reference)).collect();
        Series { name: region.name.to_owned(), points, stroke: Stroke::Solid }
    });
    Chart {
        id: "fig-3".to_owned(),
        caption: "Figure 3. The curves normalized at 8.2 ms: regions saturate at different times, so one scalar is a \
                  compromise."
            .to_owned(),
        alt: "Normalized curves coincide up to about 12 ms, then fan out; the centre bends first.".to_owned(),
        x: time_axis(),
        y: axis("amplitude relative to 8.2 ms", Scale::Linear),
        series: series.collect(),
        marks: Vec::new(),
    }
}

fn claims(lab: &Lab) -> Vec<Claim> {
    let end_ms = end_us(lab) / 1000.0;
    let whole = &lab.wall.regions[0].means_dn;
    let peak = whole.iter().copied().fold(0.0, f64::max);
    let last = whole.last().copied().unwrap_or(f64::NAN) / peak;
    let spread = regional_spread(lab);
    vec![
        Claim {
            id: "over-saturation-ends-the-range".to_owned(),
            statement: "Over-saturation ends the usable range at 27.2 ms.".to_owned(),
            measured: format!(
                "The mean of the whole image peaks at {end_ms:.1} ms and has fallen to {:.0} % of the peak at 51.2 ms.",
                100.0 * last
            ),
            value: end_ms,
            verdict: verdict(
                (end_ms - PAPER_END_MS).abs() <= END_TOLERANCE_MS && last < 0.5,
                "the peak lies elsewhere",
            ),
        },
        Claim {
            id: "one-scalar-is-a-compromise".to_owned(),
            statement: "Saturation differs within the image, so a single scalar per time is a compromise."
                .to_owned(),
            measured: format!(
                "At the end of the table the normalized curves of centre and corner differ by {:.0} %.",
                100.0 * spread
            ),
            value: spread,
            verdict: verdict(spread > 0.05, "the regions agree"),
        },
    ]
}

/// Relative difference of the regions' normalized curves at the end of the table.
fn regional_spread(lab: &Lab) -> f64 {
    let end_us = end_us(lab);
    let Some(end) = lab.wall.times_us.iter().position(|time_us| *time_us == end_us) else { return f64::NAN };
    let normalized =
        lab.wall.regions.iter().map(|region| region.means_dn[end] / at_reference(lab, &region.means_dn));
    let (low, high) =
        normalized.fold((f64::INFINITY, 0.0f64), |(low, high), value| (low.min(value), high.max(value)));
    high / low - 1.0
}

/// End of the fitted table, µs.
fn end_us(lab: &Lab) -> f64 {
    lab.calibration.terms.lut.as_ref().map_or(f64::NAN, |lut| lut.valid_integration_time_us[1])
}

fn at_reference(lab: &Lab, means_dn: &[f64]) -> f64 {
    let reference_us = lab.calibration.reference.integration_time_us.unwrap_or(f64::NAN);
    let index = lab.wall.times_us.iter().position(|time_us| *time_us == reference_us);
    index.map_or(f64::NAN, |index| means_dn[index])
}

fn milliseconds(times_us: &[f64], values: &[f64]) -> Vec<(f64, f64)> {
    times_us.iter().zip(values).map(|(time_us, value)| (time_us / 1000.0, *value)).collect()
}

fn time_axis() -> Axis {
    axis("integration time in ms", Scale::Linear)
}

fn end_mark(lab: &Lab) -> Mark {
    Mark { axis: MarkAxis::X, at: end_us(lab) / 1000.0, label: "end of the table".to_owned() }
}
