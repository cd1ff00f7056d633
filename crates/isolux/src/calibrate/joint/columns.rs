//! The order of the unknowns, and the row of the design matrix that belongs to an observation.

use std::ops::Range;

use nalgebra::DMatrix;

use super::model::{AngleModel, JointModel, LAW_CURVATURE, Observation, PROFILE_CURVATURE};
use crate::numerics::bspline::Basis;
use crate::terms::profile::{RADIAL, Surface};
use crate::terms::spline::Harmonic;

/// Equal intervals of ln d between the observed ends; the prior makes the law smooth, not their number.
const INTERVALS: usize = 12;
/// Most columns of one observation: time, spline, harmonic, profile, angle.
const LONGEST: usize = 1 + 4 + 2 + RADIAL + 16 + 1;
/// Standard deviation of the prior of every coefficient, in ln. It makes the solution unique where the observations
/// do not, and is so wide that the factor's predicted error then shows it.
const COEFFICIENT_SD: f64 = 10.0;

/// Which columns belong to which factor.
#[derive(Clone, Debug)]
pub(super) struct Columns {
    pub(super) times: Range<usize>,
    pub(super) law: Range<usize>,
    pub(super) harmonic: Range<usize>,
    pub(super) radial: Range<usize>,
    pub(super) tensor: Range<usize>,
    pub(super) angle: Range<usize>,
    pub(super) len: usize,
    /// ln of the observed distances' ends, and the B-splines between.
    pub(super) distance: Option<([f64; 2], Basis)>,
    pub(super) surface: Option<Surface>,
    pub(super) model: JointModel,
}

/// The values of one observation, at increasing columns.
#[derive(Clone, Copy, Debug)]
pub(super) struct Row {
    columns: [usize; LONGEST],
    values: [f64; LONGEST],
    len: usize,
}

impl Row {
    fn new() -> Self {
        Self { columns: [0; LONGEST], values: [0.0; LONGEST], len: 0 }
    }

    fn push(&mut self, first: usize, values: &[f64]) {
        for (offset, &value) in values.iter().enumerate() {
            self.columns[self.len] = first + offset;
            self.values[self.len] = value;
            self.len += 1;
        }
    }

    pub(super) fn entries(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        self.columns[..self.len].iter().copied().zip(self.values[..self.len].iter().copied())
    }

    pub(super) fn parts(&self) -> (&[usize], &[f64]) {
        (&self.columns[..self.len], &self.values[..self.len])
    }

    pub(super) fn dot(&self, coefficients: &[f64]) -> f64 {
        self.entries().map(|(column, value)| value * coefficients[column]).sum()
    }
}

impl Columns {
    /// `range_m`: the observed distances.
    pub(super) fn new(model: &JointModel, range_m: [f64; 2]) -> Self {
        let mut next = 0;
        let mut take = |count: usize| {
            next += count;
            next - count..next
        };
        let times = take(model.time.map_or(0, |time| time.count));
        let ends = range_m.map(f64::ln);
        let distance = model.distance.map(|_| (ends, Basis::new(ends[0], ends[1], INTERVALS)));
        let law = take(distance.map_or(0, |(_, basis)| basis.len()));
        let frequency_hz = model.distance.and_then(|distance| distance.modulation_frequency_hz);
        let harmonic = take(frequency_hz.map_or(0, |_| 2));
        let surface = model.profile.map(|places| Surface::new(&places));
        let radial = take(surface.map_or(0, |_| RADIAL));
        let tensor = take(surface.map_or(0, |_| Surface::TENSOR_LEN));
        let angle = take(usize::from(model.angle == AngleModel::Free));
        let len = angle.end;
        Self { times, law, harmonic, radial, tensor, angle, len, distance, surface, model: *model }
    }

    /// The row of one observation.
    pub(super) fn row(&self, observation: &Observation) -> Row {
        let mut row = Row::new();
        if !self.times.is_empty() {
            row.push(usize::from(observation.time), &[1.0]);
        }
        self.push_distance(f64::from(observation.distance_m), &mut row);
        self.push_place(observation.place.map(f64::from), &mut row);
        if !self.angle.is_empty() {
            row.push(self.angle.start, &[f64::from(observation.cosine).ln()]);
        }
        row
    }

    /// The law at one distance (m), without its slope of −2.
    pub(super) fn at_distance(&self, distance_m: f64) -> Row {
        let mut row = Row::new();
        self.push_distance(distance_m, &mut row);
        row
    }

    /// The profile at one place.
    pub(super) fn at_place(&self, place: [f64; 2]) -> Row {
        let mut row = Row::new();
        self.push_place(place, &mut row);
        row
    }

    fn push_distance(&self, distance_m: f64, row: &mut Row) {
        let Some(([start, end], basis)) = self.distance else { return };
        let ln_distance = distance_m.ln().clamp(start, end);
        let (first, values) = basis.at(ln_distance);
        row.push(self.law.start + first, &values);
        if let Some(frequency_hz) = self.model.distance.and_then(|law| law.modulation_frequency_hz) {
            row.push(self.harmonic.start, &Harmonic::columns(frequency_hz, ln_distance.exp()));
        }
    }

    fn push_place(&self, place: [f64; 2], row: &mut Row) {
        let Some(surface) = &self.surface else { return };
        let values = surface.row(place);
        row.push(self.radial.start, &values.radial);
        for (first, block) in values.blocks {
            row.push(self.tensor.start + first, &block);
        }
    }

    /// The part of an observation's ln A that does not depend on the unknowns.
    pub(super) fn known(&self, observation: &Observation) -> f64 {
        let law = self
            .model
            .distance
            .map_or(0.0, |law| -2.0 * (f64::from(observation.distance_m) / law.reference_m).ln());
        let angle = match self.model.angle {
            AngleModel::Fixed(exponent) => exponent * f64::from(observation.cosine).ln(),
            AngleModel::Free | AngleModel::Absent => 0.0,
        };
        law + angle
    }

    /// The inverse covariance of the coefficients' prior.
    pub(super) fn prior(&self) -> DMatrix<f64> {
        let mut prior = DMatrix::from_diagonal_element(self.len, self.len, COEFFICIENT_SD.powi(-2));
        let smoothness = self.model.smoothness;
        let mut add = |range: &Range<usize>, curvature: DMatrix<f64>, sd: f64| {
            let size = (range.len(), range.len());
            let mut block = prior.view_mut((range.start, range.start), size);
            block += curvature * (smoothness / (sd * sd));
        };
        if let Some((_, basis)) = self.distance {
            add(&self.law, basis.curvature(), LAW_CURVATURE);
        }
        if let Some(surface) = &self.surface {
            add(&self.tensor, surface.curvature(), PROFILE_CURVATURE);
        }
        prior
    }
}
