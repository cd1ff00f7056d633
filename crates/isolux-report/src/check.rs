//! Refuses pages that cannot be rendered faithfully, before anything is written.

use std::collections::BTreeMap;

use crate::error::ReportError;
use crate::page::{Block, Page, Picture, Table};

/// Longest id: it becomes a file name.
const ID_LENGTH: usize = 64;

/// Refuses duplicate and unusable ids, ragged tables and pictures without pixels.
pub(crate) fn check(page: &Page) -> Result<(), ReportError> {
    let mut anchors = Ids::default();
    // Claims have a name space of their own: their anchors carry a prefix.
    let mut claims = Ids::default();
    for section in &page.sections {
        anchors.add(&section.id, "section")?;
        for block in &section.blocks {
            match block {
                Block::Text(_) | Block::Quote { .. } => {}
                Block::Chart(chart) => anchors.add(&chart.id, "chart")?,
                Block::Pictures(pictures) => {
                    for picture in pictures {
                        anchors.add(&picture.id, "picture")?;
                        check_picture(picture)?;
                    }
                }
                Block::Table(table) => {
                    anchors.add(&table.id, "table")?;
                    check_table(table)?;
                }
                Block::Claims(list) => {
                    for claim in list {
                        claims.add(&claim.id, "claim")?;
                    }
                }
            }
        }
    }
    Ok(())
}

#[derive(Default)]
struct Ids<'a>(BTreeMap<&'a str, &'static str>);

impl<'a> Ids<'a> {
    fn add(&mut self, id: &'a str, owner: &'static str) -> Result<(), ReportError> {
        let usable =
            |byte: u8| byte.is_ascii_lowercase() || byte.is_ascii_digit() || matches!(byte, b'-' | b'_');
        let starts = id.bytes().next().is_some_and(|byte| byte.is_ascii_alphanumeric());
        if !starts || id.len() > ID_LENGTH || !id.bytes().all(usable) {
            return Err(ReportError::InvalidId { id: id.to_owned(), owner });
        }
        match self.0.insert(id, owner) {
            Some(first) => Err(ReportError::DuplicateId { id: id.to_owned(), first, second: owner }),
            None => Ok(()),
        }
    }
}

fn check_picture(picture: &Picture) -> Result<(), ReportError> {
    let shape = picture.values.shape();
    let fits = |side: usize| side > 0 && i32::try_from(side).is_ok();
    if fits(shape.height) && fits(shape.width) {
        Ok(())
    } else {
        Err(ReportError::PictureShape { id: picture.id.clone(), shape })
    }
}

fn check_table(table: &Table) -> Result<(), ReportError> {
    let expected = table.columns.len();
    match table.rows.iter().enumerate().find(|(_, cells)| cells.len() != expected) {
        Some((row, cells)) => {
            Err(ReportError::RowLength { table: table.id.clone(), row, found: cells.len(), expected })
        }
        None => Ok(()),
    }
}
