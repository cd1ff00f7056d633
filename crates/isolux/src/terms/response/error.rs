//! Why no response can be fitted.

/// Why a tier could not be fitted.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ResponseError {
    /// Too few integration times.
    #[error(
        "{found} usable integration times found, at least {expected} expected: vary the time in the sweep"
    )]
    TooFewTimes {
        /// Number found.
        found: usize,
        /// Number that the tier needs.
        expected: usize,
    },
    /// The sweep does not determine the well.
    #[error(
        "hardly any pixel is compressed, so that the full well is not determined: extend the sweep to longer times, \
         until the brightest pixels saturate"
    )]
    NoCompression,
    /// A map of the image would not fit into a calibration file.
    #[error(
        "{pixels} pixels found, at most {most} expected: a map of them is too large for a calibration file"
    )]
    ImageTooLarge {
        /// Pixels of the image.
        pixels: usize,
        /// Pixels that a map may have.
        most: usize,
    },
}
