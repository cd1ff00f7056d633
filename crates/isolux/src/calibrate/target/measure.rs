//! Measures one window of a label in one frame.

use super::patches::PATCH_PX;
use crate::frame::{Frame, IntegrationTime, PixelFlags, Plane, Shape};
use crate::numerics::statistics::{SIGMA_PER_MAD, median, median_absolute_deviation};

/// A window whose pixels scatter by more than this share of their median is faint beyond use, or uneven. Which of the
/// faint ones count is not decided by their own scatter, see [`super::noise`].
const LARGEST_SCATTER: f64 = 0.5;
/// Distances within a window may spread by this share of their median; more is an edge.
const LARGEST_SPREAD: f64 = 0.1;

/// Medians over one window of one frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct WindowMedians {
    pub(super) frame: u32,
    pub(super) label: u8,
    /// µs; NaN where it is unknown.
    pub(super) time_us: f32,
    pub(super) ln_amplitude: f32,
    /// m; NaN where the recording has none.
    pub(super) distance_m: f32,
    /// The median of its own distances, m, also where the label is flat and `distance_m` is that of its plane.
    pub(super) measured_m: f32,
    /// Row and column of the middle.
    pub(super) pixel: [u16; 2],
    /// NaN where it is not known.
    pub(super) cosine: f32,
    /// Robust standard deviation of ln A of its pixels.
    pub(super) scatter: f32,
    /// Pixels that were measured.
    pub(super) pixels: u8,
}

/// Indices of the window whose first pixel is at (row, column).
fn indices(shape: Shape, (row, column): (usize, usize)) -> impl Iterator<Item = usize> {
    let rows = row..row + PATCH_PX;
    rows.flat_map(move |row| (column..column + PATCH_PX).map(move |column| row * shape.width + column))
}

/// Medians over a window; `None` where it is saturated, faint, uneven in depth, or mostly without a measurement.
pub(super) fn measure(frame: &Frame, target: &Plane<u8>, corner: (usize, usize)) -> Option<WindowMedians> {
    const PIXELS: usize = PATCH_PX * PATCH_PX;
    let shape = frame.shape();
    let (mut logs, mut distances) = ([0.0; PIXELS], [0.0; PIXELS]);
    let (mut count, mut time_us) = (0, None);
    for index in indices(shape, corner) {
        if frame.flags.values()[index].intersects(PixelFlags::SATURATED) {
            return None;
        }
        let here_us = match &frame.integration_time_us {
            IntegrationTime::Unknown => f32::NAN,
            IntegrationTime::PerFrame(time_us) => *time_us as f32,
            IntegrationTime::PerPixel(map) => map.values()[index],
        };
        if *time_us.get_or_insert(here_us) != here_us && !here_us.is_nan() {
            return None;
        }
        let distance_m = frame.distance_m.as_ref().map_or(f32::NAN, |plane| plane.values()[index]);
        let measured = frame.distance_m.is_none() || (distance_m > 0.0 && distance_m < f32::INFINITY);
        let amplitude = frame.amplitude.values()[index];
        if frame.is_valid(index) && amplitude > 0.0 && measured {
            logs[count] = f64::from(amplitude).ln();
            distances[count] = f64::from(distance_m);
            count += 1;
        }
    }
    if count * 5 < PIXELS * 4 {
        return None;
    }
    let (ln_amplitude, scatter) = centre_and_scatter(&mut logs[..count])?;
    let (distance_m, distance_scatter) = centre_and_scatter(&mut distances[..count])?;
    if scatter > LARGEST_SCATTER || distance_scatter > LARGEST_SPREAD * distance_m {
        return None;
    }
    let middle = |start: usize| u16::try_from(start + PATCH_PX / 2).unwrap_or(u16::MAX);
    Some(WindowMedians {
        frame: 0,
        label: target.get(corner.0, corner.1)?,
        time_us: time_us.unwrap_or(f32::NAN),
        ln_amplitude: ln_amplitude as f32,
        distance_m: distance_m as f32,
        measured_m: distance_m as f32,
        pixel: [middle(corner.0), middle(corner.1)],
        cosine: f32::NAN,
        scatter: scatter as f32,
        pixels: count as u8,
    })
}

/// Median and 1.4826 MAD. NaN are kept out by the caller, but for distances that the recording lacks.
fn centre_and_scatter(values: &mut [f64]) -> Option<(f64, f64)> {
    let centre = median(values)?;
    let scatter = median_absolute_deviation(values)?;
    Some((centre, SIGMA_PER_MAD * scatter))
}

/// Median of the window's cosines; NaN where fewer than half of its pixels have one.
pub(super) fn middle_cosine(cosine: impl Fn(usize) -> f32, shape: Shape, corner: (usize, usize)) -> f32 {
    let mut known = [0.0; PATCH_PX * PATCH_PX];
    let mut count = 0;
    for cosine in indices(shape, corner).map(cosine).filter(|cosine| !cosine.is_nan()) {
        known[count] = f64::from(cosine);
        count += 1;
    }
    let enough = count * 2 >= PATCH_PX * PATCH_PX;
    let median = median(&mut known[..count]).filter(|_| enough);
    median.map_or(f32::NAN, |median| median as f32)
}
