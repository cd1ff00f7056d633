//! How much a finding weighs.

/// Errors of a term beyond this share make it useless: the aim of a calibration is a few per cent.
pub(super) const POOR_SHARE: f64 = 0.05;
/// Errors beyond this share are worth a warning: half of what is refused.
pub(super) const DOUBTFUL_SHARE: f64 = 0.5 * POOR_SHARE;

/// How much a finding weighs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// It says what was left out, as in any calibration.
    Note,
    /// The terms hold, but a better recording would give better ones.
    Doubt,
    /// At least one term is wrong.
    Poor,
}
