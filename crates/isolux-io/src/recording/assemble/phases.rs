//! Amplitude and distance from phase samples of any layout.

use isolux::{Channels, PixelFlags, Plane, phase};

use super::bins;
use super::iq::{self, Iq};
use super::loaded::Loaded;
use super::unwrap::{Pixel, Unwrapping};
use crate::error::RecordingError;
use crate::recording::frequency::ModulationFrequency;
use crate::recording::phase_layout::PhaseLayout;

/// Phases of the loaded frame, and memory that lives from frame to frame. Of two frequencies, the finer one stands
/// first: amplitude and bins are its own.
#[derive(Debug)]
pub(super) struct Phases {
    layout: PhaseLayout,
    frequency: Option<ModulationFrequency>,
    unwrapping: Option<Unwrapping>,
    pub(super) bins: Option<[Plane<f32>; 4]>,
    coarse_bins: Option<[Plane<f32>; 4]>,
    iq: Option<Iq>,
    coarse_iq: Option<Iq>,
    numbers: Vec<f32>,
    /// Amplitude and distance of the finer frequency, and of the coarser.
    polar: Option<[Plane<f32>; 4]>,
}

impl Phases {
    pub(super) fn new(layout: PhaseLayout, frequency: Option<ModulationFrequency>) -> Self {
        let (numbers, unwrapping) = (Vec::new(), frequency.and_then(Unwrapping::new));
        let unwrapping = unwrapping.filter(|_| layout.is_twice());
        let (bins, coarse_bins, iq, coarse_iq, polar) = Default::default();
        Self { layout, frequency, unwrapping, bins, coarse_bins, iq, coarse_iq, numbers, polar }
    }

    /// Reads the phase samples of the loaded frame.
    pub(super) fn read(&mut self, loaded: &Loaded<'_>) -> Result<(), RecordingError> {
        let Some(frame) = loaded.raw(Channels::PHASE_SAMPLES)? else { return Ok(()) };
        let (shape, convention) =
            (loaded.metadata.shape, loaded.metadata.info.phase_convention.unwrap_or_default());
        let sets = if self.layout.is_twice() { 2 } else { 1 };
        let second_is_finer =
            matches!(self.frequency, Some(ModulationFrequency::Pair([first, second])) if second > first);
        let fine = usize::from(self.layout.is_twice() && second_is_finer);
        if self.layout.is_iq() {
            let mut read = |set: usize, slot: &mut Option<Iq>| {
                let iq = slot.get_or_insert_with(|| [(); 2].map(|()| Plane::filled(shape, f32::NAN)));
                iq.iter_mut().for_each(|plane| plane.reshape(shape, f32::NAN));
                iq::read(&frame, sets, set, convention.reversed, &mut self.numbers, iq);
            };
            read(fine, &mut self.iq);
            if sets == 2 {
                read(1 - fine, &mut self.coarse_iq);
            }
        } else {
            bins::read(&frame, shape, sets, fine, convention, &mut self.bins);
            if sets == 2 {
                bins::read(&frame, shape, sets, 1 - fine, convention, &mut self.coarse_bins);
            }
        }
        Ok(())
    }

    /// The amplitude of the loaded phase samples.
    pub(super) fn amplitude_into(
        &self,
        loaded: &Loaded<'_>,
        out: &mut Plane<f32>,
    ) -> Result<(), RecordingError> {
        amplitude(loaded, self.bins.as_ref(), self.iq.as_ref(), out)
    }

    /// The distance of the loaded phase samples, m; nothing where the frequency is not known.
    pub(super) fn distance_into(
        &mut self,
        loaded: &Loaded<'_>,
        out: &mut Plane<f32>,
    ) -> Result<(), RecordingError> {
        let Some(frequency) = self.frequency else { return Ok(()) };
        let (bins, iq) = (self.bins.as_ref(), self.iq.as_ref());
        let (Some(unwrapping), ModulationFrequency::Pair([first, second])) =
            (&mut self.unwrapping, frequency)
        else {
            return distance(loaded, bins, iq, frequency.hz(), out);
        };
        let shape = loaded.metadata.shape;
        out.reshape(shape, f32::NAN);
        let planes = self.polar.get_or_insert_with(|| [(); 4].map(|()| Plane::filled(shape, f32::NAN)));
        planes.iter_mut().for_each(|plane| plane.reshape(shape, f32::NAN));
        let [fine_amplitude, fine_m, coarse_amplitude, coarse_m] = planes;
        let (coarse_bins, coarse_iq) = (self.coarse_bins.as_ref(), self.coarse_iq.as_ref());
        amplitude(loaded, bins, iq, fine_amplitude)?;
        distance(loaded, bins, iq, frequency.hz(), fine_m)?;
        amplitude(loaded, coarse_bins, coarse_iq, coarse_amplitude)?;
        distance(loaded, coarse_bins, coarse_iq, first.min(second), coarse_m)?;
        let (fine, coarse) = (fine_amplitude.values().iter(), coarse_amplitude.values().iter());
        let values = fine.zip(fine_m.values()).zip(coarse.zip(coarse_m.values()));
        let pixels = values.map(|((&fine_amplitude, &fine_m), (&coarse_amplitude, &coarse_m))| Pixel {
            fine_m,
            coarse_m,
            fine_amplitude,
            coarse_amplitude,
        });
        unwrapping.unwrap_into(pixels, out.values_mut());
        Ok(())
    }

    /// Marks the pixels with a sample at `clip`, of either frequency.
    pub(super) fn flag_clipped(&self, clip: f32, flags: &mut Plane<PixelFlags>) {
        let level = clip * phase::CLIPPED_SHARE as f32;
        self.bins.iter().chain(&self.coarse_bins).for_each(|bins| bins::flag_clipped(bins, level, flags));
        self.iq.iter().chain(&self.coarse_iq).for_each(|iq| bins::flag_clipped(iq, level, flags));
    }
}

fn amplitude(
    loaded: &Loaded<'_>,
    bins: Option<&[Plane<f32>; 4]>,
    iq: Option<&Iq>,
    out: &mut Plane<f32>,
) -> Result<(), RecordingError> {
    if let Some(bins) = bins {
        phase::amplitude_into(bins, out).map_err(|error| unequal(loaded, &error))?;
    } else if let Some(iq) = iq {
        iq::amplitude_into(iq, out);
    }
    Ok(())
}

fn distance(
    loaded: &Loaded<'_>,
    bins: Option<&[Plane<f32>; 4]>,
    iq: Option<&Iq>,
    frequency_hz: f64,
    out: &mut Plane<f32>,
) -> Result<(), RecordingError> {
    if let Some(bins) = bins {
        // The bins are in the paper's sign already.
        phase::distance_into(bins, frequency_hz, false, out).map_err(|error| unequal(loaded, &error))?;
    } else if let Some(iq) = iq {
        iq::distance_into(iq, frequency_hz, out);
    }
    Ok(())
}

fn unequal(loaded: &Loaded<'_>, error: &isolux::ShapeError) -> RecordingError {
    RecordingError::content(&loaded.metadata.path, error.to_string(), "bins of one shape")
}
