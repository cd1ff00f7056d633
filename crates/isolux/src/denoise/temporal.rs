//! `temporal`: the mean distance of each pixel over the last frames of a still scene.

use super::error::DenoiseError;
use super::image::measured;
use crate::frame::{Frame, Plane, Shape};
use crate::memory::bytes;

/// The last frames of a stream, and the mean of their distances, weighted by `1/σ_d² ∝ a²`: frames of several
/// integration times may follow each other, as long as nothing moves. Feed it every frame in order; a frame of
/// another shape starts a new history.
#[derive(Clone, Debug)]
pub struct TemporalMean {
    shape: Shape,
    /// Distances (NaN where invalid) and amplitudes, a ring.
    frames: Vec<[Vec<f32>; 2]>,
    /// Place of the next frame.
    next: usize,
    /// Frames so far, up to all places.
    count: usize,
}

impl Default for TemporalMean {
    fn default() -> Self {
        Self::new()
    }
}

impl TemporalMean {
    /// Frames that the mean is taken of.
    pub const FRAMES: usize = 8;

    /// No history.
    #[must_use]
    pub fn new() -> Self {
        let frames = (0..Self::FRAMES).map(|_| [Vec::new(), Vec::new()]).collect();
        Self { shape: Shape::new(0, 0), frames, next: 0, count: 0 }
    }

    /// Bytes that it holds.
    #[must_use]
    pub fn bytes(&self) -> usize {
        self.frames.iter().flatten().map(bytes).sum()
    }

    /// Forgets all frames: the next one begins another scene.
    pub fn reset(&mut self) {
        (self.next, self.count) = (0, 0);
    }

    /// Takes the next frame and writes into `out` the mean distance (m) over it and the frames before it. A pixel
    /// that is invalid in this frame gets the frame's own distance. Allocates only when the shape changes.
    ///
    /// # Errors
    /// [`DenoiseError`] when the frame has no distance, or its planes differ in shape.
    pub fn push(&mut self, frame: &Frame, out: &mut Plane<f32>) -> Result<(), DenoiseError> {
        frame.check_shapes()?;
        let distance_m = frame.distance_m.as_ref().ok_or(DenoiseError::DistanceMissing)?;
        if self.shape != frame.shape() {
            self.reset();
            self.shape = frame.shape();
        }
        let amplitude = frame.amplitude.values();
        let [kept_m, kept_amplitude] = &mut self.frames[self.next];
        kept_m.resize(amplitude.len(), f32::NAN);
        measured(amplitude, distance_m.values(), frame.flags.values(), kept_m);
        kept_amplitude.resize(amplitude.len(), 0.0);
        kept_amplitude.copy_from_slice(amplitude);
        self.next = (self.next + 1) % Self::FRAMES;
        self.count = (self.count + 1).min(Self::FRAMES);
        out.reshape(self.shape, f32::NAN);
        self.mean(distance_m.values(), out.values_mut());
        Ok(())
    }

    /// Writes the variance of the mean over that of the newest frame's own distance, `a² / Σa²`, 0..=1.
    pub fn variance_left(&self, out: &mut Plane<f32>) {
        out.reshape(self.shape, 1.0);
        let first = self.next + Self::FRAMES - self.count;
        let newest = &self.frames[(first + self.count.max(1) - 1) % Self::FRAMES];
        for (index, out) in out.values_mut().iter_mut().enumerate() {
            let weight = |[distance_m, amplitude]: &[Vec<f32>; 2]| {
                let amplitude = f64::from(amplitude[index]);
                if distance_m[index].is_nan() { 0.0 } else { amplitude * amplitude }
            };
            let ages = (0..self.count).map(|age| &self.frames[(first + age) % Self::FRAMES]);
            let left = weight(newest) / ages.map(weight).sum::<f64>();
            *out = if left > 0.0 { left as f32 } else { 1.0 };
        }
    }

    /// From the oldest frame to the newest, so that the mean depends on these frames alone, bit by bit.
    fn mean(&self, delivered_m: &[f32], out: &mut [f32]) {
        let first = self.next + Self::FRAMES - self.count;
        let newest = &self.frames[(first + self.count - 1) % Self::FRAMES][0];
        for (index, out) in out.iter_mut().enumerate() {
            if newest[index].is_nan() {
                *out = delivered_m[index];
                continue;
            }
            let (mut weights, mut sum) = (0.0, 0.0);
            for age in 0..self.count {
                let [distance_m, amplitude] = &self.frames[(first + age) % Self::FRAMES];
                if !distance_m[index].is_nan() {
                    let weight = f64::from(amplitude[index]) * f64::from(amplitude[index]);
                    weights += weight;
                    sum += weight * f64::from(distance_m[index]);
                }
            }
            *out = (sum / weights) as f32;
        }
    }
}
