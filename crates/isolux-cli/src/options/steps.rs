//! The options that choose the steps of the chain.

use clap::{Args, ValueEnum};
use isolux::specular::{HistogramRule, KneeRule, PercentRule, SigmaRule};
use isolux::standardize::{
    AngleStep, DenoiseStep, DistanceStep, Method, ProfileStep, SpecularStep, TimeStep,
};
use isolux::terms::response::ResponseTier;
use isolux::{Choice, DenoiseRule, SpecularRule};

use super::sigma::SigmaArgs;
use super::values::{fraction, positive};
use crate::failure::Failure;

/// Which steps to apply.
#[derive(Debug, Default, Args)]
pub(crate) struct StepArgs {
    /// Terms to use where no single step is given
    #[arg(long, value_enum, default_value_t)]
    pub(crate) method: MethodArg,
    /// Step for the integration time [default: by method]
    #[arg(long, value_enum)]
    pub(crate) time: Option<TimeArg>,
    /// How the response tells the fill of each pixel, for --time response [default: the best that calibration and
    /// recording allow]
    #[arg(long, value_enum, value_name = "TIER")]
    pub(crate) response_tier: Option<TierArg>,
    /// Step for the distance [default: by method]
    #[arg(long, value_enum)]
    pub(crate) distance: Option<DistanceArg>,
    /// Denoise the distance before it scales, where a distance step is applied [default: none]
    #[arg(long, value_enum)]
    pub(crate) denoise: Option<DenoiseArg>,
    /// Take the illumination profile out, where the calibration holds it [default: on with --method best]
    #[arg(long, value_enum)]
    pub(crate) profile: Option<SwitchArg>,
    /// Take the angle of incidence out: the calibration's exponent of the cosine, Lambert's where it holds none; needs
    /// intrinsics [default: off]
    #[arg(long, value_enum)]
    pub(crate) angle: Option<SwitchArg>,
    /// Step for highlights [default: histogram]
    #[arg(long, value_enum)]
    pub(crate) specular: Option<SpecularArg>,
    /// Pixels that a value needs, for --specular histogram and knee [default: max(2, 0.0005 of the valid pixels)]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) specular_occurrences: Option<u32>,
    /// Standard deviations above the mean, for --specular sigma [default: 4]
    #[arg(long, value_name = "K", value_parser = positive)]
    pub(crate) specular_deviations: Option<f64>,
    /// Fraction of the maximum, for --specular percent [default: 0.9]
    #[arg(long, value_name = "F", value_parser = fraction, conflicts_with = "specular_quantile")]
    pub(crate) specular_fraction: Option<f64>,
    /// Quantile instead of a fraction of the maximum, for --specular percent
    #[arg(long, value_name = "Q", value_parser = fraction)]
    pub(crate) specular_quantile: Option<f64>,
    /// Flag amplitudes below this as LOW_SIGNAL, DN [default: from the calibration]
    #[arg(long, value_name = "DN", value_parser = positive)]
    pub(crate) low_signal_dn: Option<f64>,
    #[command(flatten)]
    pub(crate) sigma: SigmaArgs,
}

#[derive(Clone, Copy, Debug, Default, ValueEnum)]
pub(crate) enum MethodArg {
    /// lut, cubic and histogram; the calibration must hold them
    Paper,
    /// The best terms that the calibration holds
    #[default]
    Best,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum TimeArg {
    /// The calibration's lookup table
    Lut,
    /// The calibration's response to the fill of each pixel, then t_ref / t
    Response,
    /// t_ref / t
    Linear,
    /// Leave it in
    None,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
#[value(rename_all = "snake_case")]
pub(crate) enum TierArg {
    /// By the integration time alone, as the table does
    Scalar,
    /// By the amplitude alone, for scenes without strong ambient light
    Amplitude,
    /// By the time, for the static scene of the sweep and no other
    Pixel,
    /// By intensity and amplitude
    Intensity,
    /// By the raw bins; repairs the distance too
    PhaseSamples,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum DistanceArg {
    /// The calibration's polynomial
    Cubic,
    /// The calibration's smooth law
    Spline,
    /// (d / d_ref)²
    Square,
    /// Eq. 5 of the paper: ((2d)² + 1) / ((2 d_ref)² + 1)
    Eq5,
    /// Leave it in
    None,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum DenoiseArg {
    /// Scale by the distance as it was delivered
    None,
    /// Median of 3×3 pixels
    Median,
    /// Local Wiener filter of 5×5 pixels: the fast one
    Wiener,
    /// Plane fits in 7×7 pixels: the one for slanted surfaces and quality
    Plane,
    /// Mean over the last 8 frames, for still scenes
    Temporal,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum SwitchArg {
    /// Take it out
    On,
    /// Leave it in
    Off,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum SpecularArg {
    /// Limit at the highest value with enough pixels
    Histogram,
    /// Limit at mean + k standard deviations
    Sigma,
    /// Limit at a fraction of the maximum, or a quantile
    Percent,
    /// Compress what lies above the histogram's limit, keeping the order
    Knee,
    /// Leave them
    None,
}

impl StepArgs {
    /// The steps as the core takes them; a parameter of another rule than the chosen one is a usage error.
    pub(crate) fn choice(&self) -> Result<Choice, Failure> {
        let method = match self.method {
            MethodArg::Paper => Method::Paper,
            MethodArg::Best => Method::Best,
        };
        let time = self.time.map(|time| match time {
            TimeArg::Lut => TimeStep::Lut,
            TimeArg::Response => TimeStep::Response,
            TimeArg::Linear => TimeStep::Linear,
            TimeArg::None => TimeStep::None,
        });
        let distance = self.distance.map(|distance| match distance {
            DistanceArg::Cubic => DistanceStep::Cubic,
            DistanceArg::Spline => DistanceStep::Spline,
            DistanceArg::Square => DistanceStep::Square,
            DistanceArg::Eq5 => DistanceStep::Eq5,
            DistanceArg::None => DistanceStep::None,
        });
        let denoise = self.denoise.map(|denoise| match denoise {
            DenoiseArg::None => DenoiseStep::None,
            DenoiseArg::Median => DenoiseStep::Smooth(DenoiseRule::Median),
            DenoiseArg::Wiener => DenoiseStep::Smooth(DenoiseRule::Wiener),
            DenoiseArg::Plane => DenoiseStep::Smooth(DenoiseRule::Plane),
            DenoiseArg::Temporal => DenoiseStep::Smooth(DenoiseRule::Temporal),
        });
        let profile = self.profile.map(|switch| match switch {
            SwitchArg::On => ProfileStep::On,
            SwitchArg::Off => ProfileStep::Off,
        });
        let angle = self.angle.map(|switch| match switch {
            SwitchArg::On => AngleStep::On,
            SwitchArg::Off => AngleStep::Off,
        });
        let specular = Some(self.specular()?);
        let low_signal_below_dn = self.low_signal_dn.map(|dn| dn as f32);
        let response_tier = self.tier()?;
        let mut choice = Choice {
            method,
            time,
            response_tier,
            denoise,
            distance,
            profile,
            angle,
            specular,
            low_signal_below_dn,
            ..Choice::default()
        };
        self.sigma.complete(&mut choice)?;
        Ok(choice)
    }

    fn tier(&self) -> Result<Option<ResponseTier>, Failure> {
        let Some(tier) = self.response_tier else { return Ok(None) };
        if !matches!(self.time, Some(TimeArg::Response)) {
            return Err(Failure::usage("--response-tier belongs to --time response, which is not chosen"));
        }
        Ok(Some(match tier {
            TierArg::Scalar => ResponseTier::Scalar,
            TierArg::Amplitude => ResponseTier::Amplitude,
            TierArg::Pixel => ResponseTier::Pixel,
            TierArg::Intensity => ResponseTier::Intensity,
            TierArg::PhaseSamples => ResponseTier::PhaseSamples,
        }))
    }

    fn specular(&self) -> Result<SpecularStep, Failure> {
        let chosen = self.specular.unwrap_or(SpecularArg::Histogram);
        let counts = if chosen == SpecularArg::Knee { chosen } else { SpecularArg::Histogram };
        let given = [
            (self.specular_occurrences.is_some(), "--specular-occurrences", counts),
            (self.specular_deviations.is_some(), "--specular-deviations", SpecularArg::Sigma),
            (self.specular_fraction.is_some(), "--specular-fraction", SpecularArg::Percent),
            (self.specular_quantile.is_some(), "--specular-quantile", SpecularArg::Percent),
        ];
        if let Some((_, option, rule)) = given.iter().find(|(given, _, rule)| *given && *rule != chosen) {
            let (rule, chosen) = (format!("{rule:?}").to_lowercase(), format!("{chosen:?}").to_lowercase());
            let message = format!("{option} belongs to --specular {rule}, but --specular {chosen} is chosen");
            return Err(Failure::usage(message));
        }
        let histogram = HistogramRule { occurrences: self.specular_occurrences };
        Ok(match chosen {
            SpecularArg::Histogram => SpecularStep::Limit(SpecularRule::Histogram(histogram)),
            SpecularArg::Knee => SpecularStep::Limit(SpecularRule::Knee(KneeRule { cutoff: histogram })),
            SpecularArg::Sigma => SpecularStep::Limit(SpecularRule::Sigma(SigmaRule {
                deviations: self.specular_deviations.unwrap_or(SigmaRule::default().deviations),
            })),
            SpecularArg::Percent => {
                SpecularStep::Limit(SpecularRule::Percent(match self.specular_quantile {
                    Some(quantile) => PercentRule::Quantile(quantile),
                    None => self.specular_fraction.map_or_else(PercentRule::default, PercentRule::OfMaximum),
                }))
            }
            SpecularArg::None => SpecularStep::None,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parameters_of_another_rule_are_refused() {
        let steps = StepArgs { specular_deviations: Some(3.0), ..StepArgs::default() };
        assert!(steps.choice().unwrap_err().to_string().contains("belongs to --specular sigma"));
    }
}
