//! A small recording made by integer arithmetic, against figures computed independently with NumPy and SciPy
//! (whole recording in memory, `nanstd`, `percentile`, `wasserstein_distance`, Otsu by trying every threshold).

use super::*;

const TIMES_US: [u16; 12] = [1000, 1000, 1000, 2000, 2000, 2000, 4000, 4000, 8000, 8000, 8000, 8000];
const SHAPE: Shape = Shape::new(6, 8);
/// Sums of some hundred terms in f64; nothing else differs.
const TOLERANCE: f64 = 1e-12;

/// A compressing response, 5 % noise in integer steps, saturated and dropped pixels, four labels.
fn recording() -> Vec<Frame> {
    let recorded = |(number, &time_us): (usize, &u16)| {
        let mut frame = frame(SHAPE, f64::from(time_us), |row, column| {
            let index = row * SHAPE.width + column;
            let noise = ((index * 7919 + number * 104_729 + index * number * 31) % 41) as f64 - 20.0;
            let gain = if index.is_multiple_of(5) { 6 } else { 1 };
            let linear = ((40 + index * 37 % 160) * gain) as f64 * f64::from(time_us) / 1000.0;
            (linear / (1.0 + linear / 9000.0) * (1.0 + noise / 400.0)).floor() as f32
        });
        for index in 0..SHAPE.pixels() {
            let value = frame.amplitude.values()[index];
            if (index + number).is_multiple_of(11) || value > 4500.0 {
                invalidate(&mut frame, index, value);
            }
        }
        let index = |row, column| row * SHAPE.width + column;
        let distance = |row, column| ((80 + index(row, column) * 13 % 120) as f64 / 100.0) as f32;
        frame.distance_m = Some(Plane::from_fn(SHAPE, distance));
        frame.target = Some(Plane::from_fn(SHAPE, |row, column| (index(row, column) % 4) as u8));
        frame
    };
    TIMES_US.iter().enumerate().map(recorded).collect()
}

#[test]
fn every_figure_agrees_with_numpy() {
    let times = TIMES_US.map(|time_us| Some(f64::from(time_us)));
    let reference = nearest_reference(times, 4100.0);
    assert_eq!(reference, Some(7));
    let found = evaluate(&recording(), reference);

    let cv = found.pixel_cv.unwrap();
    assert_eq!(cv.pixels, 48);
    assert_near(cv.median, 0.6790393063600415, TOLERANCE);
    assert_near(cv.p95, 0.7036425862788316, TOLERANCE);
    assert_near(cv.valid_fraction, 0.9010416666666666, TOLERANCE);
    assert_near(found.image_cv.unwrap().cv, 0.6331317907551025, TOLERANCE);

    let iou = found.threshold_iou.unwrap();
    assert_near(iou.threshold, 1024.3759075651872, 1024.0 * TOLERANCE);
    assert_near(iou.minimum, 0.0, TOLERANCE);
    assert_near(iou.mean, 0.2874303405572755, TOLERANCE);
    assert_near(iou.valid_fraction, 0.8145833333333333, TOLERANCE);

    let w1 = found.histogram_distance.unwrap();
    assert_near(w1.mean_ln, 0.8415128796832801, TOLERANCE);
    assert_near(w1.maximum_ln, 1.3273645966830234, TOLERANCE);
    let otsu = found.otsu_shift.unwrap();
    assert_near(otsu.mean_ln, 0.7708516289196539, TOLERANCE);
    assert_near(otsu.maximum_ln, 1.3494407615539252, TOLERANCE);

    let noise = found.noise.unwrap();
    assert_eq!((noise.method, noise.frames), (NoiseMethod::Temporal, 8));
    assert_near(noise.relative, 0.03203493213082546, TOLERANCE);
    assert_near(noise.valid_fraction, 0.8072916666666666, TOLERANCE);

    let slope = found.distance_slope.unwrap();
    assert_eq!((slope.pairs, slope.sample_pixels), (5612, 389));
    assert_near(slope.slope, 0.1482178463209911, TOLERANCE);

    let strata = found.pixel_cv_by_snr.unwrap();
    let members: Vec<usize> = strata.iter().map(|stratum| stratum.pixels).collect();
    assert_eq!(members, [0, 0, 16, 32]);
    assert_near(strata[2].median_cv.unwrap(), 0.6841579862393603, TOLERANCE);
    assert_near(strata[3].median_cv.unwrap(), 0.6712260970843136, TOLERANCE);
}
