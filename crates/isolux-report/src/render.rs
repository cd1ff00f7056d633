//! The page around the blocks.

use crate::chart::put_chart;
use crate::check::check;
use crate::claims::put_claims;
use crate::companions::Companions;
use crate::error::ReportError;
use crate::markup::{Escaped, put};
use crate::page::{Block, Page, Section};
use crate::picture::put_pictures;
use crate::table::put_table;

const STYLE: &str = include_str!("assets/page.css");
const SCRIPT: &str = include_str!("assets/page.js");

/// A page as one HTML document that needs nothing else and asks no network, with links to the CSV files that
/// [`crate::write_report`] lays beside it. The same page gives the same bytes.
///
/// The document is well-formed XML too.
///
/// # Errors
/// [`ReportError::DuplicateId`], [`ReportError::InvalidId`], [`ReportError::RowLength`] and
/// [`ReportError::PictureShape`] name what is wrong with the page; [`ReportError::Png`] passes on what the encoder
/// refuses.
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
            Block::Chart(chart) => put_chart(out, chart, companions),
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
