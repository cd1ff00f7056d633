//! What contradicts a recording's claims, and the sentences.

use std::fmt;

use serde::Serialize;

use super::phase::PhaseFault;
use crate::advice::{Advice, RecordingField};
use crate::common_factor::{ExposureCourse, SpannedFrames};
use crate::standardize::AlreadyCorrected;

/// Something about a recording that is probably not as it says. [`Display`](fmt::Display) says what was found;
/// [`Suspicion::advice`] what to do.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "suspicion", rename_all = "snake_case")]
#[non_exhaustive]
pub enum Suspicion {
    /// Many amplitudes share the largest value, far above all others: a code that the recording does not name.
    AmplitudeCode {
        /// The code, DN.
        value_dn: f32,
        /// Share of the pixels that have it, 0..=1.
        share: f64,
        /// Largest of the other amplitudes, DN.
        others_dn: f32,
    },
    /// Many amplitudes share the largest value, up to which the others reach.
    AmplitudeClips {
        /// The value, DN.
        value_dn: f32,
        /// Share of the pixels that have it, 0..=1.
        share: f64,
    },
    /// Many distances share an extreme value, far from all others: a code that the recording does not name.
    DistanceCode {
        /// The code, as it is stored.
        value: f32,
        /// Share of the distances that are it, 0..=1.
        share: f64,
        /// The nearest of the other distances, as it is stored.
        others: f32,
    },
    /// Distances are in another unit than they are taken for.
    DistanceUnit {
        /// 5 % of the distances are below it, as they are read, m.
        from_m: f64,
        /// 95 % are below it, m.
        to_m: f64,
        /// The unit in which they would be usual, m.
        unit_m: f64,
    },
    /// Distances are longer than the modulation can tell.
    BeyondRange {
        /// Share of the distances, 0..=1.
        share: f64,
        /// The range c/2f, m.
        range_m: f64,
    },
    /// Integration times are not in microseconds.
    TimeUnit {
        /// The shortest, as it is read.
        from_us: f64,
        /// The longest.
        to_us: f64,
        /// The unit in which they would be usual.
        unit: &'static str,
        /// Microseconds for one of it.
        us_per_unit: f64,
    },
    /// The amplitudes do not depend on the integration time: it has been corrected for.
    TimeCorrected {
        /// Exponent of t, between frames of a still scene.
        exponent: f64,
    },
    /// The amplitudes grow with less than t¹: a gamma curve, or a correction in part.
    TimePartly {
        /// Exponent of t, between frames of a still scene.
        exponent: f64,
    },
    /// The amplitudes of one labelled material do not depend on the distance: it has been corrected for.
    DistanceCorrected {
        /// Exponent of d.
        exponent: f64,
    },
    /// The principal point is far from the middle of the image.
    PrincipalPoint {
        /// Its column, pixels.
        cx: f64,
        /// Its row, pixels.
        cy: f64,
        /// Height of the image, pixels.
        height: usize,
        /// Width of the image, pixels.
        width: usize,
    },
    /// The recording says that its amplitudes have been standardized.
    Standardized,
    /// Nine tenths of the image show nothing but noise.
    TooDark {
        /// The signal-to-noise ratio that they do not reach.
        signal_to_noise: f64,
    },
    /// Phase samples that are read in the wrong order or with the wrong sign.
    PhaseConvention(PhaseFault),
    /// Many phase samples share the largest value: they clip at a value that the recording does not name.
    PhaseSamplesClip {
        /// The value, DN.
        value_dn: f32,
        /// Share of the phase samples that have it, or its negative, 0..=1.
        share: f64,
        /// True where they clip at the negative value too.
        both_signs: bool,
    },
    /// Every frame spans exactly the same values: frames were scaled one by one.
    ScaledByFrame(SpannedFrames),
    /// All still pixels share a factor from frame to frame that no recorded time explains.
    ExposureChanged(ExposureCourse),
}

impl Suspicion {
    /// What suspicions say that something upstream has taken out of the amplitudes.
    #[must_use]
    pub fn already_corrected(suspicions: &[Self]) -> AlreadyCorrected {
        let any = |is: fn(&Self) -> bool| suspicions.iter().any(is);
        let standardized = any(|found| matches!(found, Self::Standardized));
        AlreadyCorrected {
            time: standardized || any(|found| matches!(found, Self::TimeCorrected { .. })),
            distance: standardized || any(|found| matches!(found, Self::DistanceCorrected { .. })),
        }
    }

    /// A few words for a headline.
    #[must_use]
    pub fn short(&self) -> &'static str {
        match self {
            Self::AmplitudeCode { .. } | Self::DistanceCode { .. } => "a code that is not named",
            Self::AmplitudeClips { .. } => "amplitudes that clip",
            Self::PhaseConvention(_) => "phases in another order or sign",
            Self::PhaseSamplesClip { .. } => "phase samples that clip",
            Self::DistanceUnit { .. } => "distances in another unit",
            Self::BeyondRange { .. } => "distances beyond the range",
            Self::TimeUnit { .. } => "integration times in another unit",
            Self::TimeCorrected { .. } => "corrected for the integration time",
            Self::TimePartly { .. } => "a gamma curve or a partial correction",
            Self::DistanceCorrected { .. } => "corrected for the distance",
            Self::PrincipalPoint { .. } => "intrinsics of another resolution",
            Self::ScaledByFrame(_) => "frames scaled one by one",
            Self::ExposureChanged(_) => "an exposure that changed unrecorded",
            Self::Standardized => "standardized already",
            Self::TooDark { .. } => "nothing but noise",
        }
    }

    /// What can be done about it.
    #[must_use]
    pub fn advice(&self) -> Option<Advice> {
        let field = match self {
            Self::AmplitudeCode { value_dn, .. } | Self::AmplitudeClips { value_dn, .. } => {
                RecordingField::SaturatedAmplitude { value_dn: *value_dn }
            }
            Self::DistanceCode { value, .. } => RecordingField::InvalidDistance { value: *value },
            Self::DistanceUnit { unit_m, .. } => RecordingField::DistanceUnit { metres: *unit_m },
            Self::BeyondRange { .. } => RecordingField::ModulationFrequency,
            Self::TimeUnit { us_per_unit, .. } => {
                RecordingField::TimesInMicroseconds { factor: *us_per_unit }
            }
            Self::PrincipalPoint { .. } => RecordingField::Intrinsics,
            Self::PhaseConvention(fault) => RecordingField::PhaseConvention(fault.fitting),
            Self::PhaseSamplesClip { value_dn, .. } => {
                RecordingField::SaturatedPhaseSample { value_dn: *value_dn }
            }
            Self::TimeCorrected { .. } | Self::TimePartly { .. } | Self::DistanceCorrected { .. } => {
                return Some(Advice::Diagnose);
            }
            Self::ScaledByFrame(_) => return Some(Advice::RecordUnscaledValues),
            Self::ExposureChanged(_) => return Some(Advice::RecordTimes),
            Self::Standardized => return Some(Advice::TakeOriginal),
            Self::TooDark { .. } => return Some(Advice::RecordBrighter),
        };
        Some(Advice::WriteField(field))
    }
}

impl fmt::Display for Suspicion {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let percent = |share: &f64| 100.0 * share;
        match self {
            Self::AmplitudeCode { value_dn, share, others_dn } => write!(
                f,
                "{:.2} % of the amplitudes are exactly {value_dn}, the next largest is {others_dn}: probably a code \
                 for saturated pixels, taken for a measurement",
                percent(share)
            ),
            Self::AmplitudeClips { value_dn, share } => {
                write!(f, "the amplitudes are clipped at {value_dn}, which {:.2} % of them share", percent(share))
            }
            Self::DistanceCode { value, share, others } => write!(
                f,
                "{:.2} % of the distances are exactly {value}, the next is {others}: probably a code for pixels without \
                 a distance, taken for one",
                percent(share)
            ),
            Self::DistanceUnit { from_m, to_m, unit_m } => write!(
                f,
                "the distances are read as {} to {} m (5 to 95 %), but look like {}",
                digits(*from_m),
                digits(*to_m),
                unit_name(*unit_m)
            ),
            Self::BeyondRange { share, range_m } => write!(
                f,
                "{:.1} % of the distances are beyond {range_m:.2} m, all that the modulation frequency can tell: it, or the \
                 unit of the distances, is wrong",
                percent(share)
            ),
            Self::TimeUnit { from_us, to_us, unit, .. } => {
                write!(f, "integration times of {from_us} to {to_us} µs look like {unit}")
            }
            Self::TimeCorrected { exponent } => write!(
                f,
                "the amplitudes of what stands still go with t^{exponent:.2}, not with t: the integration time has been \
                 corrected for already"
            ),
            Self::TimePartly { exponent } => write!(
                f,
                "the amplitudes of what stands still go with t^{exponent:.2}, not with t: a gamma curve or a correction in \
                 part, which a scaling by the time does not undo"
            ),
            Self::DistanceCorrected { exponent } => write!(
                f,
                "the amplitudes of one material go with d^{exponent:.2}, not with d^-2: the distance has been corrected for \
                 already"
            ),
            Self::PrincipalPoint { cx, cy, height, width } => write!(
                f,
                "the principal point, column {cx:.1} and row {cy:.1}, is far from the middle of the {height}×{width} image: \
                 the intrinsics are probably those of another resolution"
            ),
            Self::Standardized => f.write_str(
                "its description says that its amplitudes have been standardized: correcting them again would undo it",
            ),
            Self::TooDark { signal_to_noise } => write!(
                f,
                "the amplitudes are little more than noise: nine tenths of the image have a signal-to-noise ratio below \
                 {signal_to_noise:.1} (of noise alone: 2.8)"
            ),
            Self::PhaseConvention(fault) => fault.fmt(f),
            Self::PhaseSamplesClip { value_dn, share, both_signs } => write!(
                f,
                "{:.2} % of the phase samples are exactly {}{value_dn}, and hardly any are near it: they clip there, and \
                 the amplitudes of these pixels are wrong",
                100.0 * share,
                if *both_signs { "±" } else { "" }
            ),
            Self::ScaledByFrame(spanned) => spanned.fmt(f),
            Self::ExposureChanged(course) => course.fmt(f),
        }
    }
}

/// Three digits.
fn digits(value: f64) -> String {
    let decimals = (2 - value.abs().max(1e-6).log10().floor() as i32).clamp(0, 6);
    format!("{value:.*}", decimals.unsigned_abs() as usize)
}

fn unit_name(unit_m: f64) -> String {
    match unit_m {
        1.0 => "metres".to_owned(),
        0.01 => "centimetres".to_owned(),
        0.001 => "millimetres".to_owned(),
        _ => format!("units of {unit_m} m"),
    }
}
