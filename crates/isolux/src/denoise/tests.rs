//! The rules against naive versions of themselves, and the laws that they keep.

use super::image::{Image, measured};
use super::noise::NoiseScale;
use super::wiener::Wiener;
use super::*;
use crate::frame::{Frame, PixelFlags, Plane, Shape};
use proptest::prelude::*;

const SHAPE: Shape = Shape::new(11, 14);
const SPATIAL: [DenoiseRule; 3] = [DenoiseRule::Median, DenoiseRule::Wiener, DenoiseRule::Plane];

fn frame(shape: Shape, amplitude: Vec<f32>, distance_m: Vec<f32>) -> Frame {
    let mut frame = Frame::new(shape);
    frame.amplitude = Plane::from_vec(shape, amplitude).unwrap();
    frame.distance_m = Some(Plane::from_vec(shape, distance_m).unwrap());
    frame.flag_amplitude(None);
    frame
}

/// Noisy distances before a step, amplitudes over two orders of magnitude, one pixel in ten no measurement.
fn frames() -> impl Strategy<Value = Frame> {
    let odd = || prop::sample::select(vec![f32::NAN, 0.0, -1.0, f32::INFINITY]);
    let amplitudes = prop::collection::vec(prop_oneof![15 => 5f32..500.0, 1 => odd()], SHAPE.pixels());
    let noise = prop::collection::vec(prop_oneof![15 => -1f32..1.0, 1 => odd()], SHAPE.pixels());
    (amplitudes, noise, 0.01f32..0.3, 0usize..14, 0f32..2.0).prop_map(
        |(amplitude, noise, spread, edge, jump)| {
            let distance = noise.iter().enumerate().map(|(index, noise)| {
                let step = if index % SHAPE.width < edge { jump } else { 0.0 };
                if noise.abs() < 1.0 { 1.5 + step + spread * noise } else { *noise }
            });
            let distance = distance.collect();
            frame(SHAPE, amplitude, distance)
        },
    )
}

fn denoise(rule: DenoiseRule, frame: &Frame) -> Vec<f32> {
    Denoiser::default().denoise(rule, frame, frame.distance_m.as_ref().unwrap(), false).distance_m.to_vec()
}

fn distances(frame: &Frame) -> &[f32] {
    frame.distance_m.as_ref().unwrap().values()
}

fn takes_part(frame: &Frame, index: usize) -> bool {
    let d = distances(frame)[index];
    frame.is_valid(index) && d > 0.0 && d.is_finite()
}

/// Valid pixels of the window around `index`: row and column relative to it, amplitude, distance.
fn window(frame: &Frame, index: usize, radius: i64) -> Vec<(i64, i64, f64, f64)> {
    let Shape { height, width } = frame.shape();
    let (y, x) = ((index / width) as i64, (index % width) as i64);
    let mut found = Vec::new();
    for dy in -radius..=radius {
        for dx in -radius..=radius {
            let (row, column) = (y + dy, x + dx);
            if row < 0 || column < 0 || row >= height as i64 || column >= width as i64 {
                continue;
            }
            let other = row as usize * width + column as usize;
            if takes_part(frame, other) {
                found.push((
                    dy,
                    dx,
                    f64::from(frame.amplitude.values()[other]),
                    f64::from(distances(frame)[other]),
                ));
            }
        }
    }
    found
}

/// The estimate of k with a sorted list in place of the bins.
fn naive_k(frame: &Frame) -> f64 {
    let (mut normalized, width) = (Vec::new(), frame.shape().width);
    for index in 0..frame.shape().pixels() - width {
        let corners = [index, index + 1, index + width, index + width + 1];
        if index % width + 1 == width || !corners.iter().all(|&i| takes_part(frame, i)) {
            continue;
        }
        let [a, b, c, d] = corners.map(|i| f64::from(distances(frame)[i]));
        let variance: f64 = corners.iter().map(|&i| f64::from(frame.amplitude.values()[i]).powi(-2)).sum();
        normalized.push((a - b - c + d).abs() / variance.sqrt());
    }
    normalized.sort_by(f64::total_cmp);
    if normalized.len() < 16 { 0.0 } else { (1.4826 * normalized[normalized.len() / 2]).powi(2) }
}

/// The k that the frame is denoised with.
fn k(frame: &Frame) -> f64 {
    with_image(frame, |image| NoiseScale::default().estimate(image))
}

/// The guide of the plane fits: what the Wiener filter, tested by itself, writes.
fn guide(frame: &Frame, k: f64) -> Vec<(f64, f64)> {
    let mut planes = [vec![0.0; frame.shape().pixels()], vec![0.0; frame.shape().pixels()]];
    let [distance_m, detail] = &mut planes;
    with_image(frame, |image| Wiener::default().denoise(image, k, distance_m, Some(detail)));
    distance_m.iter().zip(detail).map(|(d, alpha)| (f64::from(*d), f64::from(*alpha))).collect()
}

fn with_image<T>(frame: &Frame, work: impl FnOnce(Image<'_>) -> T) -> T {
    let mut measured_m = distances(frame).to_vec();
    let amplitude = frame.amplitude.values();
    measured(amplitude, distances(frame), frame.flags.values(), &mut measured_m);
    work(Image { shape: frame.shape(), distance_m: &measured_m, amplitude })
}

/// The filter's definition, word for word: α and m of the window around a pixel.
fn naive_window(frame: &Frame, k: f64, index: usize) -> (f64, f64) {
    let sigma2 = |a: f64| k / (a * a);
    let pixels = window(frame, index, 2);
    let sum = |of: &dyn Fn(f64, f64) -> f64| pixels.iter().map(|(_, _, a, d)| of(*a, *d)).sum::<f64>();
    let w = sum(&|a, _| 1.0 / sigma2(a));
    let m = sum(&|a, d| d / sigma2(a)) / w;
    let v = sum(&|a, d| d * d / sigma2(a)) / w - m * m;
    let n2 = sum(&|a, _| sigma2(a) / sigma2(a)) / w;
    if v <= n2 {
        return (0.0, m);
    }
    ((1.0 - (1.15 * n2 / v).powi(2)).clamp(0.0, 1.0), m)
}

/// The denoised distance and the mean α of every pixel; NaN where it takes no part.
fn naive_wiener(frame: &Frame, k: f64) -> Vec<(f64, f64)> {
    let width = frame.shape().width as i64;
    let pixel = |index: usize| {
        if !takes_part(frame, index) {
            return (f64::NAN, f64::NAN);
        }
        let answers: Vec<(f64, f64)> = window(frame, index, 2)
            .iter()
            .map(|(dy, dx, ..)| naive_window(frame, k, (index as i64 + dy * width + dx) as usize))
            .collect();
        let count = answers.len() as f64;
        let alpha = answers.iter().map(|(alpha, _)| alpha).sum::<f64>() / count;
        let rest = answers.iter().map(|(alpha, m)| (1.0 - alpha) * m).sum::<f64>() / count;
        (alpha * f64::from(distances(frame)[index]) + rest, alpha)
    };
    (0..frame.shape().pixels()).map(pixel).collect()
}

fn naive_median(frame: &Frame, index: usize) -> f64 {
    let mut values: Vec<f64> = window(frame, index, 1).iter().map(|pixel| pixel.3).collect();
    values.sort_by(f64::total_cmp);
    let (low, high) = (values[(values.len() - 1) / 2], values[values.len() / 2]);
    0.5 * (low + high)
}

/// The plane fit by the normal equations of all three coefficients and Cramer's rule.
fn naive_plane(frame: &Frame, k: f64, guide: &[(f64, f64)], index: usize) -> f64 {
    let width = frame.shape().width as i64;
    let mut plane = [guide[index].0, 0.0, 0.0];
    for fit in 0..2 {
        let mut normal = [[0.0; 3]; 3];
        let mut right = [0.0; 3];
        let mut values = Vec::new();
        for (dy, dx, a, d) in window(frame, index, 3) {
            let basis = [1.0, dx as f64, dy as f64];
            let at_plane: f64 = plane.iter().zip(basis).map(|(p, b)| p * b).sum();
            let (g, alpha) = guide[(index as i64 + dy * width + dx) as usize];
            let value = [g, d][fit];
            let u = (g - at_plane).powi(2) / (9.0 * (0.06 + 0.94 * alpha * alpha) * k / (a * a));
            let weight = if u < 1.0 { a * a * (1.0 - u).powi(2) } else { 0.0 };
            values.extend((weight > 0.0).then_some(value));
            for i in 0..3 {
                right[i] += weight * basis[i] * (value - at_plane);
                (0..3).for_each(|j| normal[i][j] += weight * basis[i] * basis[j]);
            }
        }
        let total = normal[0][0];
        if total == 0.0 {
            continue;
        }
        let spread =
            |i: usize, j: usize| normal[i][j] / total - normal[0][i] * normal[0][j] / (total * total);
        let trace = spread(1, 1) + spread(2, 2);
        if spread(1, 1) * spread(2, 2) - spread(1, 2).powi(2) <= 1e-3 * (0.5 * trace).powi(2) {
            plane[0] += right[0] / total;
            plane[0] = within(plane[0], &values);
            continue;
        }
        let determinant = |m: [[f64; 3]; 3]| {
            m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1])
                - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0])
                + m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0])
        };
        let whole = determinant(normal);
        for (i, coefficient) in plane.iter_mut().enumerate() {
            let mut replaced = normal;
            (0..3).for_each(|row| replaced[row][i] = right[row]);
            *coefficient += determinant(replaced) / whole;
        }
        plane[0] = within(plane[0], &values);
    }
    plane[0]
}

fn within(value: f64, values: &[f64]) -> f64 {
    value.clamp(values.iter().copied().fold(f64::MAX, f64::min), values.iter().copied().fold(0.0, f64::max))
}

fn bits(values: &[f32]) -> Vec<u32> {
    values.iter().map(|value| value.to_bits()).collect()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]

    /// The median is one of the values, or a mean of two: half an ulp, 4 m at most. The sums of the Wiener filter are
    /// f64, and v = Σwd²/Σw − m² loses digits where d²/v is large; d is below 4 m, and v above n², a few mm² here:
    /// 2⁻⁵³ · 50 sums · 16/1e-6 = 1e-7 of a departure from the mean of 2 m at most. A plane is fitted to differences
    /// from a known plane, and loses nothing but where the biweight ends: the same tolerance.
    #[test]
    fn the_fast_paths_equal_the_naive_ones(frame in frames()) {
        let k = k(&frame);
        prop_assume!(k > 0.0);
        let (wiener, guide) = (naive_wiener(&frame, k), guide(&frame, k));
        let found = SPATIAL.map(|rule| denoise(rule, &frame));
        for index in (0..SHAPE.pixels()).filter(|&index| takes_part(&frame, index)) {
            prop_assert!((guide[index].1 - wiener[index].1).abs() <= 1e-6);
            let expected = [naive_median(&frame, index), wiener[index].0, naive_plane(&frame, k, &guide, index)];
            for (rule, (found, expected)) in SPATIAL.iter().zip(found.iter().zip(expected)) {
                let deviation = (f64::from(found[index]) - expected).abs();
                prop_assert!(deviation <= 1e-6, "{:?} {} {} {}", rule, index, found[index], expected);
            }
        }
    }

    /// One bin is 3 % wide, and its even spread an assumption: k, a square, within 7 %.
    #[test]
    fn the_noise_scale_equals_that_of_a_sorted_list(frame in frames()) {
        let (found, expected) = (k(&frame), naive_k(&frame));
        prop_assert!((found - expected).abs() <= 0.07 * expected, "{} {}", found, expected);
    }

    /// What is no measurement gives nothing to its neighbours and takes nothing, whatever value it holds.
    #[test]
    fn invalid_pixels_neither_give_nor_take(frame in frames(), other in prop::sample::select(vec![f32::NAN, 0.0, -3.0, 1e30])) {
        for rule in SPATIAL {
            let found = denoise(rule, &frame);
            let mut spoilt = frame.clone();
            for index in (0..SHAPE.pixels()).filter(|&index| !takes_part(&frame, index)) {
                prop_assert_eq!(found[index].to_bits(), distances(&frame)[index].to_bits());
                spoilt.distance_m.as_mut().unwrap().values_mut()[index] = other;
                spoilt.flags.values_mut()[index] |= PixelFlags::INVALID;
            }
            let again = denoise(rule, &spoilt);
            for index in (0..SHAPE.pixels()).filter(|&index| takes_part(&frame, index)) {
                prop_assert!(found[index] > 0.0 && found[index].is_finite());
                prop_assert_eq!(found[index].to_bits(), again[index].to_bits());
            }
        }
    }

    /// A gain of two, of the amplitude or of the distance, changes exponents only.
    #[test]
    fn gains_pass_through(frame in frames(), exponent in -3i32..=3) {
        let gain = 2f32.powi(exponent);
        for rule in SPATIAL {
            let expected = denoise(rule, &frame);
            let mut louder = frame.clone();
            louder.amplitude.values_mut().iter_mut().for_each(|a| *a *= gain);
            prop_assert_eq!(bits(&denoise(rule, &louder)), bits(&expected));
            let mut farther = frame.clone();
            farther.distance_m.as_mut().unwrap().values_mut().iter_mut().for_each(|d| *d *= gain);
            let expected: Vec<f32> = expected.iter().map(|d| d * gain).collect();
            prop_assert_eq!(bits(&denoise(rule, &farther)), bits(&expected));
        }
    }

    /// A constant distance stays what it is, bit for bit, whatever the amplitude shows.
    #[test]
    fn a_constant_distance_stays(frame in frames(), distance in 0.1f32..9.0) {
        let mut constant = frame;
        for d in constant.distance_m.as_mut().unwrap().values_mut() {
            *d = if *d > 0.0 && d.is_finite() { distance } else { *d };
        }
        for rule in SPATIAL {
            prop_assert_eq!(bits(&denoise(rule, &constant)), bits(distances(&constant)));
        }
        let mut out = Plane::filled(Shape::new(0, 0), 0.0);
        let mut history = TemporalMean::new();
        for _ in 0..10 {
            history.push(&constant, &mut out).unwrap();
            prop_assert_eq!(bits(out.values()), bits(distances(&constant)));
        }
    }

    /// The mean of the last eight frames, weighted by a², of the valid pixels; nothing older. Relative to f64, the
    /// result's rounding.
    #[test]
    fn the_temporal_mean_equals_the_naive_one(frames in prop::collection::vec(frames(), 1..12)) {
        let (mut history, mut out) = (TemporalMean::new(), Plane::filled(Shape::new(0, 0), 0.0));
        for (last, frame) in frames.iter().enumerate() {
            history.push(frame, &mut out).unwrap();
            for (index, &found) in out.values().iter().enumerate() {
                if !takes_part(frame, index) {
                    prop_assert_eq!(found.to_bits(), distances(frame)[index].to_bits());
                    continue;
                }
                let (mut sum, mut weights) = (0.0, 0.0);
                for frame in frames[(last + 1).saturating_sub(8)..=last].iter().filter(|f| takes_part(f, index)) {
                    let weight = f64::from(frame.amplitude.values()[index]).powi(2);
                    sum += weight * f64::from(distances(frame)[index]);
                    weights += weight;
                }
                prop_assert!((f64::from(found) / (sum / weights) - 1.0).abs() <= f64::from(f32::EPSILON));
            }
        }
        let mut fresh = TemporalMean::new();
        let mut expected = Plane::filled(Shape::new(0, 0), 0.0);
        for frame in &frames[frames.len().saturating_sub(8)..] {
            fresh.push(frame, &mut expected).unwrap();
        }
        prop_assert_eq!(bits(out.values()), bits(expected.values()));
    }
}

#[test]
fn a_frame_of_another_shape_starts_a_new_history_and_one_without_distance_is_refused() {
    let of = |shape: Shape, d: f32| frame(shape, vec![9.0; shape.pixels()], vec![d; shape.pixels()]);
    let (mut history, mut out) = (TemporalMean::new(), Plane::filled(Shape::new(0, 0), 0.0));
    history.push(&of(Shape::new(2, 3), 5.0), &mut out).unwrap();
    history.push(&of(Shape::new(3, 2), 1.0), &mut out).unwrap();
    assert_eq!((out.shape(), out.values()), (Shape::new(3, 2), &[1.0; 6][..]));
    assert_eq!(history.push(&Frame::new(Shape::new(3, 2)), &mut out), Err(DenoiseError::DistanceMissing));
}

#[test]
fn images_of_any_size_and_frames_one_after_the_other() {
    let mut denoiser = Denoiser::default();
    for (height, width) in [(0, 0), (1, 1), (1, 40), (40, 1), (2, 2), (3, 30), (30, 3), (0, 5), (9, 9)] {
        let shape = Shape::new(height, width);
        let distance = (0..shape.pixels()).map(|i| 1.0 + 0.01 * ((i * 7919) % 13) as f32).collect();
        let frame = frame(shape, vec![50.0; shape.pixels()], distance);
        for rule in SPATIAL {
            let found =
                denoiser.denoise(rule, &frame, frame.distance_m.as_ref().unwrap(), false).distance_m.to_vec();
            assert_eq!(bits(&found), bits(&denoise(rule, &frame)), "{rule:?} {shape}");
            assert!(found.iter().all(|d| (1.0..=1.13).contains(d)), "{rule:?} {shape} {found:?}");
        }
    }
}
