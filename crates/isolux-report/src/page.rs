//! The contents of a report, without their appearance, which is up to the renderer.

use isolux::Plane;

/// A report: one self-contained page.
#[derive(Clone, Debug, PartialEq)]
pub struct Page {
    /// Heading and title of the document.
    pub title: String,
    /// One or two sentences below it: what this is, and the result.
    pub lead: String,
    /// Sections in their order; each gets an entry in the table of contents.
    pub sections: Vec<Section>,
    /// How the page was made: program, seed.
    pub colophon: String,
}

/// One part of a page.
#[derive(Clone, Debug, PartialEq)]
pub struct Section {
    /// Anchor, unique within the page: lower-case letters, digits and hyphens.
    pub id: String,
    /// Heading.
    pub title: String,
    /// Contents in their order.
    pub blocks: Vec<Block>,
}

/// One piece of a section.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Block {
    /// A paragraph of plain text.
    Text(String),
    /// What was said elsewhere, with its source.
    Quote {
        /// The statement, in our words.
        text: String,
        /// Where it stands.
        source: String,
    },
    /// Curves or points over an axis.
    Chart(Chart),
    /// Images side by side, on phones below each other.
    Pictures(Vec<Picture>),
    /// Numbers in rows and columns.
    Table(Table),
    /// Statements with what was measured.
    Claims(Vec<Claim>),
}

/// Curves or points over an axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Chart {
    /// Anchor and name of its CSV file: unique within the page.
    pub id: String,
    /// Caption: what is shown.
    pub caption: String,
    /// The same for a reader who cannot see it: what the curves do.
    pub alt: String,
    /// Horizontal axis.
    pub x: Axis,
    /// Vertical axis.
    pub y: Axis,
    /// Curves.
    pub series: Vec<Series>,
    /// Straight lines that mark a value.
    pub marks: Vec<Mark>,
}

/// One axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// Quantity and unit, e.g. "distance in m".
    pub label: String,
    /// Linear or logarithmic.
    pub scale: Scale,
    /// Ends of the axis; from the data where it is `None`.
    pub range: Option<(f64, f64)>,
}

/// Scale of an axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Scale {
    /// Equal steps for equal differences.
    #[default]
    Linear,
    /// Equal steps for equal ratios; values that are not positive are left out.
    Log,
}

/// One curve.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// Name in the legend.
    pub name: String,
    /// (x, y) in drawing order; a pair with NaN interrupts the curve.
    pub points: Vec<(f64, f64)>,
    /// How it is drawn.
    pub stroke: Stroke,
}

/// How a curve is drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Stroke {
    /// A line.
    #[default]
    Solid,
    /// A dashed line.
    Dashed,
    /// Points only.
    Points,
    /// A line with points.
    SolidPoints,
}

/// A straight line that marks a value.
#[derive(Clone, Debug, PartialEq)]
pub struct Mark {
    /// Which axis the value is on.
    pub axis: MarkAxis,
    /// The value.
    pub at: f64,
    /// What it means.
    pub label: String,
}

/// Which axis a mark is on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MarkAxis {
    /// A vertical line at an x.
    X,
    /// A horizontal line at a y.
    Y,
}

/// An image with a colour bar.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Anchor and file name: unique within the page.
    pub id: String,
    /// Caption.
    pub caption: String,
    /// What it shows, for a reader who cannot see it.
    pub alt: String,
    /// The values; NaN is drawn in a colour of its own.
    pub values: Plane<f32>,
    /// Values of the ends of the colour bar.
    pub range: (f32, f32),
    /// Label of the colour bar: quantity and unit.
    pub label: String,
    /// Colours.
    pub colours: Colours,
}

/// Colours of an image.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Colours {
    /// Black to white, for amplitudes.
    #[default]
    Grey,
    /// Perceptually even, for distances and factors.
    Viridis,
}

/// Numbers in rows and columns.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// Anchor and name of its CSV file: unique within the page.
    pub id: String,
    /// Caption.
    pub caption: String,
    /// Headings with units; the first column names the row.
    pub columns: Vec<String>,
    /// Rows, each with one cell per column.
    pub rows: Vec<Vec<Cell>>,
}

/// One cell of a table.
#[derive(Clone, Debug, PartialEq)]
pub enum Cell {
    /// Words.
    Text(String),
    /// A number and how many decimals to show; the CSV has all.
    Number {
        /// The value.
        value: f64,
        /// Decimals on the page.
        decimals: usize,
    },
    /// No value, and why.
    Missing(String),
    /// A number that is the best of its kind in this table.
    Best {
        /// The value.
        value: f64,
        /// Decimals on the page.
        decimals: usize,
    },
}

/// A statement, and whether it holds here.
#[derive(Clone, Debug, PartialEq)]
pub struct Claim {
    /// Short name for tests, unique within the page.
    pub id: String,
    /// What is stated.
    pub statement: String,
    /// What was measured, with numbers and units.
    pub measured: String,
    /// The number that decides.
    pub value: f64,
    /// The verdict.
    pub verdict: Verdict,
}

/// Whether a statement holds.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// It does.
    Holds,
    /// It does not; why.
    Fails(String),
    /// The simulation cannot tell, or the statement is open; why.
    Open(String),
}
