//! Eight bits a pixel, as image libraries want them: one fixed scale, chosen once at the reference.

use imageproc::image::GrayImage;
use isolux::Plane;
use isolux::statistics::quantile;

/// Quantile of the reference image that becomes [`BRIGHT_LEVEL`]: single bright pixels do not choose the scale.
const BRIGHT_QUANTILE: f64 = 0.99;
/// Grey level of that quantile, of 255: some room for brighter frames.
const BRIGHT_LEVEL: f64 = 200.0;

/// Grey levels for digital numbers: one factor, no offset.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Scale {
    /// Grey levels per DN.
    pub(super) levels_per_dn: f64,
}

impl Scale {
    /// The scale that a user picks at the reference image; NaN = invalid.
    pub(super) fn chosen_at(reference: &Plane<f32>) -> Self {
        let mut values: Vec<f64> = reference
            .values()
            .iter()
            .map(|value| f64::from(*value))
            .filter(|value| value.is_finite())
            .collect();
        let bright_dn = quantile(&mut values, BRIGHT_QUANTILE).unwrap_or(BRIGHT_LEVEL);
        Self { levels_per_dn: BRIGHT_LEVEL / bright_dn }
    }

    /// The image in grey levels, rounded, clipped at 255; invalid pixels are black.
    pub(super) fn grey(self, image: &Plane<f32>) -> GrayImage {
        let (width, height) = (image.shape().width as u32, image.shape().height as u32);
        let levels =
            image.values().iter().map(|value| (f64::from(*value) * self.levels_per_dn).round() as u8);
        GrayImage::from_raw(width, height, levels.collect()).unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use isolux::Shape;

    use super::*;

    #[test]
    fn the_scale_is_fixed_and_clips() {
        let shape = Shape::new(1, 4);
        let reference = Plane::from_vec(shape, vec![100.0, 100.0, 100.0, f32::NAN]).unwrap();
        let scale = Scale::chosen_at(&reference);
        assert_eq!(scale.levels_per_dn, 2.0);
        let image = Plane::from_vec(shape, vec![50.2, 0.0, 1000.0, f32::NAN]).unwrap();
        assert_eq!(scale.grey(&image).as_raw(), &[100, 0, 255, 0]);
    }
}
