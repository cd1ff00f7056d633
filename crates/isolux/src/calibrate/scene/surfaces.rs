//! The surfaces of a scene, and every amplitude that was measured on each.

use nalgebra::Vector3;

use super::facets::Facet;
use super::rigid::Rigid;
use super::view::View;
use crate::numerics::hash::splitmix64;

/// Surfaces per frame that are followed from there on, where none are yet.
const SEEDS_PER_FRAME: usize = 1600;
/// Observations that are kept; beyond, every other surface is dropped.
const MOST_OBSERVATIONS: usize = 200_000;
/// The same surface lies within this many standard errors of where it was, and this share of the distance: what
/// the motion's error and a curved surface add.
const STANDARD_ERRORS: f64 = 4.0;
const TOLERANCE: f64 = 0.01;
/// Cosine of the largest angle between two normals of one surface; they are noisy.
pub(super) const SAME_NORMAL: f64 = 0.8;

/// Least error, m or rad: noise-free distances must not divide by 0.
const LEAST_ERROR: f64 = 1e-6;

/// A place on a surface.
#[derive(Clone, Debug)]
pub(super) struct Surface {
    /// Chooses which surfaces stay when there are too many.
    rank: u64,
    anchor_m: Vector3<f64>,
    normals: Vector3<f64>,
    normal_weight: f64,
    /// Mean distance of the observed planes from the anchor along the normal, and the sum of the weights.
    offset_m: f64,
    weight: f64,
}

/// One amplitude.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Sighting {
    pub(super) surface: u32,
    pub(super) frame: u32,
    pub(super) pixel: u32,
    pub(super) ln_amplitude: f32,
    /// Standard deviation of `ln_amplitude`.
    pub(super) sigma: f32,
    /// NaN where it is unknown.
    pub(super) integration_time_us: f64,
}

impl Surface {
    fn new(rank: u64, facet: &Facet, pose: &Rigid) -> Self {
        let mut surface = Self {
            rank,
            anchor_m: pose.point(&facet.point_m),
            normals: Vector3::zeros(),
            normal_weight: 0.0,
            offset_m: 0.0,
            weight: 0.0,
        };
        surface.learn(facet, pose);
        surface
    }

    /// Unit normal, away from the camera.
    pub(super) fn normal(&self) -> Vector3<f64> {
        self.normals.normalize()
    }

    pub(super) fn point_m(&self) -> Vector3<f64> {
        self.anchor_m + self.normal() * self.offset_m
    }

    /// Standard error of the point along the normal, metres.
    pub(super) fn error_m(&self) -> f64 {
        self.weight.sqrt().recip()
    }

    /// Standard error of the normal about either axis, rad.
    pub(super) fn normal_error(&self) -> f64 {
        self.normal_weight.sqrt().recip()
    }

    /// Means weighted by the inverse variances.
    fn learn(&mut self, facet: &Facet, pose: &Rigid) {
        let weight = 1.0 / facet.normal_error.max(LEAST_ERROR).powi(2);
        self.normals += weight * (pose.rotation * facet.normal);
        self.normal_weight += weight;
        let offset = self.normal().dot(&(pose.point(&facet.point_m) - self.anchor_m));
        let weight = 1.0 / facet.error_m.max(LEAST_ERROR).powi(2);
        self.weight += weight;
        self.offset_m += (offset - self.offset_m) * weight / self.weight;
    }
}

/// All of them.
#[derive(Clone, Debug, Default)]
pub(super) struct Surfaces {
    pub(super) surfaces: Vec<Surface>,
    pub(super) sightings: Vec<Sighting>,
    seeded: u64,
    /// Ranks below `u64::MAX >> halvings` stay.
    halvings: u32,
}

impl Surfaces {
    /// Takes in what a view from `pose` (world from camera) sees: known surfaces first, then new ones where none are
    /// known.
    pub(super) fn observe(&mut self, view: &View, pose: &Rigid, frame: u32) {
        let shape = view.shape();
        let cell = (((shape.pixels() / SEEDS_PER_FRAME) as f64).sqrt() as usize).max(1);
        let columns = shape.width.div_ceil(cell);
        let mut taken = vec![false; columns * shape.height.div_ceil(cell)];
        let cell_of = |pixel: usize| {
            let (row, column) = shape.place(pixel);
            row / cell * columns + column / cell
        };
        let camera = pose.inverse();
        for (number, surface) in (0u32..).zip(&mut self.surfaces) {
            let Some(pixel) = view.pixel_of(&camera.point(&surface.point_m())) else { continue };
            taken[cell_of(pixel)] = true;
            if let Some(sighting) = look(view, pose, surface, pixel) {
                self.sightings.push(Sighting { surface: number, frame, ..sighting });
            }
        }
        for (cell_number, _) in taken.iter().enumerate().filter(|(_, taken)| !**taken) {
            let rank = splitmix64(self.seeded);
            self.seeded += 1;
            let row = cell_number / columns * cell + rank as usize % cell;
            let column = cell_number % columns * cell + (rank >> 16) as usize % cell;
            if row < shape.height && column < shape.width {
                self.seed(view, pose, frame, row * shape.width + column, rank);
            }
        }
        if self.sightings.len() > MOST_OBSERVATIONS {
            self.thin_out();
        }
    }

    fn seed(&mut self, view: &View, pose: &Rigid, frame: u32, pixel: usize, rank: u64) {
        let Some(facet) = view.facet(pixel).filter(|_| rank <= u64::MAX >> self.halvings) else { return };
        let Some((ln_amplitude, sigma)) = view.ln_amplitude(pixel).filter(|_| view.is_plain(pixel)) else {
            return;
        };
        let surface = Surface::new(rank, facet, pose);
        let sighting = Sighting {
            surface: self.surfaces.len() as u32,
            frame,
            pixel: pixel as u32,
            ln_amplitude: ln_amplitude as f32,
            sigma: sigma as f32,
            integration_time_us: view.integration_time_us(pixel),
        };
        self.surfaces.push(surface);
        self.sightings.push(sighting);
    }

    /// Drops every other surface, those of the higher ranks: memory stays bounded, whatever the length.
    fn thin_out(&mut self) {
        self.halvings += 1;
        let limit = u64::MAX >> self.halvings;
        let mut numbers = Vec::with_capacity(self.surfaces.len());
        let mut next = 0;
        for surface in &self.surfaces {
            let stays = surface.rank <= limit;
            numbers.push(stays.then_some(next));
            next += u32::from(stays);
        }
        self.surfaces.retain(|surface| surface.rank <= limit);
        self.sightings.retain_mut(|sighting| {
            let number = numbers[sighting.surface as usize];
            sighting.surface = number.unwrap_or(0);
            number.is_some()
        });
    }
}

/// The sighting of a surface at the pixel where it should be; `None` where something else is.
fn look(view: &View, pose: &Rigid, surface: &mut Surface, pixel: usize) -> Option<Sighting> {
    let facet = view.facet(pixel)?;
    let (ln_amplitude, sigma) = view.ln_amplitude(pixel)?;
    let (point_m, normal) = (pose.point(&facet.point_m), pose.rotation * facet.normal);
    let away_m = surface.normal().dot(&(point_m - surface.point_m())).abs();
    let tolerance_m =
        STANDARD_ERRORS * facet.error_m.hypot(surface.error_m()) + TOLERANCE * facet.point_m.norm();
    if away_m > tolerance_m || normal.dot(&surface.normal()) < SAME_NORMAL {
        return None;
    }
    surface.learn(facet, pose);
    let (ln_amplitude, sigma) = (ln_amplitude as f32, sigma as f32);
    let integration_time_us = view.integration_time_us(pixel);
    Some(Sighting { surface: 0, frame: 0, pixel: pixel as u32, ln_amplitude, sigma, integration_time_us })
}
