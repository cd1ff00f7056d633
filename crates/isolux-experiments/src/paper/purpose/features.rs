//! One set of parameters for features: FAST corners, and BRIEF descriptors matched to the reference's.

use imageproc::binary_descriptors::BinaryDescriptor;
use imageproc::binary_descriptors::brief::{BriefDescriptor, TestPair, brief};
use imageproc::corners::{Corner, corners_fast9};
use imageproc::image::GrayImage;
use imageproc::point::Point;
use imageproc::suppress::local_maxima;

use crate::error::ExperimentError;

/// Two keypoints are the same within this distance, pixels.
pub(super) const SAME_PX: f64 = 1.5;
/// Fewest keypoints at the reference: a handful of corners repeats well and serves nobody.
const MINIMUM_KEYPOINTS: usize = 40;
/// Thresholds of FAST that the tuning tries, grey levels.
const THRESHOLDS: std::ops::RangeInclusive<u8> = 4..=60;
/// Of corners closer than this the strongest stays, pixels.
const SUPPRESSION_PX: u32 = 3;
/// The library's BRIEF patch does not fit nearer to the image's edge, pixels.
const MARGIN_PX: u32 = 18;
/// Side of the patch, pixels.
const PATCH_PX: u32 = 31;
/// Length of a descriptor, bits.
const BITS: usize = 256;

/// FAST's threshold tuned at the reference, and the keypoints with their descriptors there.
#[derive(Clone)]
pub(super) struct FixedFeatures {
    /// Threshold, grey levels.
    pub(super) threshold: u8,
    corners: Vec<Corner>,
    described: Vec<BriefDescriptor>,
}

impl FixedFeatures {
    /// The threshold whose corners repeat best from the reference frame to another one (`again`) under the same
    /// conditions, of those that give enough corners; the lowest when none does.
    ///
    /// # Errors
    /// [`ExperimentError::Detector`] when the library refuses, which its limits should never bring about.
    pub(super) fn tuned_at(reference: &GrayImage, again: &GrayImage) -> Result<Self, ExperimentError> {
        let trial = |threshold: u8| {
            let corners = detect(reference, threshold);
            let enough = corners.len() >= MINIMUM_KEYPOINTS;
            enough.then(|| (repeatability(&corners, &detect(again, threshold)), threshold))
        };
        // Of equals the highest threshold, which is the last.
        let best = THRESHOLDS.filter_map(trial).max_by(|a, b| a.0.total_cmp(&b.0));
        let threshold = best.map_or(*THRESHOLDS.start(), |(_, threshold)| threshold);
        let corners = detect(reference, threshold);
        let described = describe(reference, &corners)?;
        Ok(Self { threshold, corners, described })
    }

    /// Keypoints at the reference.
    pub(super) fn count(&self) -> usize {
        self.corners.len()
    }

    /// Repeatability, and the share of the reference's descriptors that find their own keypoint again, both 0..=1.
    ///
    /// Repeatability is the share of the keypoints of both images that have a partner within [`SAME_PX`] in the
    /// other: lost and additional keypoints count alike. A descriptor is matched when it and its nearest
    /// (Hamming) choose each other and lie within [`SAME_PX`].
    ///
    /// # Errors
    /// [`ExperimentError::Detector`], as in [`Self::tuned_at`].
    pub(super) fn compare(&self, image: &GrayImage) -> Result<(f64, f64), ExperimentError> {
        let corners = detect(image, self.threshold);
        let described = describe(image, &corners)?;
        Ok((repeatability(&self.corners, &corners), matched(&self.described, &described)))
    }
}

fn detect(image: &GrayImage, threshold: u8) -> Vec<Corner> {
    local_maxima(&corners_fast9(image, threshold), SUPPRESSION_PX)
}

fn describe(image: &GrayImage, corners: &[Corner]) -> Result<Vec<BriefDescriptor>, ExperimentError> {
    let inside = |at: u32, length: u32| at >= MARGIN_PX && at + MARGIN_PX < length;
    let (width, height) = image.dimensions();
    let points: Vec<Point<u32>> = corners
        .iter()
        .filter(|corner| inside(corner.x, width) && inside(corner.y, height))
        .map(|corner| Point::new(corner.x, corner.y))
        .collect();
    let (described, _) =
        brief(image, &points, BITS, Some(&test_pairs())).map_err(ExperimentError::Detector)?;
    Ok(described)
}

fn same(a: (u32, u32), b: (u32, u32)) -> bool {
    f64::hypot(f64::from(a.0) - f64::from(b.0), f64::from(a.1) - f64::from(b.1)) <= SAME_PX
}

fn repeatability(reference: &[Corner], found: &[Corner]) -> f64 {
    let with_partner = |of: &[Corner], among: &[Corner]| {
        of.iter().filter(|a| among.iter().any(|b| same((a.x, a.y), (b.x, b.y)))).count()
    };
    let partners = with_partner(reference, found) + with_partner(found, reference);
    partners as f64 / (reference.len() + found.len()) as f64
}

fn matched(reference: &[BriefDescriptor], found: &[BriefDescriptor]) -> f64 {
    let own = reference.iter().enumerate().filter(|(index, descriptor)| {
        let Some(there) = nearest(descriptor, found) else { return false };
        let (a, b) = (descriptor.position(), found[there].position());
        nearest(&found[there], reference) == Some(*index) && same((a.x, a.y), (b.x, b.y))
    });
    own.count() as f64 / reference.len() as f64
}

/// Index of the descriptor with the fewest different bits; the first of several.
fn nearest(of: &BriefDescriptor, among: &[BriefDescriptor]) -> Option<usize> {
    (0..among.len()).min_by_key(|index| of.hamming_distance(&among[*index]))
}

/// Pairs of places in the patch, denser in the middle; our own, because the library draws new ones on every run.
fn test_pairs() -> Vec<TestPair> {
    let mut state = 0u64;
    let mut uniform = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((state >> 33) % u64::from(PATCH_PX)) as u32
    };
    // The mean of three even numbers is nearly bell-shaped (Irwin–Hall).
    let mut place = || (uniform() + uniform() + uniform()) / 3;
    let mut point = || Point::new(place(), place());
    (0..BITS).map(|_| TestPair { p0: point(), p1: point() }).collect()
}

#[cfg(test)]
mod tests {
    use imageproc::image::Luma;

    use super::*;

    fn squares(bright: u8) -> GrayImage {
        GrayImage::from_fn(160, 120, |x, y| {
            let inside = x % 20 >= 8 && y % 20 >= 8 && (x / 20 + 2 * (y / 20)) % 3 > 0;
            Luma([if inside { bright } else { 10 }])
        })
    }

    #[test]
    fn the_same_image_repeats_all_and_a_dark_one_nothing() {
        let features = FixedFeatures::tuned_at(&squares(200), &squares(200)).unwrap();
        assert!(features.count() >= MINIMUM_KEYPOINTS, "{}", features.count());
        let (repeatability, _) = features.compare(&squares(200)).unwrap();
        assert_eq!(repeatability, 1.0);
        assert_eq!(features.compare(&squares(12)).unwrap(), (0.0, 0.0));
    }

    #[test]
    fn lost_and_additional_keypoints_count_alike() {
        let at = |x: u32| Corner::new(x, 50, 1.0);
        assert_eq!(repeatability(&[at(10), at(30)], &[at(11)]), 2.0 / 3.0);
        assert_eq!(repeatability(&[at(11)], &[at(10), at(30)]), 2.0 / 3.0);
        assert_eq!(repeatability(&[at(10)], &[at(12)]), 0.0);
    }
}
