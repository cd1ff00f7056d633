//! The files beside a page, and the links to them.

use crate::markup::put;

/// Whether the files of [`crate::write_report`] lie beside the page.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Companions {
    /// `data/ID.csv` and `pictures/ID.png` are there: figures link to them.
    Beside,
    /// The page is all there is: no links to files.
    Absent,
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
