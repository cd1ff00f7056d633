//! What a reader of the page can rely on, checked with an XML parser that shares no code with the crate.

#![allow(clippy::unwrap_used, clippy::panic, reason = "helpers of tests fail by panicking")]

mod charts;
mod parts;

use std::collections::BTreeSet;

use isolux::{Plane, Shape};
use isolux_report::page::{
    Block, Cell, Claim, Mark, MarkAxis, Page, Scale, Section, Series, Stroke, Table, Verdict,
};
use isolux_report::{Companions, ReportError, render, render_with};
use roxmltree::Node;

use parts::{all, chart, has_class, page, parse, picture};

#[allow(dead_code, reason = "the example's main is not run here")]
#[path = "../../examples/sample.rs"]
mod sample;

const HOSTILE: &str = "<script>alert(\"1\")</script> & 'x' </style> ]]> \u{1b}\u{0}";
/// The same, as a reader sees it.
const HARMLESS: &str = "<script>alert(\"1\")</script> & 'x' </style> ]]> \u{fffd}\u{fffd}";

#[test]
fn the_sample_is_well_formed_with_headings_in_order_and_unique_ids() {
    let html = render(&sample::page()).unwrap();
    let document = parse(&html);
    assert_eq!(document.root_element().attribute("lang"), Some("en"));
    assert!(all(&document, "title").next().unwrap().text().unwrap().contains("SR-3100"));
    assert_eq!(all(&document, "h1").count(), 1);
    assert_eq!(all(&document, "h2").count(), sample::page().sections.len());
    let ids: Vec<&str> = document.descendants().filter_map(|node| node.attribute("id")).collect();
    assert_eq!(ids.len(), ids.iter().collect::<BTreeSet<_>>().len(), "{ids:?}");
    let links: Vec<&str> = all(&document, "a").filter_map(|link| link.attribute("href")).collect();
    for target in links.iter().filter_map(|link| link.strip_prefix('#')) {
        assert!(ids.contains(&target), "{target}");
    }
    assert!(links.contains(&"data/fig-1.csv") && links.contains(&"data/methods-table.csv"));
}

#[test]
fn everything_that_is_seen_is_said_too() {
    let html = render(&sample::page()).unwrap();
    let document = parse(&html);
    for image in all(&document, "img") {
        let bar = image.parent().is_some_and(|parent| has_class(parent, "colour-bar"));
        let alt = image.attribute("alt").unwrap();
        assert!(bar || !alt.is_empty());
    }
    for drawing in all(&document, "svg").filter(|svg| svg.attribute("aria-hidden") != Some("true")) {
        assert_eq!(drawing.attribute("role"), Some("img"));
        assert!(!drawing.attribute("aria-label").unwrap().is_empty());
    }
    // Each chart is there for screens and for phones; one of the two is shown.
    let charts = all(&document, "figure").filter(|figure| has_class(*figure, "chart")).count();
    for format in ["wide", "narrow"] {
        assert_eq!(all(&document, "svg").filter(|svg| has_class(*svg, format)).count(), charts);
    }
    // Verdicts are words, the best cell has a symbol with a name.
    let verdicts: Vec<String> = document
        .descendants()
        .filter(|node| has_class(*node, "verdict"))
        .map(|node| node.descendants().filter(Node::is_text).filter_map(|text| text.text()).collect())
        .collect();
    assert_eq!(verdicts, ["✓ holds", "✗ fails", "? open"]);
    let star = document.descendants().find(|node| has_class(*node, "star")).unwrap();
    assert_eq!((star.text(), star.attribute("aria-label")), (Some("★"), Some("best")));
}

#[test]
fn nothing_is_fetched() {
    let html = render(&sample::page()).unwrap();
    let without_names = html.replace("xmlns=\"http://www.w3.org/2000/svg\"", "");
    for address in ["http:", "https:", "//www", "url(", "@import", "<link", "<iframe", "<base"] {
        assert!(!without_names.contains(address), "{address}");
    }
    let document = parse(&html);
    let sources = document.descendants().filter_map(|node| node.attribute("src"));
    assert!(
        sources.clone().count() > 3
            && sources.clone().all(|source| source.starts_with("data:image/png;base64,"))
    );
    let alone = render_with(&sample::page(), Companions::Absent).unwrap();
    assert!(!alone.contains(".csv\""), "a page that lies alone links to no file");
}

#[test]
fn the_same_page_gives_the_same_bytes() {
    assert_eq!(render(&sample::page()).unwrap(), render(&sample::page()).unwrap());
}

#[test]
fn hostile_names_stay_text() {
    let text = || HOSTILE.to_owned();
    let mut drawn = chart(
        "c",
        Scale::Linear,
        vec![Series { name: text(), points: vec![(0.0, 1.0)], stroke: Stroke::Solid }],
    );
    (drawn.caption, drawn.alt, drawn.x.label, drawn.y.label) = (text(), text(), text(), text());
    drawn.marks = vec![
        Mark { axis: MarkAxis::X, at: 0.5, label: text() },
        Mark { axis: MarkAxis::Y, at: 0.5, label: text() },
    ];
    let mut shown = picture("p", Plane::filled(Shape::new(2, 2), 1.0), (0.0, 1.0));
    (shown.caption, shown.alt, shown.label) = (text(), text(), text());
    let table = Table {
        id: "t".into(),
        caption: text(),
        columns: vec![text(), text()],
        rows: vec![vec![Cell::Text(text()), Cell::Missing(text())]],
    };
    let claim = Claim {
        id: "k".into(),
        statement: text(),
        measured: text(),
        value: f64::NAN,
        verdict: Verdict::Fails(text()),
    };
    let blocks = vec![
        Block::Text(text()),
        Block::Quote { text: text(), source: text() },
        Block::Chart(drawn),
        Block::Pictures(vec![shown]),
        Block::Table(table),
        Block::Claims(vec![claim]),
    ];
    let section = |id: &str, blocks| Section { id: id.into(), title: text(), blocks };
    let page = Page {
        title: text(),
        lead: text(),
        sections: vec![section("one", blocks), section("two", vec![])],
        colophon: text(),
    };
    let html = render(&page).unwrap();
    let document = parse(&html);
    assert_eq!(all(&document, "script").count(), 1);
    assert_eq!(all(&document, "style").count(), 1);
    assert_eq!(all(&document, "h1").next().unwrap().text(), Some(HARMLESS));
    assert_eq!(all(&document, "th").next().unwrap().text(), Some(HARMLESS));
    assert_eq!(
        all(&document, "svg").find(|svg| has_class(*svg, "plot")).unwrap().attribute("aria-label"),
        Some(HARMLESS)
    );
}

#[test]
fn ids_and_shapes_that_cannot_be_rendered_are_refused() {
    let chart_of = |id: &str| Block::Chart(chart(id, Scale::Linear, vec![]));
    let error = render(&page(vec![chart_of("twice"), chart_of("twice")])).unwrap_err();
    assert_eq!(
        error.to_string(),
        "the id `twice` is used twice, by a chart and by a chart: give each its own"
    );
    assert!(matches!(
        render(&page(vec![chart_of("only")])),
        Err(ReportError::DuplicateId { first: "section", .. })
    ));
    for id in ["", "../x", "a b", "A", "-x", "a.b", "ä", &"x".repeat(65)] {
        assert!(matches!(render(&page(vec![chart_of(id)])), Err(ReportError::InvalidId { .. })), "{id}");
    }
    let table = Table {
        id: "t".into(),
        caption: String::new(),
        columns: vec!["a".into(), "b".into()],
        rows: vec![vec![Cell::Text("1".into())]],
    };
    let error = render(&page(vec![Block::Table(table)])).unwrap_err();
    assert_eq!(error.to_string(), "row 0 of table `t` has 1 cells, 2 expected, one for each heading");
    let empty = picture("p", Plane::filled(Shape::new(0, 4), 0.0), (0.0, 1.0));
    assert!(matches!(
        render(&page(vec![Block::Pictures(vec![empty])])),
        Err(ReportError::PictureShape { .. })
    ));
}

#[test]
fn empty_parts_and_pictures_without_values_still_give_a_page() {
    let nothing = Table { id: "t".into(), caption: String::new(), columns: vec![], rows: vec![] };
    let blind = picture("p", Plane::filled(Shape::new(3, 3), f32::NAN), (f32::NAN, f32::NAN));
    let blocks = vec![
        Block::Text(String::new()),
        Block::Chart(chart("c", Scale::Log, vec![])),
        Block::Pictures(vec![]),
        Block::Pictures(vec![blind]),
        Block::Table(nothing),
        Block::Claims(vec![]),
    ];
    let html = render(&page(blocks)).unwrap();
    parse(&html);
    assert!(html.contains("no values to draw") && html.contains("no value (100 % of pixels)"));
    parse(
        &render(&Page {
            title: String::new(),
            lead: String::new(),
            sections: vec![],
            colophon: String::new(),
        })
        .unwrap(),
    );
}
