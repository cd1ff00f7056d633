//! The fit of the well that all pixels share, of any channel: what it rests on, and how well it holds.

use super::error::ResponseError;
use super::full_well::FullWell;
use super::means::{PixelMeans, PixelSeries, plateau};
use super::solve::{Model, Point, Series, Solution, solve};
use crate::frame::phase::CLIPPED_SHARE;
use crate::numerics::statistics::median;
use crate::terms::{FitQuality, root_mean_square};

/// Relative standard deviation of W above which the sweep has not determined it.
const LARGEST_SD: f64 = 0.05;
/// Pixels whose values determine the well: more only take longer.
const PIXELS: usize = 200;
/// Integration times of each, evenly spread in ln t.
const TIMES: usize = 48;

/// The pixels and times that the fit rests on.
pub(super) fn thinned(pixels: &[PixelSeries]) -> Vec<PixelSeries> {
    let step = pixels.len().div_ceil(PIXELS).max(1);
    pixels.iter().step_by(step).map(|series| spread(series)).collect()
}

/// At most [`TIMES`] of a series, evenly spread in ln t, the first and the last among them.
fn spread(series: &[PixelMeans]) -> PixelSeries {
    let (Some(first), Some(last)) = (series.first(), series.last()) else { return Vec::new() };
    let (low, high) = (first.integration_time_us.ln(), last.integration_time_us.ln());
    let step = (high - low) / (TIMES - 1) as f64;
    let mut next = low;
    let mut kept = PixelSeries::new();
    for means in series {
        let place = means.integration_time_us.ln();
        if place >= next - 1e-9 {
            kept.push(*means);
            next = (next + step).max(place + 0.5 * step);
        }
    }
    kept
}

/// Fitted well, the limit above which it is not inverted, and how well it fits.
pub(super) struct Fitted {
    pub(super) well: FullWell,
    pub(super) clip_dn: Option<f64>,
    pub(super) largest_dn: f64,
    pub(super) fit: FitQuality,
}

/// A channel of which a well is fitted: R values per point, Q numbers of light per pixel.
pub(super) trait Channel<const R: usize, const Q: usize>: Model<R, Q> {
    /// The series of one pixel with a first guess of its light, from points that do not exceed `usable_dn`.
    fn series(&self, pixel: &[PixelMeans], start: &FullWell, usable_dn: f64) -> Vec<Series<R, Q>>;
    /// (time, value) of one pixel, of a value that stays at the clip level once the pixel is clipped, usable or not.
    fn clipping_values(&self, pixel: &[PixelMeans]) -> Vec<(f64, f64)>;
    /// (time, value) of one pixel, of the value that reaches the clip first.
    fn largest_values(&self, pixel: &[PixelMeans]) -> Vec<(f64, f64)>;
    /// (time, value) of one pixel, of a value that without light is the black level, where usable.
    fn plain_values(&self, pixel: &[PixelMeans]) -> Vec<(f64, f64)>;
    /// Linearised over linear amplitude or charge of a point, where that is more than a tenth of the well.
    fn proportion(&self, well: &FullWell, light: &[f64; Q], point: &Point<R>) -> Option<f64>;
}

/// Fits the well of `channel` to what `pixels` delivered.
pub(super) fn fit<const R: usize, const Q: usize, C: Channel<R, Q>>(
    channel: &C,
    pixels: &[PixelSeries],
) -> Result<Fitted, ResponseError> {
    const LEAST_TIMES: usize = 5;
    let pixels = thinned(pixels);
    let longest = pixels.iter().map(|p| channel.plain_values(p).len()).max().unwrap_or(0);
    if longest < LEAST_TIMES {
        return Err(ResponseError::TooFewTimes { found: longest, expected: LEAST_TIMES });
    }
    let black_level_dn = black_level(channel, &pixels);
    let above = |pixel: &PixelSeries| {
        let values = channel.clipping_values(pixel).into_iter();
        values.map(|(t, y)| (t, y - black_level_dn)).collect::<Vec<_>>()
    };
    let clip_dn = plateau(pixels.iter().map(above)).map(|clip| clip + black_level_dn);
    let usable_dn =
        clip_dn.map_or(f64::INFINITY, |clip| black_level_dn + CLIPPED_SHARE * (clip - black_level_dn));
    let usable = |pixel: &PixelSeries| pixel.iter().filter(|m| !m.unusable).copied().collect::<Vec<_>>();
    let values = pixels.iter().flat_map(|p| channel.largest_values(&usable(p))).map(|(_, y)| y);
    let top = values.filter(|y| *y < usable_dn).fold(f64::NEG_INFINITY, f64::max);
    let start = FullWell { full_well_dn: 1.05 * (top - black_level_dn), softness: 6.0, black_level_dn };
    if !(start.full_well_dn > 0.0 && start.full_well_dn.is_finite()) {
        return Err(ResponseError::NoCompression);
    }
    let mut series: Vec<Series<R, Q>> =
        pixels.iter().flat_map(|p| channel.series(p, &start, usable_dn)).collect();
    series.retain(|series| series.points.len() > Q);
    let solution = solve(&mut series, start, channel).ok_or(ResponseError::NoCompression)?;
    let Solution { well, relative_sd } = solution;
    if relative_sd > LARGEST_SD {
        return Err(ResponseError::NoCompression);
    }
    let points = series.iter().map(|s| s.points.len()).sum();
    let largest_dn = well.largest_dn(clip_dn).min(top.max(black_level_dn));
    let fit = FitQuality {
        points,
        residual: deviation(channel, &well, &series, |_| true).unwrap_or(0.0),
        held_out_residual: held_out(channel, &well, &series),
    };
    Ok(Fitted { well, clip_dn, largest_dn, fit })
}

/// Where the line through each pixel's two shortest times meets zero light; the median over the pixels.
fn black_level<const R: usize, const Q: usize, C: Channel<R, Q>>(channel: &C, pixels: &[PixelSeries]) -> f64 {
    let intercept = |pixel: &PixelSeries| match channel.plain_values(pixel).as_slice() {
        [(t0, y0), (t1, y1), ..] if t1 > t0 => Some((y0 * t1 - y1 * t0) / (t1 - t0)),
        _ => None,
    };
    let mut intercepts: Vec<f64> = pixels.iter().filter_map(intercept).filter(|y| y.is_finite()).collect();
    median(&mut intercepts).unwrap_or(0.0)
}

/// Root mean square of the relative deviation of the linearised values from proportion to time.
fn deviation<const R: usize, const Q: usize, C: Channel<R, Q>>(
    channel: &C,
    well: &FullWell,
    series: &[Series<R, Q>],
    wanted: impl Fn(usize) -> bool,
) -> Option<f64> {
    let of = |series: &Series<R, Q>| {
        let points = series.points.iter().enumerate().filter(|(i, _)| wanted(*i));
        let proportions = points.filter_map(|(_, point)| channel.proportion(well, &series.light, point));
        proportions.map(|p| p - 1.0).filter(|p| p.is_finite()).collect::<Vec<_>>()
    };
    root_mean_square(series.iter().flat_map(of))
}

/// The same at every second time, from a fit to the others.
fn held_out<const R: usize, const Q: usize, C: Channel<R, Q>>(
    channel: &C,
    start: &FullWell,
    series: &[Series<R, Q>],
) -> Option<f64> {
    let mut rest: Vec<Series<R, Q>> = series.to_vec();
    rest.iter_mut().for_each(|s| s.points = s.points.iter().step_by(2).copied().collect());
    let well = solve(&mut rest, *start, channel)?.well;
    let tested: Vec<Series<R, Q>> = series
        .iter()
        .zip(&rest)
        .filter(|(_, rest)| rest.points.len() > Q)
        .map(|(all, rest)| Series { points: all.points.clone(), light: rest.light })
        .collect();
    deviation(channel, &well, &tested, |index| index % 2 == 1)
}
