//! The factors of the joint model.

/// A factor of the joint model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Factor {
    /// s, over the integration times.
    Time,
    /// s, of each frame of which the integration time is unknown. It is fitted along and never becomes a term.
    Exposure,
    /// h, over the distance.
    Distance,
    /// v, over the image.
    Profile,
    /// k, the exponent of cosθ.
    Angle,
}

impl Factor {
    pub(super) const ALL: [Self; 5] =
        [Self::Time, Self::Exposure, Self::Distance, Self::Profile, Self::Angle];

    /// Its name in messages.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Time => "integration time",
            Self::Exposure => "unrecorded exposure of each frame",
            Self::Distance => "distance law",
            Self::Profile => "illumination profile",
            Self::Angle => "angle exponent",
        }
    }
}
