//! The paper's fits as one would write them in NumPy: all frames in memory, f64, no streaming, no sharing of code
//! with the library.

use isolux::{Frame, PixelFlags};

use super::time_us;

/// The lookup table: (integration time in µs, multiplier), up to the peak of the mean curve. All frames are in
/// memory; the first `skip_frames` after each change of the time are dropped. Pixels that are 0 throughout are
/// dead; a pixel that is 0 for a while counts as 0; saturation codes do not count.
pub fn lut(frames: &[&Frame], skip_frames: usize, reference_us: f64) -> Vec<(f64, f64)> {
    let settled = settled(frames, skip_frames);
    let pixels = frames[0].shape().pixels();
    let dead = |i: usize| settled.iter().all(|frame| frame.amplitude.values()[i] == 0.0);
    let living: Vec<usize> = (0..pixels).filter(|&i| !dead(i)).collect();
    let mut times: Vec<f64> = settled.iter().map(|frame| time_us(frame)).collect();
    times.sort_by(f64::total_cmp);
    times.dedup();
    let mean = |&time: &f64| {
        let mut values = Vec::new();
        for frame in settled.iter().filter(|frame| time_us(frame) == time) {
            let coded = |i: usize| frame.flags.values()[i].contains(PixelFlags::SATURATED);
            values.extend(living.iter().filter(|&&i| !coded(i)).map(|&i| frame.amplitude.values()[i]));
        }
        (time, values.iter().map(|&v| f64::from(v)).sum::<f64>() / values.len() as f64)
    };
    let means: Vec<(f64, f64)> = times.iter().map(mean).collect();
    let peak = means.iter().map(|(_, mean)| *mean).fold(0.0, f64::max);
    let end = means.iter().position(|(_, mean)| *mean == peak).unwrap();
    let at_reference = log_log(&means[..=end], reference_us);
    means[..=end].iter().map(|&(time, mean)| (time, at_reference / mean)).collect()
}

/// Frames that are not among the first `skip` of their run.
fn settled<'a>(frames: &[&'a Frame], skip: usize) -> Vec<&'a Frame> {
    let since_change = |index: usize| {
        let same = |i: &usize| time_us(frames[*i]) == time_us(frames[index]);
        (0..index).rev().take_while(same).count()
    };
    (0..frames.len()).filter(|&i| since_change(i) >= skip).map(|i| frames[i]).collect()
}

/// Straight line in double-logarithmic coordinates between the two neighbours of `x`; their first and last
/// interval beyond the ends.
pub fn log_log(points: &[(f64, f64)], x: f64) -> f64 {
    let pair = points.windows(2).find(|pair| x <= pair[1].0).unwrap_or(&points[points.len() - 2..]);
    let [(x0, y0), (x1, y1)] = [pair[0], pair[1]];
    (y0.ln() + (y1.ln() - y0.ln()) * (x.ln() - x0.ln()) / (x1.ln() - x0.ln())).exp()
}

/// How a polynomial is fitted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Weighting {
    /// `numpy.polyfit(d, 1 / a, 3)`, as the paper says it.
    Plain,
    /// `numpy.polyfit(d, 1 / a, 3, w=a)`: relative errors.
    Relative,
}

/// A cubic and the distances that it was fitted on.
#[derive(Clone, Copy, Debug)]
pub struct NaiveCubic {
    pub coefficients: [f64; 4],
    pub range_m: [f64; 2],
}

impl NaiveCubic {
    /// The multiplier, continued with the slope of d² outside its range.
    pub fn at(&self, distance_m: f64) -> f64 {
        let [min, max] = self.range_m;
        let inside = if distance_m < min { min } else { distance_m.min(max) };
        polynomial(self.coefficients, inside) * (distance_m / inside) * (distance_m / inside)
    }
}

/// Sections 2.2 of the paper and 3 of the methods: each decay (distance in m, amplitude) is inverted and
/// normalized at the reference by a cubic of its own; those that do not reach there are scaled onto the pool; a
/// second cubic through all points is normalized again.
pub fn paper_cubic(decays: &[Vec<(f64, f64)>], reference_m: f64, weighting: Weighting) -> NaiveCubic {
    let mut pool: Vec<(f64, f64)> = Vec::new();
    let inverted = decays.iter().map(|d| d.iter().map(|&(d, a)| (d, 1.0 / a)).collect::<Vec<_>>());
    let reaches = |points: &Vec<(f64, f64)>| {
        points.iter().any(|p| p.0 <= reference_m) && points.iter().any(|p| p.0 >= reference_m)
    };
    let (near, far): (Vec<_>, Vec<_>) = inverted.partition(reaches);
    for points in &near {
        let scale = 1.0 / polynomial(polyfit(points, weighting), reference_m);
        pool.extend(points.iter().map(|&(d, y)| (d, y * scale)));
    }
    for points in &far {
        let fit = NaiveCubic { coefficients: polyfit(&pool, weighting), range_m: range(&pool) };
        let overlap = points.iter().filter(|(d, _)| (fit.range_m[0]..=fit.range_m[1]).contains(d));
        let logs: Vec<f64> = overlap.map(|&(d, y)| (fit.at(d) / y).ln()).collect();
        let scale = (logs.iter().sum::<f64>() / logs.len() as f64).exp();
        pool.extend(points.iter().map(|&(d, y)| (d, y * scale)));
    }
    let coefficients = polyfit(&pool, weighting);
    let at_reference = polynomial(coefficients, reference_m);
    NaiveCubic { coefficients: coefficients.map(|c| c / at_reference), range_m: range(&pool) }
}

pub fn polynomial([c0, c1, c2, c3]: [f64; 4], x: f64) -> f64 {
    c0 + c1 * x + c2 * x * x + c3 * x * x * x
}

fn range(points: &[(f64, f64)]) -> [f64; 2] {
    let mut distances: Vec<f64> = points.iter().map(|p| p.0).collect();
    distances.sort_by(f64::total_cmp);
    [distances[0], distances[distances.len() - 1]]
}

/// Least squares by the normal equations, in distances divided by the largest: four columns of like size, so that
/// the equations' condition number stays near 10⁶ and f64 keeps ten digits.
fn polyfit(points: &[(f64, f64)], weighting: Weighting) -> [f64; 4] {
    let scale = range(points)[1];
    let mut system = [[0.0; 5]; 4];
    for &(d, y) in points {
        let weight = if weighting == Weighting::Plain { 1.0 } else { 1.0 / y };
        let x = d / scale;
        let row = [1.0, x, x * x, x * x * x, y].map(|value| value * weight);
        for i in 0..4 {
            (0..5).for_each(|j| system[i][j] += row[i] * row[j]);
        }
    }
    let solution = gauss(system);
    [0, 1, 2, 3].map(|power| solution[power] / scale.powi(power as i32))
}

/// Elimination with pivoting of four equations.
fn gauss(mut system: [[f64; 5]; 4]) -> [f64; 4] {
    for column in 0..4 {
        let largest = |a: &usize, b: &usize| system[*a][column].abs().total_cmp(&system[*b][column].abs());
        let pivot = (column..4).max_by(largest).unwrap();
        system.swap(column, pivot);
        for row in (0..4).filter(|row| *row != column) {
            let factor = system[row][column] / system[column][column];
            (0..5).for_each(|j| system[row][j] -= factor * system[column][j]);
        }
    }
    [0, 1, 2, 3].map(|i| system[i][4] / system[i][i])
}
