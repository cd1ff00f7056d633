//! The files of a report.

#![allow(clippy::unwrap_used, clippy::panic, reason = "helpers of tests fail by panicking")]

use std::fs;
use std::path::Path;

use isolux_report::page::{Block, Page};
use isolux_report::{ReportError, render, write_report};

#[allow(dead_code, reason = "the example's main is not run here")]
#[path = "../examples/sample.rs"]
mod sample;

/// All files below a folder, sorted, with forward slashes.
fn listing(folder: &Path) -> Vec<String> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_str().unwrap().to_owned();
        match path.is_dir() {
            true => found.extend(listing(&path).into_iter().map(|inner| format!("{name}/{inner}"))),
            false => found.push(name),
        }
    }
    found.sort();
    found
}

const FILES: [&str; 9] = [
    "data/empty.csv",
    "data/fig-1.csv",
    "data/fig-4.csv",
    "data/methods-table.csv",
    "data/residuals.csv",
    "pictures/fig-12-after.png",
    "pictures/fig-12-before.png",
    "pictures/fig-12-factor.png",
    "report.html",
];

#[test]
fn page_numbers_and_pictures_are_written_and_nothing_else() {
    let place = tempfile::tempdir().unwrap();
    let folder = place.path().join("deep/new");
    let path = write_report(&sample::page(), &folder, "report.html").unwrap();
    assert_eq!(fs::read_to_string(path).unwrap(), render(&sample::page()).unwrap());
    assert_eq!(listing(place.path()), FILES.map(|file| format!("deep/new/{file}")));
}

#[test]
fn an_existing_folder_keeps_its_other_files() {
    let place = tempfile::tempdir().unwrap();
    fs::create_dir(place.path().join("data")).unwrap();
    fs::write(place.path().join("data/mine.csv"), "mine").unwrap();
    for _ in 0..2 {
        write_report(&sample::page(), place.path(), "report.html").unwrap();
    }
    assert_eq!(listing(place.path()).len(), FILES.len() + 1);
    assert_eq!(fs::read_to_string(place.path().join("data/mine.csv")).unwrap(), "mine");
}

#[test]
fn a_report_that_cannot_be_placed_leaves_nothing() {
    let place = tempfile::tempdir().unwrap();
    // A folder in the way of the page, which comes last.
    fs::create_dir(place.path().join("report.html")).unwrap();
    let error = write_report(&sample::page(), place.path(), "report.html").unwrap_err();
    assert!(matches!(error, ReportError::Write { .. }), "{error}");
    assert_eq!(listing(place.path()), Vec::<String>::new());
    assert_eq!(fs::read_dir(place.path()).unwrap().count(), 1);
    // A file in the way of the folder.
    let file = place.path().join("file");
    fs::write(&file, "x").unwrap();
    assert!(matches!(write_report(&sample::page(), &file, "report.html"), Err(ReportError::Write { .. })));
    assert_eq!(listing(place.path()), ["file"]);
}

#[test]
fn a_page_is_checked_before_anything_is_written() {
    let place = tempfile::tempdir().unwrap();
    let folder = place.path().join("new");
    for name in ["", "..", "a/b.html", "data", "/x"] {
        assert!(
            matches!(write_report(&sample::page(), &folder, name), Err(ReportError::FileName { .. })),
            "{name}"
        );
    }
    let mut page = sample::page();
    page.sections[0].id = "no id".into();
    assert!(matches!(write_report(&page, &folder, "report.html"), Err(ReportError::InvalidId { .. })));
    assert!(!folder.exists());
}

fn chart(page: &Page, id: &str) -> isolux_report::page::Chart {
    let blocks = page.sections.iter().flat_map(|section| &section.blocks);
    let charts = blocks.filter_map(|block| if let Block::Chart(chart) = block { Some(chart) } else { None });
    charts.clone().find(|chart| chart.id == id).unwrap().clone()
}

#[test]
fn the_csv_of_a_chart_reads_back_to_the_bit() {
    let mut chart = chart(&sample::page(), "fig-4");
    chart.series[0].name = "0.2 ms, \"stray\"\nleft out".into();
    chart.series[0].points.push((f64::NAN, 1.0 / 3.0));
    let text = isolux_report::chart_csv(&chart);
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    assert_eq!(
        reader.headers().unwrap(),
        vec!["series", "Distance in m", "Mean amplitude of the window in DN"]
    );
    let wanted = chart
        .series
        .iter()
        .flat_map(|series| series.points.iter().map(|&(x, y)| (series.name.clone(), x, y)));
    let number = |field: &str| if field.is_empty() { f64::NAN } else { field.parse().unwrap() };
    let found: Vec<(String, f64, f64)> = reader
        .records()
        .map(|record| record.unwrap())
        .map(|record| (record[0].to_owned(), number(&record[1]), number(&record[2])))
        .collect();
    assert_eq!(found.len(), chart.series.iter().map(|series| series.points.len()).sum::<usize>());
    for ((name, x, y), wanted) in found.into_iter().zip(wanted) {
        assert_eq!((name, x.to_bits(), y.to_bits()), (wanted.0, wanted.1.to_bits(), wanted.2.to_bits()));
    }
}
