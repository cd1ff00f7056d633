//! How well a term fits its measurements.

use std::fmt;

use super::severity::Severity;

/// The residual of a term that is too large, or the largest of a calibration.
#[derive(Clone, Debug, PartialEq)]
pub struct TermResidual {
    /// The term.
    pub term: &'static str,
    /// Relative error that it leaves on its measurements, root mean square.
    pub residual: f64,
    /// The error above which it is poor; half of it is doubtful.
    pub limit: f64,
}

impl TermResidual {
    /// How much it weighs.
    #[must_use]
    pub fn severity(&self) -> Severity {
        if self.residual > self.limit {
            Severity::Poor
        } else if self.residual > 0.5 * self.limit {
            Severity::Doubt
        } else {
            Severity::Note
        }
    }
}

impl fmt::Display for TermResidual {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{}: it leaves {:.1} % on the measurements that it was fitted to, {:.1} % or less expected: they contradict \
             each other",
            self.term,
            100.0 * self.residual,
            50.0 * self.limit
        )
    }
}
