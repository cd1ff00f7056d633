//! Fits the well that all pixels share to their values at several times: robust least squares in which the light of
//! every pixel is eliminated (Schur complement), so that the time grows only with the number of points.

use nalgebra::{Matrix3, SMatrix, SVector, Vector3};

use super::FullWell;
use super::well::SoftWell;
use crate::numerics::robust::{biweight, tukey_loss, tukey_share};
use crate::numerics::statistics::{SIGMA_PER_MAD, median};

/// What one pixel delivered over the times: R values each, and Q numbers of its own that explain them.
#[derive(Clone, Debug)]
pub(super) struct Series<const R: usize, const Q: usize> {
    pub(super) points: Vec<Point<R>>,
    /// Logarithms of the pixel's own numbers, at first a guess.
    pub(super) light: [f64; Q],
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Point<const R: usize> {
    pub(super) time_us: f64,
    pub(super) values_dn: [f64; R],
    /// Standard deviations, up to a common factor.
    pub(super) sigmas: [f64; R],
}

/// The well and how well it is known.
#[derive(Clone, Debug)]
pub(super) struct Solution {
    pub(super) well: FullWell,
    /// Standard deviation of ln W.
    pub(super) relative_sd: f64,
}

/// Predicted values in DN of a pixel with this light at this time, µs.
pub(super) trait Model<const R: usize, const Q: usize> {
    fn predict(&self, well: &FullWell, light: &[f64; Q], time_us: f64) -> [f64; R];
}

impl<const R: usize, const Q: usize, F: Fn(&FullWell, &[f64; Q], f64) -> [f64; R]> Model<R, Q> for F {
    fn predict(&self, well: &FullWell, light: &[f64; Q], time_us: f64) -> [f64; R] {
        self(well, light, time_us)
    }
}

/// Rounds of reweighting; each step of Levenberg and Marquardt is one.
const ROUNDS: usize = 60;

/// Well and light that leave the least robust sum of squares; `None` when the points do not determine them.
pub(super) fn solve<const R: usize, const Q: usize>(
    series: &mut [Series<R, Q>],
    start: FullWell,
    model: &impl Model<R, Q>,
) -> Option<Solution> {
    let mut well = start;
    let mut damping = 1e-3;
    let mut sigma = scale(series, &well, model)?;
    let mut cost = robust_cost(series, &well, model, sigma);
    let mut normal = Normal::new(series, &well, model, sigma);
    for _ in 0..ROUNDS {
        let Some((step, lights)) = normal.step(series, damping) else {
            damping *= 10.0;
            continue;
        };
        let candidate = moved(&well, &step);
        let old: Vec<[f64; Q]> = series.iter().map(|s| s.light).collect();
        series.iter_mut().zip(lights).for_each(|(series, light)| series.light = light);
        let found = robust_cost(series, &candidate, model, sigma);
        if found <= cost {
            well = candidate;
            damping = (0.2 * damping).max(1e-9);
            let done = step.amax() < 1e-7;
            sigma = scale(series, &well, model)?;
            cost = robust_cost(series, &well, model, sigma);
            normal = Normal::new(series, &well, model, sigma);
            if done {
                break;
            }
        } else {
            series.iter_mut().zip(old).for_each(|(series, light)| series.light = light);
            damping *= 10.0;
            if damping > 1e12 {
                break;
            }
        }
    }
    let variance = normal.reduced(0.0)?.0.try_inverse()?[(0, 0)];
    let relative_sd = sigma * variance.sqrt();
    relative_sd.is_finite().then_some(Solution { well, relative_sd })
}

/// The well after a step in (ln W, ln p, black level / W).
fn moved(well: &FullWell, step: &Vector3<f64>) -> FullWell {
    let (low, high) = (*SoftWell::SOFTNESS_LIMITS.start(), *SoftWell::SOFTNESS_LIMITS.end());
    let bounded = |x: f64| x.clamp(-0.5, 0.5);
    FullWell {
        full_well_dn: well.full_well_dn * bounded(step[0]).exp(),
        softness: (well.softness * bounded(step[1]).exp()).clamp(low, high),
        black_level_dn: well.black_level_dn + well.full_well_dn * bounded(step[2]),
    }
}

/// Residuals of one point in units of its σ.
fn residuals<const R: usize, const Q: usize>(
    point: &Point<R>,
    well: &FullWell,
    light: &[f64; Q],
    model: &impl Model<R, Q>,
) -> [f64; R] {
    let predicted = model.predict(well, light, point.time_us);
    std::array::from_fn(|i| (point.values_dn[i] - predicted[i]) / point.sigmas[i])
}

fn all_residuals<'a, const R: usize, const Q: usize>(
    series: &'a [Series<R, Q>],
    well: &'a FullWell,
    model: &'a impl Model<R, Q>,
) -> impl Iterator<Item = f64> + 'a {
    let of =
        move |s: &'a Series<R, Q>| s.points.iter().flat_map(move |p| residuals(p, well, &s.light, model));
    series.iter().flat_map(of)
}

/// σ of the residuals from their median size.
fn scale<const R: usize, const Q: usize>(
    series: &[Series<R, Q>],
    well: &FullWell,
    model: &impl Model<R, Q>,
) -> Option<f64> {
    let mut sizes: Vec<f64> = all_residuals(series, well, model).map(f64::abs).collect();
    let sigma = SIGMA_PER_MAD * median(&mut sizes)?;
    // Data without noise must not divide by nothing.
    sigma.is_finite().then_some(sigma.max(1e-9))
}

/// Tukey's loss, at most 1 per residual.
fn robust_cost<const R: usize, const Q: usize>(
    series: &[Series<R, Q>],
    well: &FullWell,
    model: &impl Model<R, Q>,
    sigma: f64,
) -> f64 {
    all_residuals(series, well, model).map(|residual| tukey_loss(residual, sigma)).sum()
}

/// Normal equations: the shared block, and each pixel's own.
struct Normal<const Q: usize> {
    shared: Matrix3<f64>,
    gradient: Vector3<f64>,
    own: Vec<Own<Q>>,
}

struct Own<const Q: usize> {
    block: SMatrix<f64, Q, Q>,
    cross: SMatrix<f64, 3, Q>,
    gradient: SVector<f64, Q>,
}

/// Step of the numeric derivatives: their error, 1e-8 relative, only slows the convergence.
const STEP: f64 = 1e-4;

impl<const Q: usize> Normal<Q> {
    fn new<const R: usize>(
        series: &[Series<R, Q>],
        well: &FullWell,
        model: &impl Model<R, Q>,
        sigma: f64,
    ) -> Self {
        let mut normal = Self {
            shared: Matrix3::zeros(),
            gradient: Vector3::zeros(),
            own: Vec::with_capacity(series.len()),
        };
        let shifted = [0, 1, 2].map(|axis| {
            let mut step = Vector3::zeros();
            step[axis] = STEP;
            [moved(well, &step), moved(well, &-step)]
        });
        for series in series {
            let mut own =
                Own { block: SMatrix::zeros(), cross: SMatrix::zeros(), gradient: SVector::zeros() };
            for point in &series.points {
                let now = residuals(point, well, &series.light, model);
                let shared = shifted.each_ref().map(|[up, down]| {
                    let (up, down) = (
                        residuals(point, up, &series.light, model),
                        residuals(point, down, &series.light, model),
                    );
                    std::array::from_fn::<f64, R, _>(|i| (down[i] - up[i]) / (2.0 * STEP))
                });
                let light: [[f64; R]; Q] = std::array::from_fn(|q| {
                    let at = |step: f64| {
                        let mut light = series.light;
                        light[q] += step;
                        residuals(point, well, &light, model)
                    };
                    let (up, down) = (at(STEP), at(-STEP));
                    std::array::from_fn(|i| (down[i] - up[i]) / (2.0 * STEP))
                });
                for i in 0..R {
                    let by_well = Vector3::from_fn(|axis, _| shared[axis][i]);
                    let by_light = SVector::<f64, Q>::from_fn(|q, _| light[q][i]);
                    let weight = biweight(tukey_share(now[i], sigma));
                    normal.shared += weight * by_well * by_well.transpose();
                    normal.gradient += weight * now[i] * by_well;
                    own.block += weight * by_light * by_light.transpose();
                    own.cross += weight * by_well * by_light.transpose();
                    own.gradient += weight * now[i] * by_light;
                }
            }
            normal.own.push(own);
        }
        normal
    }

    /// Shared matrix and gradient after the light is eliminated. Pixels whose own block is singular do not count.
    fn reduced(&self, damping: f64) -> Option<(Matrix3<f64>, Vector3<f64>)> {
        let (mut matrix, mut gradient) = (damped(self.shared, damping), self.gradient);
        for own in &self.own {
            let Some(inverse) = damped(own.block, damping).try_inverse() else { continue };
            matrix -= own.cross * inverse * own.cross.transpose();
            gradient -= own.cross * inverse * own.gradient;
        }
        matrix.iter().all(|v| v.is_finite()).then_some((matrix, gradient))
    }

    /// Step of the well, and the light after it.
    fn step<const R: usize>(
        &self,
        series: &[Series<R, Q>],
        damping: f64,
    ) -> Option<(Vector3<f64>, Vec<[f64; Q]>)> {
        let (matrix, gradient) = self.reduced(damping)?;
        let step = matrix.cholesky()?.solve(&gradient);
        let light = |(series, own): (&Series<R, Q>, &Own<Q>)| match damped(own.block, damping).try_inverse() {
            Some(inverse) => {
                let own_step = inverse * (own.gradient - own.cross.transpose() * step);
                std::array::from_fn(|q| series.light[q] + own_step[q].clamp(-0.5, 0.5))
            }
            None => series.light,
        };
        Some((step, series.iter().zip(&self.own).map(light).collect()))
    }
}

/// Marquardt's damping: relative to the diagonal.
fn damped<const N: usize>(mut matrix: SMatrix<f64, N, N>, damping: f64) -> SMatrix<f64, N, N> {
    for i in 0..N {
        matrix[(i, i)] += damping * matrix[(i, i)];
    }
    matrix
}
