//! What is wrong with the description of a lens.

use std::fmt;

use crate::frame::Shape;

/// Names of distortions that are understood. Of each model the first is our own.
const KNOWN_NAMES: &str = "`brown_conrady` (plumb_bob, radtan), `inverse_brown_conrady`, `rational` \
     (rational_polynomial), `fisheye` (equidistant, kannala_brandt, kb4) and `none`";

/// A description of a lens that cannot be used.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum LensError {
    /// A distortion of a name that isolux does not know.
    UnknownModel {
        /// The name, as it was given.
        name: String,
    },
    /// The wrong number of coefficients.
    CoefficientCount {
        /// The model.
        model: &'static str,
        /// Number of coefficients.
        found: usize,
        /// Numbers that the model takes.
        expected: &'static str,
    },
    /// Coefficients that are not finite.
    NotFinite {
        /// The model.
        model: &'static str,
    },
    /// Coefficients of a sensor that is tilted against its lens, and of thin prisms.
    Prisms {
        /// The first of them that is not 0.
        value: f64,
    },
    /// A distortion that no pixel of the image lies in the domain of.
    SeesNothing,
    /// Altitudes or azimuths of beams that are no angles.
    BeamAngles,
    /// Another number of azimuths than of altitudes.
    AzimuthCount {
        /// Number of azimuths.
        found: usize,
        /// Number of altitudes.
        expected: usize,
    },
    /// Another number of beams than the image has rows.
    BeamCount {
        /// Number of beams.
        found: usize,
        /// Rows of the image.
        expected: usize,
    },
    /// A table of rays of another shape than the image.
    TableShape {
        /// Shape of the table.
        found: Shape,
        /// Shape of the image.
        expected: Shape,
    },
    /// Another number of values than three for each pixel.
    TableValues {
        /// Number of values.
        found: usize,
        /// Three for each pixel.
        expected: usize,
    },
    /// A ray that points nowhere.
    Ray {
        /// Row of the pixel.
        row: usize,
        /// Column of the pixel.
        column: usize,
        /// The ray.
        ray: [f64; 3],
    },
    /// A table in which no pixel sees anything.
    EmptyTable,
}

impl LensError {
    /// What was found.
    #[must_use]
    pub fn found(&self) -> String {
        match self {
            Self::UnknownModel { name } => format!("a distortion model named `{name}`"),
            Self::CoefficientCount { model, found, .. } => {
                format!("{found} coefficients of the distortion model `{model}`")
            }
            Self::NotFinite { model } => {
                format!("a coefficient of the distortion model `{model}` that is not finite")
            }
            Self::Prisms { value } => format!("a 9th or later coefficient of {value}"),
            Self::SeesNothing => "a distortion that has no inverse at any pixel of the image".to_owned(),
            Self::BeamAngles => "a beam's angle that is not finite, or an altitude beyond ±90°".to_owned(),
            Self::AzimuthCount { found, .. } => format!("{found} beam azimuths"),
            Self::BeamCount { found, .. } => format!("{found} beam altitudes"),
            Self::TableShape { found, .. } => format!("rays of {found}"),
            Self::TableValues { found, .. } => format!("{found} values of a table of rays"),
            Self::Ray { row, column, ray } => format!("a ray of {ray:?} at row {row}, column {column}"),
            Self::EmptyTable => "a table without a single ray".to_owned(),
        }
    }

    /// What should be there.
    #[must_use]
    pub fn expected(&self) -> String {
        match self {
            Self::UnknownModel { .. } => format!("one of {KNOWN_NAMES}"),
            Self::CoefficientCount { model, expected, .. } => format!("{expected} of the model `{model}`"),
            Self::NotFinite { .. } => "finite coefficients".to_owned(),
            Self::Prisms { .. } => "0: thin prisms and tilted sensors are not modelled".to_owned(),
            Self::SeesNothing => "one whose domain the image lies in".to_owned(),
            Self::BeamAngles => "degrees".to_owned(),
            Self::AzimuthCount { expected, .. } => format!("{expected}, as many as altitudes"),
            Self::BeamCount { expected, .. } => format!("{expected}, as many as the image has rows"),
            Self::TableShape { expected, .. } => format!("{expected}, one for each pixel"),
            Self::TableValues { expected, .. } => format!("{expected}, three for each pixel"),
            Self::Ray { .. } => {
                "a finite direction that is not 0, or three NaN where the pixel sees nothing".to_owned()
            }
            Self::EmptyTable => "one for every pixel that sees something".to_owned(),
        }
    }
}

impl fmt::Display for LensError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} found, {} expected", self.found(), self.expected())
    }
}

impl std::error::Error for LensError {}
