//! Why a factor of the joint model is withheld, and what to vary in the next recording.

use std::fmt;

use super::factor::Factor;

/// Largest standard error of a curve that becomes a term.
pub(super) const LARGEST_ERROR: f64 = 0.05;

/// Why a factor is not determined.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Refusal {
    /// The quantity it depends on hardly changes within any surface.
    NotSeen {
        /// Which factor.
        factor: Factor,
    },
    /// It cannot be separated from other factors.
    Confounded {
        /// Which factor.
        factor: Factor,
        /// With these.
        with: Vec<Factor>,
        /// Factor by which its error grows because the others are unknown.
        inflation: f64,
    },
    /// The observations are too few or too noisy.
    Uncertain {
        /// Which factor.
        factor: Factor,
        /// Predicted standard error of its curve.
        standard_error: f64,
    },
}

/// What to vary in a recording that determines the factor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Vary {
    /// The distance of one material.
    Distance,
    /// The distance of the target at each place of the image.
    DistanceAtEachPlace,
    /// The place of the target in the image.
    Place,
    /// The tilt of the target.
    Angle,
    /// The tilt of the target, at each place of the image.
    AngleAtEachPlace,
    /// Nothing, but the integration times have to be known.
    RecordedExposure,
    /// Two quantities that changed together: each without the other.
    Apart,
    /// Nothing: more frames, or more light.
    MoreLight,
}

/// How a recording was made in which two factors cannot be separated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Cause {
    AlwaysTiltedAlike,
    OneDistanceAtEachPlace,
    TiltedByDistance,
    TimeByDistance,
    ExposureByDistance,
}

impl Refusal {
    /// What to vary in the next recording; `None` where the refusal does not determine it.
    #[must_use]
    pub fn vary(&self) -> Option<Vary> {
        match self {
            Self::NotSeen { factor: Factor::Time | Factor::Exposure } => None,
            Self::NotSeen { factor: Factor::Distance } => Some(Vary::Distance),
            Self::NotSeen { factor: Factor::Profile } => Some(Vary::Place),
            Self::NotSeen { factor: Factor::Angle } => Some(Vary::Angle),
            Self::Confounded { factor, with, .. } => Cause::of(*factor, with).map(|cause| match cause {
                Cause::AlwaysTiltedAlike => Vary::AngleAtEachPlace,
                Cause::OneDistanceAtEachPlace => Vary::DistanceAtEachPlace,
                Cause::TiltedByDistance | Cause::TimeByDistance => Vary::Apart,
                Cause::ExposureByDistance => Vary::RecordedExposure,
            }),
            Self::Uncertain { .. } => Some(Vary::MoreLight),
        }
    }
}

impl Cause {
    fn of(factor: Factor, with: &[Factor]) -> Option<Self> {
        let among = |one: Factor| factor == one || with.contains(&one);
        if among(Factor::Distance) && among(Factor::Exposure) {
            return Some(Self::ExposureByDistance);
        }
        match (among(Factor::Profile), among(Factor::Angle), among(Factor::Distance), among(Factor::Time)) {
            (true, true, false, _) => Some(Self::AlwaysTiltedAlike),
            (true, _, true, _) => Some(Self::OneDistanceAtEachPlace),
            (_, true, true, _) => Some(Self::TiltedByDistance),
            (_, _, true, true) => Some(Self::TimeByDistance),
            _ => None,
        }
    }

    fn words(self) -> &'static str {
        match self {
            Self::AlwaysTiltedAlike => {
                "the target faced the camera in all frames, or was always tilted alike where it was seen"
            }
            Self::OneDistanceAtEachPlace => "each place of the image saw one distance",
            Self::TiltedByDistance => "the target was tilted by its distance",
            Self::TimeByDistance => "each distance was recorded with its own integration time",
            Self::ExposureByDistance => {
                "the integration times are not recorded, and each distance was recorded in frames of its own: if the exposure \
                 was automatic, any law would fit"
            }
        }
    }
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotSeen { factor } => {
                let seen = match factor {
                    Factor::Time | Factor::Exposure => "more than one",
                    Factor::Distance => "distances that are unlike enough",
                    Factor::Profile => "unlike places of the image",
                    Factor::Angle => "angles that are unlike enough",
                };
                write!(f, "{}: no surface is seen at {seen}", factor.name())?;
            }
            Self::Confounded { factor, with, inflation } => {
                let others: Vec<&str> = with.iter().map(|other| other.name()).collect();
                write!(
                    f,
                    "{}: cannot be told from the {} (its error grows {inflation:.0}-fold)",
                    factor.name(),
                    others.join(" and the "),
                )?;
                if let Some(cause) = Cause::of(*factor, with) {
                    write!(f, ": {}", cause.words())?;
                }
            }
            Self::Uncertain { factor, standard_error } => write!(
                f,
                "{}: its standard error of {:.1} % is above {:.0} %",
                factor.name(),
                100.0 * standard_error,
                100.0 * LARGEST_ERROR
            )?,
        }
        self.vary().map_or(Ok(()), |vary| write!(f, "; {vary}"))
    }
}

impl fmt::Display for Vary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Distance => "record one material from near to far",
            Self::DistanceAtEachPlace => "move the target nearer and farther",
            Self::Place => "let a target wander through it",
            Self::Angle => "tilt the target by up to 60°",
            Self::AngleAtEachPlace => "tilt it",
            Self::RecordedExposure => "record the integration time of each frame, or fix it and state it",
            Self::Apart => "vary the two apart",
            Self::MoreLight => "record more frames, or brighter ones",
        })
    }
}
