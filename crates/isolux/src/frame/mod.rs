//! One frame of a recording: its images and what is known about them.

mod channels;
mod flags;
mod geometry;
mod integration_time;
mod lens;
pub mod phase;
mod plane;

pub use channels::Channels;
pub use flags::PixelFlags;
pub use geometry::Intrinsics;
pub use integration_time::IntegrationTime;
pub use lens::{Distortion, Lens, LensError, PixelRays, RayTable, SpinningLidar};
pub use phase::PhaseConvention;
pub use plane::{Plane, Shape, ShapeError, Window};

/// One frame: height × width planes of one instant. Reuse one `Frame` for a whole recording: readers keep the
/// memory of its planes.
#[derive(Clone, Debug, PartialEq)]
pub struct Frame {
    /// Amplitude in DN, as delivered. What is not a measurement is marked in `flags`.
    pub amplitude: Plane<f32>,
    /// Radial distance in metres; 0, negative or NaN = invalid.
    pub distance_m: Option<Plane<f32>>,
    /// Integration time in µs.
    pub integration_time_us: IntegrationTime,
    /// Flags of each pixel before any correction.
    pub flags: Plane<PixelFlags>,
    /// Raw bins A1..A4 in DN, in the paper's order.
    pub phase_samples: Option<[Plane<f32>; 4]>,
    /// DC image (active and ambient light) in DN.
    pub intensity: Option<Plane<f32>>,
    /// Time stamp in µs.
    pub timestamp_us: Option<f64>,
    /// Calibration label of each pixel: equal labels > 0 are one material, 0 is unused.
    pub target: Option<Plane<u8>>,
    /// Amplitude as the vendor scaled it, kept verbatim.
    pub vendor_amplitude: Option<Plane<f32>>,
    /// Confidence as the vendor delivered it, kept verbatim.
    pub vendor_confidence: Option<Plane<f32>>,
    /// Row-major rigid transform from camera to world coordinates, metres.
    pub world_from_camera: Option<[[f64; 4]; 4]>,
}

impl Frame {
    /// A frame of amplitude alone, every pixel NaN, nothing flagged.
    #[must_use]
    pub fn new(shape: Shape) -> Self {
        Self {
            amplitude: Plane::filled(shape, f32::NAN),
            distance_m: None,
            integration_time_us: IntegrationTime::Unknown,
            flags: Plane::filled(shape, PixelFlags::empty()),
            phase_samples: None,
            intensity: None,
            timestamp_us: None,
            target: None,
            vendor_amplitude: None,
            vendor_confidence: None,
            world_from_camera: None,
        }
    }

    /// Height and width.
    #[must_use]
    pub fn shape(&self) -> Shape {
        self.amplitude.shape()
    }

    /// Bytes that its planes hold.
    #[must_use]
    pub fn bytes(&self) -> usize {
        let Self { distance_m, intensity, vendor_amplitude, vendor_confidence, .. } = self;
        let optional = [distance_m, intensity, vendor_amplitude, vendor_confidence].into_iter().flatten();
        let times = match &self.integration_time_us {
            IntegrationTime::PerPixel(map) => map.bytes(),
            IntegrationTime::PerFrame(_) | IntegrationTime::Unknown => 0,
        };
        let images = optional.chain(self.phase_samples.iter().flatten()).map(Plane::bytes);
        let labels = self.target.as_ref().map_or(0, Plane::bytes);
        self.amplitude.bytes() + self.flags.bytes() + times + labels + images.sum::<usize>()
    }

    /// Flags pixels without a measurement. Amplitudes that are not finite and positive become INVALID; those that
    /// reach `saturated_amplitude` (the camera's saturation code, DN) become SATURATED and INVALID. Existing flags
    /// are kept.
    ///
    /// An amplitude of exactly 0 is what dead and over-saturated pixels deliver (all four bins equal, the
    /// paper's section 2.1), so it is no measurement either.
    pub fn flag_amplitude(&mut self, saturated_amplitude: Option<f32>) {
        let code = saturated_amplitude.unwrap_or(f32::INFINITY);
        for (flags, &amplitude) in self.flags.values_mut().iter_mut().zip(self.amplitude.values()) {
            let measured = amplitude > 0.0 && amplitude.is_finite();
            flags.set(PixelFlags::INVALID, !measured || flags.contains(PixelFlags::INVALID));
            if measured && amplitude >= code {
                flags.insert(PixelFlags::SATURATED | PixelFlags::INVALID);
            }
        }
    }

    /// Refuses planes that differ in shape from the amplitude.
    ///
    /// # Errors
    /// [`ShapeError::Mismatch`] names the first plane that does not fit.
    pub fn check_shapes(&self) -> Result<(), ShapeError> {
        let shape = self.shape();
        self.flags.expect_shape("flags", shape)?;
        let optional = [
            ("distance", &self.distance_m),
            ("intensity", &self.intensity),
            ("vendor_amplitude", &self.vendor_amplitude),
            ("vendor_confidence", &self.vendor_confidence),
        ];
        for (name, plane) in optional {
            plane.as_ref().map_or(Ok(()), |plane| plane.expect_shape(name, shape))?;
        }
        if let IntegrationTime::PerPixel(map) = &self.integration_time_us {
            map.expect_shape("integration_time_us", shape)?;
        }
        if let Some(target) = &self.target {
            target.expect_shape("target", shape)?;
        }
        self.phase_samples.iter().flatten().try_for_each(|bin| bin.expect_shape("phase_samples", shape))
    }

    /// True when the pixel is not INVALID, so that its amplitude may enter a statistic.
    #[must_use]
    pub fn is_valid(&self, index: usize) -> bool {
        !self.flags.values()[index].contains(PixelFlags::INVALID)
    }

    /// The amplitudes, DN; NaN for INVALID and SATURATED pixels, which do not count.
    pub(crate) fn counted_amplitudes(&self) -> impl Iterator<Item = f32> + '_ {
        let excluded = PixelFlags::INVALID | PixelFlags::SATURATED;
        let values = self.amplitude.values().iter().zip(self.flags.values());
        values.map(move |(&value, flags)| if flags.intersects(excluded) { f32::NAN } else { value })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_that_are_not_measurements_are_flagged_and_their_neighbours_are_not() {
        let mut frame = Frame::new(Shape::new(1, 6));
        frame.amplitude.values_mut().copy_from_slice(&[1.0, f32::NAN, 0.0, -2.0, f32::INFINITY, 65535.0]);
        frame.flag_amplitude(Some(65535.0));
        let invalid = PixelFlags::INVALID;
        let expected =
            [PixelFlags::empty(), invalid, invalid, invalid, invalid, invalid | PixelFlags::SATURATED];
        assert_eq!(frame.flags.values(), expected);
    }

    #[test]
    fn a_plane_of_another_shape_is_named() {
        let mut frame = Frame::new(Shape::new(2, 2));
        frame.distance_m = Some(Plane::filled(Shape::new(2, 3), 1.0));
        let message = frame.check_shapes().unwrap_err().to_string();
        assert!(message.starts_with("`distance` is 2×3"), "{message}");
    }
}
