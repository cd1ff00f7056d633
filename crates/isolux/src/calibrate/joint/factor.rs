//! The factors of the joint model.

/// A factor of the joint model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Factor {
    /// s, over the integration times.
    Time,
    /// h, over the distance.
    Distance,
    /// v, over the image.
    Profile,
    /// k, the exponent of cosθ.
    Angle,
}

impl Factor {
    pub(super) const ALL: [Self; 4] = [Self::Time, Self::Distance, Self::Profile, Self::Angle];

    /// Its name in messages.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Time => "integration time",
            Self::Distance => "distance law",
            Self::Profile => "illumination profile",
            Self::Angle => "angle exponent",
        }
    }
}
