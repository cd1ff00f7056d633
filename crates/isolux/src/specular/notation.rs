//! Rules as texts: the name, then parameters, such as `histogram` or `percent:quantile=0.9`.

use std::fmt;
use std::str::FromStr;

use super::{HistogramRule, KneeRule, PercentRule, SigmaRule, SpecularRule};
use crate::names::{UnknownName, by_name, one_of};

/// Why a text is not a rule.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum RuleError {
    /// No rule has this name.
    #[error(transparent)]
    Rule(#[from] UnknownName),
    /// The rule has no such parameter.
    #[error("parameter `{found}` found, {expected} expected: the rule `{rule}` has no other")]
    Parameter {
        /// Name of the rule.
        rule: &'static str,
        /// The text.
        found: String,
        /// The parameters it has.
        expected: String,
    },
    /// The parameter has an impossible value.
    #[error("`{parameter}` found as `{found}`, {expected} expected")]
    Value {
        /// Name of the parameter.
        parameter: &'static str,
        /// The text.
        found: String,
        /// What it should be.
        expected: &'static str,
    },
}

/// Parameters, in the notation and in errors.
const OCCURRENCES: &str = "occurrences";
const DEVIATIONS: &str = "deviations";
const FRACTION: &str = "fraction";
const QUANTILE: &str = "quantile";

impl SpecularRule {
    /// The names of the rules.
    pub const NAMES: &'static [&'static str] = &["histogram", "sigma", "percent", "knee"];

    /// Every rule with its default parameters.
    #[must_use]
    pub fn all() -> [Self; 4] {
        [
            Self::Histogram(HistogramRule::default()),
            Self::Sigma(SigmaRule::default()),
            Self::Percent(PercentRule::default()),
            Self::Knee(KneeRule::default()),
        ]
    }
}

impl fmt::Display for SpecularRule {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = self.name();
        match self {
            Self::Histogram(HistogramRule { occurrences: None })
            | Self::Knee(KneeRule { cutoff: HistogramRule { occurrences: None } }) => f.write_str(name),
            Self::Histogram(HistogramRule { occurrences: Some(count) })
            | Self::Knee(KneeRule { cutoff: HistogramRule { occurrences: Some(count) } }) => {
                write!(f, "{name}:{OCCURRENCES}={count}")
            }
            Self::Sigma(rule) => write!(f, "{name}:{DEVIATIONS}={}", rule.deviations),
            Self::Percent(PercentRule::OfMaximum(fraction)) => write!(f, "{name}:{FRACTION}={fraction}"),
            Self::Percent(PercentRule::Quantile(fraction)) => write!(f, "{name}:{QUANTILE}={fraction}"),
        }
    }
}

impl FromStr for SpecularRule {
    type Err = RuleError;

    fn from_str(text: &str) -> Result<Self, RuleError> {
        let (name, parameter) = match text.split_once(':') {
            Some((name, parameter)) => (name, Some(parameter)),
            None => (text, None),
        };
        let rule = Self::all().into_iter().find(|rule| rule.name() == name);
        let rule = rule.ok_or_else(|| UnknownName::new("specular rule", name, Self::NAMES))?;
        parameter.map_or(Ok(rule), |parameter| rule.with(parameter))
    }
}

impl SpecularRule {
    /// The rule with a parameter, `name=value`.
    fn with(self, text: &str) -> Result<Self, RuleError> {
        let (key, value) = text.split_once('=').unwrap_or((text, ""));
        match (self, key) {
            (Self::Histogram(_), OCCURRENCES) => {
                Ok(Self::Histogram(HistogramRule { occurrences: Some(occurrences(value)?) }))
            }
            (Self::Knee(_), OCCURRENCES) => {
                let cutoff = HistogramRule { occurrences: Some(occurrences(value)?) };
                Ok(Self::Knee(KneeRule { cutoff }))
            }
            (Self::Sigma(_), DEVIATIONS) => {
                let expected = "a positive number";
                let deviations = number(DEVIATIONS, value, f64::INFINITY, expected)?;
                Ok(Self::Sigma(SigmaRule { deviations }))
            }
            (Self::Percent(_), FRACTION) => {
                Ok(Self::Percent(PercentRule::OfMaximum(share(FRACTION, value)?)))
            }
            (Self::Percent(_), QUANTILE) => Ok(Self::Percent(PercentRule::Quantile(share(QUANTILE, value)?))),
            (rule, _) => {
                let names: &[&str] = match rule {
                    Self::Histogram(_) | Self::Knee(_) => &[OCCURRENCES],
                    Self::Sigma(_) => &[DEVIATIONS],
                    Self::Percent(_) => &[FRACTION, QUANTILE],
                };
                let (rule, expected) = (rule.name(), one_of(names));
                Err(RuleError::Parameter { rule, found: key.to_owned(), expected })
            }
        }
    }
}

fn occurrences(text: &str) -> Result<u32, RuleError> {
    let expected = "a whole number of 1 or more";
    let value = text.parse().ok().filter(|count| *count > 0);
    value.ok_or_else(|| RuleError::Value { parameter: OCCURRENCES, found: text.to_owned(), expected })
}

fn share(parameter: &'static str, text: &str) -> Result<f64, RuleError> {
    number(parameter, text, 1.0, "a fraction above 0 and up to 1")
}

fn number(
    parameter: &'static str,
    text: &str,
    largest: f64,
    expected: &'static str,
) -> Result<f64, RuleError> {
    let value =
        text.parse().ok().filter(|value: &f64| *value > 0.0 && value.is_finite() && *value <= largest);
    value.ok_or_else(|| RuleError::Value { parameter, found: text.to_owned(), expected })
}

by_name!(SpecularRule);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rules_read_back_from_their_texts() {
        for text in [
            "histogram",
            "histogram:occurrences=7",
            "sigma:deviations=2.5",
            "percent:fraction=0.9",
            "percent:quantile=0.25",
            "knee",
            "knee:occurrences=2",
        ] {
            assert_eq!(text.parse::<SpecularRule>().unwrap().to_string(), text);
        }
        assert_eq!("percent".parse::<SpecularRule>().unwrap().to_string(), "percent:fraction=0.9");
        assert_eq!(SpecularRule::all().map(|rule| rule.name()), SpecularRule::NAMES);
    }

    #[test]
    fn what_is_no_rule_is_refused_with_what_would_be() {
        for (text, words) in [
            ("median", "specular rule `median` found, histogram, sigma, percent or knee expected"),
            ("histogram:deviations=3", "parameter `deviations` found, occurrences expected"),
            ("percent:quantile=1.5", "a fraction above 0 and up to 1 expected"),
            ("percent:quantile", "`quantile` found as ``"),
            ("sigma:deviations=NaN", "a positive number expected"),
            ("histogram:occurrences=0", "a whole number of 1 or more expected"),
            ("", "specular rule `` found"),
        ] {
            let error = text.parse::<SpecularRule>().unwrap_err().to_string();
            assert!(error.contains(words), "{text}: {error}");
        }
    }
}
