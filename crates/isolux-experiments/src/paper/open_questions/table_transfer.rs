//! The lookup table under other light and before other walls.

use isolux::calibrate::CalibrateSettings;
use isolux::terms::lut::LutAnswer;
use isolux_camera::scene::run::RegisterRange;
use isolux_camera::scene::texture::Texture;
use isolux_camera::{Scene, Simulation};
use isolux_pipeline::simulate::SimulatedFrames;
use isolux_pipeline::{CalibrationSources, Unobserved, calibrate};
use isolux_report::page::{Block, Cell, Chart, Claim, Mark, MarkAxis, Scale, Series, Stroke, Table, Verdict};

use crate::error::ExperimentError;
use crate::paper::lab::Lab;
use crate::paper::parts::{axis, number, quote, text, verdict};

/// Ambient light of the laboratory's wall, and others, relative to the active light at 1 m.
const AMBIENTS: [f64; 5] = [0.0, 0.35, LAB_AMBIENT, 1.4, 2.8];
const LAB_AMBIENT: f64 = 0.7;
/// Reflectivity of other walls than the laboratory's.
const OTHER_REFLECTIVITIES: [f64; 3] = [0.2, 0.45, 0.95];
const LAB_REFLECTIVITY: f64 = 0.7;
/// Every fifth register: 0.2, 1.2, … 51.2 ms, among them 8.2 and 27.2 ms.
const REGISTERS: RegisterRange = RegisterRange { first: 0, last: 255, step: 5 };

/// Ends of the table that differ by this factor differ heavily.
const HEAVILY: f64 = 1.5;

/// One wall under one light.
struct Condition {
    ambient: f64,
    reflectivity: f64,
    /// (integration time in µs, mean standardized amplitude relative to that at the reference time), as far as
    /// the laboratory's table reaches.
    standardized: Vec<(f64, f64)>,
    /// The same with `t_ref / t` instead of the table.
    linear: Vec<(f64, f64)>,
    /// End of the table fitted here, µs.
    end_us: f64,
    /// The means still rise at the last register.
    never_over_saturated: bool,
}

impl Condition {
    fn name(&self) -> String {
        format!("ambient {}, reflectivity {}", self.ambient, self.reflectivity)
    }

    fn ratio_at(&self, time_us: f64) -> f64 {
        let found = self.standardized.iter().find(|(at, _)| *at == time_us);
        found.map_or(f64::NAN, |(_, ratio)| *ratio)
    }
}

/// Largest deviation from 1 at times within the range.
fn largest_error(ratios: &[(f64, f64)], from_us: f64, to_us: f64) -> f64 {
    let inside = ratios.iter().filter(|(time_us, _)| (from_us..=to_us).contains(time_us));
    inside.map(|(_, ratio)| (ratio - 1.0).abs()).fold(0.0, f64::max)
}

pub(super) fn blocks(lab: &Lab) -> Result<Vec<Block>, ExperimentError> {
    let table_end_us =
        lab.calibration.terms.lut.as_ref().map_or(f64::NAN, |lut| lut.valid_integration_time_us[1]);
    let ambients = AMBIENTS.map(|ambient| (ambient, LAB_REFLECTIVITY));
    let walls = OTHER_REFLECTIVITIES.map(|reflectivity| (LAB_AMBIENT, reflectivity));
    let measured = ambients.into_iter().chain(walls).map(|(ambient, wall)| measure(lab, ambient, wall));
    let all: Vec<Condition> = measured.collect::<Result<_, _>>()?;
    let end = Mark { axis: MarkAxis::X, at: table_end_us / 1000.0, label: "end of the table".to_owned() };
    let chart = |id: &str, caption: &str, alt: &str, series| Chart {
        id: id.to_owned(),
        caption: caption.to_owned(),
        alt: alt.to_owned(),
        x: axis("integration time in ms", Scale::Linear),
        y: axis("standardized mean, 1 at 8.2 ms", Scale::Linear),
        series,
        marks: vec![end.clone()],
    };
    Ok(vec![
        quote(
            "The usable range of integration times depends heavily on the reflectivity of the calibration material \
             and on other light sources. How far a table carries over to another scene is not said.",
            "section 2.1",
        ),
        Block::Text(format!(
            "The laboratory's table (wall of reflectivity {LAB_REFLECTIVITY} at 0.9 m, ambient light \
             {LAB_AMBIENT} of the active light at 1 m) corrects the same wall under other light, and other walls \
             under the same light: every fifth register, one frame each after 50 skipped, mean of the whole image. \
             A table that carried over would leave 1 everywhere."
        )),
        Block::Chart(chart(
            "table-ambient",
            "The laboratory's table under other ambient light.",
            "All curves are 1 up to about 10 ms; with stronger ambient light they fall ever earlier, with less \
             they rise above 1 towards the end of the table.",
            all.iter()
                .filter(|condition| condition.reflectivity == LAB_REFLECTIVITY)
                .map(|condition| series(&format!("ambient {}", condition.ambient), condition))
                .collect(),
        )),
        Block::Chart(chart(
            "table-wall",
            "The laboratory's table before walls of other reflectivity.",
            "Curves of brighter walls fall before the end of the table; those of darker ones rise above 1 there, and \
             also at the shortest times, where noise carries the mean.",
            all.iter()
                .filter(|condition| condition.ambient == LAB_AMBIENT)
                .map(|condition| series(&format!("reflectivity {}", condition.reflectivity), condition))
                .collect(),
        )),
        Block::Table(table(&all)),
        Block::Claims(claims(&all, table_end_us)),
    ])
}

fn measure(lab: &Lab, ambient: f64, reflectivity: f64) -> Result<Condition, ExperimentError> {
    let mut scene = Scene::builtin("wall-sweep")?;
    scene.ambient = ambient;
    scene.objects.iter_mut().for_each(|wall| wall.texture = Texture::Uniform(reflectivity));
    for run in &mut scene.runs {
        (run.registers, run.frames_per_time) = (Some(REGISTERS), 1);
    }
    let simulation = Simulation::new(lab.camera.clone(), scene, lab.seed)?;
    let sources = CalibrationSources {
        exposure_sweeps: vec![Box::new(SimulatedFrames::new(&simulation))],
        ..CalibrationSources::default()
    };
    let (calibration, report) = calibrate(&CalibrateSettings::default(), None, sources, &Unobserved)?;
    let end_us = calibration.terms.lut.map_or(f64::NAN, |lut| lut.valid_integration_time_us[1]);
    let samples = report.exposure_curves.iter().flat_map(|curve| &curve.samples);
    let means: Vec<(f64, f64)> = samples.map(|s| (s.integration_time_us, s.mean_amplitude_dn)).collect();
    let last_us = means.last().map_or(f64::NAN, |(time_us, _)| *time_us);
    let reference_us = lab.calibration.reference.integration_time_us.unwrap_or(f64::NAN);
    Ok(Condition {
        ambient,
        reflectivity,
        standardized: relative_to_reference(&means, reference_us, |time_us| table_at(lab, time_us)),
        linear: relative_to_reference(&means, reference_us, |time_us| Some(reference_us / time_us)),
        end_us,
        never_over_saturated: end_us == last_us,
    })
}

/// The laboratory's table, inside its range.
fn table_at(lab: &Lab, time_us: f64) -> Option<f64> {
    match lab.calibration.terms.lut.as_ref()?.at(time_us) {
        LutAnswer::Inside(multiplier) => Some(multiplier),
        _ => None,
    }
}

/// The means after a multiplier over time, relative to that at the reference time.
fn relative_to_reference(
    means: &[(f64, f64)],
    reference_us: f64,
    multiplier: impl Fn(f64) -> Option<f64>,
) -> Vec<(f64, f64)> {
    let at_reference = means.iter().find(|(time_us, _)| *time_us == reference_us);
    let at_reference = at_reference.map_or(f64::NAN, |(_, mean)| *mean);
    let scaled = means
        .iter()
        .filter_map(|(time_us, mean)| Some((*time_us, multiplier(*time_us)? * mean / at_reference)));
    scaled.collect()
}

fn series(name: &str, condition: &Condition) -> Series {
    let points = condition.standardized.iter().map(|(time_us, ratio)| (time_us / 1000.0, *ratio)).collect();
    Series { name: name.to_owned(), points, stroke: Stroke::Solid }
}

fn table(conditions: &[Condition]) -> Table {
    let columns = ["condition", "own table ends, ms", "at 0.2 ms", "at 4.2 ms", "at 16.2 ms", "at 27.2 ms"];
    let row = |condition: &Condition| {
        let end = if condition.never_over_saturated {
            Cell::Missing("beyond the register".to_owned())
        } else {
            number(condition.end_us / 1000.0, 1)
        };
        let mut row = vec![text(&condition.name()), end];
        row.extend([200.0, 4200.0, 16_200.0, 27_200.0].map(|time_us| number(condition.ratio_at(time_us), 3)));
        row
    };
    Table {
        id: "table-transfer".to_owned(),
        caption: "Mean standardized amplitude, 1 at 8.2 ms, when the laboratory's table is used; and where a table made \
                  here would end (in steps of 1 ms)."
            .to_owned(),
        columns: columns.map(str::to_owned).to_vec(),
        rows: conditions.iter().map(row).collect(),
    }
}

fn claims(conditions: &[Condition], table_end_us: f64) -> Vec<Claim> {
    vec![range_depends(conditions), up_to_the_reference(conditions), beyond(conditions, table_end_us)]
}

fn range_depends(conditions: &[Condition]) -> Claim {
    let by_end = |a: &&Condition, b: &&Condition| a.end_us.total_cmp(&b.end_us);
    let (shortest, longest) = (conditions.iter().min_by(by_end), conditions.iter().max_by(by_end));
    let end_us = |condition: Option<&Condition>| condition.map_or(f64::NAN, |condition| condition.end_us);
    let name =
        |condition: Option<&Condition>| condition.map_or_else(String::new, |condition| condition.name());
    let value = end_us(longest) / end_us(shortest);
    Claim {
        id: "range-depends-on-wall-and-light".to_owned(),
        statement: "The range of the table depends heavily on the wall and on other light.".to_owned(),
        measured: format!(
            "It ends at {:.1} ms with {}, and at {:.1} ms or later with {}.",
            end_us(shortest) / 1000.0,
            name(shortest),
            end_us(longest) / 1000.0,
            name(longest)
        ),
        value,
        verdict: verdict(value > HEAVILY, "the ends agree"),
    }
}

fn up_to_the_reference(conditions: &[Condition]) -> Claim {
    let largest = |ratios: &dyn Fn(&Condition) -> f64| conditions.iter().map(ratios).fold(0.0, f64::max);
    let value = largest(&|condition| largest_error(&condition.standardized, 1200.0, 8200.0));
    let linear = largest(&|condition| largest_error(&condition.linear, 1200.0, 8200.0));
    let shortest = largest(&|condition| (condition.ratio_at(200.0) - 1.0).abs());
    Claim {
        id: "table-carries-over-up-to-the-reference".to_owned(),
        statement: "Does a table carry over to other light and other walls at short times?".to_owned(),
        measured: format!(
            "From 1.2 to 8.2 ms it errs by at most {:.1} % in all these conditions; so does t_ref/t ({:.1} %). At 0.2 ms \
             it errs by up to {:.0} %, where a dark wall's mean is noise.",
            100.0 * value,
            100.0 * linear,
            100.0 * shortest
        ),
        value,
        verdict: Verdict::Open("the paper makes no statement".to_owned()),
    }
}

fn beyond(conditions: &[Condition], table_end_us: f64) -> Claim {
    let largest = |end_us: &dyn Fn(&Condition) -> f64| {
        let error = |condition: &Condition| largest_error(&condition.standardized, 8200.0, end_us(condition));
        conditions.iter().map(error).fold(0.0, f64::max)
    };
    let value = largest(&|condition| condition.end_us.min(table_end_us));
    let over_saturated = largest(&|_| table_end_us);
    Claim {
        id: "table-does-not-carry-over-beyond".to_owned(),
        statement: "And at long times, where the table corrects compression?".to_owned(),
        measured: format!(
            "From 8.2 ms on it errs by up to {:.0} % where neither wall is over-saturated, and by up to {:.0} % at times \
             that it accepts although the other wall is.",
            100.0 * value,
            100.0 * over_saturated
        ),
        value,
        verdict: Verdict::Open(
            "the paper makes no statement. Compression follows the well's fill, by ambient and active light together, \
             and not the integration time: a table over time holds for the wall and the light that it was made with"
                .to_owned(),
        ),
    }
}
