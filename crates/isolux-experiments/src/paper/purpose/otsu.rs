//! One rule: Otsu's, applied afresh to every image. The mask follows the image; does the level stay?

use imageproc::contrast::otsu_level;
use imageproc::image::GrayImage;

use super::threshold::{intersection_over_union, mask};

/// Otsu's level of the reference image, and its mask.
#[derive(Clone, Debug)]
pub(super) struct OtsuRule {
    level: u8,
    mask: GrayImage,
}

impl OtsuRule {
    pub(super) fn at(reference: &GrayImage) -> Self {
        let level = otsu_level(reference);
        Self { level, mask: mask(reference, level) }
    }

    /// The level of another image relative to the reference's, and the overlap of the two masks (0..=1).
    ///
    /// Level n divides n from n + 1, so the threshold itself is n + ½: a dark image's level may well be 0.
    pub(super) fn compare(&self, image: &GrayImage) -> (f64, f64) {
        let level = otsu_level(image);
        let ratio = (f64::from(level) + 0.5) / (f64::from(self.level) + 0.5);
        (ratio, intersection_over_union(&self.mask, &mask(image, level)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rule_follows_a_gain() {
        let image = |values: [u8; 6]| GrayImage::from_raw(6, 1, values.to_vec()).unwrap();
        let rule = OtsuRule::at(&image([20, 20, 20, 80, 80, 80]));
        let (ratio, overlap) = rule.compare(&image([40, 40, 40, 160, 160, 160]));
        // The library gives the lower class's highest level: 20 and 40.
        assert!((ratio - 40.5 / 20.5).abs() < 1e-12, "{ratio}");
        assert_eq!(overlap, 1.0);
    }
}
