//! The paper's chain for one frame, pixel by pixel in f64 with a sorted list for the histogram: the oracle of the
//! fast path.

use isolux::{Calibration, Frame, IntegrationTime, PixelFlags};

use super::naive_fit::{NaiveCubic, log_log, polynomial};

/// A standardized frame.
pub struct NaiveFrame {
    pub values: Vec<f64>,
    pub flags: Vec<PixelFlags>,
    /// Relative error that f32 arithmetic may make of each value.
    pub tolerance: Vec<f64>,
    pub cutoff: Option<f64>,
}

/// lut, cubic, histogram of `calibration`.
pub fn standardize(frame: &Frame, calibration: &Calibration) -> NaiveFrame {
    let mut out = NaiveFrame { values: vec![], flags: vec![], tolerance: vec![], cutoff: None };
    for index in 0..frame.shape().pixels() {
        let (value, flags, tolerance) = pixel(frame, index, calibration);
        out.values.push(value);
        out.flags.push(flags);
        out.tolerance.push(tolerance);
    }
    out.cutoff = histogram_cutoff(&out.values);
    if let Some(cutoff) = out.cutoff {
        for (value, flags) in out.values.iter_mut().zip(&mut out.flags).filter(|(v, _)| **v > cutoff) {
            *value = cutoff;
            flags.insert(PixelFlags::SPECULAR);
        }
    }
    out
}

/// Value before the highlights, flags, and the relative tolerance of f32.
fn pixel(frame: &Frame, index: usize, calibration: &Calibration) -> (f64, PixelFlags, f64) {
    let mut flags = frame.flags.values()[index];
    let amplitude = f64::from(frame.amplitude.values()[index]);
    let distance = f64::from(frame.distance_m.as_ref().unwrap().values()[index]);
    let time = match &frame.integration_time_us {
        IntegrationTime::PerFrame(time) => *time,
        IntegrationTime::PerPixel(map) => f64::from(map.values()[index]),
        IntegrationTime::Unknown => f64::NAN,
    };
    let (time_gain, time_flags) = time_gain(calibration, time);
    flags |= time_flags;
    let cubic = calibration.terms.cubic.as_ref().unwrap();
    let law = NaiveCubic { coefficients: cubic.coefficients, range_m: cubic.valid_distance_m };
    let value = amplitude * time_gain * law.at(distance);
    if !(distance > 0.0 && distance.is_finite() && value > 0.0 && value.is_finite()) {
        flags |= PixelFlags::INVALID;
    } else if !(law.range_m[0]..=law.range_m[1]).contains(&distance) {
        flags |= PixelFlags::DISTANCE_OUT_OF_RANGE;
    }
    if flags.contains(PixelFlags::INVALID) {
        return (f64::NAN, flags, 0.0);
    }
    if amplitude < calibration.noise_floor.map_or(0.0, |floor| floor.low_signal_below_dn) {
        flags |= PixelFlags::LOW_SIGNAL;
    }
    (value, flags, f32_tolerance(&law, distance))
}

/// Half an ulp, ε/2, for each rounding. Four outside the polynomial: the time's multiplier, its product with the
/// amplitude, that with the distance's, and the result's rescaling; outside the range four more, as the quotient
/// enters squared and the range's end is rounded, cubed at most. Inside, each coefficient and each of the six
/// operations of Horner's scheme, on terms that may cancel: their sum of magnitudes counts, not their sum.
fn f32_tolerance(law: &NaiveCubic, distance: f64) -> f64 {
    let inside = distance.clamp(law.range_m[0], law.range_m[1]);
    let magnitude = polynomial(law.coefficients.map(f64::abs), inside);
    let cancelled = magnitude / polynomial(law.coefficients, inside);
    0.5 * f64::from(f32::EPSILON) * (4.0 + 4.0 + 7.0 * cancelled)
}

fn time_gain(calibration: &Calibration, time: f64) -> (f64, PixelFlags) {
    let lut = calibration.terms.lut.as_ref().unwrap();
    let table: Vec<(f64, f64)> =
        lut.integration_time_us.iter().copied().zip(lut.multiplier.iter().copied()).collect();
    let [min, max] = lut.valid_integration_time_us;
    if time > 0.0 && time < min {
        (log_log(&table, min) * min / time, PixelFlags::TIME_OUT_OF_RANGE)
    } else if time >= min && time <= max {
        (log_log(&table, time), PixelFlags::empty())
    } else {
        (f64::NAN, PixelFlags::TIME_OUT_OF_RANGE | PixelFlags::INVALID)
    }
}

/// Methods, section 6: 256 bins on [0, min(max, 4·P99)], overflow never qualifies, 3-bin box smoothing,
/// t = max(2, 5e-4 N), the upper edge of the highest bin that qualifies, never below the 98th percentile.
pub fn histogram_cutoff(values: &[f64]) -> Option<f64> {
    let mut sorted: Vec<f64> = values.iter().copied().filter(|v| *v > 0.0 && v.is_finite()).collect();
    sorted.sort_by(f64::total_cmp);
    let last = sorted.len().checked_sub(1)?;
    let percentile = |fraction: f64| sorted[(fraction * last as f64).floor() as usize];
    let end = sorted[last].min(4.0 * percentile(0.99));
    let width = end / 256.0;
    let in_bin = |bin: i32| {
        let edges = (f64::from(bin) * width, f64::from(bin + 1) * width);
        let holds = |v: &&f64| **v >= edges.0 && (**v < edges.1 || (bin == 255 && **v <= end));
        sorted.iter().filter(holds).count() as f64
    };
    let counts: Vec<f64> =
        (-1..=256).map(|bin| if (0..256).contains(&bin) { in_bin(bin) } else { 0.0 }).collect();
    let smoothed = |bin: usize| (counts[bin] + counts[bin + 1] + counts[bin + 2]) / 3.0;
    let needed = (5e-4 * sorted.len() as f64).max(2.0);
    let highest = (0..256).rev().find(|&bin| smoothed(bin) >= needed)?;
    Some((width * (highest + 1) as f64).max(percentile(0.98)))
}
