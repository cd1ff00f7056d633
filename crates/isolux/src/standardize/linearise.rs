//! What the response does to the amplitude before anything scales it: the values of a pixel without a full well.

use super::StandardizeError;
use crate::frame::{Channels, Frame, IntegrationTime, PixelFlags, Plane, Shape};
use crate::terms::response::{PlannedAmplitude, PlannedBins, PlannedIntensity, PlannedPixels};

/// A tier of the response that is applied pixel by pixel.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Lineariser {
    Amplitude(PlannedAmplitude),
    Pixel(PlannedPixels),
    Intensity(PlannedIntensity),
    PhaseSamples(PlannedBins),
}

impl Lineariser {
    /// The channels that it reads besides the amplitude.
    pub(super) fn channels(&self) -> Channels {
        match self {
            Self::Amplitude(_) | Self::Pixel(_) => Channels::empty(),
            Self::Intensity(_) => Channels::INTENSITY,
            Self::PhaseSamples(_) => Channels::PHASE_SAMPLES,
        }
    }
}

/// Linear amplitude and, where the tier repairs it, distance of a frame.
#[derive(Clone, Debug)]
pub(super) struct Linearised {
    amplitude: Vec<f32>,
    distance_m: Plane<f32>,
}

/// The value of a pixel whose fill was not measured: not saturated, but no value either.
const UNKNOWN: Option<f32> = Some(f32::NAN);

/// What became of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Repaired {
    Amplitude,
    AmplitudeAndDistance,
}

impl Linearised {
    pub(super) fn new() -> Self {
        Self { amplitude: Vec::new(), distance_m: Plane::filled(Shape::new(0, 0), f32::NAN) }
    }

    pub(super) fn amplitude(&self) -> &[f32] {
        &self.amplitude
    }

    pub(super) fn distance_m(&self) -> &Plane<f32> {
        &self.distance_m
    }

    /// Linearises `frame`. Measured pixels beyond the range, or saturated ones, become SATURATED and INVALID: nothing
    /// tells what their linear value is. Allocates only when the shape differs from that of the last frame.
    ///
    /// # Errors
    /// [`StandardizeError`] when the frame lacks the channel or the time, or is not of the map's shape.
    pub(super) fn fill(
        &mut self,
        lineariser: &Lineariser,
        frame: &Frame,
        flags: &mut [PixelFlags],
    ) -> Result<Repaired, StandardizeError> {
        self.amplitude.resize(frame.shape().pixels(), f32::NAN);
        let amplitude = frame.amplitude.values();
        match lineariser {
            Lineariser::Amplitude(planned) => {
                self.each(flags, |i| planned.linearise(amplitude[i]));
                Ok(Repaired::Amplitude)
            }
            Lineariser::Pixel(planned) => {
                let (found, expected) = (frame.shape(), planned.shape);
                if found != expected {
                    return Err(StandardizeError::AnotherScene { found, expected });
                }
                match &frame.integration_time_us {
                    IntegrationTime::Unknown => return Err(StandardizeError::TimeUnknown),
                    IntegrationTime::PerFrame(time_us) => {
                        self.each(flags, |i| planned.linearise(i, amplitude[i], *time_us));
                    }
                    IntegrationTime::PerPixel(map) => {
                        let times_us = map.values();
                        // The time step says of a pixel without a time that it has none.
                        let linear = |i: usize| match f64::from(times_us[i]) {
                            time_us if time_us > 0.0 => planned.linearise(i, amplitude[i], time_us),
                            _ => Some(amplitude[i]),
                        };
                        self.each(flags, linear);
                    }
                }
                Ok(Repaired::Amplitude)
            }
            Lineariser::Intensity(planned) => {
                let channel = StandardizeError::FillMissing { channel: "intensity" };
                let intensity = frame.intensity.as_ref().ok_or(channel)?.values();
                self.each(flags, |i| match intensity[i].is_nan() {
                    true => UNKNOWN,
                    false => planned.linearise(intensity[i], amplitude[i]),
                });
                Ok(Repaired::Amplitude)
            }
            Lineariser::PhaseSamples(planned) => {
                let channel = StandardizeError::FillMissing { channel: "phase_samples" };
                let [a1, a2, a3, a4] =
                    frame.phase_samples.as_ref().ok_or(channel)?.each_ref().map(Plane::values);
                let linear = |i: usize| match [a1[i], a2[i], a3[i], a4[i]] {
                    bins if bins.iter().any(|bin| bin.is_nan()) => UNKNOWN.map(|unknown| (unknown, 0.0)),
                    bins => planned.linearise(bins),
                };
                match &frame.distance_m {
                    Some(distance_m) if planned.repairs_distance() => {
                        let delivered = distance_m.values();
                        self.distance_m.reshape(frame.shape(), f32::NAN);
                        let Self { amplitude, distance_m } = self;
                        let repaired = distance_m.values_mut();
                        repaired.copy_from_slice(delivered);
                        each(amplitude, flags, |i| {
                            let Some((amplitude, shift_m)) = linear(i) else {
                                // Clipped bins tell no distance that neighbours could be smoothed with.
                                repaired[i] = f32::NAN;
                                return None;
                            };
                            // What is no distance must not become one.
                            if delivered[i] > 0.0 {
                                repaired[i] += shift_m;
                            }
                            Some(amplitude)
                        });
                        Ok(Repaired::AmplitudeAndDistance)
                    }
                    _ => {
                        self.each(flags, |i| linear(i).map(|(amplitude, _)| amplitude));
                        Ok(Repaired::Amplitude)
                    }
                }
            }
        }
    }

    fn each(&mut self, flags: &mut [PixelFlags], linear: impl FnMut(usize) -> Option<f32>) {
        each(&mut self.amplitude, flags, linear);
    }
}

/// The linear value of every measured pixel, where there is one.
fn each(amplitude: &mut [f32], flags: &mut [PixelFlags], mut linear: impl FnMut(usize) -> Option<f32>) {
    for (index, (value, flags)) in amplitude.iter_mut().zip(flags).enumerate() {
        if flags.contains(PixelFlags::INVALID) {
            *value = f32::NAN;
            continue;
        }
        let found = if flags.contains(PixelFlags::SATURATED) { None } else { linear(index) };
        *value = found.unwrap_or(f32::NAN);
        if found.is_none() {
            *flags |= PixelFlags::SATURATED | PixelFlags::INVALID;
        }
    }
}
