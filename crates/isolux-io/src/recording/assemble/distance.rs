//! Stored distances: made metric and radial.

use isolux::{Intrinsics, Plane};

use crate::recording::element::ElementType;
use crate::recording::info::{DistanceKind, DistanceUnit, RecordingInfo};

/// What turns stored distances into radial ones in metres.
#[derive(Debug)]
pub(super) struct DistanceScale {
    unit: DistanceUnit,
    /// Given where the stored distances are depths.
    intrinsics: Option<Intrinsics>,
    /// Radial distance of each pixel at depth 1.
    radial_per_depth: Option<Plane<f32>>,
}

impl DistanceScale {
    /// `element` is the type of the stored distances. Integers are millimetres and floats metres, as in REP 118,
    /// unless the recording says otherwise.
    pub(super) fn new(info: &RecordingInfo, element: Option<ElementType>) -> Self {
        let integer = element.is_some_and(ElementType::is_integer);
        let default = if integer { DistanceUnit::Millimetre } else { DistanceUnit::Metre };
        let depths = info.distance_kind == Some(DistanceKind::Z);
        let intrinsics = info.intrinsics.as_ref().filter(|_| depths).map(|intrinsics| intrinsics.pinhole);
        Self { unit: info.distance_unit.unwrap_or(default), intrinsics, radial_per_depth: None }
    }

    /// Converts in place. Invalid distances (0, negative, NaN) stay invalid: both steps keep the sign.
    pub(super) fn apply(&mut self, distance: &mut Plane<f32>) {
        if self.unit == DistanceUnit::Millimetre {
            // A division, not a product with 0.001: it rounds once.
            distance.values_mut().iter_mut().for_each(|value| *value /= 1000.0);
        }
        if let Some(intrinsics) = &self.intrinsics {
            let shape = distance.shape();
            let ratio = self.radial_per_depth.get_or_insert_with(|| intrinsics.radial_per_depth(shape));
            distance.values_mut().iter_mut().zip(ratio.values()).for_each(|(value, &ratio)| *value *= ratio);
        }
    }
}
