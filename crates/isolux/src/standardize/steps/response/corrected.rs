//! Corrects the amplitudes of a frame for saturation, each pixel by the tier that was planned.

use super::SaturationCorrection;
use crate::frame::{Frame, IntegrationTime, PixelFlags, Plane, Shape};
use crate::memory::bytes;
use crate::standardize::AmbientLight;
use crate::standardize::error::StandardizeError;
use crate::terms::response::{PlannedAmbient, PlannedBins, PlannedPixels, Recovered};

/// Saturation-corrected amplitude and, where the tier repairs it, distance of a frame.
#[derive(Clone, Debug)]
pub(crate) struct Corrected {
    amplitude: Vec<f32>,
    distance_m: Plane<f32>,
    /// Growth of the ambient light, and the factor of each pixel by it.
    places: (f64, Plane<f32>),
}

/// The value of a pixel whose fill was not measured: the pixel is not saturated, but has no value.
const UNKNOWN: Option<f32> = Some(f32::NAN);

/// What corrections by distance and ambient light need besides the frame.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Fill<'a> {
    /// Denoised distances, m; empty where the correction does not need them.
    pub(crate) distance_m: &'a [f32],
    /// Ambient light of this frame, where it is not that of the whole recording, DN/µs.
    pub(crate) ambient_dn_per_us: Option<f64>,
}

/// Integration times of a frame.
#[derive(Clone, Copy)]
enum PixelTimes<'a> {
    One(f32),
    Each(&'a [f32]),
}

impl PixelTimes<'_> {
    #[inline(always)]
    fn at(self, index: usize) -> f32 {
        match self {
            Self::One(time_us) => time_us,
            Self::Each(times_us) => times_us[index],
        }
    }
}

/// The corrected planes of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Repaired {
    Amplitude,
    AmplitudeAndDistance,
}

impl Default for Corrected {
    fn default() -> Self {
        let empty = || Plane::filled(Shape::new(0, 0), f32::NAN);
        Self { amplitude: Vec::new(), distance_m: empty(), places: (f64::NAN, empty()) }
    }
}

impl Corrected {
    /// Bytes that it has allocated.
    pub(crate) fn bytes(&self) -> usize {
        bytes(&self.amplitude) + self.distance_m.bytes() + self.places.1.bytes()
    }

    pub(crate) fn amplitude(&self) -> &[f32] {
        &self.amplitude
    }

    pub(crate) fn distance_m(&self) -> &Plane<f32> {
        &self.distance_m
    }

    /// Corrects `frame`. Measured pixels that are saturated or beyond the fitted range become SATURATED and
    /// INVALID, because their linear value cannot be determined; AMBIGUOUS takes the place of SATURATED where they only
    /// may be. Allocates only when the shape differs from that of
    /// the last frame.
    ///
    /// # Errors
    /// [`StandardizeError`] when the frame lacks the channel or the time, or is not of the map's shape.
    pub(crate) fn fill(
        &mut self,
        correction: &SaturationCorrection,
        frame: &Frame,
        fill: Fill<'_>,
        flags: &mut [PixelFlags],
    ) -> Result<Repaired, StandardizeError> {
        self.amplitude.resize(frame.shape().pixels(), f32::NAN);
        let amplitude = frame.amplitude.values();
        match correction {
            SaturationCorrection::Amplitude(planned) => {
                each(&mut self.amplitude, flags, |i| planned.linearise(amplitude[i]));
            }
            SaturationCorrection::Pixel(planned) => self.by_time(planned, frame, flags)?,
            SaturationCorrection::Ambient { planned, light } => {
                self.place(frame.shape(), light.growth);
                let light = fill.ambient_dn_per_us.unwrap_or(light.dn_per_us);
                self.by_ambient_light(planned, light as f32, frame, fill.distance_m, flags)?;
            }
            SaturationCorrection::Intensity(planned) => {
                let channel = StandardizeError::FillMissing { channel: "intensity" };
                let intensity = frame.intensity.as_ref().ok_or(channel)?.values();
                each(&mut self.amplitude, flags, |i| match intensity[i].is_nan() {
                    true => UNKNOWN,
                    false => planned.linearise(intensity[i], amplitude[i]),
                });
            }
            SaturationCorrection::PhaseSamples(planned) => return self.by_bins(planned, frame, flags),
        }
        Ok(Repaired::Amplitude)
    }

    /// Computes the growth of the ambient light over the image, unless it is known from the last frame.
    fn place(&mut self, shape: Shape, growth: f64) {
        let (known, places) = &mut self.places;
        if *known != growth || places.shape() != shape {
            *known = growth;
            *places = Plane::from_fn(shape, |row, column| {
                (growth as f32 * AmbientLight::radius_squared(shape, row, column)).exp()
            });
        }
    }

    /// Corrects by the distance and the ambient light.
    fn by_ambient_light(
        &mut self,
        planned: &PlannedAmbient,
        ambient_dn_per_us: f32,
        frame: &Frame,
        distance_m: &[f32],
        flags: &mut [PixelFlags],
    ) -> Result<(), StandardizeError> {
        let times = match &frame.integration_time_us {
            IntegrationTime::Unknown => return Err(StandardizeError::TimeUnknown),
            IntegrationTime::PerFrame(time_us) => PixelTimes::One(*time_us as f32),
            IntegrationTime::PerPixel(map) => PixelTimes::Each(map.values()),
        };
        let (amplitude, places) = (frame.amplitude.values(), self.places.1.values());
        each_or_flag(&mut self.amplitude, flags, |i| {
            let light = ambient_dn_per_us * places[i];
            let found = planned.linearise(amplitude[i], distance_m[i], times.at(i), light);
            match found {
                None => Ok(f32::NAN),
                Some(Recovered::Linear(linear)) => Ok(linear),
                Some(Recovered::Saturated) => Err(PixelFlags::SATURATED),
                Some(Recovered::Ambiguous) => Err(PixelFlags::AMBIGUOUS),
            }
        });
        Ok(())
    }

    /// Corrects by the integration time, for the scene of the sweep only.
    fn by_time(
        &mut self,
        planned: &PlannedPixels,
        frame: &Frame,
        flags: &mut [PixelFlags],
    ) -> Result<(), StandardizeError> {
        let (found, expected) = (frame.shape(), planned.shape);
        if found != expected {
            return Err(StandardizeError::AnotherScene { found, expected });
        }
        let amplitude = frame.amplitude.values();
        match &frame.integration_time_us {
            IntegrationTime::Unknown => return Err(StandardizeError::TimeUnknown),
            IntegrationTime::PerFrame(time_us) => {
                each(&mut self.amplitude, flags, |i| planned.linearise(i, amplitude[i], *time_us));
            }
            IntegrationTime::PerPixel(map) => {
                let times_us = map.values();
                each(&mut self.amplitude, flags, |i| match f64::from(times_us[i]) {
                    time_us if time_us > 0.0 => planned.linearise(i, amplitude[i], time_us),
                    // The time step flags pixels without a time.
                    _ => Some(amplitude[i]),
                });
            }
        }
        Ok(())
    }

    /// Corrects amplitude and distance by the raw bins.
    fn by_bins(
        &mut self,
        planned: &PlannedBins,
        frame: &Frame,
        flags: &mut [PixelFlags],
    ) -> Result<Repaired, StandardizeError> {
        let channel = StandardizeError::FillMissing { channel: "phase_samples" };
        let [a1, a2, a3, a4] = frame.phase_samples.as_ref().ok_or(channel)?.each_ref().map(Plane::values);
        let linear = |i: usize| match [a1[i], a2[i], a3[i], a4[i]] {
            bins if bins.iter().any(|bin| bin.is_nan()) => UNKNOWN.map(|unknown| (unknown, 0.0)),
            bins => planned.linearise(bins),
        };
        let Some(delivered) = frame.distance_m.as_ref().filter(|_| planned.repairs_distance()) else {
            each(&mut self.amplitude, flags, |i| linear(i).map(|(amplitude, _)| amplitude));
            return Ok(Repaired::Amplitude);
        };
        let delivered = delivered.values();
        self.distance_m.reshape(frame.shape(), f32::NAN);
        let repaired = self.distance_m.values_mut();
        repaired.copy_from_slice(delivered);
        each(&mut self.amplitude, flags, |i| {
            let Some((amplitude, shift_m)) = linear(i) else {
                // Clipped bins give a wrong distance, which must not enter the smoothing of neighbours.
                repaired[i] = f32::NAN;
                return None;
            };
            // An invalid distance must stay invalid.
            if delivered[i] > 0.0 {
                repaired[i] += shift_m;
            }
            Some(amplitude)
        });
        Ok(Repaired::AmplitudeAndDistance)
    }
}

/// Writes the corrected value of every measured pixel that has one; the others become SATURATED and INVALID.
fn each(amplitude: &mut [f32], flags: &mut [PixelFlags], mut linear: impl FnMut(usize) -> Option<f32>) {
    each_or_flag(amplitude, flags, |index| linear(index).ok_or(PixelFlags::SATURATED));
}

/// The same for corrections that say why a pixel has no value; INVALID is added to the flag.
fn each_or_flag(
    amplitude: &mut [f32],
    flags: &mut [PixelFlags],
    mut linear: impl FnMut(usize) -> Result<f32, PixelFlags>,
) {
    for (index, (value, flags)) in amplitude.iter_mut().zip(flags).enumerate() {
        if flags.contains(PixelFlags::INVALID) {
            *value = f32::NAN;
            continue;
        }
        let saturated = flags.contains(PixelFlags::SATURATED);
        let found = if saturated { Err(PixelFlags::SATURATED) } else { linear(index) };
        *value = found.unwrap_or(f32::NAN);
        if let Err(reason) = found {
            *flags |= reason | PixelFlags::INVALID;
        }
    }
}
