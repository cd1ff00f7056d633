//! The ambient light of a recording, as the response by amplitude and distance needs it.

use crate::frame::Shape;

/// Ambient light on the surfaces of a recording: the charge that it puts per µs into a pixel that sees a surface like
/// the target of the calibration, DN/µs.
#[derive(Clone, Debug, PartialEq)]
pub struct AmbientLight {
    /// At the centre of the image, over the whole recording.
    pub dn_per_us: f64,
    /// Standard error: of the noise that it was estimated from, of the model, and of a light that may be uneven.
    pub error_dn_per_us: f64,
    /// By how much it gains on the camera's own light towards the corners, which lobe and lens darken: the light grows
    /// by `exp(growth r²)`, r the distance from the centre of the image in half diagonals.
    pub growth: f64,
    /// Where it drifts: numbers of frames, ascending, and the light there. Between them it changes evenly. Empty where
    /// it is steady.
    pub course: Vec<(usize, f64)>,
}

impl AmbientLight {
    /// A light that is known.
    #[must_use]
    pub fn steady(dn_per_us: f64) -> Self {
        Self { dn_per_us, error_dn_per_us: 0.0, growth: 0.0, course: Vec::new() }
    }

    /// r² of a pixel, 0 at the centre and 1 at the corners.
    pub(crate) fn radius_squared(shape: Shape, row: usize, column: usize) -> f32 {
        let [height, width] = [shape.height as f32, shape.width as f32];
        let (y, x) = (row as f32 + 0.5 - 0.5 * height, column as f32 + 0.5 - 0.5 * width);
        4.0 * (x * x + y * y) / (height * height + width * width)
    }

    /// The light in a frame, counted from 0.
    #[must_use]
    pub fn at(&self, frame: usize) -> f64 {
        let after = self.course.partition_point(|(number, _)| *number <= frame);
        match (after.checked_sub(1).and_then(|before| self.course.get(before)), self.course.get(after)) {
            (Some(&(first, from)), Some(&(last, to))) => {
                from + (to - from) * (frame - first) as f64 / (last - first) as f64
            }
            (Some(&(_, light)), None) | (None, Some(&(_, light))) => light,
            (None, None) => self.dn_per_us,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn between_two_frames_the_light_changes_evenly() {
        let light = AmbientLight { course: vec![(10, 1.0), (20, 3.0)], ..AmbientLight::steady(2.0) };
        assert_eq!([0, 10, 15, 20, 99].map(|frame| light.at(frame)), [1.0, 1.0, 2.0, 3.0, 3.0]);
        assert_eq!(AmbientLight::steady(2.0).at(7), 2.0);
    }
}
