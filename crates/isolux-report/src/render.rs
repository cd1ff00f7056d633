//! The page around the blocks.

use crate::chart;
use crate::check::check;
use crate::error::ReportError;
use crate::markup::{Escaped, put};
use crate::page::{Block, Chart, Claim, Page, Section, Verdict};
use crate::picture::put_pictures;
use crate::table::put_table;

const STYLE: &str = include_str!("assets/page.css");
const SCRIPT: &str = include_str!("assets/page.js");

/// Whether the files of [`crate::write_report`] lie beside the page.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Companions {
    /// `data/ID.csv` and `pictures/ID.png` are there: figures link to them.
    Beside,
    /// The page is all there is: no links to files.
    Absent,
}

/// A page as one HTML document that needs nothing else and asks no network, with links to the CSV files that
/// [`crate::write_report`] lays beside it. The same page gives the same bytes.
///
/// The document is well-formed XML too.
///
/// # Errors
/// [`ReportError::DuplicateId`], [`ReportError::InvalidId`], [`ReportError::RowLength`] and
/// [`ReportError::PictureShape`] name what is wrong with the page; [`ReportError::Png`] and
/// [`ReportError::Drawing`] pass on what the libraries refuse.
pub fn render(page: &Page) -> Result<String, ReportError> {
    render_with(page, Companions::Beside)
}

/// As [`render`], for a page that lies alone or not.
///
/// # Errors
/// As [`render`].
pub fn render_with(page: &Page, companions: Companions) -> Result<String, ReportError> {
    check(page)?;
    let mut out = String::new();
    put_head(&mut out, page);
    out.push_str("<body>\n<a class=\"skip\" href=\"#_main\">Skip to the contents</a>\n");
    put!(out, "<header>\n<h1>{}</h1>\n", Escaped(&page.title));
    put_paragraphs(&mut out, &page.lead, "lead");
    out.push_str("</header>\n");
    put_contents(&mut out, page);
    out.push_str("<main id=\"_main\">\n");
    for section in &page.sections {
        put_section(&mut out, section, companions)?;
    }
    out.push_str("</main>\n<footer>\n");
    put_paragraphs(&mut out, &page.colophon, "colophon");
    put!(out, "</footer>\n<script>\n{SCRIPT}</script>\n</body>\n</html>\n");
    Ok(out)
}

fn put_head(out: &mut String, page: &Page) {
    put!(
        out,
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n\
         <meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; img-src data:; \
         style-src 'unsafe-inline'; script-src 'unsafe-inline'\"/>\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n\
         <meta name=\"color-scheme\" content=\"light dark\"/>\n\
         <title>{}</title>\n<style>\n{STYLE}</style>\n</head>\n",
        Escaped(&page.title)
    );
}

fn put_contents(out: &mut String, page: &Page) {
    if page.sections.len() < 2 {
        return;
    }
    out.push_str("<nav aria-label=\"Contents\">\n<ol>\n");
    for section in &page.sections {
        put!(out, "<li><a href=\"#{}\">{}</a></li>\n", section.id, Escaped(&section.title));
    }
    out.push_str("</ol>\n</nav>\n");
}

fn put_section(out: &mut String, section: &Section, companions: Companions) -> Result<(), ReportError> {
    put!(out, "<section id=\"{}\">\n<h2>{}</h2>\n", section.id, Escaped(&section.title));
    for block in &section.blocks {
        match block {
            Block::Text(text) => put_paragraphs(out, text, ""),
            Block::Quote { text, source } => {
                out.push_str("<figure class=\"quote\">\n<blockquote>\n");
                put_paragraphs(out, text, "");
                put!(out, "</blockquote>\n<figcaption>{}</figcaption>\n</figure>\n", Escaped(source));
            }
            Block::Chart(chart) => put_chart_figure(out, chart, companions)?,
            Block::Pictures(pictures) => put_pictures(out, pictures)?,
            Block::Table(table) => put_table(out, table, companions),
            Block::Claims(claims) => put_claims(out, claims),
        }
    }
    out.push_str("</section>\n");
    Ok(())
}

/// Paragraphs of plain text; an empty line starts a new one.
fn put_paragraphs(out: &mut String, text: &str, class: &str) {
    let paragraphs = text.split("\n\n").map(str::trim).filter(|paragraph| !paragraph.is_empty());
    for paragraph in paragraphs {
        match class {
            "" => put!(out, "<p>{}</p>\n", Escaped(paragraph)),
            _ => put!(out, "<p class=\"{class}\">{}</p>\n", Escaped(paragraph)),
        }
    }
}

fn put_chart_figure(out: &mut String, chart: &Chart, companions: Companions) -> Result<(), ReportError> {
    put!(out, "<figure class=\"chart\" id=\"{}\">\n", chart.id);
    chart::put_chart(out, chart)?;
    put!(out, "<figcaption>{}", Escaped(&chart.caption));
    if let Some(note) = chart::left_out(chart) {
        put!(out, " <span class=\"note\">{note}</span>");
    }
    put_csv_link(out, &chart.id, companions);
    out.push_str("</figcaption>\n</figure>\n");
    Ok(())
}

/// A link to the numbers of a figure.
pub(crate) fn put_csv_link(out: &mut String, id: &str, companions: Companions) {
    if companions == Companions::Beside {
        put!(
            out,
            " <a class=\"file\" href=\"data/{id}.csv\" download=\"{id}.csv\" \
             title=\"All digits, in the folder data beside this page\">CSV</a>"
        );
    }
}

fn put_claims(out: &mut String, claims: &[Claim]) {
    if claims.is_empty() {
        return;
    }
    put_tally(out, claims);
    out.push_str("<ul class=\"claims\">\n");
    for claim in claims {
        let (class, symbol, word, why) = match &claim.verdict {
            Verdict::Holds => ("holds", "✓", "holds", None),
            Verdict::Fails(why) => ("fails", "✗", "fails", Some(why)),
            Verdict::Open(why) => ("open", "?", "open", Some(why)),
        };
        put!(
            out,
            "<li class=\"{class}\" id=\"claim:{0}\" data-claim=\"{0}\" data-value=\"{1}\">\n\
             <p class=\"verdict\"><span aria-hidden=\"true\">{symbol}</span> {word}</p>\n\
             <div>\n<p class=\"statement\">{2}</p>\n<p class=\"measured\">{3}</p>\n",
            claim.id,
            crate::csv::number(claim.value),
            Escaped(&claim.statement),
            Escaped(&claim.measured)
        );
        if let Some(why) = why.filter(|why| !why.is_empty()) {
            put!(out, "<p class=\"why\">Why: {}</p>\n", Escaped(why));
        }
        out.push_str("</div>\n</li>\n");
    }
    out.push_str("</ul>\n");
}

/// How many of several statements hold.
fn put_tally(out: &mut String, claims: &[Claim]) {
    if claims.len() < 2 {
        return;
    }
    let count = |which: fn(&Verdict) -> bool| claims.iter().filter(|claim| which(&claim.verdict)).count();
    let counts = [
        (count(|verdict| matches!(verdict, Verdict::Holds)), "holds", "hold"),
        (count(|verdict| matches!(verdict, Verdict::Fails(_))), "fails", "fail"),
        (count(|verdict| matches!(verdict, Verdict::Open(_))), "is open", "are open"),
    ];
    let told = counts.iter().filter(|(count, ..)| *count > 0);
    let words: Vec<String> =
        told.map(|(count, one, more)| format!("{count} {}", if *count == 1 { one } else { more })).collect();
    put!(out, "<p class=\"tally\">Of {} statements {}.</p>\n", claims.len(), words.join(", "));
}
