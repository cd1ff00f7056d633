//! One fixed threshold: Otsu's level of the reference image, then never changed.

use imageproc::contrast::{ThresholdType, otsu_level, threshold};
use imageproc::image::GrayImage;

/// A threshold tuned at the reference, and the mask it gives there.
#[derive(Clone, Debug)]
pub(super) struct FixedThreshold {
    /// Grey level; brighter pixels are in the mask.
    pub(super) level: u8,
    mask: GrayImage,
}

impl FixedThreshold {
    pub(super) fn tuned_at(reference: &GrayImage) -> Self {
        let level = otsu_level(reference);
        Self { level, mask: mask(reference, level) }
    }

    /// The mask of the same threshold in another image.
    pub(super) fn mask(&self, image: &GrayImage) -> GrayImage {
        mask(image, self.level)
    }

    /// Overlap of that mask with the reference's, 0..=1.
    pub(super) fn overlap(&self, image: &GrayImage) -> f64 {
        intersection_over_union(&self.mask, &self.mask(image))
    }
}

/// White where the image is brighter than `level`.
pub(super) fn mask(image: &GrayImage, level: u8) -> GrayImage {
    threshold(image, level, ThresholdType::Binary)
}

/// Intersection over union of two masks; NaN when both are empty.
pub(super) fn intersection_over_union(first: &GrayImage, second: &GrayImage) -> f64 {
    let (mut both, mut either) = (0.0, 0.0);
    for (a, b) in first.as_raw().iter().zip(second.as_raw()) {
        both += f64::from(u8::from(*a > 0 && *b > 0));
        either += f64::from(u8::from(*a > 0 || *b > 0));
    }
    both / either
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn overlap_of_masks() {
        let image = |values: [u8; 4]| GrayImage::from_raw(4, 1, values.to_vec()).unwrap();
        let fixed = FixedThreshold::tuned_at(&image([10, 10, 200, 200]));
        assert!((10..200).contains(&fixed.level));
        assert_eq!(fixed.overlap(&image([10, 10, 250, 250])), 1.0);
        assert_eq!(fixed.overlap(&image([0, 0, 250, 5])), 0.5);
        assert_eq!(fixed.overlap(&image([0, 0, 5, 5])), 0.0);
        assert!(intersection_over_union(&image([0; 4]), &image([0; 4])).is_nan());
    }
}
