//! From the light on a pixel to its four digital numbers, with noise.

use isolux::phase::CLIPPED_SHARE;

use crate::full_well::{FullWell, FullWellTable};
use crate::model::CameraModel;
use crate::noise::{Noise, Purpose};

/// Everything of the pixel and converter that does not depend on the frame, computed once.
#[derive(Clone, Debug)]
pub(crate) struct Readout {
    well: FullWellTable,
    read_noise_electrons: f64,
    gain_dn_per_electron: f64,
    black_level_dn: f64,
    adc_maximum_dn: f64,
    /// Level from which on a bin counts as saturated, DN.
    saturated_dn: u16,
}

impl Readout {
    pub(crate) fn new(model: &CameraModel) -> Self {
        Self {
            well: FullWellTable::new(&FullWell::of(model)),
            read_noise_electrons: model.read_noise_electrons,
            gain_dn_per_electron: model.gain_dn_per_electron,
            black_level_dn: model.black_level_dn,
            adc_maximum_dn: f64::from(model.adc_maximum_dn),
            saturated_dn: (CLIPPED_SHARE * model.clip_dn()) as u16,
        }
    }

    /// Bins of one exposure: shot noise, full well, read noise, gain (times `drift`), converter.
    #[inline]
    pub(crate) fn bins(&self, received_electrons: [f64; 4], drift: f64, noise: &mut Noise) -> [u16; 4] {
        received_electrons.map(|mean| {
            let kept = self.well.kept_electrons(noise.poisson(mean));
            let read = kept + self.read_noise_electrons * noise.normal();
            let level = drift * self.gain_dn_per_electron * read + self.black_level_dn;
            // The cast truncates, so that this rounds to nearest; the converter's range is 0 to its maximum.
            (level + 0.5).clamp(0.0, self.adc_maximum_dn) as u16
        })
    }

    /// Amplitude of the same exposure without noise and quantization, DN.
    #[inline]
    pub(crate) fn noise_free_amplitude_dn(&self, received_electrons: [f64; 4], drift: f64) -> f64 {
        let [a1, a2, a3, a4] = received_electrons.map(|mean| {
            let level = drift * self.gain_dn_per_electron * self.well.kept_electrons(mean);
            (level + self.black_level_dn).min(self.adc_maximum_dn)
        });
        let (cosine, sine) = (a1 - a3, a2 - a4);
        0.5 * (cosine * cosine + sine * sine).sqrt()
    }

    pub(crate) fn is_saturated(&self, bins: [u16; 4]) -> bool {
        bins.iter().any(|&bin| bin >= self.saturated_dn)
    }
}

/// The camera's dead pixels, row by row: each is dead with the model's probability, whatever the others are.
pub(crate) fn dead_pixels(model: &CameraModel) -> Vec<bool> {
    let mut noise = Noise::new(model.dead_pixel_seed, Purpose::DeadPixels, 0);
    (0..model.shape().pixels()).map(|_| noise.uniform() <= model.dead_pixel_fraction).collect()
}
