//! Figures 4, 5 and 10: the decay over the distance, turned over and pooled under one cubic, and scaled by it.

mod claims;
mod curves;
mod rician;

use isolux::calibrate::{DistanceWarning, FitWarning};
use isolux_report::page::{Block, Chart, Mark, MarkAxis, Scale, Section, Series, Stroke, Table};

use super::parts::{axis, number, quote, text};
use crate::error::ExperimentError;
use crate::paper::lab::{BoardMean, Lab};
use curves::{
    Curve, FLAT_WITHIN, STRAY_US, cubic, curves, median, multiplier, reference_amplitude_dn, time_multiplier,
};

/// The section of figures 4, 5 and 10.
///
/// # Errors
/// [`ExperimentError`] when a single decay has no cubic of its own.
pub(super) fn section(lab: &Lab) -> Result<Section, ExperimentError> {
    let curves = curves(lab)?;
    let claims = claims::claims(lab, &curves)?;
    Ok(Section {
        id: "distance".to_owned(),
        title: "Figures 4, 5 and 10: distance".to_owned(),
        blocks: vec![
            quote(
                "The decay over the distance is recorded at several integration times, each from where \
                 over-saturation ends. Inverted and normalized at 750 mm, a cubic is fitted to each, and a second \
                 one through all valid points is the scaling. 0.2 ms is left out: it deviates strongly, and its \
                 distances are not reliable.",
                "section 2.2, figures 4 and 5",
            ),
            Block::Text(
                "A white board at 26 distances from 0.3 to 3 m, six integration times, three frames each after 50 \
                 skipped, means over the central window of 20×20 pixels. A position where any bin is expected at \
                 its hard clip is not recorded at that integration time; of those recorded, a curve starts at its \
                 brightest, as what lies nearer is over-saturated."
                    .to_owned(),
            ),
            Block::Chart(figure_4(&curves)),
            Block::Chart(figure_5(lab, &curves)?),
            Block::Text(why_left_out(lab)),
            quote(
                "The reference decay, scaled, is flat; with the integration time scaled too (dashed), the curves \
                 lie together about 0.5.",
                "section 3, figure 10",
            ),
            Block::Chart(figure_10(lab, &curves)?),
            Block::Chart(flatness(lab, &curves)?),
            Block::Table(table(lab, &curves)?),
            Block::Claims(claims),
        ],
    })
}

fn figure_4(curves: &[Curve]) -> Chart {
    let series = curves.iter().map(|curve| Series {
        name: curve.name(),
        points: curve.points.iter().map(|point| (point.distance_m, point.amplitude_dn)).collect(),
        stroke: Stroke::SolidPoints,
    });
    Chart {
        id: "fig-4".to_owned(),
        caption: "Figure 4. Mean amplitude over the mean measured distance, by integration time, each curve from \
                  where over-saturation ends."
            .to_owned(),
        alt: "Six curves fall with the distance, about as its inverse square. The longer the integration time, the \
              higher the curve and the farther away it starts."
            .to_owned(),
        x: axis("measured distance in m", Scale::Linear),
        y: axis("mean amplitude in DN", Scale::Linear),
        series: series.collect(),
        marks: Vec::new(),
    }
}

fn figure_5(lab: &Lab, curves: &[Curve]) -> Result<Chart, ExperimentError> {
    let pooled = cubic(lab)?;
    let mut series = Vec::new();
    for curve in curves {
        let inverse = |point: &BoardMean| (point.distance_m, curve.inverse(point));
        let points = curve.points.iter().map(inverse).collect();
        series.push(Series { name: curve.name(), points, stroke: Stroke::Points });
    }
    let mut own = Vec::new();
    for curve in curves {
        let on_cubic = |point: &BoardMean| (point.distance_m, curve.own_cubic(point.distance_m));
        own.extend(curve.points.iter().map(on_cubic));
        own.push((f64::NAN, f64::NAN));
    }
    series.push(Series { name: "cubic of each".to_owned(), points: own, stroke: Stroke::Solid });
    series.push(Series {
        name: "pooled cubic".to_owned(),
        points: steps(pooled.valid_distance_m)
            .map(|distance_m| (distance_m, multiplier(pooled, distance_m)))
            .collect(),
        stroke: Stroke::Dashed,
    });
    if let Some(stray) = curves.iter().find(|curve| curve.integration_time_us == STRAY_US) {
        let expected = claims::expected_stray(lab, curves, stray)?;
        let point = |(at, dn): (&BoardMean, f64)| (at.true_distance_m, stray.reference_dn / dn);
        series.push(Series {
            name: format!("{}, expected from the noise floor", stray.name()),
            points: stray.points.iter().zip(expected).map(point).collect(),
            stroke: Stroke::Dashed,
        });
    }
    Ok(Chart {
        id: "fig-5".to_owned(),
        caption: "Figure 5. Inverted and normalized at 750 mm: the points of every integration time, each with a \
                  cubic of its own, the pooled cubic, and what noise alone makes of the 0.2 ms curve (over the true \
                  distance)."
            .to_owned(),
        alt: "From 1 ms on all points lie along the pooled cubic. Those of 0.2 ms leave it beyond about 1.5 m and \
              stay below it."
            .to_owned(),
        x: axis("measured distance in m", Scale::Linear),
        y: axis("inverse amplitude, 1 at 750 mm", Scale::Linear),
        series,
        marks: vec![reference_mark(lab)],
    })
}

/// Decays as recorded, scaled by distance, and by integration time too. Each is one series, interrupted between
/// the integration times, so that the three states are told apart at a glance.
fn figure_10(lab: &Lab, curves: &[Curve]) -> Result<Chart, ExperimentError> {
    let pooled = cubic(lab)?;
    let unit_dn = 2.0 * reference_amplitude_dn(lab, curves);
    let state = |name: &str, stroke: Stroke, factor: &dyn Fn(&Curve, &BoardMean) -> f64| {
        let mut points = Vec::new();
        for curve in curves {
            let scaled = |point: &BoardMean| point.amplitude_dn * factor(curve, point) / unit_dn;
            points.extend(curve.points.iter().map(|point| (point.distance_m, scaled(point))));
            points.push((f64::NAN, f64::NAN));
        }
        Series { name: name.to_owned(), points, stroke }
    };
    let distance = |point: &BoardMean| multiplier(pooled, point.distance_m);
    let time = |curve: &Curve| time_multiplier(lab, curve.integration_time_us);
    Ok(Chart {
        id: "fig-10".to_owned(),
        caption: "Figure 10. The reference decays (points), scaled by distance (solid), and by integration time \
                  as well (dashed); 0.2, 1, 2, 4.2, 8.2 and 16.4 ms from below. The unit is twice the amplitude at \
                  the reference of 8.2 ms and 0.75 m."
            .to_owned(),
        alt: "The decays fall steeply; scaled by distance they are level lines, one for each integration time; \
              scaled by time too, these fall together at 0.5. Only 0.2 ms rises at far distances."
            .to_owned(),
        x: axis("measured distance in m", Scale::Linear),
        y: axis("amplitude, normalized", Scale::Log),
        series: vec![
            state("as recorded", Stroke::Points, &|_, _| 1.0),
            state("distance scaled", Stroke::Solid, &|_, point| distance(point)),
            state("distance and time scaled", Stroke::Dashed, &|curve, point| distance(point) * time(curve)),
        ],
        marks: Vec::new(),
    })
}

/// The same closely: only what the calibration was fitted on, relative to each curve's median.
fn flatness(lab: &Lab, curves: &[Curve]) -> Result<Chart, ExperimentError> {
    let pooled = cubic(lab)?;
    let series = curves.iter().filter(|curve| curve.is_fitted).map(|curve| {
        let flat = curve.flattened(pooled);
        let middle = median(flat.iter().map(|(_, dn)| *dn).collect());
        let points = flat.into_iter().map(|(distance_m, dn)| (distance_m, 100.0 * (dn / middle - 1.0)));
        Series { name: curve.name(), points: points.collect(), stroke: Stroke::SolidPoints }
    });
    let mark = |percent: f64| Mark { axis: MarkAxis::Y, at: percent, label: format!("{percent:+} %") };
    Ok(Chart {
        id: "fig-10-flatness".to_owned(),
        caption: "How level the scaled decays are from 0.5 to 3 m: deviation of each from its own median. The slow \
                  wave is the camera's third harmonic, which no cubic follows."
            .to_owned(),
        alt: "Curves from 1 to 8.2 ms stay well within 10 percent; that of 16.4 ms starts below the \
              band at 0.8 m and is level from about 1 m on."
            .to_owned(),
        x: axis("measured distance in m", Scale::Linear),
        y: axis("deviation in %", Scale::Linear),
        series: series.collect(),
        marks: vec![mark(-100.0 * FLAT_WITHIN), mark(100.0 * FLAT_WITHIN)],
    })
}

fn table(lab: &Lab, curves: &[Curve]) -> Result<Table, ExperimentError> {
    let pooled = cubic(lab)?;
    let columns = [
        "integration time",
        "starts at, m",
        "positions left out",
        "mean off the cubic, %",
        "worst off level, %",
        "worst off in distance, mm",
        "fitted",
    ];
    let row = |curve: &Curve| {
        vec![
            text(&curve.name()),
            number(curve.points.first().map_or(f64::NAN, |point| point.true_distance_m), 2),
            number(curve.over_saturated as f64, 0),
            number(100.0 * claims::mean_deviation(curve, pooled), 1),
            number(100.0 * claims::largest_deviation_from_level(curve, pooled), 1),
            number(1000.0 * claims::largest_distance_error_m(curve), 0),
            text(if curve.is_fitted { "yes" } else { "no" }),
        ]
    };
    Ok(Table {
        id: "decays".to_owned(),
        caption: "The decays: positions left out as over-saturated, mean deviation of the inverted points from the pooled \
                  cubic, worst deviation of the scaled points from their median (0.5 to 3 m), worst error of the \
                  mean distance (from 0.75 m on)."
            .to_owned(),
        columns: columns.map(str::to_owned).to_vec(),
        rows: curves.iter().map(row).collect(),
    })
}

/// Why the shortest time is not in the pool, in the words of the calibration.
fn why_left_out(lab: &Lab) -> String {
    let about_stray = |warning: &&FitWarning| match warning {
        FitWarning::Distance(
            DistanceWarning::FewReliable { integration_time_us, .. }
            | DistanceWarning::LowSignal { integration_time_us, .. },
        ) => *integration_time_us == Some(STRAY_US),
        _ => false,
    };
    let said = lab.report.warnings.iter().find(about_stray).map(ToString::to_string);
    let said = said.unwrap_or_else(|| "nothing: it used this curve".to_owned());
    format!(
        "Why 0.2 ms strays: an amplitude is the length of a vector, so noise can only lengthen it (a Rician mean, at \
         least √(π/2) σ). Far away the amplitude stops falling at that floor, its inverse stops rising, and the \
         phase becomes so noisy that distances wrap around. The calibration leaves the curve out by its own rule; \
         it said: “{said}”."
    )
}

fn reference_mark(lab: &Lab) -> Mark {
    let at = lab.calibration.reference.distance_m;
    Mark { axis: MarkAxis::X, at, label: "reference".to_owned() }
}

fn steps([from, to]: [f64; 2]) -> impl Iterator<Item = f64> {
    const COUNT: u32 = 100;
    (0..=COUNT).map(move |step| from + (to - from) * f64::from(step) / f64::from(COUNT))
}
