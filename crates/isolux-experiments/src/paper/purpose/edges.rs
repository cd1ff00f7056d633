//! One Canny setting, tuned at the reference against the true outlines of the scene.

use imageproc::distance_transform::Norm;
use imageproc::edges::canny;
use imageproc::image::{GrayImage, Luma};
use imageproc::morphology::dilate;
use isolux_camera::Truth;

/// Upper thresholds that the tuning tries, in the library's gradient units (0 to 1140); the lower is half of it.
const UPPER_THRESHOLDS: [f32; 10] = [15.0, 22.0, 30.0, 42.0, 60.0, 85.0, 120.0, 170.0, 240.0, 340.0];
/// An edge counts as found within this many pixels, diagonals included.
pub(super) const TOLERANCE_PX: u8 = 1;
/// Relative steps between neighbours that make an outline: of reflectivity, distance, cosine of incidence.
const STEPS: [f32; 3] = [0.1, 0.05, 0.1];

/// Canny's thresholds tuned at the reference, and the edges they give there.
#[derive(Clone, Debug)]
pub(super) struct FixedCanny {
    /// Upper threshold, in the library's gradient units.
    pub(super) upper: f32,
    /// F1 against the true outlines at the reference, 0..=1.
    pub(super) true_f1: f64,
    edges: GrayImage,
}

impl FixedCanny {
    /// The thresholds whose edges agree best with the true `outlines`.
    pub(super) fn tuned_at(reference: &GrayImage, outlines: &GrayImage) -> Self {
        let trial = |upper: f32| {
            let edges = detect(reference, upper);
            Self { upper, true_f1: f1(outlines, &edges), edges }
        };
        let first = trial(UPPER_THRESHOLDS[0]);
        UPPER_THRESHOLDS[1..]
            .iter()
            .map(|upper| trial(*upper))
            .fold(first, |best, found| if found.true_f1 > best.true_f1 { found } else { best })
    }

    /// F1 of the edges in another image against those at the reference, 0..=1.
    pub(super) fn agreement(&self, image: &GrayImage) -> f64 {
        f1(&self.edges, &detect(image, self.upper))
    }
}

fn detect(image: &GrayImage, upper: f32) -> GrayImage {
    canny(image, upper / 2.0, upper)
}

/// Harmonic mean of precision and recall, each within [`TOLERANCE_PX`]; 0 when only one has edges, NaN when none.
fn f1(reference: &GrayImage, found: &GrayImage) -> f64 {
    let share = |of: &GrayImage, near: &GrayImage| {
        let near = dilate(near, Norm::LInf, TOLERANCE_PX);
        let pixels = of.as_raw().iter().zip(near.as_raw()).filter(|(edge, _)| **edge > 0);
        let (hits, count) =
            pixels.fold((0u32, 0u32), |(hits, count), (_, near)| (hits + u32::from(*near > 0), count + 1));
        (f64::from(hits), f64::from(count))
    };
    let ((hits_found, found_count), (hits_reference, reference_count)) =
        (share(found, reference), share(reference, found));
    match (hits_found > 0.0, found_count + reference_count > 0.0) {
        (true, _) => {
            let (precision, recall) = (hits_found / found_count, hits_reference / reference_count);
            2.0 * precision * recall / (precision + recall)
        }
        (false, true) => 0.0,
        (false, false) => f64::NAN,
    }
}

/// White where reflectivity, distance or incidence differ from the pixel to the right or below.
pub(super) fn true_outlines(truth: &Truth) -> GrayImage {
    let planes = [&truth.reflectivity, &truth.true_distance_m, &truth.cos_incidence];
    let shape = truth.reflectivity.shape();
    GrayImage::from_fn(shape.width as u32, shape.height as u32, |x, y| {
        let step = |row: usize, column: usize| {
            planes.iter().zip(STEPS).any(|(plane, step)| {
                let (here, there) = (plane.get(y as usize, x as usize), plane.get(row, column));
                here.zip(there).is_some_and(|(a, b)| (a - b).abs() > step * a.max(b))
            })
        };
        let outline = step(y as usize, x as usize + 1) || step(y as usize + 1, x as usize);
        Luma([if outline { u8::MAX } else { 0 }])
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(x: u32) -> GrayImage {
        GrayImage::from_fn(32, 32, |column, _| Luma([if column == x { 255 } else { 0 }]))
    }

    #[test]
    fn edges_count_within_one_pixel_and_not_beyond() {
        assert_eq!(f1(&line(10), &line(11)), 1.0);
        assert_eq!(f1(&line(10), &line(12)), 0.0);
        assert_eq!(f1(&line(10), &GrayImage::new(32, 32)), 0.0);
        assert!(f1(&GrayImage::new(32, 32), &GrayImage::new(32, 32)).is_nan());
        // One of two lines found: precision 1, recall one half.
        let mut both = line(10);
        both.as_mut().iter_mut().zip(line(20).as_raw()).for_each(|(a, b)| *a |= *b);
        assert!((f1(&both, &line(10)) - 2.0 / 3.0).abs() < 1e-12);
    }

    #[test]
    fn the_tuned_setting_finds_the_outline_and_a_dark_image_loses_it() {
        let step =
            |low: u8, high: u8| GrayImage::from_fn(32, 32, |x, _| Luma([if x < 16 { low } else { high }]));
        let canny = FixedCanny::tuned_at(&step(50, 200), &line(15));
        // Canny leaves the outermost rows and columns empty, and the outline is there too, within 1 px.
        assert!(canny.true_f1 > 0.99, "{}", canny.true_f1);
        assert_eq!(canny.agreement(&step(50, 200)), 1.0);
        assert_eq!(canny.agreement(&step(1, 2)), 0.0);
    }
}
