//! The options of the predicted standard deviation.

use clap::{Args, ValueEnum};
use isolux::Choice;
use isolux::standardize::SigmaStep;
use isolux::terms::NoiseModel;
use isolux::terms::noise::AmplitudeNoise;

use super::values::{not_negative, positive};
use crate::failure::Failure;

/// Prediction of the standard deviation.
#[derive(Debug, Default, Args)]
pub(crate) struct SigmaArgs {
    /// Predict the standard deviation of each value, and subtract the bias that the noise of the distance causes
    /// [default: on where options or the calibration give the noise]
    #[arg(long, value_enum)]
    pub(crate) sigma: Option<SigmaArg>,
    /// Noise of the amplitude without any light, as a standard deviation, DN
    #[arg(long, value_name = "DN", value_parser = not_negative)]
    pub(crate) read_noise_dn: Option<f64>,
    /// Shot noise: the variance that each DN of amplitude adds, DN²
    #[arg(long, value_name = "X", value_parser = not_negative)]
    pub(crate) shot_noise_dn2_per_dn: Option<f64>,
    /// Modulation frequency, Hz; the noise of the distance is computed from it [default: that of the recording]
    #[arg(long, value_name = "HZ", value_parser = positive)]
    pub(crate) modulation_frequency_hz: Option<f64>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum SigmaArg {
    /// Predict it; if neither options nor the calibration give the noise, estimate it from the recording
    On,
    /// Predict nothing, subtract nothing
    Off,
}

impl SigmaArgs {
    /// Adds what the options say to the choice.
    pub(crate) fn complete(&self, choice: &mut Choice) -> Result<(), Failure> {
        choice.sigma = match self.sigma {
            Some(SigmaArg::On) => SigmaStep::Required,
            None => SigmaStep::WhereKnown,
            Some(SigmaArg::Off) => SigmaStep::None,
        };
        let given = [self.read_noise_dn, self.shot_noise_dn2_per_dn];
        if given.iter().any(Option::is_some) {
            if self.sigma == Some(SigmaArg::Off) {
                return Err(Failure::usage("the noise is given, but --sigma off predicts nothing with it"));
            }
            let [read_dn, shot_variance_dn2_per_dn] = given.map(|number| number.unwrap_or(0.0));
            if read_dn + shot_variance_dn2_per_dn == 0.0 {
                return Err(Failure::usage(
                    "no noise at all is given: --read-noise-dn or --shot-noise-dn2-per-dn above 0 expected",
                ));
            }
            let by_amplitude = AmplitudeNoise {
                read_variance_dn2: read_dn * read_dn,
                shot_variance_dn2_per_dn,
                ambient_variance_dn2_per_us: 0.0,
            };
            choice.noise = Some(NoiseModel { by_amplitude, by_intensity: None });
        }
        Ok(())
    }
}
