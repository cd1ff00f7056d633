//! The full well that all pixels of a camera share, in the camera's own numbers.

use serde::{Deserialize, Serialize};

use super::well::{InverseTable, SoftWell};
use crate::frame::phase::CLIPPED_SHARE;
use crate::terms::check::{Check, ParameterError};

/// Full well, softness and black level of a channel.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FullWell {
    /// W: charge at which the linear law would fill the well, DN above the black level.
    pub full_well_dn: f64,
    /// Softness p.
    pub softness: f64,
    /// Value without any charge, DN.
    pub black_level_dn: f64,
}

impl FullWell {
    /// Slope f′ below which a value is not inverted: its noise would grow by the inverse, here fivefold.
    pub const LEAST_SLOPE: f64 = 0.2;

    /// The well's shape.
    #[must_use]
    pub fn shape(&self) -> SoftWell {
        SoftWell { softness: self.softness }
    }

    /// Value of a received charge (DN above the black level), DN.
    #[must_use]
    pub fn kept_dn(&self, received_dn: f64) -> f64 {
        self.black_level_dn + self.full_well_dn * self.shape().kept(received_dn.max(0.0) / self.full_well_dn)
    }

    /// Received charge of a value, DN above the black level; infinite from the full well on.
    #[must_use]
    pub fn received_dn(&self, value_dn: f64) -> f64 {
        self.full_well_dn * self.shape().received((value_dn - self.black_level_dn) / self.full_well_dn)
    }

    /// Largest value that is inverted: below the clip, where it is known, and where the slope is large enough, DN.
    pub(super) fn largest_dn(&self, clip_dn: Option<f64>) -> f64 {
        let by_slope = self.full_well_dn * self.shape().kept_at_slope(Self::LEAST_SLOPE);
        let by_clip = clip_dn.map_or(f64::INFINITY, |clip| CLIPPED_SHARE * (clip - self.black_level_dn));
        self.black_level_dn + by_slope.min(by_clip)
    }

    pub(super) fn table(&self, largest_dn: f64) -> InverseTable {
        InverseTable::new(self.shape(), self.full_well_dn, largest_dn - self.black_level_dn)
    }

    /// Refuses what no fit gives, `largest_dn` being the largest value that is inverted. Both stand within `tier`.
    pub(super) fn check_at(&self, tier: &Check<'_>, largest_dn: f64) -> Result<(), ParameterError> {
        let (here, well, black) = (tier.at("well"), self.full_well_dn, self.black_level_dn);
        self.shape().check_at(&here)?;
        let fine = (1e-6..=1e12).contains(&well);
        here.at("full_well_dn").require(fine, well, "a number of DN, 1e-6 to 1e12")?;
        let fine = black.abs() <= well;
        here.at("black_level_dn").require(fine, black, "a number of DN, at most the full well")?;
        let most = self.largest_dn(None) * (1.0 + 1e-9) + 1e-9 * well;
        let fine = largest_dn > black && largest_dn <= most;
        let expected = "DN above the black level, where the slope of the well is 0.2 or more";
        tier.at("largest_dn").require(fine, largest_dn, expected)
    }
}
