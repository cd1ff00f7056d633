//! Takes some frames of a recording and names what contradicts its claims.

use super::claims::Claims;
use super::dark::Dark;
use super::exponents::Exponents;
use super::exposure::Exposures;
use super::extreme::{Extreme, Kind, largest, smallest};
use super::phase;
use super::suspicion::Suspicion;
use super::times::Times;
use super::{clip, distances, lens};
use crate::frame::{Frame, PixelFlags, Plane, Shape, ShapeError};

/// Sampled pixels of a frame, at most: more would take time without telling more.
const SAMPLED_PIXELS: usize = 1 << 14;

/// Looks at some frames of a recording, the first ones and some later ones, and tells what contradicts its
/// [`Claims`]. A few milliseconds for each frame.
#[derive(Clone, Debug)]
pub struct Inspector {
    shape: Shape,
    claims: Claims,
    /// Valid amplitudes, DN.
    amplitudes: Vec<f32>,
    /// Distances, m.
    distances_m: Vec<f32>,
    /// Distances as they are stored.
    stored_distances: Vec<f32>,
    times: Times,
    dark: Dark,
    exponents: Exponents,
    exposures: Exposures,
    phases: phase::Sample,
}

impl Inspector {
    /// An inspector of frames of `shape`.
    #[must_use]
    pub fn new(shape: Shape, claims: Claims) -> Self {
        Self {
            shape,
            claims,
            amplitudes: Vec::new(),
            distances_m: Vec::new(),
            stored_distances: Vec::new(),
            times: Times::default(),
            dark: Dark::default(),
            exponents: Exponents::default(),
            exposures: Exposures::new(shape),
            phases: phase::Sample::default(),
        }
    }

    /// Takes in a frame of the recording. Frames come in ascending order; some may be left out.
    ///
    /// # Errors
    /// [`ShapeError::Mismatch`] when a plane is not of the inspector's shape; the frame then does not count.
    pub fn push(&mut self, frame: &Frame) -> Result<(), ShapeError> {
        frame.amplitude.expect_shape("amplitude", self.shape)?;
        frame.check_shapes()?;
        let stride = self.stride();
        let amplitudes = frame.amplitude.values().iter().zip(frame.flags.values()).step_by(stride);
        let valid = amplitudes.filter(|(_, flags)| !flags.contains(PixelFlags::INVALID));
        self.amplitudes.extend(valid.map(|(&value, _)| value));
        if let Some(plane) = &frame.distance_m {
            let sampled = plane.values().iter().step_by(stride).copied();
            self.distances_m.extend(sampled.filter(|&d| is_measured(d)));
        }
        self.times.push(frame, stride);
        self.dark.push(frame, stride);
        self.exponents.push(frame, stride);
        self.exposures.push(frame);
        self.phases.push(frame, &self.claims);
        Ok(())
    }

    /// Takes in the distances of a frame as they are stored, where they are depths: others follow from their unit.
    /// `frame` tells which of them are distances.
    ///
    /// # Errors
    /// [`ShapeError::Mismatch`] when the plane is not of the inspector's shape.
    pub fn push_stored_distances(&mut self, frame: &Frame, stored: &Plane<f32>) -> Result<(), ShapeError> {
        stored.expect_shape("distance", self.shape)?;
        let Some(plane) = &frame.distance_m else { return Ok(()) };
        let pairs = plane.values().iter().zip(stored.values()).step_by(self.stride());
        self.stored_distances.extend(pairs.filter(|(d, _)| is_measured(**d)).map(|(_, &stored)| stored));
        Ok(())
    }

    /// The distances in the unit in which they are stored; whole numbers where they are all but whole.
    fn as_stored(&self) -> Vec<f32> {
        let Some(metres) = self.claims.metres_per_unit else { return Vec::new() };
        let stored = |&distance_m: &f32| {
            let value = (f64::from(distance_m) / metres) as f32;
            let whole = value.round();
            if (value - whole).abs() <= 4.0 * f32::EPSILON * whole { whole } else { value }
        };
        self.distances_m.iter().map(stored).collect()
    }

    /// An odd number, so that cameras which alternate something by columns are seen whole.
    fn stride(&self) -> usize {
        self.shape.pixels().div_ceil(SAMPLED_PIXELS) | 1
    }

    /// What contradicts the claims, most important first. Empty where nothing does.
    #[must_use]
    pub fn finish(mut self) -> Vec<Suspicion> {
        self.amplitudes.sort_unstable_by(f32::total_cmp);
        if self.stored_distances.is_empty() {
            self.stored_distances = self.as_stored();
        }
        self.stored_distances.sort_unstable_by(f32::total_cmp);
        let standardized = self.claims.standardized.then_some(Suspicion::Standardized);
        let distances = distances::suspicion(&self.distances_m, &self.claims);
        let codes = [largest(&self.stored_distances), smallest(&self.stored_distances)];
        let codes = codes.into_iter().flatten().filter(|found| found.kind == Kind::Code);
        let mut found: Vec<Suspicion> = standardized.into_iter().collect();
        found.extend(distances);
        found.extend(self.times.suspicion());
        found.extend(largest(&self.amplitudes).map(of_amplitudes));
        found.extend(codes.map(of_distances));
        found.extend(self.phases.fault(&self.claims).map(Suspicion::PhaseConvention));
        found.extend(self.clipped_bins());
        let exposures = self.exposures.finish();
        // Exponents of frames that were scaled one by one are those of the scaling.
        if exposures.is_none() {
            found.extend(self.exponents.suspicions());
        }
        found.extend(exposures);
        found.extend(lens::suspicion(self.claims.principal_point, self.shape));
        found.extend(self.dark.suspicion());
        found
    }

    /// Phase samples that clip. Those at a stated value are flagged, and not among these.
    fn clipped_bins(&self) -> Option<Suspicion> {
        let clip::Clip { value_dn, share, both_signs } = clip::clip(self.phases.bins())?;
        Some(Suspicion::PhaseSamplesClip { value_dn, share, both_signs })
    }
}

fn is_measured(distance: f32) -> bool {
    distance > 0.0 && distance.is_finite()
}

fn of_amplitudes(found: Extreme) -> Suspicion {
    let (value_dn, share, others_dn) = (found.value, found.share, found.next);
    match found.kind {
        Kind::Code => Suspicion::AmplitudeCode { value_dn, share, others_dn },
        Kind::Clip => Suspicion::AmplitudeClips { value_dn, share },
    }
}

fn of_distances(found: Extreme) -> Suspicion {
    Suspicion::DistanceCode { value: found.value, share: found.share, others: found.next }
}
