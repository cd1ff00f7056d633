//! The angle of incidence of each pixel, from planes fitted to the distances around it.
//!
//! On a plane, the inverse depth is an affine function of the image: `1/z = a x + b y + c`, with the ray (x, y, 1), and
//! (a, b, c) is the normal. So a fit of 1/z is a linear one, without a bias from the slant. Each window holds 9×9
//! samples; where the distances are noisy, they are farther apart. A window reaches across edges of depth, so the
//! fit is robust: it starts in the window's inner half with what a surface through the middle pixel could hold at all,
//! and closes in on the plane that the majority lies on (Tukey's biweight, the cutoff at three times the weighted
//! root mean square, at best halved from round to round).

use crate::denoise::{DenoiseRule, Denoiser};
use crate::frame::{Frame, Intrinsics, Plane, Shape};

/// Samples to either side of the middle one.
const REACH: i64 = 4;
/// Half of the narrowest window, tangent of the angle: 2°, 35 mm at 1 m. Within less, a camera's depth follows the
/// texture more than the slant.
const NARROWEST: f64 = 0.034;
/// Most pixels from sample to sample: the distances that are sampled are means over 5×5, so that more would leave
/// some out.
const WIDEST_STEP: i64 = 5;
/// Predicted error of the slant that widens the window, rad.
const LARGEST_ERROR: f64 = 0.02;
/// Samples to either side with which a fit starts: the window's inner half, which an edge reaches less often.
const NEAR_REACH: i64 = 2;
/// Tangent of the steepest surface that a fit starts with: 68°.
const STEEPEST: f64 = 2.5;
/// Standard deviations of a pixel's distance, before it was denoised, that a fit starts with besides.
const NOISE_MARGIN: f64 = 1.0;
/// Larger relative deviations do not widen the start: they would let in everything.
const LARGEST_NOISE: f64 = 0.1;
/// Rounds with the inner half, and all.
const NEAR_ROUNDS: usize = 2;
const ROUNDS: usize = 6;
/// A cutoff is never less than this share of 1/z: what cameras' distances err by on any surface.
const LEAST_CUTOFF: f64 = 0.004;
/// Samples that a plane needs: as many as the inner half holds in the image's corner.
const LEAST_SAMPLES: u32 = 9;
/// Least ratio of the determinant of the samples' spread to the square of half its trace: a line has no plane.
const LEAST_SPREAD: f64 = 0.02;

/// Denoises a frame's distances and fits the planes; reuse one for a whole recording. Empty until it is used.
#[derive(Clone, Debug, Default)]
pub(crate) struct Incidence {
    denoiser: Denoiser,
    normals: Normals,
}

impl Incidence {
    /// Takes the next frame, seen at `distance_m` (m, radial). Allocates only when the shape differs from that of the
    /// last frame.
    pub(crate) fn take(&mut self, frame: &Frame, distance_m: &Plane<f32>, intrinsics: &Intrinsics) {
        self.denoiser.denoise(DenoiseRule::Wiener, frame, distance_m, false);
        let (denoised_m, scale) = self.denoiser.wiener_result();
        self.normals.take(frame, intrinsics, denoised_m, scale.sqrt());
    }

    /// Cosine of the angle of incidence, 0..=1, at a pixel of that frame; NaN where no plane was found or the pixel
    /// is no measurement.
    pub(crate) fn cosine(&self, index: usize, intrinsics: &Intrinsics) -> f32 {
        self.normals.cosine(index, intrinsics)
    }

    /// The same for all pixels of a frame, row by row.
    pub(crate) fn cosines(
        &mut self,
        frame: &Frame,
        distance_m: &Plane<f32>,
        intrinsics: &Intrinsics,
    ) -> &[f32] {
        self.take(frame, distance_m, intrinsics);
        self.normals.cosines(intrinsics)
    }
}

/// Working memory of the fits.
#[derive(Clone, Debug)]
struct Normals {
    shape: Shape,
    /// 1/z, 1/m; NaN where there is no distance.
    inverse_depth: Vec<f32>,
    /// Relative standard deviation of each pixel's distance, before it was denoised.
    noise: Vec<f32>,
    cosines: Vec<f32>,
}

impl Default for Normals {
    fn default() -> Self {
        let empty = Vec::new;
        Self { shape: Shape::new(0, 0), inverse_depth: empty(), noise: empty(), cosines: empty() }
    }
}

impl Facet {
    /// Within a thousandth of the slant.
    fn is_close_to(self, other: Self) -> bool {
        let limit = 1e-3 * self.c.abs();
        (self.a - other.a).abs() < limit && (self.b - other.b).abs() < limit
    }
}

impl Normals {
    /// `distance_m` are denoised radial distances (m), NaN or not positive where there are none; before that, they had
    /// the standard deviation `deviation / amplitude`.
    fn take(&mut self, frame: &Frame, intrinsics: &Intrinsics, distance_m: &[f32], deviation: f64) {
        self.shape = frame.shape();
        self.inverse_depth.resize(distance_m.len(), f32::NAN);
        self.noise.resize(distance_m.len(), f32::NAN);
        for (index, &distance) in distance_m.iter().enumerate() {
            let per_depth = radial_per_depth(intrinsics, index / self.shape.width, index % self.shape.width);
            let measured = distance > 0.0 && distance < f32::INFINITY && frame.is_valid(index);
            let inverse = if measured { (per_depth / f64::from(distance)) as f32 } else { f32::NAN };
            self.inverse_depth[index] = inverse;
            self.noise[index] = deviation as f32 / (frame.amplitude.values()[index] * distance);
        }
    }

    fn cosine(&self, index: usize, intrinsics: &Intrinsics) -> f32 {
        if self.inverse_depth[index].is_nan() {
            return f32::NAN;
        }
        let field = Field { shape: self.shape, intrinsics, inverse_depth: &self.inverse_depth };
        let cosine = field.cosine(index, f64::from(self.noise[index]));
        cosine.map_or(f32::NAN, |cosine| cosine as f32)
    }

    fn cosines(&mut self, intrinsics: &Intrinsics) -> &[f32] {
        let mut cosines = std::mem::take(&mut self.cosines);
        cosines.resize(self.inverse_depth.len(), f32::NAN);
        cosines.iter_mut().enumerate().for_each(|(index, out)| *out = self.cosine(index, intrinsics));
        self.cosines = cosines;
        &self.cosines
    }
}

/// What the fits of one frame share.
struct Field<'a> {
    shape: Shape,
    intrinsics: &'a Intrinsics,
    inverse_depth: &'a [f32],
}

/// `1/z = c + a Δx + b Δy` around a pixel.
#[derive(Clone, Copy)]
struct Facet {
    a: f64,
    b: f64,
    c: f64,
}

impl Field<'_> {
    /// `noise`: relative standard deviation of the pixel's distance.
    fn cosine(&self, index: usize, noise: f64) -> Option<f64> {
        let (row, column) = (index / self.shape.width, index % self.shape.width);
        let step = self.step(noise);
        let facet = self.facet(row, column, step, noise)?;
        let [x, y, _] = self.intrinsics.ray(row as f64, column as f64);
        let along = facet.c - facet.a * x - facet.b * y;
        let length = (facet.a * facet.a + facet.b * facet.b + along * along).sqrt();
        let cosine = facet.c / (length * radial_per_depth(self.intrinsics, row, column));
        (cosine > 0.0).then(|| cosine.min(1.0))
    }

    /// Pixels from sample to sample: the slant of N pixels within a half width of R has the standard error
    /// `σ/d · √3 f / (R √N)`.
    fn step(&self, noise: f64) -> i64 {
        let focal = self.intrinsics.fx.min(self.intrinsics.fy);
        let narrowest = ((NARROWEST * focal / REACH as f64).round() as i64).clamp(1, 64);
        let error = |step: i64| {
            let half = (REACH * step) as f64;
            noise * 3f64.sqrt() * focal / (half * (2.0 * half + 1.0))
        };
        let mut step = narrowest;
        while step < WIDEST_STEP && error(step) > LARGEST_ERROR {
            step += 1;
        }
        step
    }

    fn facet(&self, row: usize, column: usize, step: i64, noise: f64) -> Option<Facet> {
        let middle = f64::from(self.inverse_depth[row * self.shape.width + column]);
        let focal = self.intrinsics.fx.min(self.intrinsics.fy);
        let near = STEEPEST * (NEAR_REACH * step) as f64 / focal;
        let mut cutoff = middle * (near + NOISE_MARGIN * noise.min(LARGEST_NOISE));
        let mut facet = Facet { a: 0.0, b: 0.0, c: middle };
        for round in 0..ROUNDS {
            let reach = if round < NEAR_ROUNDS { NEAR_REACH } else { REACH };
            let sums = self.sums((row, column), reach, step, facet, cutoff);
            let before = facet;
            facet = sums.corrected(facet)?;
            let closest = cutoff <= LEAST_CUTOFF * middle * 1.001;
            if closest && round >= NEAR_ROUNDS && facet.is_close_to(before) {
                break;
            }
            // A plane that half of the window has told is less sure where the window widens.
            let widens = if round + 1 == NEAR_ROUNDS { 1.5 } else { 1.0 };
            let closer = 3.0 * sums.root_mean_square() * widens;
            cutoff = closer.clamp(0.5 * cutoff, cutoff).max(LEAST_CUTOFF * middle);
        }
        // A pixel that its own plane leaves out lies on an edge or is an outlier: it has no normal.
        ((middle - facet.c).abs() < cutoff.max(3.0 * noise * middle)).then_some(facet)
    }

    /// Weighted moments of the samples and of their residuals from `known`.
    fn sums(&self, (row, column): (usize, usize), reach: i64, step: i64, known: Facet, cutoff: f64) -> Sums {
        let (height, width) = (self.shape.height as i64, self.shape.width as i64);
        let inverse_square = 1.0 / (cutoff * cutoff);
        let mut sums = Sums::default();
        for i in -reach..=reach {
            let y = row as i64 + i * step;
            if y < 0 || y >= height {
                continue;
            }
            let dy = (i * step) as f64 / self.intrinsics.fy;
            for j in -reach..=reach {
                let x = column as i64 + j * step;
                if x < 0 || x >= width {
                    continue;
                }
                let dx = (j * step) as f64 / self.intrinsics.fx;
                let value = f64::from(self.inverse_depth[(y * width + x) as usize]);
                let residual = value - known.c - known.a * dx - known.b * dy;
                let share = residual * residual * inverse_square;
                // False for NaN.
                if share < 1.0 {
                    sums.add((1.0 - share) * (1.0 - share), dx, dy, residual);
                }
            }
        }
        sums
    }
}

#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    count: u32,
    w: f64,
    x: f64,
    y: f64,
    xx: f64,
    xy: f64,
    yy: f64,
    r: f64,
    xr: f64,
    yr: f64,
    rr: f64,
}

impl Sums {
    #[inline(always)]
    fn add(&mut self, w: f64, x: f64, y: f64, r: f64) {
        self.count += 1;
        self.w += w;
        self.x += w * x;
        self.y += w * y;
        self.xx += w * x * x;
        self.xy += w * x * y;
        self.yy += w * y * y;
        self.r += w * r;
        self.xr += w * x * r;
        self.yr += w * y * r;
        self.rr += w * r * r;
    }

    fn root_mean_square(&self) -> f64 {
        (self.rr / self.w).sqrt()
    }

    /// The known plane and that of the residuals; `None` where the samples determine none.
    fn corrected(&self, known: Facet) -> Option<Facet> {
        if self.count < LEAST_SAMPLES {
            return None;
        }
        let [x, y, r] = [self.x, self.y, self.r].map(|sum| sum / self.w);
        let [xx, xy, yy] = [self.xx / self.w - x * x, self.xy / self.w - x * y, self.yy / self.w - y * y];
        let [xr, yr] = [self.xr / self.w - x * r, self.yr / self.w - y * r];
        let determinant = xx * yy - xy * xy;
        let half_trace = 0.5 * (xx + yy);
        if determinant <= LEAST_SPREAD * half_trace * half_trace {
            return None;
        }
        let a = (xr * yy - yr * xy) / determinant;
        let b = (yr * xx - xr * xy) / determinant;
        Some(Facet { a: known.a + a, b: known.b + b, c: known.c + r - a * x - b * y })
    }
}

fn radial_per_depth(intrinsics: &Intrinsics, row: usize, column: usize) -> f64 {
    let [x, y, z] = intrinsics.ray(row as f64, column as f64);
    (x * x + y * y + z * z).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    const SHAPE: Shape = Shape::new(60, 80);
    const INTRINSICS: Intrinsics = Intrinsics { fx: 90.0, fy: 92.0, cx: 38.0, cy: 31.0 };

    /// Radial distance and cosine of the plane `n · p = offset` at a pixel.
    fn plane(n: [f64; 3], offset: f64, index: usize) -> (f64, f64) {
        let ray = INTRINSICS.ray((index / SHAPE.width) as f64, (index % SHAPE.width) as f64);
        let dot = n[0] * ray[0] + n[1] * ray[1] + n[2] * ray[2];
        let length = radial_per_depth(&INTRINSICS, index / SHAPE.width, index % SHAPE.width);
        let size = (n[0] * n[0] + n[1] * n[1] + n[2] * n[2]).sqrt();
        (offset / dot * length, dot / (length * size))
    }

    fn uniform(state: &mut u64) -> f64 {
        *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (*state >> 11) as f64 / (1u64 << 53) as f64 - 0.5
    }

    /// Cosines where the distances have the standard deviation `noise_m`.
    fn cosines(shape: Shape, distance_m: &[f32], noise_m: f64) -> Vec<f32> {
        let mut frame = Frame::new(shape);
        frame.amplitude.fill(100.0);
        let mut normals = Normals::default();
        normals.take(&frame, &INTRINSICS, distance_m, 100.0 * noise_m);
        normals.cosines(&INTRINSICS).to_vec()
    }

    #[test]
    fn the_angle_of_any_plane_is_exact_up_to_the_edges() {
        for n in [[0.0, 0.0, 1.0], [0.8, 0.1, 1.0], [-0.5, 1.1, 1.0]] {
            let truth: Vec<(f64, f64)> = (0..SHAPE.pixels()).map(|i| plane(n, 1.3, i)).collect();
            let distances: Vec<f32> = truth.iter().map(|(d, _)| *d as f32).collect();
            let cosines = cosines(SHAPE, &distances, 0.0);
            for (found, (d, cosine)) in cosines.iter().zip(&truth) {
                // 1/z in f32, 6e-8 of it, over a window of 1/25 rad: 2e-6 of slant. Beyond 68° nothing is promised.
                assert!(
                    *d <= 0.0 || *cosine < 0.37 || (f64::from(*found) - cosine).abs() < 1e-4,
                    "{found} {cosine}"
                );
            }
        }
    }

    #[test]
    fn a_step_of_depth_bends_no_normal_on_either_side() {
        let side = |index: usize| {
            if index % SHAPE.width < 40 { ([0.5, 0.0, 1.0], 1.0) } else { ([0.0, -0.4, 1.0], 1.6) }
        };
        let mut state = 5;
        let truth: Vec<(f64, f64)> = (0..SHAPE.pixels()).map(|i| plane(side(i).0, side(i).1, i)).collect();
        let distances: Vec<f32> =
            truth.iter().map(|(d, _)| (d * (1.0 + 0.002 * uniform(&mut state))) as f32).collect();
        let cosines = cosines(SHAPE, &distances, 0.0006);
        let errors =
            cosines.iter().zip(&truth).map(|(found, (_, cosine))| (f64::from(*found) - cosine).abs());
        let errors: Vec<f64> = errors.filter(|error| error.is_finite()).collect();
        // σ = 0.06 %: a slant error of σ √3 f / (R √81) = 0.3 mrad·… below 1e-2 at any angle; half the window may be
        // missing at the edge, which triples it.
        let bad = errors.iter().filter(|error| **error > 0.03).count();
        assert!(errors.len() > SHAPE.pixels() * 99 / 100, "{}", errors.len());
        assert!(bad * 200 < errors.len(), "{bad} of {}", errors.len());
    }

    #[test]
    fn pixels_without_a_surface_have_no_angle() {
        let mut distances = vec![f32::NAN; SHAPE.pixels()];
        distances[40] = 1.0;
        (0..80).for_each(|column| distances[30 * 80 + column] = 1.0);
        // One pixel and one line determine no plane.
        assert!(cosines(SHAPE, &distances, 0.0).iter().all(|c| c.is_nan()));
        assert!(cosines(Shape::new(1, 1), &[1.0], 0.0)[0].is_nan());
    }
}
