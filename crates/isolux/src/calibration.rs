//! The calibration of one camera: fitted terms, the conditions they refer to, and the recordings they were fitted
//! on. [`Calibration`] has the structure of the calibration file (JSON).

use serde::{Deserialize, Serialize};

use crate::step_names::DistanceStep;
use crate::terms::check::{Check, ParameterError, Parameters, optional_term};
use crate::terms::{Angle, Cubic, DistanceLaw, Lut, Noise, Profile, Response, Spline};

/// Reference integration time of the paper (register 40 of the SR-3100), µs.
pub const REFERENCE_TIME_US: f64 = 8200.0;
/// Reference distance of the paper, m.
pub const REFERENCE_DISTANCE_M: f64 = 0.75;

/// Conditions under which every multiplier is 1.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Reference {
    /// Integration time, µs; absent where the recordings do not state it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub integration_time_us: Option<f64>,
    /// Radial distance, m.
    pub distance_m: f64,
}

impl Default for Reference {
    fn default() -> Self {
        Self { integration_time_us: Some(REFERENCE_TIME_US), distance_m: REFERENCE_DISTANCE_M }
    }
}

/// The noise that the amplitude has without light, measured at the shortest integration time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NoiseFloor {
    /// Standard deviation of the amplitude, DN.
    pub amplitude_sd_dn: f64,
    /// Integration time at which it was measured, µs.
    pub integration_time_us: f64,
    /// Amplitudes below this are flagged LOW_SIGNAL, DN.
    pub low_signal_below_dn: f64,
}

impl NoiseFloor {
    /// Signal-to-noise ratio below which an amplitude is LOW_SIGNAL. An amplitude is Rician: its mean is too
    /// high by `1 / (2 SNR²)`, 2 % at 5.
    pub const LOW_SIGNAL_SNR: f64 = 5.0;

    /// The noise floor for a standard deviation (DN) that was measured at an integration time (µs).
    #[must_use]
    pub fn new(amplitude_sd_dn: f64, integration_time_us: f64) -> Self {
        Self {
            amplitude_sd_dn,
            integration_time_us,
            low_signal_below_dn: Self::LOW_SIGNAL_SNR * amplitude_sd_dn,
        }
    }
}

/// The fitted terms, each with its own valid range, sources and residuals.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Terms {
    /// Integration time, the paper's lookup table.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lut: Option<Lut>,
    /// Integration time, the fill-level response.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub response: Option<Response>,
    /// Distance, the paper's cubic.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cubic: Option<Cubic>,
    /// Distance, a smooth law around the inverse square.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub spline: Option<Spline>,
    /// Illumination profile, over the image.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub profile: Option<Profile>,
    /// Angle of incidence.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub angle: Option<Angle>,
    /// Noise of the amplitude.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub noise: Option<Noise>,
}

impl Terms {
    /// Fitted laws over distance, the best first.
    const DISTANCE_LAWS: [DistanceStep; 2] = [DistanceStep::Spline, DistanceStep::Cubic];

    /// The best law over distance that is here.
    pub(crate) fn best_distance(&self) -> Option<DistanceStep> {
        Self::DISTANCE_LAWS.into_iter().find(|step| self.distance_law(*step).is_some())
    }

    /// The fitted law of a step and the distances (m) for which it is valid; `None` where it is not here, or for a
    /// step that is not fitted.
    pub(crate) fn distance_law(&self, step: DistanceStep) -> Option<(DistanceLaw, [f64; 2])> {
        match step {
            DistanceStep::Spline => {
                let law = &self.spline.as_ref()?.law;
                Some((law.distance_law(), law.valid_distance_m))
            }
            DistanceStep::Cubic => {
                let cubic = self.cubic.as_ref()?;
                Some((cubic.distance_law(), cubic.valid_distance_m))
            }
            DistanceStep::Square | DistanceStep::Eq5 | DistanceStep::None => None,
        }
    }
}

/// A camera's calibration, as its file holds it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Calibration {
    /// Always [`Calibration::FORMAT`].
    pub format: String,
    /// Version of the file format, [`Calibration::VERSION`].
    pub version: u32,
    /// Camera, as the user or the recordings name it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub camera: Option<String>,
    /// Program and version that wrote the file.
    pub created_by: String,
    /// Conditions under which every multiplier is 1.
    pub reference: Reference,
    /// The fitted terms; each may be absent.
    pub terms: Terms,
    /// Noise of the amplitude without light; present when an exposure sweep had repeated frames.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub noise_floor: Option<NoiseFloor>,
    /// Warnings that concern more than one term.
    pub warnings: Vec<String>,
}

impl Calibration {
    /// Format name in every calibration file.
    pub const FORMAT: &'static str = "isolux-calibration";
    /// Newest format version that this library reads, and the one it writes.
    pub const VERSION: u32 = 1;

    /// A calibration without terms. `camera` is the name of the camera.
    #[must_use]
    pub fn new(camera: Option<String>, reference: Reference) -> Self {
        Self {
            format: Self::FORMAT.to_owned(),
            version: Self::VERSION,
            camera,
            created_by: concat!("isolux ", env!("CARGO_PKG_VERSION")).to_owned(),
            reference,
            terms: Terms::default(),
            noise_floor: None,
            warnings: Vec::new(),
        }
    }

    /// Refuses impossible values (formats, signs, ranges, lengths), so that later code may rely on them. It does
    /// not check that table and cubic are 1 at the reference: their fits ensure that.
    ///
    /// # Errors
    /// [`ParameterError`] names the field.
    pub fn check(&self) -> Result<(), ParameterError> {
        Check::of("format").require(self.format == Self::FORMAT, &self.format, Self::FORMAT)?;
        Check::of("version").require(self.version == Self::VERSION, self.version, "1")?;
        self.reference.check_at(&Check::of("reference"))?;
        self.noise_floor.map_or(Ok(()), |floor| floor.check_at(&Check::of("noise_floor")))?;
        self.terms.check()?;
        self.terms.check_against(&self.reference)
    }
}

impl Reference {
    fn check_at(&self, here: &Check<'_>) -> Result<(), ParameterError> {
        // From a nanosecond to a quarter of an hour, from a tenth of a millimetre to 100 km: far beyond any camera.
        let (times_us, distances_m) = (1e-3..=1e9, 1e-4..=1e5);
        let time = self.integration_time_us.unwrap_or(REFERENCE_TIME_US);
        here.at("integration_time_us").require(
            times_us.contains(&time),
            time,
            "a time in µs, 1e-3 to 1e9",
        )?;
        let distance_m = self.distance_m;
        let fine = distances_m.contains(&distance_m);
        here.at("distance_m").require(fine, distance_m, "a distance in m, 1e-4 to 1e5")
    }
}

impl NoiseFloor {
    fn check_at(&self, here: &Check<'_>) -> Result<(), ParameterError> {
        let positive = |value: f64| value > 0.0 && value.is_finite();
        let fine = positive(self.low_signal_below_dn) && positive(self.amplitude_sd_dn);
        here.require(fine, self.low_signal_below_dn, "positive numbers")
    }
}

impl Terms {
    /// Checks each term by itself.
    fn check(&self) -> Result<(), ParameterError> {
        let Self { lut, response, cubic, spline, profile, angle, noise } = self;
        optional_term(lut)?;
        optional_term(response)?;
        optional_term(cubic)?;
        optional_term(spline)?;
        optional_term(profile)?;
        optional_term(angle)?;
        optional_term(noise)
    }

    /// Checks that the terms refer to the calibration's reference.
    fn check_against(&self, reference: &Reference) -> Result<(), ParameterError> {
        let needs_time = self.lut.is_some() || self.response.is_some();
        let fine = !needs_time || reference.integration_time_us.is_some();
        let expected = "the time that lut and response refer to";
        Check::of("reference").at("integration_time_us").require(fine, "nothing", expected)?;
        let gauge_m = self.spline.as_ref().map(|spline| spline.law.reference_distance_m);
        let fine = gauge_m.is_none_or(|gauge_m| gauge_m == reference.distance_m);
        let found = gauge_m.unwrap_or_default();
        Check::of(Spline::NAME).at("reference_distance_m").require(fine, found, "reference.distance_m")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_file_names_its_format_and_refuses_unknown_fields() {
        let calibration = Calibration::new(Some("SR-3100".into()), Reference::default());
        assert!(calibration.check().is_ok());
        let text = serde_json::to_string(&calibration).unwrap();
        assert!(text.starts_with(r#"{"format":"isolux-calibration","version":1"#));
        assert_eq!(serde_json::from_str::<Calibration>(&text).unwrap(), calibration);
        let spoilt = text.replacen("\"version\"", "\"surprise\":1,\"version\"", 1);
        let message = serde_json::from_str::<Calibration>(&spoilt).unwrap_err().to_string();
        assert!(message.contains("surprise"), "{message}");
    }

    #[test]
    fn impossible_references_are_refused() {
        let mut calibration =
            Calibration::new(None, Reference { integration_time_us: None, distance_m: -1.0 });
        assert_eq!(calibration.check().unwrap_err().field, "reference.distance_m");
        calibration.reference = Reference { integration_time_us: Some(f64::NAN), distance_m: 1.0 };
        assert_eq!(calibration.check().unwrap_err().field, "reference.integration_time_us");
    }
}
