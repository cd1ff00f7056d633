//! The surfaces that one frame shows.

use nalgebra::Vector3;

use super::facets::{self, Depth, Facet};
use super::scatter::Scatter;
use crate::frame::{Frame, IntegrationTime, Lens, PixelFlags, PixelRays, Shape};
use crate::numerics::statistics::{SIGMA_PER_MAD, median, quantile};

/// A distance that leaves the median of its neighbours by more than this many standard deviations is dropped: a flying
/// pixel, a wrapped one.
const SPIKE: f64 = 5.0;
/// Windows, widest first: pixels to each side, and the scatter, relative to what is usual in the frame, beyond
/// which the window holds an edge or a crease. The wide one tells a normal from noise, the narrow one suits furniture.
const WINDOWS: [(usize, f64); 3] = [(14, 1.06), (7, 1.15), (3, 1.4)];
/// Distances that scatter by more than this share of themselves are too dim to place a surface.
const LARGEST_SCATTER: f64 = 0.06;
/// Distances without noise still change from pixel to pixel.
const LEAST_SCATTER: f64 = 1e-5;
/// Surfaces at a lower cosine are not used: their amplitude depends mostly on the angle.
pub(super) const LEAST_COSINE: f64 = 0.2;
/// Amplitudes around a pixel that scatter by more than this, relative to what is usual, are a texture's.
const TEXTURE: f64 = 1.8;
/// Half the side of the window that must be free of texture, less a half.
const PLAIN_RADIUS: usize = 2;
/// Quantiles between which that window's scatter is taken, and how many σ of a normal distribution they span: two of
/// ten pixels may be outliers.
const PLAIN_QUANTILES: ([f64; 2], f64) = ([0.2, 0.8], 1.683_242_467);

/// One frame, surface by surface.
#[derive(Clone, Debug)]
pub(super) struct View {
    shape: Shape,
    lens: Lens,
    /// NaN where there is no amplitude to use.
    ln_amplitude: Vec<f64>,
    /// Median of each pixel and its neighbours: what its noise follows from. Its own amplitude would not do, since a
    /// weight that grows with the noise bends every mean.
    usual_ln_amplitude: Vec<f64>,
    /// Only those that may be used.
    facets: Vec<Option<Facet>>,
    amplitude_scatter: Scatter,
    integration_time_us: IntegrationTime,
}

impl View {
    /// `None` when the frame has too few pixels with amplitude and distance.
    pub(super) fn new(frame: &Frame, lens: &Lens, rays: &PixelRays) -> Option<Self> {
        let shape = frame.shape();
        let distances_m = frame.distance_m.as_ref()?.values();
        let ln_amplitude: Vec<f64> = (0..shape.pixels())
            .map(|index| if is_usable(frame, index) { ln(frame.amplitude.values()[index]) } else { f64::NAN })
            .collect();
        let inverse_depth = inverse_depth(frame, distances_m, rays);
        let usual_ln_amplitude: Vec<f64> =
            (0..shape.pixels()).map(|index| middle(&ln_amplitude, shape, index)).collect();
        let depths = depths(&inverse_depth, &usual_ln_amplitude, shape)?;
        let fits = WINDOWS.map(|(radius, _)| facets::fit(&depths, shape, rays, radius));
        let facets = choose(&fits, &ln_amplitude, &depths)?;
        let second = |index: &usize| index % shape.width >= 2;
        let differences = (2..shape.pixels()).filter(second).map(|index| {
            let [a, b, c] = [0, 1, 2].map(|back| ln_amplitude[index - back]);
            (usual_ln_amplitude[index - 1], (a - 2.0 * b + c).abs() * SIGMA_PER_MAD / 6f64.sqrt())
        });
        let amplitude_scatter = Scatter::measure(differences)?;
        let integration_time_us = frame.integration_time_us.clone();
        let lens = lens.clone();
        Some(Self {
            shape,
            lens,
            ln_amplitude,
            usual_ln_amplitude,
            facets,
            amplitude_scatter,
            integration_time_us,
        })
    }

    /// Integration time of a pixel, µs; NaN where it is unknown.
    pub(super) fn integration_time_us(&self, pixel: usize) -> f64 {
        match &self.integration_time_us {
            IntegrationTime::Unknown => f64::NAN,
            IntegrationTime::PerFrame(time_us) => *time_us,
            IntegrationTime::PerPixel(times_us) => f64::from(times_us.values()[pixel]),
        }
    }

    pub(super) fn shape(&self) -> Shape {
        self.shape
    }

    /// The pixel that sees a point in camera coordinates.
    pub(super) fn pixel_of(&self, point_m: &Vector3<f64>) -> Option<usize> {
        let [row, column] = self.lens.project(self.shape, (*point_m).into())?.map(f64::round);
        let inside = (0.0..self.shape.height as f64).contains(&row)
            && (0.0..self.shape.width as f64).contains(&column);
        inside.then(|| row as usize * self.shape.width + column as usize)
    }

    /// The surface at a pixel, where it may be used.
    pub(super) fn facet(&self, pixel: usize) -> Option<&Facet> {
        self.facets[pixel].as_ref()
    }

    /// ln of the amplitude (DN), and its standard deviation; `None` where there is none to use.
    pub(super) fn ln_amplitude(&self, pixel: usize) -> Option<(f64, f64)> {
        let value = self.ln_amplitude[pixel];
        value.is_finite().then(|| (value, self.amplitude_scatter.at(self.usual_ln_amplitude[pixel])))
    }

    /// True where the surroundings of a pixel have one reflectivity: there, half a pixel does not matter.
    pub(super) fn is_plain(&self, pixel: usize) -> bool {
        let (row, column) = self.shape.place(pixel);
        let inside = |at: usize, size: usize| at >= PLAIN_RADIUS && at + PLAIN_RADIUS < size;
        if !inside(row, self.shape.height) || !inside(column, self.shape.width) {
            return false;
        }
        let mut values = Vec::with_capacity((2 * PLAIN_RADIUS + 1).pow(2));
        for row in row - PLAIN_RADIUS..=row + PLAIN_RADIUS {
            let start = row * self.shape.width + column - PLAIN_RADIUS;
            values.extend_from_slice(&self.ln_amplitude[start..=start + 2 * PLAIN_RADIUS]);
        }
        let ([low, high], sigmas) = PLAIN_QUANTILES;
        let all = values.iter().all(|value| value.is_finite());
        let ends = quantile(&mut values, low).zip(quantile(&mut values, high));
        ends.is_some_and(|(low, high)| {
            let usual = self.amplitude_scatter.at(0.5 * (low + high));
            all && high - low <= TEXTURE * sigmas * usual.max(LEAST_TEXTURE)
        })
    }
}

/// Inverse depth in the axes of a pinhole, inverse distance for any other lens, 1/m; NaN where there is none.
fn inverse_depth(frame: &Frame, distances_m: &[f32], rays: &PixelRays) -> Vec<f64> {
    let fine =
        |index: usize, distance_m: f32| frame.is_valid(index) && distance_m > 0.0 && distance_m.is_finite();
    let measured = distances_m.iter().enumerate();
    match rays {
        PixelRays::Pinhole(pinhole) => {
            let depth_per_m = pinhole.radial_per_depth(frame.shape());
            let inverse = |(index, &distance_m): (usize, &f32)| {
                let ratio = f64::from(depth_per_m.values()[index]);
                if fine(index, distance_m) { ratio / f64::from(distance_m) } else { f64::NAN }
            };
            measured.map(inverse).collect()
        }
        PixelRays::Table(table) => {
            let inverse = |((index, &distance_m), ray): ((usize, &f32), &[f64; 3])| {
                let seen = fine(index, distance_m) && !ray[0].is_nan();
                if seen { 1.0 / f64::from(distance_m) } else { f64::NAN }
            };
            measured.zip(table.unit()).map(inverse).collect()
        }
    }
}

/// Noise-free amplitudes still change from pixel to pixel, with distance and profile.
const LEAST_TEXTURE: f64 = 0.01;

fn ln(amplitude: f32) -> f64 {
    f64::from(amplitude).ln()
}

/// Valid, neither dim nor saturated, nor beside a saturated pixel: light spills over.
fn is_usable(frame: &Frame, index: usize) -> bool {
    let shape = frame.shape();
    let bad = PixelFlags::INVALID | PixelFlags::LOW_SIGNAL;
    let (row, column) = shape.place(index);
    let near = |at: usize, size: usize| at.saturating_sub(1)..(at + 2).min(size);
    let saturated = near(row, shape.height).any(|row| {
        near(column, shape.width)
            .any(|column| frame.flags.values()[row * shape.width + column].contains(PixelFlags::SATURATED))
    });
    !saturated && !frame.flags.values()[index].intersects(bad)
}

/// Median of the valid values among a pixel and its eight neighbours; NaN where there are none.
fn middle(values: &[f64], shape: Shape, index: usize) -> f64 {
    let (row, column) = shape.place(index);
    let (mut around, mut count) = ([0.0; 9], 0);
    for row in row.saturating_sub(1)..(row + 2).min(shape.height) {
        for column in column.saturating_sub(1)..(column + 2).min(shape.width) {
            let value = values[row * shape.width + column];
            if value.is_finite() {
                around[count] = value;
                count += 1;
            }
        }
    }
    median(&mut around[..count]).unwrap_or(f64::NAN)
}

/// Inverse depths with weights by their amplitude. The deviations from the median of the neighbours show how much
/// dim pixels scatter, and which pixels are spikes.
fn depths(inverse_depth: &[f64], usual_ln_amplitude: &[f64], shape: Shape) -> Option<Vec<Depth>> {
    let deviation = |index: usize| (inverse_depth[index] / middle(inverse_depth, shape, index) - 1.0).abs();
    let deviations: Vec<f64> = (0..shape.pixels()).map(deviation).collect();
    let pairs = usual_ln_amplitude.iter().zip(&deviations).filter(|(ln, _)| ln.is_finite());
    let scatter = Scatter::measure(pairs.map(|(ln, deviation)| (*ln, SIGMA_PER_MAD * deviation)))?;
    let depth = |((&inverse, &ln_amplitude), deviation): ((&f64, &f64), f64)| {
        let sigma = scatter.at(ln_amplitude).max(LEAST_SCATTER);
        let fine = inverse > 0.0 && deviation <= SPIKE * sigma && sigma <= LARGEST_SCATTER;
        Depth { inverse, weight: if fine { (sigma * inverse).powi(-2) } else { 0.0 } }
    };
    Some(inverse_depth.iter().zip(usual_ln_amplitude).zip(deviations).map(depth).collect())
}

/// The widest facet of each pixel that holds no edge; none without an amplitude, and none that grazes.
fn choose(
    fits: &[Vec<Option<Facet>>; 3],
    ln_amplitude: &[f64],
    depths: &[Depth],
) -> Option<Vec<Option<Facet>>> {
    let [_, _, narrow] = fits;
    let mut scatters: Vec<f64> = narrow.iter().flatten().map(|facet| facet.scatter).collect();
    let usual = median(&mut scatters)?;
    let facet = |(index, ln_amplitude): (usize, &f64)| {
        let there = ln_amplitude.is_finite() && depths[index].weight > 0.0;
        fits.iter().zip(WINDOWS).filter(|_| there).find_map(|(facets, (_, edge))| {
            facets[index].filter(|facet| {
                let cosine = facet.normal.dot(&facet.point_m) / facet.point_m.norm();
                facet.scatter <= edge * usual && cosine >= LEAST_COSINE
            })
        })
    };
    Some(ln_amplitude.iter().enumerate().map(facet).collect())
}
