//! Stored distances: made metric and radial.

use isolux::{Lens, Plane};

use crate::recording::distance_unit::DistanceUnit;
use crate::recording::element::ElementType;
use crate::recording::info::{DistanceKind, RecordingInfo};

/// What turns stored distances into radial ones in metres.
#[derive(Debug)]
pub(super) struct DistanceScale {
    unit: DistanceUnit,
    /// Given where the stored distances are depths.
    lens: Option<Lens>,
    /// Radial distance of each pixel at depth 1.
    radial_per_depth: Option<Plane<f32>>,
}

impl DistanceScale {
    /// `element` is the type of the stored distances.
    pub(super) fn new(info: &RecordingInfo, element: Option<ElementType>, lens: Option<Lens>) -> Self {
        let default = element.map_or(DistanceUnit::Metre, DistanceUnit::usual);
        let depths = info.distance_kind == Some(DistanceKind::Z);
        let lens = lens.filter(|_| depths);
        Self { unit: info.distance_unit.unwrap_or(default), lens, radial_per_depth: None }
    }

    /// Converts in place. Invalid distances (0, negative, NaN) stay invalid: both steps keep the sign. Depths
    /// of pixels that do not look ahead become NaN.
    pub(super) fn apply(&mut self, distance: &mut Plane<f32>) {
        if self.unit != DistanceUnit::Metre {
            distance.values_mut().iter_mut().for_each(|value| *value = self.unit.to_metres(*value));
        }
        if let Some(lens) = &self.lens {
            let shape = distance.shape();
            let compute = || lens.pixel_rays(shape).radial_per_depth(shape);
            let ratio = self.radial_per_depth.get_or_insert_with(compute);
            distance.values_mut().iter_mut().zip(ratio.values()).for_each(|(value, &ratio)| *value *= ratio);
        }
    }
}
