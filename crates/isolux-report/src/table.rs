//! Tables: read without a script, sorted and copied with it.

use crate::companions::{Companions, put_csv_link};
use crate::markup::{Escaped, put};
use crate::numbers::scientific;
use crate::page::{Cell, Table};

/// Most decimals of an f64 that mean anything.
const DECIMALS: usize = 17;

pub(crate) fn put_table(out: &mut String, table: &Table, companions: Companions) {
    put!(out, "<figure class=\"table\" id=\"{}\">\n<figcaption>{}", table.id, Escaped(&table.caption));
    put_csv_link(out, &table.id, companions);
    put!(
        out,
        "</figcaption>\n<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"{}\">\n\
         <table>\n<thead>\n<tr>",
        Escaped(&table.caption)
    );
    let numeric: Vec<bool> = (0..table.columns.len()).map(|column| is_numeric(table, column)).collect();
    for (heading, &numeric) in table.columns.iter().zip(&numeric) {
        put!(out, "<th scope=\"col\"{}>{}</th>", class_of(numeric), Escaped(heading));
    }
    out.push_str("</tr>\n</thead>\n<tbody>\n");
    for row in &table.rows {
        out.push_str("<tr>");
        for (column, (cell, &numeric)) in row.iter().zip(&numeric).enumerate() {
            put_cell(out, cell, numeric, column == 0);
        }
        out.push_str("</tr>\n");
    }
    out.push_str("</tbody>\n</table>\n</div>\n");
    if table.rows.is_empty() {
        out.push_str("<p class=\"note\">No rows.</p>\n");
    } else if table.rows.iter().flatten().any(|cell| matches!(cell, Cell::Best { .. })) {
        out.push_str(
            "<p class=\"note\"><span aria-hidden=\"true\">★</span> best of its kind in this table</p>\n",
        );
    }
    out.push_str("</figure>\n");
}

fn class_of(numeric: bool) -> &'static str {
    if numeric { " class=\"number\"" } else { "" }
}

/// Whether a column holds numbers, apart from missing ones.
fn is_numeric(table: &Table, column: usize) -> bool {
    let cells = || table.rows.iter().filter_map(|row| row.get(column));
    let number = |cell: &Cell| matches!(cell, Cell::Number { .. } | Cell::Best { .. });
    cells().any(number) && cells().all(|cell| number(cell) || matches!(cell, Cell::Missing(_)))
}

fn put_cell(out: &mut String, cell: &Cell, numeric: bool, heads_row: bool) {
    let (open, close) = if heads_row { ("th scope=\"row\"", "th") } else { ("td", "td") };
    let class = class_of(numeric);
    match cell {
        Cell::Text(text) => put!(out, "<{open}{class}>{}</{close}>", Escaped(text)),
        Cell::Number { value, decimals } => {
            put!(out, "<{open}{class} data-value=\"{value:e}\">{}</{close}>", shown(*value, *decimals));
        }
        Cell::Best { value, decimals } => put!(
            out,
            "<{open} class=\"{}best\" data-value=\"{value:e}\"><span class=\"star\" role=\"img\" \
             aria-label=\"best\">★</span><strong>{}</strong></{close}>",
            if numeric { "number " } else { "" },
            shown(*value, *decimals)
        ),
        Cell::Missing(why) => {
            let why = Escaped(if why.is_empty() { "–" } else { why });
            put!(out, "<{open} class=\"{}missing\">{why}</{close}>", if numeric { "number " } else { "" });
        }
    }
}

/// A number with its decimals; very large ones, and small ones of which no digit would be left, as powers of ten.
fn shown(value: f64, decimals: usize) -> String {
    let decimals = decimals.min(DECIMALS);
    if value.is_nan() {
        return "–".to_owned();
    }
    if value.is_infinite() {
        return if value > 0.0 { "∞" } else { "-∞" }.to_owned();
    }
    if value.abs() >= 1e9 {
        return scientific(value, decimals.clamp(1, 3));
    }
    let text = format!("{value:.decimals$}");
    let nothing_left = value != 0.0 && !text.bytes().any(|byte| matches!(byte, b'1'..=b'9'));
    if nothing_left && decimals > 0 { scientific(value, 1) } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_stay_short_and_keep_a_digit() {
        assert_eq!(shown(1.255, 1), "1.3");
        assert_eq!(shown(0.0, 2), "0.00");
        assert_eq!(shown(0.0004, 2), "4.0×10⁻⁴");
        assert_eq!(shown(-2.5e12, 2), "-2.50×10¹²");
        assert_eq!(shown(f64::NAN, 2), "–");
        assert_eq!(shown(0.1, usize::MAX).len(), 19);
    }
}
