//! What can be wrong with a page.

use std::io;
use std::path::PathBuf;

use isolux::Shape;

/// Why a page was not rendered or not written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReportError {
    /// Two things on one page carry the same id.
    #[error("the id `{id}` is used twice, by a {first} and by a {second}: give each its own")]
    DuplicateId {
        /// The id.
        id: String,
        /// What carries it first.
        first: &'static str,
        /// What carries it again.
        second: &'static str,
    },
    /// An id cannot be an anchor and a file name.
    #[error(
        "the {owner} id `{id}` is not usable: 1 to 64 lower-case letters, digits, hyphens and underscores \
         expected, a letter or digit first"
    )]
    InvalidId {
        /// The id.
        id: String,
        /// What carries it.
        owner: &'static str,
    },
    /// A row of a table does not fit its headings.
    #[error("row {row} of table `{table}` has {found} cells, {expected} expected, one for each heading")]
    RowLength {
        /// Id of the table.
        table: String,
        /// Row, from 0.
        row: usize,
        /// Cells in the row.
        found: usize,
        /// Headings of the table.
        expected: usize,
    },
    /// A picture without pixels, or with more than a PNG can hold.
    #[error("the picture `{id}` is {shape}: 1 to {} rows and columns expected", i32::MAX)]
    PictureShape {
        /// Id of the picture.
        id: String,
        /// Its shape.
        shape: Shape,
    },
    /// A montage without pictures, or with pictures of unlike shapes.
    #[error("a montage needs pictures of one shape with at least one pixel; found {found}")]
    Montage {
        /// What was found instead.
        found: String,
    },
    /// A PNG could not be made.
    #[error("cannot make a PNG: {0}")]
    Png(#[from] png::EncodingError),
    /// The file name of a report is none.
    #[error("`{found}` is no name for the page: a plain file name such as `report.html` expected")]
    FileName {
        /// The name that was given.
        found: String,
    },
    /// A file or folder could not be written.
    #[error("cannot write `{}`: {source}", path.display())]
    Write {
        /// The file or folder.
        path: PathBuf,
        /// The error of the operating system.
        source: io::Error,
    },
}
