//! How well a term fits its measurements.

use std::fmt;

use super::severity::Severity;

/// Which measurements a residual is taken from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ResidualOf {
    /// Those that the term was fitted to.
    Fitted,
    /// Those that were left out of the fit, in turn.
    HeldOut,
}

/// The residual of a term that is too large, or the largest of a calibration.
#[derive(Clone, Debug, PartialEq)]
pub struct TermResidual {
    /// The term.
    pub term: &'static str,
    /// Which measurements it is taken from.
    pub of: ResidualOf,
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
        let (term, percent, expected) = (self.term, 100.0 * self.residual, 50.0 * self.limit);
        match self.of {
            ResidualOf::Fitted => write!(
                f,
                "{term}: it leaves {percent:.1} % on the measurements that it was fitted to, {expected:.1} % or less \
                 expected: they contradict each other"
            ),
            ResidualOf::HeldOut => write!(
                f,
                "{term}: fitted without them, it misses measurements by {percent:.1} %, {expected:.1} % or less expected: \
                 they are too few, or contradict each other"
            ),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_of_the_limit_is_doubtful_and_the_words_name_the_measurements() {
        let found = |residual| TermResidual { term: "lut", of: ResidualOf::HeldOut, residual, limit: 0.2 };
        let severities = [0.09, 0.11, 0.21].map(|residual| found(residual).severity());
        assert_eq!(severities, [Severity::Note, Severity::Doubt, Severity::Poor]);
        let words = found(0.21).to_string();
        assert!(
            words.starts_with("lut: fitted without them, it misses measurements by 21.0 %, 10.0 % or less"),
            "{words}"
        );
    }
}
