//! Charts hold their data, whatever it is.

use isolux_report::page::{Axis, Block, Chart, Mark, MarkAxis, Scale, Series, Stroke};
use isolux_report::render;
use proptest::prelude::*;

use crate::parts::{all, chart, has_class, page, parse};

/// Markers and line vertices of a series in the drawing for screens.
fn drawn(html: &str, class: &str) -> (usize, usize) {
    let document = parse(html);
    let plot = all(&document, "svg").find(|svg| has_class(*svg, "wide")).unwrap();
    let group = plot.children().find(|node| has_class(*node, class)).unwrap();
    let count = |class: &str, letters: &[char]| {
        let paths = group.children().filter(|node| has_class(*node, class));
        paths.map(|path| path.attribute("d").unwrap().matches(letters).count()).sum()
    };
    (count("dots", &['M']), count("line", &['M', 'L']))
}

#[test]
fn charts_hold_the_data() {
    let points = |count: u32| (0..count).map(|x| (f64::from(x), f64::from(x * x % 17))).collect::<Vec<_>>();
    let series = |name: &str, stroke, count| Series { name: name.into(), points: points(count), stroke };
    let chart = chart(
        "c",
        Scale::Linear,
        vec![
            series("line", Stroke::Solid, 120),
            series("dashed", Stroke::Dashed, 30),
            series("points", Stroke::Points, 250),
            series("both", Stroke::SolidPoints, 40),
        ],
    );
    let html = render(&page(vec![Block::Chart(chart)])).unwrap();
    assert_eq!(drawn(&html, "s0"), (0, 120));
    assert_eq!(drawn(&html, "s1"), (0, 30));
    assert_eq!(drawn(&html, "s2"), (250, 0));
    assert_eq!(drawn(&html, "s3"), (40, 40));
}

#[test]
fn values_without_a_place_on_a_logarithmic_axis_are_counted() {
    let points = vec![(1.0, 10.0), (2.0, 0.0), (3.0, -5.0), (4.0, 1000.0), (f64::NAN, 1.0)];
    let series = vec![Series { name: "s".into(), points, stroke: Stroke::Points }];
    let html = render(&page(vec![Block::Chart(chart("c", Scale::Log, series))])).unwrap();
    assert_eq!(drawn(&html, "s0").0, 2);
    assert!(html.contains("2 points that are not positive have no place on the logarithmic axis."));
}

fn any_number() -> impl Strategy<Value = f64> {
    prop_oneof![
        any::<f64>(),
        -10.0..10.0,
        Just(0.0),
        Just(1e300),
        Just(-1e300),
        Just(5e-324),
        Just(f64::NAN),
        Just(f64::INFINITY),
        1.0..1.000_000_001,
    ]
}

fn any_axis() -> impl Strategy<Value = Axis> {
    let scale = prop_oneof![Just(Scale::Linear), Just(Scale::Log)];
    let range = proptest::option::of((any_number(), any_number()));
    ("[ -~]{0,80}", scale, range).prop_map(|(label, scale, range)| Axis { label, scale, range })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn any_chart_is_drawn_inside_its_frame(
        x in any_axis(),
        y in any_axis(),
        series in proptest::collection::vec(proptest::collection::vec((any_number(), any_number()), 0..12), 0..10),
        marks in proptest::collection::vec((any::<bool>(), any_number(), "[ -~]{0,60}"), 0..4),
    ) {
        let strokes = [Stroke::Solid, Stroke::Dashed, Stroke::Points, Stroke::SolidPoints];
        let series = series.into_iter().enumerate().map(|(index, points)| {
            Series { name: format!("series {index}"), points, stroke: strokes[index % 4] }
        });
        let marks = marks.into_iter().map(|(vertical, at, label)| {
            Mark { axis: if vertical { MarkAxis::X } else { MarkAxis::Y }, at, label }
        });
        let chart = Chart {
            id: "c".into(), caption: "c".into(), alt: "a".into(), x, y, series: series.collect(), marks: marks.collect(),
        };
        let html = render(&page(vec![Block::Chart(chart)])).unwrap();
        let document = parse(&html);
        for svg in all(&document, "svg").filter(|svg| has_class(*svg, "plot")) {
            let size: Vec<f64> = svg.attribute("viewBox").unwrap().split(' ').map(|side| side.parse().unwrap()).collect();
            for path in svg.descendants().filter(|node| has_class(*node, "line")) {
                for pair in path.attribute("d").unwrap().split(['M', 'L']).skip(1) {
                    let (x, y) = pair.split_once(' ').unwrap();
                    let (x, y): (f64, f64) = (x.parse().unwrap(), y.parse().unwrap());
                    prop_assert!((0.0..=size[2]).contains(&x) && (0.0..=size[3]).contains(&y), "{x} {y} in {size:?}");
                }
            }
        }
    }
}
