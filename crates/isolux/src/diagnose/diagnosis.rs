//! What all the fits together say of a recording.

use serde::Serialize;

use super::effect::Effect;
use super::finding::{self, Finding};
use super::material::Material;
use super::scaling::Scaling;
use super::still::StillPixels;
use super::unavailable::{Outcome, Unavailable};
use super::values::Values;
use crate::common_factor::{ExposureCourse, SpannedFrames};

/// The diagnosis of a recording: what is in its amplitude, what is gone, and what cannot be told.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Diagnosis {
    /// Frames that were looked at.
    pub frames: u32,
    /// What follows, most important first. Empty when nothing can be told.
    pub findings: Vec<Finding>,
    /// Integration time.
    #[serde(serialize_with = "crate::outcome_json::serialize")]
    pub time: Outcome<Effect>,
    /// Distance.
    #[serde(serialize_with = "crate::outcome_json::serialize")]
    pub distance: Outcome<Effect>,
    /// Place in the image: the coefficient of r².
    #[serde(serialize_with = "crate::outcome_json::serialize")]
    pub radius: Outcome<Effect>,
    /// The vendor amplitude against the amplitude.
    #[serde(serialize_with = "crate::outcome_json::serialize")]
    pub vendor_scaling: Outcome<Scaling>,
    /// The amplitude against eq. 1 of the phase samples.
    #[serde(serialize_with = "crate::outcome_json::serialize")]
    pub phase_samples: Outcome<Scaling>,
    /// The same pixels at several times.
    #[serde(serialize_with = "crate::outcome_json::serialize")]
    pub still_pixels: Outcome<StillPixels>,
    /// Pixels of one material.
    pub material: Material,
    /// A factor that all still pixels share from frame to frame, and that no recorded time explains.
    pub exposure_changed: Option<ExposureCourse>,
    /// Frames that all span exactly the same values.
    pub scaled_by_frame: Option<SpannedFrames>,
    /// The values that the amplitude takes; `None` where no pixel is valid.
    pub values: Option<Values>,
}

impl Diagnosis {
    /// The findings in a few words: `raw in time and distance; clipped`.
    #[must_use]
    pub fn headline(&self) -> String {
        finding::headline(&self.findings)
    }

    /// What is not told, with its reason: name and reason.
    #[must_use]
    pub fn unavailable(&self) -> Vec<(&'static str, &Unavailable)> {
        let effects = [
            ("integration time", &self.time),
            ("distance", &self.distance),
            ("place in the image", &self.radius),
        ];
        let mut unavailable: Vec<_> = effects
            .into_iter()
            .filter_map(|(name, effect)| effect.as_ref().err().map(|why| (name, why)))
            .collect();
        let vendor = self.vendor_scaling.as_ref();
        match vendor {
            Err(why) => unavailable.push(("the vendor's scaling", why)),
            Ok(scaling) => {
                let parts = [
                    ("the vendor's scaling with time", scaling.time.as_ref().err()),
                    ("the vendor's scaling with distance", scaling.distance.as_ref().err()),
                    ("the vendor's scaling with the place in the image", scaling.radial.as_ref().err()),
                ];
                unavailable.extend(parts.into_iter().filter_map(|(name, why)| why.map(|why| (name, why))));
            }
        }
        unavailable.extend(
            self.phase_samples.as_ref().err().map(|why| ("a gamma curve against the phase samples", why)),
        );
        unavailable
    }
}
