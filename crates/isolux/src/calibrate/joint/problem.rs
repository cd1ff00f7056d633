//! The observations, surface by surface, and their normal equations without the surfaces' levels.

use nalgebra::{DMatrix, DVector};

use super::columns::Columns;
use super::model::{AngleModel, JointError, JointModel, Observation};

/// Largest number of integration times.
const MOST_TIMES: usize = 1024;
/// The observed distances are those between these quantiles: beyond them, the law goes on with its slope of −2.
const ENDS: [f64; 2] = [0.001, 0.999];

/// Least ratio of the ends: the splines need a range, even where there is only one distance.
const LEAST_RANGE: f64 = 1.05;

/// The usable observations, sorted by surface.
#[derive(Clone, Debug)]
pub(super) struct Problem {
    pub(super) columns: Columns,
    pub(super) observations: Vec<Observation>,
    /// Place of each of them in the caller's list.
    pub(super) numbers: Vec<u32>,
    /// Length of the caller's list.
    pub(super) given: usize,
    /// Where each surface starts, and the end of the last.
    starts: Vec<usize>,
}

/// Gram matrix and moments of weighted observations, less those of the surfaces' means.
#[derive(Clone, Debug)]
pub(super) struct Normal {
    pub(super) gram: DMatrix<f64>,
    pub(super) moment: DVector<f64>,
    /// Sum of the weights.
    pub(super) total: f64,
}

impl Problem {
    pub(super) fn new(observations: &[Observation], model: &JointModel) -> Result<Self, JointError> {
        check(model)?;
        let given = observations.len();
        let mut numbers: Vec<u32> = (0u32..)
            .zip(observations)
            .filter(|(_, observation)| is_usable(observation, model))
            .map(|(number, _)| number)
            .collect();
        let surface = |number: &u32| observations[*number as usize].surface;
        numbers.sort_by_key(surface);
        // A single observation of a surface only determines the surface's level.
        let mut repeated = Vec::with_capacity(numbers.len());
        for group in numbers.chunk_by(|a, b| surface(a) == surface(b)).filter(|group| group.len() > 1) {
            repeated.extend_from_slice(group);
        }
        let observations: Vec<Observation> = repeated.iter().map(|&n| observations[n as usize]).collect();
        let range_m = distance_range(&observations, model);
        let columns = Columns::new(model, range_m);
        let mut starts = vec![0];
        starts.extend(observations.chunk_by(|a, b| a.surface == b.surface).scan(0, |end, group| {
            *end += group.len();
            Some(*end)
        }));
        let problem = Self { columns, observations, numbers: repeated, given, starts };
        let expected = problem.columns.len + problem.surfaces();
        if problem.columns.len == 0 {
            let found = "no factor".to_owned();
            return Err(JointError::Model { found, expected: "at least one unknown factor" });
        }
        if problem.observations.len() < problem.surfaces() + 2 {
            return Err(JointError::TooFew { found: problem.observations.len(), expected });
        }
        Ok(problem)
    }

    pub(super) fn surfaces(&self) -> usize {
        self.starts.len() - 1
    }

    pub(super) fn groups(&self) -> impl Iterator<Item = std::ops::Range<usize>> + '_ {
        self.starts.windows(2).map(|ends| ends[0]..ends[1])
    }

    /// ln A, without the known part.
    fn response(&self, index: usize) -> f64 {
        let observation = &self.observations[index];
        f64::from(observation.ln_amplitude) - self.columns.known(observation)
    }

    /// The normal equations of these weights.
    pub(super) fn normal(&self, weights: &[f64]) -> Normal {
        let unknowns = self.columns.len;
        // Row-major lower triangle in one piece: the inner loop runs along it.
        let mut gram = vec![0.0; unknowns * unknowns];
        let (mut moment, mut total) = (vec![0.0; unknowns], 0.0);
        let mut sums = vec![0.0; unknowns];
        for group in self.groups() {
            sums.fill(0.0);
            let (mut weight_sum, mut response_sum) = (0.0, 0.0);
            for index in group.filter(|&index| weights[index] > 0.0) {
                let (row, weight) = (self.columns.row(&self.observations[index]), weights[index]);
                let response = weight * self.response(index);
                let (columns, values) = row.parts();
                for (i, (&column, value)) in columns.iter().zip(values).enumerate() {
                    let scaled = weight * value;
                    sums[column] += scaled;
                    moment[column] += value * response;
                    let line = &mut gram[column * unknowns..][..unknowns];
                    for (&other, value) in columns[..=i].iter().zip(values) {
                        line[other] += scaled * value;
                    }
                }
                weight_sum += weight;
                response_sum += response;
            }
            if weight_sum > 0.0 {
                eliminate(&mut gram, &mut moment, &sums, weight_sum, response_sum);
                total += weight_sum;
            }
        }
        let mut gram = DMatrix::from_row_slice(unknowns, unknowns, &gram);
        gram.fill_upper_triangle_with_lower_triangle();
        Normal { gram, moment: DVector::from_vec(moment), total }
    }

    /// Residual of each observation, without its surface's level; NaN where the surface has no weight.
    pub(super) fn residuals(&self, coefficients: &[f64], weights: &[f64], out: &mut Vec<f64>) {
        out.clear();
        for group in self.groups() {
            let start = out.len();
            let (mut sum, mut weight_sum) = (0.0, 0.0);
            for index in group {
                let row = self.columns.row(&self.observations[index]);
                let rest = self.response(index) - row.dot(coefficients);
                sum += weights[index] * rest;
                weight_sum += weights[index];
                out.push(rest);
            }
            let level = sum / weight_sum;
            out[start..].iter_mut().for_each(|rest| *rest -= level);
        }
    }
}

/// Removes a surface's mean: `G −= x̄ x̄ᵀ W`, `b −= x̄ ȳ W`.
fn eliminate(gram: &mut [f64], moment: &mut [f64], sums: &[f64], weight_sum: f64, response_sum: f64) {
    let unknowns = sums.len();
    // A surface is seen in some frames only: most levels of frames have no part in it.
    let seen: Vec<usize> = (0..unknowns).filter(|&i| sums[i] != 0.0).collect();
    for (count, &i) in seen.iter().enumerate() {
        let mean = sums[i] / weight_sum;
        moment[i] -= mean * response_sum;
        let line = &mut gram[i * unknowns..][..=i];
        seen[..=count].iter().for_each(|&j| line[j] -= mean * sums[j]);
    }
}

fn check(model: &JointModel) -> Result<(), JointError> {
    let refuse = |found: String, expected| Err(JointError::Model { found, expected });
    if let Some(time) = model.time
        && !((1..=MOST_TIMES).contains(&time.count) && time.reference < time.count)
    {
        return refuse(format!("{time:?}"), "1 to 1024 integration times, the reference among them");
    }
    if let Some(law) = model.distance {
        let fine = |value: f64| value > 0.0 && value.is_finite();
        if !fine(law.reference_m) || !law.modulation_frequency_hz.is_none_or(fine) {
            return refuse(format!("{law:?}"), "a positive reference distance and modulation frequency");
        }
    }
    if !(model.smoothness > 0.0 && model.smoothness.is_finite()) {
        return refuse(format!("smoothness {}", model.smoothness), "a positive factor");
    }
    match model.angle {
        AngleModel::Fixed(k) if !k.is_finite() => refuse(format!("k = {k}"), "a finite exponent"),
        _ => Ok(()),
    }
}

fn is_usable(observation: &Observation, model: &JointModel) -> bool {
    let positive = |value: f32| value > 0.0 && value < f32::INFINITY;
    let place = observation.place.iter().all(|value| value.abs() <= 10.0);
    observation.ln_amplitude.is_finite()
        && (observation.weight >= 0.0 && observation.weight < f32::INFINITY)
        && model.time.is_none_or(|time| usize::from(observation.time) < time.count)
        && (model.distance.is_none() || positive(observation.distance_m))
        && (model.profile.is_none() || place)
        && (model.angle == AngleModel::Absent || (observation.cosine > 0.0 && observation.cosine <= 1.0))
}

/// Ends of the observed distances, m.
fn distance_range(observations: &[Observation], model: &JointModel) -> [f64; 2] {
    if model.distance.is_none() || observations.is_empty() {
        return [1.0, 2.0];
    }
    let mut distances: Vec<f32> = observations.iter().map(|observation| observation.distance_m).collect();
    let last = (distances.len() - 1) as f64;
    let [near, far] = ENDS.map(|share| {
        let rank = (share * last).round() as usize;
        f64::from(*distances.select_nth_unstable_by(rank, f32::total_cmp).1)
    });
    [near, far.max(near * LEAST_RANGE)]
}
