//! The numbers of charts and tables as CSV (RFC 4180, UTF-8), with all their digits.

use crate::page::{Cell, Chart, Table};

/// One line per point: series, x, y. The headings are the labels of the axes, so they hold the units.
///
/// Points that are drawn as gaps are kept: a coordinate that is not a number is an empty field.
#[must_use]
pub fn chart_csv(chart: &Chart) -> String {
    let headings = ["series".to_owned(), chart.x.label.clone(), chart.y.label.clone()];
    let points = chart
        .series
        .iter()
        .flat_map(|series| series.points.iter().map(|&(x, y)| [series.name.clone(), number(x), number(y)]));
    lines(std::iter::once(headings).chain(points))
}

/// The headings, then one line per row; missing values are empty fields.
#[must_use]
pub fn table_csv(table: &Table) -> String {
    let rows = table.rows.iter().map(|row| row.iter().map(cell).collect());
    lines(std::iter::once(table.columns.clone()).chain(rows))
}

/// One line per record.
fn lines<R: IntoIterator<Item = String>>(records: impl Iterator<Item = R>) -> String {
    let mut writer = ::csv::WriterBuilder::new()
        .flexible(true)
        .terminator(::csv::Terminator::CRLF)
        .from_writer(Vec::new());
    for record in records {
        // Memory takes all bytes, and a flexible writer records of any length: nothing can fail.
        let _ = writer.write_record(record);
    }
    let bytes = writer.into_inner().unwrap_or_default();
    String::from_utf8(bytes).unwrap_or_default()
}

fn cell(cell: &Cell) -> String {
    match cell {
        Cell::Text(text) => text.clone(),
        Cell::Number { value, .. } | Cell::Best { value, .. } => number(*value),
        Cell::Missing(_) => String::new(),
    }
}

/// The shortest text that reads back as the same number; NaN is empty.
pub(crate) fn number(value: f64) -> String {
    let magnitude = value.abs();
    if value.is_nan() {
        String::new()
    } else if value == 0.0 || (1e-5..1e15).contains(&magnitude) || magnitude.is_infinite() {
        value.to_string()
    } else {
        format!("{value:e}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_back_to_the_bit() {
        for value in [0.1, -0.0, 1.0 / 3.0, 1e300, 5e-324, f64::MAX, 123_456_789.125, f64::INFINITY] {
            assert_eq!(number(value).parse::<f64>().unwrap().to_bits(), value.to_bits(), "{value}");
            assert!(number(value).len() < 26, "{}", number(value));
        }
        assert_eq!(number(f64::NAN), "");
    }

    #[test]
    fn commas_quotes_and_line_breaks_are_quoted() {
        let table = Table {
            id: "t".into(),
            caption: String::new(),
            columns: vec!["camera".into(), "σ in \"DN\", raw".into()],
            rows: vec![
                vec![Cell::Text("a\nb".into()), Cell::Number { value: 0.25, decimals: 0 }],
                vec![Cell::Text(" x".into()), Cell::Missing("too dark".into())],
            ],
        };
        assert_eq!(table_csv(&table), "camera,\"σ in \"\"DN\"\", raw\"\r\n\"a\nb\",0.25\r\n x,\r\n");
    }

    /// Readers skip empty lines: a row whose only value is missing would be lost.
    #[test]
    fn a_row_of_one_missing_value_is_no_empty_line() {
        let rows = vec![vec![Cell::Missing("too dark".into())], vec![Cell::Text("a".into())]];
        let table = Table { id: "t".into(), caption: String::new(), columns: vec!["camera".into()], rows };
        assert_eq!(table_csv(&table), "camera\r\n\"\"\r\na\r\n");
    }
}
