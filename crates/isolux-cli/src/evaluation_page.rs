//! The page of an evaluation: figures, curves, pictures.

use isolux::evaluate::ComparisonRow;
use isolux::{Calibration, Frame, IntegrationTime, Plane, Standardized, Standardizer};
use isolux_io::{Metadata, Recording};
use isolux_report::page::{
    Axis, Block, Cell, Chart, Colours, Page, Picture, Scale, Section, Series, Stroke, Table,
};

use crate::assessment::Assessment;
use crate::chain::Chain;
use crate::failure::{Failure, Outcome};

/// Share of the valid pixels that the white end of a grey scale covers.
const WHITE_QUANTILE: f64 = 0.995;

/// A page about one recording.
pub(crate) fn page(
    metadata: &Metadata,
    standardizer: &Standardizer,
    calibration: Option<&Calibration>,
    assessment: &Assessment,
    pictures: Vec<Picture>,
) -> Page {
    let name = metadata.path.file_name().map_or_else(|| "recording".into(), |name| name.to_string_lossy());
    let camera = metadata.info.camera.as_deref().unwrap_or("an unnamed camera");
    let by = calibration.map_or("textbook physics, without a calibration".to_owned(), |calibration| {
        format!("the calibration of {}", calibration.camera.as_deref().unwrap_or("an unnamed camera"))
    });
    Page {
        title: format!("{name}: before and after standardization"),
        lead: format!(
            "{} frames of {} by {camera}, standardized with {by}.",
            metadata.frame_count.map_or("an unknown number of".to_owned(), |count| count.to_string()),
            metadata.shape
        ),
        sections: vec![section("recording", "Before and after", standardizer, assessment, pictures)],
        colophon: format!("Made by isolux {} with `isolux evaluate`.", env!("CARGO_PKG_VERSION")),
    }
}

/// The part of a page about one recording; `id` makes its anchors unique.
pub(crate) fn section(
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
        blocks.push(Block::Table(crate::beside::page_table(id, assessment)));
    }
    Section { id: id.to_owned(), title: title.to_owned(), blocks }
}

fn means_chart(id: &str, assessment: &Assessment) -> Chart {
    let series = |name: &str, value: fn(&crate::assessment::MeanAtTime) -> f64, stroke| Series {
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
    let value = |value: &isolux::evaluate::Outcome<f64>| match value {
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
        Cell::Text(crate::cmd::evaluate::direction(row.better).to_owned()),
        share(row.before_valid_fraction),
        share(row.after_valid_fraction),
    ]
}

/// Some frames before and after; all raw ones on one grey scale, all standardized ones on another.
pub(crate) fn pictures(
    recording: &mut dyn Recording,
    standardizer: &Standardizer,
    indices: &[usize],
    id: &str,
) -> Outcome<Vec<Picture>> {
    let metadata = recording.metadata().clone();
    let (mut frame, mut out) = (Frame::new(metadata.shape), Standardized::new(metadata.shape));
    let mut chain = Chain::new(standardizer);
    let mut smoothed = chain.smoothed();
    let (mut raw, mut standardized) = (Vec::new(), Vec::new());
    for &index in indices {
        let wanted = standardizer.needed() | isolux::Channels::INTEGRATION_TIME;
        chain.read_alone(recording, index, wanted, &mut frame)?;
        chain
            .standardize(&frame, &mut smoothed, &mut out)
            .map_err(|error| Failure::frame(&metadata.path, index, error))?;
        let time = match &frame.integration_time_us {
            IntegrationTime::PerFrame(time_us) => format!("{} ms", time_us / 1000.0),
            _ => format!("frame {index}"),
        };
        raw.push((time.clone(), measured(&frame)));
        standardized.push((time, out.amplitude.clone()));
    }
    let row = |kind: &str, frames: Vec<(String, Plane<f32>)>| {
        let white = white_level(frames.iter().map(|(_, plane)| plane));
        let picture = move |(index, (time, values)): (usize, (String, Plane<f32>))| Picture {
            id: format!("{id}-{}-{index}", kind.to_lowercase()),
            caption: format!("{kind}, {time}"),
            alt: format!("{kind} amplitude at {time}"),
            values,
            range: (0.0, white),
            label: format!("{} amplitude in DN", kind.to_lowercase()),
            colours: Colours::Grey,
        };
        frames.into_iter().enumerate().map(picture).collect::<Vec<_>>()
    };
    let mut pictures = row("Raw", raw);
    pictures.extend(row("Standardized", standardized));
    Ok(pictures)
}

/// The raw amplitude, NaN where it is no measurement.
fn measured(frame: &Frame) -> Plane<f32> {
    let mut plane = frame.amplitude.clone();
    for (index, value) in plane.values_mut().iter_mut().enumerate() {
        if !frame.is_valid(index) {
            *value = f32::NAN;
        }
    }
    plane
}

/// The value below which nearly all valid pixels lie; 1 where there are none.
fn white_level<'a>(planes: impl Iterator<Item = &'a Plane<f32>>) -> f32 {
    let valid = planes.flat_map(|plane| plane.values()).filter(|value| value.is_finite());
    let mut values: Vec<f64> = valid.map(|&value| f64::from(value)).collect();
    isolux::statistics::quantile(&mut values, WHITE_QUANTILE).filter(|level| *level > 0.0).unwrap_or(1.0)
        as f32
}
