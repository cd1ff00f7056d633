//! `wiener`: the local Wiener filter, weighted by the variance of each distance.
//!
//! In the 5×5 pixels around each, with `w = 1/σ_d²`: mean `m = Σwd/Σw`, variance `v = Σwd²/Σw − m²`, its share that
//! is noise `n² = Σwσ_d²/Σw`, and `α`, the share of the detail. All windows that hold a pixel decide together:
//! `d~ = avg(α) d + avg((1 − α) m)`. (J.-S. Lee's filter, "Digital image enhancement and noise filtering by use of
//! local statistics", PAMI 2, 1980, with weights.)
//!
//! Lee's `α = clamp(1 − n²/v, 0, 1)` pulls a bar of three pixels by 7 to 12 % towards its background at a
//! signal-to-noise ratio of 4.5. With the square of the share, `α = clamp(1 − (q n²/v)², 0, 1)`, clear detail is
//! not changed; with q = 1.15, the variance of flat areas, which scatters about n², counts as noise.
//!
//! With `σ_d² = k/a²`, the weights are `a²/k`, and `n² = k N / Σa²`.

use super::image::Image;
use crate::memory::bytes;

/// Pixels to either side.
pub(super) const RADIUS: usize = 2;
/// Variance up to this many times that of the noise is taken for noise: q.
const NOISE_MARGIN: f64 = 1.15;
const SIDE: usize = 2 * RADIUS + 1;
/// Variance that is left of one pixel's where nothing is detail: (85/625)² = 0.018 would be left by two boxes of 5×5
/// one after the other, but the detail that is kept is where the noise is largest. With this constant the mean over
/// flat areas is what is measured there, 0.038.
const SMOOTHED_VARIANCE: f32 = 0.03;

/// Share of a distance's variance that is left in a pixel of which `detail` (0..=1) was kept.
pub(super) fn variance_left(detail: f32) -> f32 {
    SMOOTHED_VARIANCE + (1.0 - SMOOTHED_VARIANCE) * detail * detail
}

/// Working memory: a few rows. Every pixel costs the same, whatever is in it.
#[derive(Clone, Debug, Default)]
pub(super) struct Wiener {
    /// Pixels that take part, a², a² d, a² d².
    moments: BoxSums<4>,
    /// Pixels that take part, α, (1 − α) m.
    answers: BoxSums<3>,
}

impl Wiener {
    pub(super) fn bytes(&self) -> usize {
        self.moments.bytes() + self.answers.bytes()
    }

    /// Writes the denoised distances, NaN where the pixel does not count, and into `detail` the mean α of the other
    /// pixels. Without noise (`k` = 0) everything is detail.
    pub(super) fn denoise(
        &mut self,
        image: Image<'_>,
        k: f64,
        out: &mut [f32],
        mut detail: Option<&mut [f32]>,
    ) {
        let (height, width) = (image.shape.height, image.shape.width);
        if k <= 0.0 {
            out.copy_from_slice(image.distance_m);
            if let Some(detail) = detail {
                detail.fill(1.0);
            }
            return;
        }
        self.moments.start(width);
        self.answers.start(width);
        let row = |y: usize| y * width..(y + 1) * width;
        // Row `y` enters; the windows of row y − 2 are then complete, and with them the answers of row y − 4.
        for y in 0..height + 2 * RADIUS {
            let moments = self.moments.next_row();
            if y < height {
                products(&image.distance_m[row(y)], &image.amplitude[row(y)], moments);
            }
            let Some(y) = y.checked_sub(RADIUS) else { continue };
            let answers = self.answers.next_row();
            if y < height {
                answer(self.moments.sum(), &image.distance_m[row(y)], k, answers);
            }
            let Some(y) = y.checked_sub(RADIUS) else { continue };
            let sums = self.answers.sum();
            combine(sums, &image.distance_m[row(y)], &mut out[row(y)]);
            if let Some(detail) = &mut detail {
                let means = sums[1].iter().zip(&sums[0]).map(|(alpha, count)| (alpha / count) as f32);
                detail[row(y)].iter_mut().zip(means).for_each(|(detail, mean)| *detail = mean);
            }
        }
    }
}

/// Sums over 5×5 windows of Q quantities, row after row. The rows have two zeros at either end, as have the columns:
/// a window is clipped at the image's edge. Sums are added up anew for each row and pixel: running sums would carry
/// the rounding of one place to the next.
#[derive(Clone, Debug)]
struct BoxSums<const Q: usize> {
    /// Ring of the last five rows.
    rows: [[Vec<f64>; Q]; SIDE],
    next: usize,
    columns: Vec<f64>,
    sums: [Vec<f64>; Q],
}

impl<const Q: usize> Default for BoxSums<Q> {
    fn default() -> Self {
        let rows = || std::array::from_fn(|_| Vec::new());
        Self { rows: std::array::from_fn(|_| rows()), next: 0, columns: Vec::new(), sums: rows() }
    }
}

impl<const Q: usize> BoxSums<Q> {
    fn bytes(&self) -> usize {
        let rows = self.rows.iter().flatten().chain(&self.sums);
        rows.map(bytes).sum::<usize>() + bytes(&self.columns)
    }

    /// Forgets all rows.
    fn start(&mut self, width: usize) {
        let padded = width + 2 * RADIUS;
        for row in self.rows.iter_mut().flatten().chain([&mut self.columns]) {
            row.clear();
            row.resize(padded, 0.0);
        }
        self.sums.iter_mut().for_each(|sums| sums.resize(width, 0.0));
        self.next = 0;
    }

    /// The place for the next row, all zeros.
    fn next_row(&mut self) -> [&mut [f64]; Q] {
        let row = &mut self.rows[self.next];
        self.next = (self.next + 1) % SIDE;
        row.each_mut().map(|quantity| {
            let end = quantity.len() - RADIUS;
            let inner = &mut quantity[RADIUS..end];
            inner.fill(0.0);
            inner
        })
    }

    /// Sums of the windows around the third of the last five rows.
    fn sum(&mut self) -> &[Vec<f64>; Q] {
        for quantity in 0..Q {
            let row = |age: usize| self.rows[(self.next + age) % SIDE][quantity].as_slice();
            add_rows([row(0), row(1), row(2), row(3), row(4)], &mut self.columns);
            add_columns(&self.columns, &mut self.sums[quantity]);
        }
        &self.sums
    }
}

#[multiversion::multiversion(targets("x86_64+avx512f+avx512bw+avx512vl+avx512dq", "x86_64+avx2"))]
fn add_rows(rows: [&[f64]; SIDE], out: &mut [f64]) {
    let [a, b, c, d, e] = rows.map(|row| &row[..out.len()]);
    for x in 0..out.len() {
        out[x] = a[x] + b[x] + c[x] + d[x] + e[x];
    }
}

#[multiversion::multiversion(targets("x86_64+avx512f+avx512bw+avx512vl+avx512dq", "x86_64+avx2"))]
fn add_columns(row: &[f64], out: &mut [f64]) {
    let row = &row[..out.len() + 2 * RADIUS];
    for x in 0..out.len() {
        out[x] = row[x] + row[x + 1] + row[x + 2] + row[x + 3] + row[x + 4];
    }
}

#[multiversion::multiversion(targets("x86_64+avx512f+avx512bw+avx512vl+avx512dq", "x86_64+avx2"))]
fn products(distance_m: &[f32], amplitude: &[f32], out: [&mut [f64]; 4]) {
    let count = distance_m.len();
    let amplitude = &amplitude[..count];
    let [valid, w, wd, wdd] = out.map(|quantity| &mut quantity[..count]);
    for x in 0..count {
        let (d, a) = (f64::from(distance_m[x]), f64::from(amplitude[x]));
        let takes_part = !d.is_nan();
        let (d, weight) = if takes_part { (d, a * a) } else { (0.0, 0.0) };
        valid[x] = if takes_part { 1.0 } else { 0.0 };
        w[x] = weight;
        wd[x] = weight * d;
        wdd[x] = weight * d * d;
    }
}

#[multiversion::multiversion(targets("x86_64+avx512f+avx512bw+avx512vl+avx512dq", "x86_64+avx2"))]
fn answer(sums: &[Vec<f64>; 4], distance_m: &[f32], k: f64, out: [&mut [f64]; 3]) {
    let count = distance_m.len();
    let [valid, w, wd, wdd] = sums.each_ref().map(|sums| &sums[..count]);
    let [takes_part, alpha, rest] = out.map(|quantity| &mut quantity[..count]);
    for x in 0..count {
        let mean = wd[x] / w[x];
        let variance = wdd[x] / w[x] - mean * mean;
        let noise = k * valid[x] / w[x];
        let share = NOISE_MARGIN * noise / variance;
        let detail = if variance > NOISE_MARGIN * noise { 1.0 - share * share } else { 0.0 };
        let valid = !distance_m[x].is_nan();
        takes_part[x] = if valid { 1.0 } else { 0.0 };
        alpha[x] = if valid { detail } else { 0.0 };
        rest[x] = if valid { (1.0 - detail) * mean } else { 0.0 };
    }
}

#[multiversion::multiversion(targets("x86_64+avx512f+avx512bw+avx512vl+avx512dq", "x86_64+avx2"))]
fn combine(sums: &[Vec<f64>; 3], distance_m: &[f32], out: &mut [f32]) {
    let count = out.len();
    let [valid, alpha, rest] = sums.each_ref().map(|sums| &sums[..count]);
    let distance_m = &distance_m[..count];
    for x in 0..count {
        // NaN where the pixel does not count.
        out[x] = ((alpha[x] * f64::from(distance_m[x]) + rest[x]) / valid[x]) as f32;
    }
}
