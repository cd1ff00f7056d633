//! Is a calibration good?

use std::fmt;

use super::report::FitReport;
use super::residual::{ResidualOf, TermResidual};
use super::severity::{POOR_SHARE, Severity};
use super::warning::FitWarning;
use crate::advice::Advice;
use crate::calibration::Calibration;

/// The windows of targets and the facets of scenes scatter by more, each by its own gloss and pose; thousands of them
/// still make a law. Twice the share of a real checkerboard's squares.
const POOR_SCATTER: f64 = 0.12;

/// A sample of the table is predicted from its neighbours, twice as far apart as the samples between which the table
/// is used; the error of interpolation grows with the square of that.
const WIDER_STEPS: f64 = 4.0;

/// What a calibration is worth, and why.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Verdict {
    /// Nothing is doubtful.
    Good {
        /// The term that fits least well.
        worst: Option<TermResidual>,
    },
    /// The terms hold, but the recordings could be better.
    Usable {
        /// What is doubtful, at least one finding.
        reasons: Vec<FitWarning>,
    },
    /// At least one term is wrong.
    Poor {
        /// What makes it so, at least one finding.
        reasons: Vec<FitWarning>,
    },
}

impl Verdict {
    /// Judges a calibration by what its fits found.
    #[must_use]
    pub fn of(calibration: &Calibration, report: &FitReport) -> Self {
        let weighing = |severity| -> Vec<FitWarning> {
            let reasons = report.warnings.iter().filter(|warning| warning.severity() == severity);
            reasons.cloned().collect()
        };
        let poor = weighing(Severity::Poor);
        if !poor.is_empty() {
            return Self::Poor { reasons: poor };
        }
        let doubts = weighing(Severity::Doubt);
        if !doubts.is_empty() {
            return Self::Usable { reasons: doubts };
        }
        let share = |found: &TermResidual| found.residual / found.limit;
        let worst = residuals(calibration, report)
            .into_iter()
            .filter(|found| found.of == ResidualOf::Fitted)
            .reduce(|worst, next| if share(&next) > share(&worst) { next } else { worst });
        Self::Good { worst }
    }

    /// The findings that it rests on.
    #[must_use]
    pub fn reasons(&self) -> &[FitWarning] {
        match self {
            Self::Good { .. } => &[],
            Self::Usable { reasons } | Self::Poor { reasons } => reasons,
        }
    }

    /// What the user can do about the first of them that can be helped.
    #[must_use]
    pub fn advice(&self) -> Option<Advice> {
        self.reasons().iter().find_map(FitWarning::advice)
    }
}

/// One line: the verdict and why.
impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let because = |f: &mut fmt::Formatter<'_>, word: &str, reasons: &[FitWarning]| {
            write!(f, "{word}")?;
            let Some((first, others)) = reasons.split_first() else { return Ok(()) };
            write!(f, ": {first}")?;
            if others.is_empty() { Ok(()) } else { write!(f, " (and {} more)", others.len()) }
        };
        match self {
            Self::Good { worst: None } => f.write_str("good: nothing contradicts it"),
            Self::Good { worst: Some(worst) } => {
                let (term, percent) = (worst.term, 100.0 * worst.residual);
                write!(f, "good: no term leaves more than {percent:.1} % on its measurements ({term})")
            }
            Self::Usable { reasons } => because(f, "usable", reasons),
            Self::Poor { reasons } => because(f, "not usable", reasons),
        }
    }
}

/// The residuals of all terms that a calibration is judged by. The cubic is not among them where there is a spline:
/// it is the paper's, and leaves several per cent where some times saturate and others do not.
fn residuals(calibration: &Calibration, report: &FitReport) -> Vec<TermResidual> {
    let terms = &calibration.terms;
    let mut found = Vec::new();
    let mut add = |term, of, residual: Option<f64>, limit| {
        found.extend(residual.map(|residual| TermResidual { term, of, residual, limit }));
    };
    // Several sweeps show several scenes, whose saturation differs.
    if report.exposure_curves.len() == 1 {
        let fit = terms.lut.as_ref().map(|lut| &lut.fit);
        add("lut", ResidualOf::Fitted, fit.map(|fit| fit.residual), POOR_SHARE);
        let held_out = fit.and_then(|fit| fit.held_out_residual);
        add("lut", ResidualOf::HeldOut, held_out, WIDER_STEPS * POOR_SHARE);
    }
    let uses = &report.spline_uses;
    if uses.is_empty() {
        let laws = [
            ("spline", terms.spline.as_ref().map(|spline| &spline.fit)),
            ("profile", terms.profile.as_ref().map(|profile| &profile.fit)),
        ];
        for (term, fit) in laws {
            add(term, ResidualOf::Fitted, fit.map(|fit| fit.residual), POOR_SCATTER);
            add(term, ResidualOf::HeldOut, fit.and_then(|fit| fit.held_out_residual), POOR_SCATTER);
        }
    } else {
        // Without the positions that the fit found to be outliers, saturated ones for the most part.
        let kept = uses.iter().filter_map(|used| used.residual);
        add("spline", ResidualOf::Fitted, kept.reduce(f64::max), POOR_SHARE);
        let unseen = uses.iter().filter_map(|used| used.held_out_error);
        add("spline", ResidualOf::HeldOut, unseen.reduce(f64::max), POOR_SHARE);
    }
    found
}

/// A warning about each term that fits its measurements badly.
pub(super) fn misfits(calibration: &Calibration, report: &FitReport) -> Vec<FitWarning> {
    let bad = |found: &TermResidual| found.severity() > Severity::Note;
    residuals(calibration, report).into_iter().filter(bad).map(FitWarning::Residual).collect()
}
