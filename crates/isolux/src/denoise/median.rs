//! `median`: the median of the valid distances of 3×3 pixels, the mean of the middle two where their number is even.

use super::image::Image;

/// Pixels to either side.
pub(super) const RADIUS: usize = 1;
/// Variance of the median of nine normal values, over that of a single one (D. Teichroew, "Tables of expected
/// values of order statistics", Ann. Math. Statist. 27, 1956).
pub(super) const VARIANCE_LEFT: f32 = 0.166;

/// Writes the medians; NaN where the pixel does not count.
pub(super) fn denoise(image: Image<'_>, out: &mut [f32]) {
    let width = image.shape.width;
    if width == 0 {
        return;
    }
    for (y, out) in out.chunks_mut(width).enumerate() {
        let row = |y: usize| &image.distance_m[y * width..(y + 1) * width];
        out.fill(f32::NAN);
        if y > 0 && y + 1 < image.shape.height && width > 2 {
            full_windows([row(y - 1), row(y), row(y + 1)], &mut out[1..width - 1]);
        }
        for (x, out) in out.iter_mut().enumerate() {
            if out.is_nan() && !row(y)[x].is_nan() {
                *out = median_of_valid(image, y, x);
            }
        }
    }
}

/// Pairs whose exchange brings the median of nine to place 4 (J. L. Smith, "Implementing median filters in
/// XC4000E FPGAs", XCELL 23, 1996).
const EXCHANGES: [(usize, usize); 19] = [
    (1, 2),
    (4, 5),
    (7, 8),
    (0, 1),
    (3, 4),
    (6, 7),
    (1, 2),
    (4, 5),
    (7, 8),
    (0, 3),
    (5, 8),
    (4, 7),
    (3, 6),
    (1, 4),
    (2, 5),
    (4, 7),
    (4, 2),
    (6, 4),
    (4, 2),
];

/// Medians of a row's windows, NaN where a window has an invalid pixel. `out` starts at the second column. Without
/// branches, so that the loop vectorizes.
#[multiversion::multiversion(targets("x86_64+avx512f+avx512bw+avx512vl+avx512dq", "x86_64+avx2"))]
fn full_windows(rows: [&[f32]; 3], out: &mut [f32]) {
    let [above, middle, below] = rows.map(|row| &row[..out.len() + 2]);
    for x in 0..out.len() {
        let mut v = [
            above[x],
            above[x + 1],
            above[x + 2],
            middle[x],
            middle[x + 1],
            middle[x + 2],
            below[x],
            below[x + 1],
            below[x + 2],
        ];
        // Distances are positive: the sum is NaN only where one of them is.
        let sum = v[0] + v[1] + v[2] + v[3] + v[4] + v[5] + v[6] + v[7] + v[8];
        for (low, high) in EXCHANGES {
            let (a, b) = (v[low], v[high]);
            v[low] = if a < b { a } else { b };
            v[high] = if a < b { b } else { a };
        }
        out[x] = if sum.is_nan() { f32::NAN } else { v[4] };
    }
}

/// The same for one pixel, whatever its neighbours are.
fn median_of_valid(image: Image<'_>, y: usize, x: usize) -> f32 {
    let (mut sorted, mut count) = ([0.0f32; 9], 0);
    for y in y.saturating_sub(RADIUS)..(y + RADIUS + 1).min(image.shape.height) {
        for x in x.saturating_sub(RADIUS)..(x + RADIUS + 1).min(image.shape.width) {
            let value = image.distance_m[y * image.shape.width + x];
            if !value.is_nan() {
                let place = sorted[..count].partition_point(|known| *known < value);
                sorted.copy_within(place..count, place + 1);
                sorted[place] = value;
                count += 1;
            }
        }
    }
    match count {
        0 => f32::NAN,
        count if count % 2 == 1 => sorted[count / 2],
        count => 0.5 * sorted[count / 2 - 1] + 0.5 * sorted[count / 2],
    }
}
