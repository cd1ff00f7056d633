//! What is wrong with the description of a lens.

use crate::frame::Shape;

/// Names of distortions that are understood. Of each model the first is our own.
const KNOWN_NAMES: &str = "`brown_conrady` (plumb_bob, radtan), `inverse_brown_conrady`, `rational` \
     (rational_polynomial), `fisheye` (equidistant, kannala_brandt, kb4) and `none`";

/// A description of a lens that cannot be used.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LensError {
    /// A distortion of a name that isolux does not know.
    #[error("a distortion model named `{name}` found; known are {}", KNOWN_NAMES)]
    UnknownModel {
        /// The name, as it was given.
        name: String,
    },
    /// The wrong number of coefficients.
    #[error("{found} coefficients of the distortion model `{model}` found, {expected} expected")]
    CoefficientCount {
        /// The model.
        model: &'static str,
        /// Number of coefficients.
        found: usize,
        /// Numbers that the model takes.
        expected: &'static str,
    },
    /// Coefficients that are not finite.
    #[error("a coefficient of the distortion model `{model}` that is not a finite number found")]
    NotFinite {
        /// The model.
        model: &'static str,
    },
    /// Coefficients of a sensor that is tilted against its lens, and of thin prisms.
    #[error(
        "coefficients of thin prisms or a tilted sensor (the 9th and later, {value}) found, 0 expected: they are not \
         modelled"
    )]
    Prisms {
        /// The first of them that is not 0.
        value: f64,
    },
    /// A distortion that no pixel of the image lies in the domain of.
    #[error("a distortion that has no inverse at any pixel of the image found")]
    SeesNothing,
    /// Altitudes or azimuths of beams that are no angles.
    #[error("beam angles that are not finite, or altitudes beyond ±90° found, degrees expected")]
    BeamAngles,
    /// Another number of azimuths than of altitudes.
    #[error("{found} beam azimuths found, {expected} expected, as many as there are altitudes")]
    AzimuthCount {
        /// Number of azimuths.
        found: usize,
        /// Number of altitudes.
        expected: usize,
    },
    /// Another number of beams than the image has rows.
    #[error("{found} beam altitudes found, {expected} expected, as many as the image has rows")]
    BeamCount {
        /// Number of beams.
        found: usize,
        /// Rows of the image.
        expected: usize,
    },
    /// A table of rays of another shape than the image.
    #[error("a table of rays of {found} found, {expected} expected")]
    TableShape {
        /// Shape of the table.
        found: Shape,
        /// Shape of the image.
        expected: Shape,
    },
    /// Another number of values than three for each pixel.
    #[error("{found} values of a table of rays found, {expected} expected, three for each pixel")]
    TableValues {
        /// Number of values.
        found: usize,
        /// Three for each pixel.
        expected: usize,
    },
    /// A ray that points nowhere.
    #[error(
        "a ray of {ray:?} at row {row}, column {column} found, a finite direction that is not 0 expected, or three NaN \
         where the pixel sees nothing"
    )]
    Ray {
        /// Row of the pixel.
        row: usize,
        /// Column of the pixel.
        column: usize,
        /// The ray.
        ray: [f64; 3],
    },
    /// A table in which no pixel sees anything.
    #[error("a table without a single ray found")]
    EmptyTable,
}
