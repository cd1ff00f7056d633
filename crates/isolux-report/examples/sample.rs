//! Writes a page with one of everything, made-up numbers: `cargo run -p isolux-report --example sample -- FOLDER`.

#![allow(clippy::print_stdout, clippy::print_stderr, reason = "an example talks to a terminal")]

use std::path::PathBuf;
use std::process::ExitCode;

use isolux::{Plane, Shape};
use isolux_report::page::{
    Axis, Block, Cell, Chart, Claim, Colours, Mark, MarkAxis, Page, Picture, Scale, Section, Series, Stroke,
    Table, Verdict,
};
use isolux_report::write_report;

fn main() -> ExitCode {
    let Some(folder) = std::env::args_os().nth(1).map(PathBuf::from) else {
        eprintln!("usage: sample FOLDER");
        return ExitCode::from(2);
    };
    match write_report(&page(), &folder, "report.html") {
        Ok(path) => {
            println!("{}", path.display());
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("{error}");
            ExitCode::from(1)
        }
    }
}

pub(crate) fn page() -> Page {
    let section = |id: &str, title: &str, blocks| Section { id: id.into(), title: title.into(), blocks };
    Page {
        title: "Standardized amplitudes of a simulated SR-3100".into(),
        lead: "One wall and two boards, seen at 25 integration times and eight distances. After standardization the \
               same material has the same value within 2.1 %, where the raw amplitudes differ by a factor of 90."
            .into(),
        sections: vec![
            section("integration-time", "Amplitude over integration time", integration_time()),
            section("distance", "Decay over distance", distance()),
            section("boards", "Two identical boards at two distances", boards()),
            section("methods", "Methods on the same frames", methods()),
            section("noise", "Noise and residuals", noise()),
        ],
        colophon: "isolux 0.1.0, seed 1. Made-up numbers: this page shows what reports look like.".into(),
    }
}

fn axis(label: &str, scale: Scale) -> Axis {
    Axis { label: label.into(), scale, range: None }
}

fn series(name: &str, stroke: Stroke, points: impl IntoIterator<Item = (f64, f64)>) -> Series {
    Series { name: name.into(), points: points.into_iter().collect(), stroke }
}

/// Linear, compressed and at last collapsing: what over-saturation does to a mean.
fn response(time_ms: f64, gain: f64) -> f64 {
    let linear = gain * time_ms;
    let compressed = linear / (1.0 + (linear / 9000.0).powi(5)).powf(0.2);
    compressed * (1.0 - ((linear - 9500.0) / 6000.0).clamp(0.0, 0.93))
}

fn integration_time() -> Vec<Block> {
    let times = || (0..=127).map(|register| 0.2 + 0.4 * f64::from(register));
    let curve = |gain: f64| times().map(move |time| (time, response(time, gain)));
    let chart = Chart {
        id: "fig-1".into(),
        caption: "Mean amplitude of a wall at 1 m over integration time: the whole image and three windows of 20×20 \
                  pixels. Beyond 27.2 ms the bins clip, and the amplitude falls."
            .into(),
        alt: "Four curves rise linearly with integration time, bend near 9000 DN and fall; the centre does so first."
            .into(),
        x: axis("Integration time in ms", Scale::Linear),
        y: axis("Mean amplitude in DN", Scale::Linear),
        series: vec![
            series("whole image", Stroke::Solid, curve(300.0)),
            series("window at the centre", Stroke::Solid, curve(385.0)),
            series("window at the left edge", Stroke::Solid, curve(245.0)),
            series("window in the upper right corner", Stroke::Solid, curve(180.0)),
        ],
        marks: vec![
            Mark { axis: MarkAxis::X, at: 27.2, label: "27.2 ms: end of the lookup table".into() },
            Mark { axis: MarkAxis::X, at: 8.2, label: "8.2 ms: reference".into() },
        ],
    };
    vec![
        Block::Text(
            "The lookup table holds the mean amplitude of the valid pixels per integration time, 1 at 8.2 ms. It ends \
             where the mean of the whole image no longer rises."
                .into(),
        ),
        Block::Quote {
            text: "Intensities grow with the integration time until the sensor is over-saturated; from there on they \
                   fall, and the values are of no use."
                .into(),
            source: "Stürmer, Penne, Hornegger 2008, section 3.1".into(),
        },
        Block::Chart(chart),
        Block::Claims(vec![
            Claim {
                id: "saturation-ends-range".into(),
                statement: "Over-saturation ends the usable range.".into(),
                measured: "The mean peaks at 28.6 ms; at 40 ms it is 71 % below the peak.".into(),
                value: 28.6,
                verdict: Verdict::Holds,
            },
            Claim {
                id: "one-scalar".into(),
                statement: "One multiplier per integration time suits all regions of the image.".into(),
                measured: "Normalized curves of the corner and the centre differ by 14 % at 24 ms.".into(),
                value: 0.14,
                verdict: Verdict::Fails("the centre saturates earlier than the corners".into()),
            },
            Claim {
                id: "ambient".into(),
                statement: "Ambient light does not change the lookup table.".into(),
                measured: "Between 0 and 20 klx the entry at 20 ms moves by 6 %.".into(),
                value: 0.06,
                verdict: Verdict::Open("the paper does not say how bright its room was".into()),
            },
        ]),
    ]
}

fn distance() -> Vec<Block> {
    let decay = |time_ms: f64, from: f64| {
        (0..40)
            .map(move |step| 0.4 + 0.07 * f64::from(step))
            .filter(move |&d| d >= from)
            .map(move |d| (d, 4.2e2 * time_ms / (d * d) * (1.0 + 0.03 * (9.0 * d).cos())))
    };
    let chart = Chart {
        id: "fig-4".into(),
        caption: "Decay over distance at five integration times, each from where over-saturation ends; both axes are \
                  logarithmic. Dashed: the pooled cubic at 8.2 ms."
            .into(),
        alt: "Five nearly parallel falling lines, slope close to −2; the dashed cubic lies on the 8.2 ms line.".into(),
        x: axis("Distance in m", Scale::Log),
        y: axis("Mean amplitude of the window in DN", Scale::Log),
        series: vec![
            series("0.2 ms", Stroke::SolidPoints, decay(0.2, 0.4)),
            series("2.2 ms", Stroke::SolidPoints, decay(2.2, 0.5)),
            series("8.2 ms", Stroke::SolidPoints, decay(8.2, 0.8)),
            series("16.2 ms", Stroke::SolidPoints, decay(16.2, 1.1)),
            series("27.2 ms", Stroke::SolidPoints, decay(27.2, 1.3)),
            series("pooled cubic", Stroke::Dashed, decay(8.2, 0.4).chain([(3.2, 0.0), (-1.0, 5.0)])),
        ],
        marks: vec![
            Mark { axis: MarkAxis::X, at: 0.75, label: "reference".into() },
            Mark { axis: MarkAxis::Y, at: 60.0, label: "signal-to-noise ratio 10".into() },
        ],
    };
    vec![Block::Chart(chart)]
}

fn boards() -> Vec<Block> {
    let shape = Shape::new(144, 176);
    let image = |near: f32, far: f32, holes: bool| {
        Plane::from_fn(shape, |row, column| {
            let (u, v) = (column as f32 / 176.0 - 0.5, row as f32 / 144.0 - 0.5);
            let lobe = 1.0 - 0.9 * (u * u + v * v);
            let grain = 1.0 + 0.04 * ((row * 7919 + column * 104_729) % 97) as f32 / 97.0;
            if holes && (row * 31 + column * 17) % 263 == 0 {
                f32::NAN
            } else if (30..110).contains(&row) && (20..80).contains(&column) {
                near * lobe * grain
            } else if (45..95).contains(&row) && (105..145).contains(&column) {
                far * lobe * grain
            } else {
                0.12 * far.max(30.0) * lobe * grain
            }
        })
    };
    let picture = |id: &str, caption: &str, alt: &str, values, range, label: &str, colours| Picture {
        id: id.into(),
        caption: caption.into(),
        alt: alt.into(),
        values,
        range,
        label: label.into(),
        colours,
    };
    vec![
        Block::Pictures(vec![
            picture(
                "fig-12-before",
                "Before: the near board is 4.0 times as bright as the far one.",
                "A bright board on the left, a dark one on the right.",
                image(230.0, 58.0, false),
                (0.0, 250.0),
                "Amplitude in DN",
                Colours::Grey,
            ),
            picture(
                "fig-12-after",
                "After: the ratio is 1.02.",
                "Both boards are equally bright; scattered pixels have no value.",
                image(180.0, 177.0, true),
                (0.0, 200.0),
                "Standardized amplitude in DN",
                Colours::Grey,
            ),
            picture(
                "fig-12-factor",
                "The multiplier of each pixel.",
                "High at the far board, low at the near one.",
                image(0.8, 3.05, true),
                (0.0, 3.0),
                "Multiplier, 1 at 0.75 m",
                Colours::Viridis,
            ),
        ]),
        Block::Text("The same frame in all three; the colour bars say what the greys mean.".into()),
    ]
}

fn methods() -> Vec<Block> {
    let number = |value, decimals| Cell::Number { value, decimals };
    let best = |value, decimals| Cell::Best { value, decimals };
    let text = |text: &str| Cell::Text(text.into());
    let table = Table {
        id: "methods-table".into(),
        caption: "Spread and purpose of each method on the same 200 frames.".into(),
        columns: [
            "Method",
            "CV over times in %",
            "Slope of ln A on ln d",
            "Least IoU",
            "Noise factor",
            "Valid in %",
        ]
        .map(str::to_owned)
        .to_vec(),
        rows: vec![
            vec![
                text("raw"),
                number(71.3, 1),
                number(-1.98, 2),
                number(0.04, 2),
                best(1.0, 2),
                best(100.0, 1),
            ],
            vec![
                text("linear time (Ritt)"),
                number(6.4, 1),
                number(-1.97, 2),
                number(0.31, 2),
                number(1.0, 2),
                best(100.0, 1),
            ],
            vec![
                text("d² (Oprisescu)"),
                number(70.8, 1),
                number(0.08, 2),
                number(0.05, 2),
                number(2.91, 2),
                number(98.2, 1),
            ],
            vec![
                text("equation 5"),
                number(70.9, 1),
                number(-0.41, 2),
                number(0.04, 2),
                number(1.88, 2),
                number(98.2, 1),
            ],
            vec![
                text("A·d²/t"),
                number(6.5, 1),
                number(0.09, 2),
                number(0.82, 2),
                number(2.9, 2),
                number(98.2, 1),
            ],
            vec![
                text("paper: table and cubic"),
                best(2.1, 1),
                best(0.03, 2),
                best(0.93, 2),
                number(2.4, 2),
                number(96.9, 1),
            ],
            vec![
                text("vendor"),
                number(3.3, 1),
                Cell::Missing("distance unknown".into()),
                number(0.71, 2),
                number(1.1, 2),
                number(91.0, 1),
            ],
        ],
    };
    vec![
        Block::Text("CV: coefficient of variation. Where a rival wins, the star says so.".into()),
        Block::Table(table),
    ]
}

fn noise() -> Vec<Block> {
    let scatter = (0..400).map(|index| {
        let x = f64::from(index) / 40.0;
        (x, ((f64::from(index * index % 199) / 199.0) - 0.5) * (0.4 + x / 5.0))
    });
    let residuals = Chart {
        id: "residuals".into(),
        caption: "Residuals of the cubic over predicted amplitude; the dashed line is a running mean.".into(),
        alt: "A cloud around zero that widens to the right.".into(),
        x: axis("Predicted amplitude in 1000 DN", Scale::Linear),
        y: axis("Residual in %", Scale::Linear),
        series: vec![
            series("pixels", Stroke::Points, scatter),
            series(
                "running mean",
                Stroke::Dashed,
                (0..=10).map(|x| (f64::from(x), 0.05 * (f64::from(x)).sin())),
            ),
        ],
        marks: vec![Mark { axis: MarkAxis::Y, at: 0.0, label: "no residual".into() }],
    };
    let empty = Chart {
        id: "empty".into(),
        caption: "A chart whose values are all missing.".into(),
        alt: "No values.".into(),
        x: axis("Temperature in °C", Scale::Linear),
        y: axis("Gain drift in %", Scale::Linear),
        series: vec![series("drift", Stroke::Solid, [(f64::NAN, 1.0)])],
        marks: vec![],
    };
    vec![Block::Chart(residuals), Block::Chart(empty)]
}
