//! The options that choose the steps of the chain. Names and descriptions of the steps are the core's.

use std::str::FromStr;

use clap::Args;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use isolux::standardize::{
    AngleStep, DenoiseStep, DistanceStep, Method, ProfileStep, SpecularStep, TimeStep,
};
use isolux::terms::response::ResponseTier;
use isolux::{Choice, DenoiseRule, RecordingTraits};

use super::sigma::SigmaArgs;
use super::values::positive;
use crate::failure::Failure;

/// The rules for highlights, laid out like the values of the other options.
const SPECULAR_HELP: &str = "\
How to limit highlights: a rule, or a rule with its parameter [default: histogram]

Possible rules, with their parameter and its usual value:
- histogram: Limit at the highest value that occurs in enough pixels;
             histogram:occurrences=N [usual: max(2, 0.0005 of the valid pixels)]
- sigma:     Limit at K standard deviations above the mean;
             sigma:deviations=K [usual: 4]
- percent:   Limit at a fraction of the maximum, or at a quantile of the image;
             percent:fraction=F [usual: 0.9] or percent:quantile=Q
- knee:      Compress what lies above the limit of histogram, keeping its order;
             knee:occurrences=N [usual: as for histogram]
- none:      Limit nothing";

/// Which steps to apply.
#[derive(Debug, Default, Args)]
pub(crate) struct StepArgs {
    /// Steps to apply where no option below names one
    #[arg(long, default_value_t, value_parser = named(Method::ALL, Method::name, Method::description))]
    pub(crate) method: Method,
    /// How to correct the integration time [default: by method]
    #[arg(long, value_parser = named(TimeStep::ALL, TimeStep::name, TimeStep::description))]
    pub(crate) time: Option<TimeStep>,
    /// For --time response: what to compute the fill of each pixel from, that is, how near it is to saturation
    /// [default: the best that calibration and recording allow]
    #[arg(long, value_name = "TIER")]
    #[arg(value_parser = named(ResponseTier::ALL, ResponseTier::name, ResponseTier::description))]
    pub(crate) response_tier: Option<ResponseTier>,
    /// How to correct the distance [default: by method]
    #[arg(long, value_parser = named(DistanceStep::ALL, DistanceStep::name, DistanceStep::description))]
    pub(crate) distance: Option<DistanceStep>,
    /// Smooth the distance before the amplitude is corrected with it [default: none]
    #[arg(long, value_parser = denoise_steps())]
    pub(crate) denoise: Option<DenoiseStep>,
    /// Correct the uneven illumination of the image [default: on with --method best]
    #[arg(long, value_parser = named(ProfileStep::ALL, ProfileStep::name, ProfileStep::description))]
    pub(crate) profile: Option<ProfileStep>,
    /// Correct the angle at which the light meets each surface; needs intrinsics [default: off]
    #[arg(long, value_parser = named(AngleStep::ALL, AngleStep::name, AngleStep::description))]
    pub(crate) angle: Option<AngleStep>,
    /// How to limit highlights: a rule, or a rule with its parameter [default: histogram]
    #[arg(long, value_name = "RULE", long_help = SPECULAR_HELP)]
    pub(crate) specular: Option<SpecularStep>,
    /// Flag amplitudes below this as LOW_SIGNAL, DN [default: from the calibration]
    #[arg(long, value_name = "DN", value_parser = positive)]
    pub(crate) low_signal_dn: Option<f64>,
    #[command(flatten)]
    pub(crate) sigma: SigmaArgs,
}

impl StepArgs {
    /// The steps as the core takes them.
    pub(crate) fn choice(&self) -> Result<Choice, Failure> {
        if self.response_tier.is_some() && self.time != Some(TimeStep::Response) {
            return Err(Failure::usage("--response-tier belongs to --time response, which is not chosen"));
        }
        let mut choice = Choice {
            method: self.method,
            time: self.time,
            response_tier: self.response_tier,
            denoise: self.denoise,
            distance: self.distance,
            profile: self.profile,
            angle: self.angle,
            specular: self.specular,
            low_signal_below_dn: self.low_signal_dn.map(|dn| dn as f32),
            ..Choice::default()
        };
        self.sigma.complete(&mut choice)?;
        Ok(choice)
    }

    /// The recording's traits, with what the options know better.
    pub(crate) fn traits(&self, recorded: RecordingTraits) -> RecordingTraits {
        let told_hz = self.sigma.modulation_frequency_hz;
        let modulation_frequency_hz = told_hz.or(recorded.modulation_frequency_hz);
        RecordingTraits { modulation_frequency_hz, ..recorded }
    }
}

/// Takes the core's names, with the core's descriptions in the help.
pub(super) fn named<T>(
    all: &[T],
    name: fn(T) -> &'static str,
    description: fn(T) -> &'static str,
) -> impl TypedValueParser<Value = T>
where
    T: Copy + FromStr + Send + Sync + 'static,
    T::Err: std::error::Error + Send + Sync + 'static,
{
    let value = |one: &T| PossibleValue::new(name(*one)).help(plain(description(*one)));
    PossibleValuesParser::new(all.iter().map(value).collect::<Vec<_>>()).try_map(|text| text.parse::<T>())
}

/// The same for a step that is a rule or nothing.
fn denoise_steps() -> impl TypedValueParser<Value = DenoiseStep> {
    let none = PossibleValue::new("none").help("Use the distance as it was delivered");
    let rule = |rule: &DenoiseRule| PossibleValue::new(rule.name()).help(plain(rule.description()));
    let values: Vec<PossibleValue> = [none].into_iter().chain(DenoiseRule::ALL.iter().map(rule)).collect();
    PossibleValuesParser::new(values).try_map(|text| text.parse::<DenoiseStep>())
}

/// A description without the marks of documentation.
fn plain(description: &str) -> String {
    description.trim_end_matches('.').replace('`', "")
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser;

    #[derive(Debug, Parser)]
    struct Line {
        #[command(flatten)]
        steps: StepArgs,
    }

    #[test]
    fn every_name_of_the_core_is_an_option() {
        for (option, names) in [
            ("--method", Method::NAMES),
            ("--time", TimeStep::NAMES),
            ("--distance", DistanceStep::NAMES),
            ("--denoise", DenoiseRule::NAMES),
            ("--profile", ProfileStep::NAMES),
            ("--angle", AngleStep::NAMES),
            ("--specular", &["none", "histogram", "knee:occurrences=3", "percent:quantile=0.9"]),
        ] {
            for name in names {
                assert!(Line::try_parse_from(["isolux", option, name]).is_ok(), "{option} {name}");
            }
        }
        let tier = Line::try_parse_from(["isolux", "--response-tier", "phase_samples"]).unwrap();
        assert!(tier.steps.choice().is_err(), "a tier without --time response");
    }

    #[test]
    fn a_parameter_of_another_rule_is_refused() {
        let error = Line::try_parse_from(["isolux", "--specular", "histogram:deviations=3"]).unwrap_err();
        assert!(error.to_string().contains("parameter `deviations` found, occurrences expected"), "{error}");
    }
}
