//! Finding things on the page.
#![allow(dead_code, reason = "each test uses its part")]

use std::sync::OnceLock;

use isolux_experiments::paper::{self, Lab};
use isolux_report::page::{Block, Cell, Chart, Claim, Section, Series, Table};

/// One laboratory for all tests of a file: its sweeps take seconds.
pub(crate) fn lab() -> &'static Lab {
    static LAB: OnceLock<Lab> = OnceLock::new();
    LAB.get_or_init(|| Lab::new(1, &mut |_| ()).unwrap())
}

/// The section that progress calls `name`.
pub(crate) fn make(name: &str) -> Section {
    let (_, section) = paper::ALL.iter().find(|(found, _)| *found == name).unwrap();
    section(lab()).unwrap()
}

pub(crate) fn chart<'a>(section: &'a Section, id: &str) -> &'a Chart {
    let mut charts = section.blocks.iter().filter_map(|block| match block {
        Block::Chart(chart) => Some(chart),
        _ => None,
    });
    charts.find(|chart| chart.id == id).unwrap()
}

pub(crate) fn series<'a>(chart: &'a Chart, name: &str) -> &'a Series {
    chart.series.iter().find(|series| series.name == name).unwrap()
}

pub(crate) fn claim<'a>(section: &'a Section, id: &str) -> &'a Claim {
    let claims = section.blocks.iter().filter_map(|block| match block {
        Block::Claims(claims) => Some(claims),
        _ => None,
    });
    claims.flatten().find(|claim| claim.id == id).unwrap()
}

pub(crate) fn table<'a>(section: &'a Section, id: &str) -> &'a Table {
    let mut tables = section.blocks.iter().filter_map(|block| match block {
        Block::Table(table) => Some(table),
        _ => None,
    });
    tables.find(|table| table.id == id).unwrap()
}

/// The numbers of the row that starts with `name`; NaN for words.
pub(crate) fn row(table: &Table, name: &str) -> Vec<f64> {
    let row = table.rows.iter().find(|row| row[0] == Cell::Text(name.to_owned())).unwrap();
    let number = |cell: &Cell| match cell {
        Cell::Number { value, .. } | Cell::Best { value, .. } => *value,
        _ => f64::NAN,
    };
    row[1..].iter().map(number).collect()
}
