//! What the evaluation reads of a frame, and which of its pixels and times count.

use crate::frame::{Frame, IntegrationTime, PixelFlags, Plane, Shape, ShapeError};

/// One frame as the evaluation sees it: raw or standardized values, and what they were taken with.
///
/// A pixel is usable when its value is finite and positive and [`PixelFlags::INVALID`] is not set; all other
/// pixels enter no statistic.
#[derive(Clone, Copy, Debug)]
pub struct EvaluationFrame<'a> {
    /// Height × width values in DN: raw or standardized amplitude.
    pub values: &'a Plane<f32>,
    /// What is known of each pixel.
    pub flags: &'a Plane<PixelFlags>,
    /// Radial distance in metres; 0, negative or NaN = invalid.
    pub distance_m: Option<&'a Plane<f32>>,
    /// Integration time in µs.
    pub integration_time_us: &'a IntegrationTime,
    /// Labels: equal labels > 0 are one material, 0 is unused.
    pub target: Option<&'a Plane<u8>>,
    /// Predicted standard deviation of each value, DN.
    pub sigma: Option<&'a Plane<f32>>,
}

impl<'a> EvaluationFrame<'a> {
    /// The raw amplitude of a frame.
    #[must_use]
    pub fn of_raw(frame: &'a Frame) -> Self {
        Self::of_standardized(frame, &frame.amplitude, &frame.flags)
    }

    /// Standardized values and their flags, with the distance, time and labels of the frame they came from.
    #[must_use]
    pub fn of_standardized(frame: &'a Frame, values: &'a Plane<f32>, flags: &'a Plane<PixelFlags>) -> Self {
        Self {
            values,
            flags,
            distance_m: frame.distance_m.as_ref(),
            integration_time_us: &frame.integration_time_us,
            target: frame.target.as_ref(),
            sigma: None,
        }
    }

    /// With the predicted standard deviation of each value, DN.
    #[must_use]
    pub fn with_sigma(self, sigma: Option<&'a Plane<f32>>) -> Self {
        Self { sigma, ..self }
    }

    pub(super) fn check_shapes(&self, shape: Shape) -> Result<(), ShapeError> {
        self.values.expect_shape("values", shape)?;
        self.flags.expect_shape("flags", shape)?;
        self.distance_m.map_or(Ok(()), |plane| plane.expect_shape("distance", shape))?;
        self.target.map_or(Ok(()), |plane| plane.expect_shape("target", shape))?;
        self.sigma.map_or(Ok(()), |plane| plane.expect_shape("sigma", shape))?;
        match self.integration_time_us {
            IntegrationTime::PerPixel(map) => map.expect_shape("integration_time_us", shape),
            IntegrationTime::Unknown | IntegrationTime::PerFrame(_) => Ok(()),
        }
    }

    /// The usable values, NaN for all other pixels, into `out` (one per pixel); returns how many are usable.
    pub(super) fn usable_into(&self, out: &mut [f32]) -> usize {
        let mut usable = 0;
        for ((out, &value), flags) in out.iter_mut().zip(self.values.values()).zip(self.flags.values()) {
            let counts = value > 0.0 && value.is_finite() && !flags.contains(PixelFlags::INVALID);
            *out = if counts { value } else { f32::NAN };
            usable += usize::from(counts);
        }
        usable
    }
}

/// The integration times of a frame in µs; 0 where the time is unknown.
#[derive(Clone, Copy, Debug)]
pub(super) enum Times<'a> {
    /// All pixels share one.
    Uniform(f32),
    /// One for each pixel.
    PerPixel(&'a [f32]),
}

impl<'a> Times<'a> {
    pub(super) fn of(time: &'a IntegrationTime) -> Self {
        match time {
            IntegrationTime::Unknown => Self::Uniform(0.0),
            IntegrationTime::PerFrame(time) => Self::Uniform(known(*time as f32)),
            IntegrationTime::PerPixel(map) => Self::PerPixel(map.values()),
        }
    }

    pub(super) fn at(self, index: usize) -> f32 {
        match self {
            Self::Uniform(time) => time,
            Self::PerPixel(map) => known(map[index]),
        }
    }

    /// The one known time of the whole frame.
    pub(super) fn of_frame(self) -> Option<f32> {
        match self {
            Self::Uniform(time) => (time > 0.0).then_some(time),
            Self::PerPixel(_) => None,
        }
    }
}

fn known(time_us: f32) -> f32 {
    if time_us > 0.0 && time_us.is_finite() { time_us } else { 0.0 }
}

/// Which frame to give to [`Evaluator::set_reference`](super::Evaluator::set_reference): of the frames whose
/// integration time is nearest to `reference_time_us` (by ratio), the last of the first run of equal times, as
/// the camera has settled there. Unknown times are `None`. `None` when no time is known or the reference is not
/// positive.
#[must_use]
pub fn nearest_reference(
    times_us: impl IntoIterator<Item = Option<f64>>,
    reference_time_us: f64,
) -> Option<usize> {
    let mut best: Option<(f64, usize)> = None;
    let mut in_best_run = false;
    for (index, time_us) in times_us.into_iter().enumerate() {
        let distance = time_us.map_or(f64::NAN, |time_us| (time_us / reference_time_us).ln().abs());
        let nearer = best.is_none_or(|(nearest, _)| distance < nearest);
        let continues = in_best_run && best.is_some_and(|(nearest, _)| distance == nearest);
        in_best_run = distance.is_finite() && (nearer || continues);
        if in_best_run {
            best = Some((distance, index));
        }
    }
    best.map(|(_, index)| index)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_reference_is_the_last_frame_of_the_nearest_run() {
        let times = [100.0, 800.0, 800.0, 800.0, 6000.0, 800.0].map(Some);
        assert_eq!(nearest_reference(times, 1000.0), Some(3));
        // By ratio 4000 is nearer to 6000 (1.5) than to 800 (5).
        assert_eq!(nearest_reference(times, 4000.0), Some(4));
    }

    #[test]
    fn unknown_times_are_never_the_reference() {
        assert_eq!(nearest_reference([None, Some(5.0), None, Some(5.0)], 8200.0), Some(1));
        assert_eq!(nearest_reference([None, Some(0.0), Some(-1.0), Some(f64::NAN)], 8200.0), None);
        assert_eq!(nearest_reference([Some(5.0)], 0.0), None);
        assert_eq!(nearest_reference([], 8200.0), None);
    }

    #[test]
    fn only_finite_positive_unflagged_values_are_usable() {
        let shape = Shape::new(1, 6);
        let values = Plane::from_vec(shape, vec![1.0, 0.0, f32::NAN, -1.0, f32::INFINITY, 1e30]).unwrap();
        let mut flags = Plane::filled(shape, PixelFlags::empty());
        flags.values_mut()[0] = PixelFlags::SATURATED;
        flags.values_mut()[5] = PixelFlags::INVALID;
        let frame = EvaluationFrame {
            values: &values,
            flags: &flags,
            distance_m: None,
            integration_time_us: &IntegrationTime::Unknown,
            target: None,
            sigma: None,
        };
        let mut out = [0.0; 6];
        assert_eq!(frame.usable_into(&mut out), 1);
        assert_eq!(out[0], 1.0);
        assert!(out[1..].iter().all(|value| value.is_nan()));
    }
}
