//! Why no tier can be fitted to a sweep.

/// Why the tier is not determined.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum AmbientError {
    /// Too few positions.
    #[error("{found} positions at known times found, at least {expected} expected")]
    TooFewSamples {
        /// Number found.
        found: usize,
        /// Number that the fit needs.
        expected: usize,
    },
    /// One time only.
    #[error("one integration time found, at least 2 expected: saturation shows in how they differ")]
    OneTime,
    /// No position covers the reference.
    #[error("no position at or around the reference distance of {reference_m} m")]
    ReferenceOutside {
        /// The reference distance, m.
        reference_m: f64,
    },
    /// The amplitudes are all in proportion to the time.
    #[error(
        "no position is compressed by more than {:.1} %, so that the full well is not determined: record the target \
         nearer, or at longer times, until it saturates", 100.0 * most
    )]
    NoCompression {
        /// Largest compression found.
        most: f64,
    },
    /// The model does not describe the amplitudes.
    #[error(
        "the amplitudes contradict the model of a saturating pixel by {:.1} %: is the target the same everywhere, does \
         it face the camera, and is the ambient light steady?", 100.0 * residual
    )]
    Misfit {
        /// Root mean square of the relative errors.
        residual: f64,
    },
}
