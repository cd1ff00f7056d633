//! Measures the noise of a recording: by how much amplitudes that should be equal differ, in groups of similar
//! light.

#[cfg(test)]
mod tests;

use crate::calibrate::grouped_noise::{Compared, GroupNoise, GroupedNoise};
use crate::frame::{Frame, IntegrationTime};
use crate::terms::noise::NoiseCell;
use crate::terms::{Noise, Source};

/// Collects differences frame by frame: between consecutive frames of one integration time, or between neighbouring
/// pixels while there are no such frames. Memory does not grow with the number of frames.
///
/// Between frames, the mean difference of a group (a drift of the gain) is removed, and so are the largest 5 % of
/// the differences (movement). Between pixels, texture counts as noise.
#[derive(Clone, Debug)]
pub struct NoiseSurvey {
    noise: GroupedNoise,
    whole_numbers: bool,
}

impl Default for NoiseSurvey {
    fn default() -> Self {
        Self { noise: GroupedNoise::new(1), whole_numbers: true }
    }
}

/// The result of a survey.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct NoiseCells {
    /// The groups.
    pub cells: Vec<NoiseCell>,
    /// True when they come from neighbouring pixels, because there were no repeated frames.
    pub spatial: bool,
    /// Variance of the amplitude's own quantization, DN²: 1/12 where all amplitudes are whole numbers.
    pub quantization_variance_dn2: f64,
}

impl NoiseSurvey {
    /// A survey without frames.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// States that the next frame does not follow the last one, so that the two are not compared.
    pub fn interrupt(&mut self) {
        self.noise.interrupt();
    }

    /// Takes the next frame. INVALID and SATURATED pixels do not count. A frame whose planes differ in shape is
    /// ignored.
    pub fn push(&mut self, frame: &Frame) {
        if frame.check_shapes().is_err() {
            return self.interrupt();
        }
        let amplitude: Vec<f32> = frame.counted_amplitudes().collect();
        let whole = |value: &f32| value.is_nan() || value.fract() == 0.0;
        self.whole_numbers &= amplitude.iter().all(whole);
        let class = match &frame.integration_time_us {
            IntegrationTime::Unknown => vec![0.0; amplitude.len()],
            IntegrationTime::PerFrame(time_us) => vec![*time_us as f32; amplitude.len()],
            IntegrationTime::PerPixel(map) => map.values().to_vec(),
        };
        let light = frame.intensity.as_ref().map(|plane| plane.values().to_vec());
        self.noise.push(frame.shape(), Compared { amplitude, light, class });
    }

    /// The noise of the frames so far.
    #[must_use]
    pub fn finish(&self) -> NoiseCells {
        let (groups, spatial) = self.noise.finish();
        let cells = groups.iter().map(cell).collect();
        let quantization_variance_dn2 = if self.whole_numbers { 1.0 / 12.0 } else { 0.0 };
        NoiseCells { cells, spatial, quantization_variance_dn2 }
    }
}

/// A group whose class is the integration time and whose light is the intensity, where these are known.
fn cell(group: &GroupNoise) -> NoiseCell {
    NoiseCell {
        integration_time_us: Some(group.class).filter(|time_us| *time_us > 0.0),
        amplitude_dn: group.amplitude_dn,
        intensity_dn: Some(group.light).filter(|intensity| *intensity > 0.0),
        variance_dn2: group.variance_dn2,
        differences: group.differences,
    }
}

impl NoiseCells {
    /// The cells of several recordings together.
    #[must_use]
    pub fn merged<'a>(all: impl IntoIterator<Item = &'a Self>) -> Self {
        let mut merged = Self::default();
        for cells in all {
            merged.cells.extend(&cells.cells);
            merged.spatial |= cells.spatial;
            merged.quantization_variance_dn2 =
                merged.quantization_variance_dn2.max(cells.quantization_variance_dn2);
        }
        merged
    }

    /// Leaves out the cells of times above `longest_us`.
    pub(super) fn up_to(&mut self, longest_us: f64) {
        self.cells.retain(|cell| cell.integration_time_us.is_none_or(|time_us| time_us <= longest_us));
    }

    /// The largest signal-to-noise ratio of the groups, where all are too dark for a fit.
    #[must_use]
    pub fn too_dark(&self) -> Option<f64> {
        Noise::too_dark(&self.cells)
    }

    /// Fits the noise term to these cells; `None` where they do not determine it.
    #[must_use]
    pub fn fit(&self, fitted_on: Vec<Source>) -> Option<Noise> {
        Noise::fit(&self.cells, self.quantization_variance_dn2, fitted_on)
    }
}
