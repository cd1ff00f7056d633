//! The page of an evaluation: figures, curves, pictures.

use std::path::Path;

use isolux::evaluate::{ComparisonRow, Outcome};
use isolux::{Calibration, Plane, Standardizer};
use isolux_report::page::{
    Axis, Block, Cell, Chart, Colours, Page, Picture, Scale, Section, Series, Stroke, Table,
};

use crate::assess::{Assessment, MeanAtTime, SampleFrame, sample_frames};
use crate::error::PipelineError;
use crate::figures::{chain_heads, chain_rows, direction};
use crate::source::{FrameSource, SourceFacts};

/// Share of the valid pixels that the white end of a grey scale covers.
const WHITE_QUANTILE: f64 = 0.995;

/// A page about one recording; `made_by` names the program that makes it.
#[must_use]
pub fn page(
    facts: &SourceFacts,
    standardizer: &Standardizer,
    calibration: Option<&Calibration>,
    assessment: &Assessment,
    pictures: Vec<Picture>,
    made_by: &str,
) -> Page {
    let unnamed = "an unnamed camera";
    let name = Path::new(&facts.name).file_name();
    let name = name.map_or_else(|| "recording".into(), |name| name.to_string_lossy());
    let camera = facts.info.camera.as_deref().unwrap_or(unnamed);
    let by = calibration.map_or("textbook physics, without a calibration".to_owned(), |calibration| {
        format!("the calibration of {}", calibration.camera.as_deref().unwrap_or(unnamed))
    });
    let frames = assessment.frames;
    Page {
        title: format!("{name}: before and after standardization"),
        lead: format!("{frames} frames of {} by {camera}, standardized with {by}.", facts.shape),
        sections: vec![section("recording", "Before and after", standardizer, assessment, pictures)],
        colophon: format!("Made by isolux {} with {made_by}.", env!("CARGO_PKG_VERSION")),
    }
}

/// The part of a page about one recording; `id` makes its anchors unique.
#[must_use]
pub fn section(
    id: &str,
    title: &str,
    standardizer: &Standardizer,
    assessment: &Assessment,
    pictures: Vec<Picture>,
) -> Section {
    let steps = standardizer
        .steps()
        .iter()
        .map(|step| format!("{}: {} ({})", step.effect, step.term, step.parameters));
    let steps: Vec<String> = steps.collect();
    let steps = if steps.is_empty() { "none".to_owned() } else { steps.join("; ") };
    let mut blocks = vec![Block::Text(format!("Steps: {steps}."))];
    blocks.push(Block::Pictures(pictures));
    if assessment.means.len() > 1 {
        blocks.push(Block::Chart(means_chart(id, assessment)));
    }
    blocks.push(Block::Table(figures_table(id, assessment)));
    if !assessment.rivals.is_empty() {
        blocks.push(Block::Table(chains_table(id, assessment)));
    }
    Section { id: id.to_owned(), title: title.to_owned(), blocks }
}

fn means_chart(id: &str, assessment: &Assessment) -> Chart {
    let series = |name: &str, value: fn(&MeanAtTime) -> f64, stroke| Series {
        name: name.to_owned(),
        points: assessment.means.iter().map(|mean| (mean.time_us / 1000.0, value(mean))).collect(),
        stroke,
    };
    let axis = |label: &str| Axis { label: label.to_owned(), scale: Scale::Log, range: None };
    Chart {
        id: format!("{id}-means"),
        caption: "Mean of the image over the integration time, raw and standardized.".to_owned(),
        alt: "The raw mean rises with the integration time; the standardized mean should be level."
            .to_owned(),
        x: axis("integration time in ms"),
        y: axis("mean amplitude in DN"),
        series: vec![
            series("raw", |mean| mean.before_dn, Stroke::SolidPoints),
            series("standardized", |mean| mean.after_dn, Stroke::SolidPoints),
        ],
        marks: Vec::new(),
    }
}

fn figures_table(id: &str, assessment: &Assessment) -> Table {
    let columns = ["figure", "unit", "before", "after", "better", "valid before in %", "valid after in %"];
    Table {
        id: format!("{id}-figures"),
        caption: "Figures before and after, with the share of the values behind each.".to_owned(),
        columns: columns.map(str::to_owned).to_vec(),
        rows: assessment.comparison.rows().iter().map(figure_row).collect(),
    }
}

fn figure_row(row: &ComparisonRow) -> Vec<Cell> {
    let (unit, factor, decimals) = match row.unit {
        "ratio" => ("%", 100.0, 2),
        unit => (unit, 1.0, 3),
    };
    let value = |value: &Outcome<f64>| match value {
        Ok(value) => Cell::Number { value: factor * value, decimals },
        Err(reason) => Cell::Missing(reason.to_string()),
    };
    let share = |share: Option<f64>| match share {
        Some(share) => Cell::Number { value: 100.0 * share, decimals: 1 },
        None => Cell::Missing("not applicable".to_owned()),
    };
    vec![
        Cell::Text(row.metric.clone()),
        Cell::Text(unit.to_owned()),
        value(&row.before),
        value(&row.after),
        Cell::Text(direction(row.better).to_owned()),
        share(row.before_valid_fraction),
        share(row.after_valid_fraction),
    ]
}

/// Some frames before and after; all raw ones on one grey scale, all standardized ones on another.
///
/// # Errors
/// Those of [`sample_frames`].
pub fn pictures(
    recording: &mut dyn FrameSource,
    standardizer: &Standardizer,
    indices: &[usize],
    id: &str,
) -> Result<Vec<Picture>, PipelineError> {
    let frames = sample_frames(recording, standardizer, indices)?;
    let mut pictures = row(id, "Raw", &frames, |frame| &frame.raw);
    pictures.extend(row(id, "Standardized", &frames, |frame| &frame.standardized));
    Ok(pictures)
}

fn row(id: &str, kind: &str, frames: &[SampleFrame], plane: fn(&SampleFrame) -> &Plane<f32>) -> Vec<Picture> {
    let (white, lower) = (white_level(frames.iter().map(plane)), kind.to_lowercase());
    let picture = |(place, frame): (usize, &SampleFrame)| {
        let time = match frame.integration_time_us {
            Some(time_us) => format!("{} ms", time_us / 1000.0),
            None => format!("frame {}", frame.index),
        };
        Picture {
            id: format!("{id}-{lower}-{place}"),
            caption: format!("{kind}, {time}"),
            alt: format!("{kind} amplitude at {time}"),
            values: plane(frame).clone(),
            range: (0.0, white),
            label: format!("{lower} amplitude in DN"),
            colours: Colours::Grey,
        }
    };
    frames.iter().enumerate().map(picture).collect()
}

/// The chosen chain beside its rivals.
fn chains_table(id: &str, assessment: &Assessment) -> Table {
    let cells = |cells: Vec<String>| cells.into_iter().map(Cell::Text).collect();
    Table {
        id: format!("{id}-beside"),
        caption: "The same frames by the textbook's chain (A d²/t), the paper's and the chosen one; in brackets the \
                  share of the values behind each figure."
            .to_owned(),
        columns: chain_heads(assessment),
        rows: chain_rows(assessment).into_iter().map(|row| cells(row.cells)).collect(),
    }
}

/// The value below which nearly all valid pixels lie; 1 where there are none.
fn white_level<'a>(planes: impl Iterator<Item = &'a Plane<f32>>) -> f32 {
    let valid = planes.flat_map(|plane| plane.values()).filter(|value| value.is_finite());
    let mut values: Vec<f64> = valid.map(|&value| f64::from(value)).collect();
    isolux::statistics::quantile(&mut values, WHITE_QUANTILE).filter(|level| *level > 0.0).unwrap_or(1.0)
        as f32
}
