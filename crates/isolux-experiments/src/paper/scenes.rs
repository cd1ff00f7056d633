//! Figures 7 to 9: two still scenes over the integration times; means of the whole image and of windows before
//! and after the table.

mod sweep;

use isolux::statistics::quantile;
use isolux_report::page::{
    Block, Cell, Chart, Claim, Colours, Picture, Scale, Section, Series, Stroke, Table,
};

use self::sweep::{Region, SCENES, Sweep};
use super::parts::{axis, number, text, verdict};
use crate::error::ExperimentError;
use crate::paper::lab::Lab;

/// From here on the noise floor adds little to the means.
const ABOVE_THE_FLOOR_US: f64 = 1000.0;
/// "Several times less".
const SEVERAL: f64 = 3.0;
/// How far the corrected mean at the shortest time may be off when there is no noise.
const TABLE_ERROR: f64 = 0.05;

/// The section of figures 7 to 9.
///
/// # Errors
/// Those of the camera and the chain.
pub(super) fn section(lab: &Lab) -> Result<Section, ExperimentError> {
    let sweeps = [Sweep::measure(lab, &SCENES[0])?, Sweep::measure(lab, &SCENES[1])?];
    let mut blocks = vec![
        Block::Quote {
            text: "Corrected by the table, the means of two still scenes still deviate somewhat, presumably by \
                   saturation, but not nearly as strongly as before."
                .to_owned(),
            source: "section 3, figures 7 to 9".to_owned(),
        },
        Block::Text(
            "Two still scenes, registers 0 to 135 in steps of 200 µs, 50 frames skipped after each change, one frame \
             recorded. Only the table of figure 2 is applied, one scalar per frame; distance and highlights stay as \
             they are. The windows of 20×20 pixels are those of figure 1."
                .to_owned(),
        ),
        Block::Pictures(sweeps.iter().map(|sweep| sweep.picture(lab)).collect()),
    ];
    blocks.extend(sweeps.iter().map(|sweep| Block::Chart(sweep.chart())));
    blocks.push(Block::Table(table(&sweeps)));
    blocks.push(Block::Text(shortest_time(&sweeps)));
    blocks.push(Block::Text(longest_time(&sweeps)));
    blocks.push(Block::Claims(sweeps.iter().flat_map(claims).collect()));
    Ok(Section { id: "scenes".to_owned(), title: "Figures 7–9: two still scenes".to_owned(), blocks })
}

impl Sweep {
    fn picture(&self, lab: &Lab) -> Picture {
        let reference_ms = lab.calibration.reference.integration_time_us.unwrap_or(f64::NAN) / 1000.0;
        let mut values: Vec<f64> = self.picture.values().iter().copied().map(f64::from).collect();
        values.retain(|value| value.is_finite());
        let white = quantile(&mut values, 0.995).unwrap_or(1.0);
        Picture {
            id: format!("fig-7-{}", self.subject.scene),
            caption: format!(
                "Figure 7, {}. Raw amplitude at {reference_ms:.1} ms; white is the 99.5th percentile.",
                self.subject.words
            ),
            alt: format!("Amplitude image of {}.", self.subject.words),
            values: self.picture.clone(),
            range: (0.0, white as f32),
            label: "amplitude in DN".to_owned(),
            colours: Colours::Grey,
        }
    }

    fn chart(&self) -> Chart {
        let series = |region: &Region, words: &str, means: &[f64], stroke| Series {
            name: format!("{}, {words}", region.name),
            points: self
                .times_us
                .iter()
                .zip(means)
                .map(|(time_us, mean)| (time_us / 1000.0, *mean))
                .collect(),
            stroke,
        };
        let after =
            self.regions.iter().map(|region| series(region, "after", &region.corrected, Stroke::Solid));
        let before = self.regions.iter().map(|region| series(region, "before", &region.raw, Stroke::Dashed));
        let figure = self.subject.figure;
        Chart {
            id: format!("fig-{figure}"),
            caption: format!(
                "Figure {figure}. Mean amplitudes of {}, before (dashed) and after the correction.",
                self.subject.words
            ),
            alt: "Before, four curves rise in proportion to the integration time. After, the four are nearly level \
                  from 1 to 20 ms; below they start too high, above they rise by a fifth."
                .to_owned(),
            x: axis("integration time in ms", Scale::Linear),
            y: axis("mean amplitude in DN", Scale::Linear),
            series: after.chain(before).collect(),
            marks: Vec::new(),
        }
    }
}

fn table(sweeps: &[Sweep]) -> Table {
    let ends = sweeps.first().map_or([f64::NAN; 2], Sweep::ends_ms);
    let [shortest, longest] = ends.map(|time_ms| format!("{time_ms:.1} / 8.2 ms"));
    let columns = [
        "scene and region",
        "CV before",
        "CV after",
        "before / after",
        "from 1 ms on",
        &shortest,
        &longest,
        "without noise",
    ];
    let row = |sweep: &Sweep, region: &Region| -> Vec<Cell> {
        let [raw, corrected] = sweep.variation(region, 0.0);
        let [raw_above, corrected_above] = sweep.variation(region, ABOVE_THE_FLOOR_US);
        vec![
            text(&format!("{}, {}", sweep.subject.short, region.name)),
            number(raw, 3),
            number(corrected, 3),
            number(raw / corrected, 1),
            number(raw_above / corrected_above, 1),
            number(sweep.relative(&region.corrected, 0), 2),
            number(sweep.relative(&region.corrected, sweep.times_us.len() - 1), 2),
            number(sweep.relative(&region.noise_free, 0), 2),
        ]
    };
    Table {
        id: "scenes-variation".to_owned(),
        caption: format!(
            "Variation of the means over {}: CV is standard deviation / mean; before / after, and the same of the times \
             from 1 ms on. Then the corrected mean at both ends relative to that at 8.2 ms, and the same of the amplitude \
             without noise at the lower end.",
            sweeps.first().map_or_else(String::new, Sweep::span)
        ),
        columns: columns.map(str::to_owned).to_vec(),
        rows: sweeps
            .iter()
            .flat_map(|sweep| sweep.regions.iter().map(move |region| row(sweep, region)))
            .collect(),
    }
}

fn shortest_time(sweeps: &[Sweep; 2]) -> String {
    let [first, second] = sweeps.each_ref().map(|sweep| {
        let whole = &sweep.regions[0];
        (sweep.relative(&whole.corrected, 0), sweep.relative(&whole.noise_free, 0))
    });
    let regions = || sweeps.iter().flat_map(|sweep| sweep.regions.iter().map(move |region| (sweep, region)));
    let level = |(sweep, region): &(&Sweep, &Region)| region.raw[sweep.reference()];
    let darkest = regions().min_by(|a, b| level(a).total_cmp(&level(b)));
    let darkest = darkest.map_or_else(String::new, |(sweep, region)| {
        let [raw, corrected] = sweep.variation(region, 0.0);
        format!(
            " The darker the region, the worse: in the darkest window ({}, {}; {:.0} DN at 8.2 ms) the factor is {:.1}, \
             and that one end makes the CV {:.2} after the correction against {:.2} before.",
            sweep.subject.words,
            region.name,
            level(&(sweep, region)),
            sweep.relative(&region.corrected, 0),
            corrected,
            raw
        )
    });
    let whole = &sweeps[0].regions[0];
    format!(
        "What 0.2 ms does: an amplitude is the length of a noisy vector, so where there is hardly any light its mean \
         does not fall to zero but to the noise floor (Rician bias). The table multiplies it by {:.0}, and was made on a \
         white wall well above the floor. So the corrected means of the two images at 0.2 ms are {:.1} and {:.1} times \
         those at 8.2 ms; without noise they would be {:.2} and {:.2} times (below 1 because the floor lifts the wall, \
         too, a little).{darkest} From 1 ms on little of this is left in the images. How much these few times weigh in a CV depends on \
         the spacing of the times; here it is the even one of the camera's register.",
        whole.corrected[0] / whole.raw[0],
        first.0,
        second.0,
        first.1,
        second.1
    )
}

fn longest_time(sweeps: &[Sweep; 2]) -> String {
    let last = |sweep: &Sweep| sweep.relative(&sweep.regions[0].corrected, sweep.times_us.len() - 1);
    format!(
        "At the other end the corrected means rise to {:.2} and {:.2} of those at 8.2 ms. The paper presumes saturation \
         in the scene. Here it is the saturation of the wall that the table was made on: the scenes are darker, are \
         hardly compressed, and yet get the compression of the wall taken out. A scalar per image cannot know.",
        last(&sweeps[0]),
        last(&sweeps[1])
    )
}

fn claims(sweep: &Sweep) -> Vec<Claim> {
    let figure = sweep.subject.figure;
    let ratio = |region: &Region, from_us: f64| {
        let [raw, corrected] = sweep.variation(region, from_us);
        raw / corrected
    };
    let [raw, corrected] = sweep.variation(&sweep.regions[0], 0.0);
    let windows = &sweep.regions[1..];
    let least =
        |from_us: f64| windows.iter().map(|region| ratio(region, from_us)).fold(f64::INFINITY, f64::min);
    let each = |from_us: f64| {
        let words = windows.iter().map(|region| format!("{} {:.1}", region.name, ratio(region, from_us)));
        words.collect::<Vec<_>>().join(", ")
    };
    let noise_free = sweep.relative(&sweep.regions[0].noise_free, 0);
    vec![
        Claim {
            id: format!("fig-{figure}-image-varies-less"),
            statement: format!(
                "Figure {figure}: corrected, the mean of the image varies several times less."
            ),
            measured: format!(
                "CV over {} {raw:.2} before, {corrected:.2} after: {:.1} times less.",
                sweep.span(),
                raw / corrected
            ),
            value: raw / corrected,
            verdict: verdict(raw / corrected >= SEVERAL, "less than three times"),
        },
        Claim {
            id: format!("fig-{figure}-windows-vary-less"),
            statement: format!("Figure {figure}: so do the means of the windows."),
            measured: format!(
                "CV before / after, over {}: {}; from 1 ms on: {}.",
                sweep.span(),
                each(0.0),
                each(ABOVE_THE_FLOOR_US)
            ),
            value: least(0.0),
            verdict: verdict(
                least(0.0) >= SEVERAL,
                if least(ABOVE_THE_FLOOR_US) >= SEVERAL {
                    "the darkest window sees the noise floor below 1 ms; without these times it holds"
                } else {
                    "the darkest window is too dark even from 1 ms on"
                },
            ),
        },
        Claim {
            id: format!("fig-{figure}-floor-at-the-shortest-time"),
            statement: "What deviates at 0.2 ms is noise, not the table (not in the paper).".to_owned(),
            measured: format!(
                "Corrected mean at 0.2 ms relative to 8.2 ms: {:.2}; of the amplitude without noise: {noise_free:.3}.",
                sweep.relative(&sweep.regions[0].corrected, 0)
            ),
            value: noise_free,
            verdict: verdict((noise_free - 1.0).abs() <= TABLE_ERROR, "the table itself is off"),
        },
    ]
}
