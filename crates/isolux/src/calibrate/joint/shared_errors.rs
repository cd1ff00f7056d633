//! Covariance of the coefficients where the observations of one frame share errors.
//!
//! The windows of a board in one frame have the errors of one pose, and facets of one frame those of one motion. They
//! do not average out over the frame, so that errors that are taken to be independent promise too much. The frames are
//! left out in turn instead (the jackknife by clusters, CV3 of MacKinnon, Nielsen and Webb 2023, "Fast and reliable
//! jackknife and bootstrap methods for cluster-robust inference"), which needs no refit: with the Gram matrix H of all
//! observations and the prior, the part G_c of a cluster and its scores s_c, the coefficients move by
//! `δ_c = (H − G_c)⁻¹ s_c`. The prior is not an observation: what it bends, by its own account, is added.

use nalgebra::{DMatrix, DVector};

use super::problem::Problem;
use super::robust::Robust;
use crate::numerics::robust::Loss;

/// More frames than this are joined, consecutive ones, which are alike, into as many clusters.
const MOST_CLUSTERS: usize = 100;
/// Fewer frames tell nothing about what they share: their observations are taken to be independent.
const LEAST_CLUSTERS: usize = 10;
/// A surface whose other observations have less than this share of its weight goes with the cluster.
const NOTHING_LEFT: f64 = 1e-9;

/// What one cluster contributes.
#[derive(Clone)]
struct Cluster {
    /// G_c, lower triangle, row after row.
    gram: Vec<f64>,
    score: Vec<f64>,
}

/// The observations of one surface in one cluster.
struct Share {
    weight: f64,
    /// Weighted sum of the rows.
    row: Vec<f64>,
    residual: f64,
}

/// Covariance of the coefficients; `None` with too few frames, or where the arithmetic fails.
pub(super) fn covariance(problem: &Problem, robust: &Robust) -> Option<DMatrix<f64>> {
    let (count, cluster_of) = clusters(problem, &robust.weights);
    if count < LEAST_CLUSTERS {
        return None;
    }
    let efficiency = efficiency(problem, robust);
    let prior = problem.columns.prior() * (robust.sigma * robust.sigma);
    let system = &robust.normal.gram * efficiency + &prior;
    let mut squares = DMatrix::zeros(system.nrows(), system.ncols());
    for cluster in contributions(problem, robust, count, &cluster_of) {
        let mut gram = DMatrix::from_row_slice(system.nrows(), system.ncols(), &cluster.gram);
        gram.fill_upper_triangle_with_lower_triangle();
        let moved = (&system - gram * efficiency).cholesky()?.solve(&DVector::from_vec(cluster.score));
        squares.ger((count - 1) as f64 / count as f64, &moved, &moved, 1.0);
    }
    let inverse = system.cholesky()?.inverse();
    // σ⁴ H⁻¹ P H⁻¹: the coefficients' prior deviations, as far as the observations leave them.
    Some(squares + &inverse * prior * (robust.sigma * robust.sigma) * inverse)
}

/// Number of clusters, and that of each observation, by its frame. Frames without weight do not count.
fn clusters(problem: &Problem, weights: &[f64]) -> (usize, Vec<usize>) {
    let weighted = problem.observations.iter().zip(weights).filter(|(_, weight)| **weight > 0.0);
    let mut frames: Vec<u32> = weighted.map(|(observation, _)| observation.frame).collect();
    frames.sort_unstable();
    frames.dedup();
    let per_cluster = frames.len().div_ceil(MOST_CLUSTERS).max(1);
    let cluster = |frame: u32| frames.partition_point(|other| *other < frame) / per_cluster;
    let cluster_of = problem.observations.iter().map(|observation| cluster(observation.frame)).collect();
    (frames.len().div_ceil(per_cluster), cluster_of)
}

/// By how much less the robust weights hold a coefficient than least squares with these weights would: the sum of the
/// derivatives of residual × weight over that of the weights.
fn efficiency(problem: &Problem, robust: &Robust) -> f64 {
    let (mut slopes, mut weights) = (0.0, 0.0);
    for ((observation, residual), weight) in
        problem.observations.iter().zip(&robust.residuals).zip(&robust.weights)
    {
        let given = f64::from(observation.weight);
        if residual.is_finite() {
            slopes += given * Loss::Tukey.derivative(residual * given.sqrt() / robust.sigma);
            weights += weight;
        }
    }
    // Far from normal errors, the derivatives' sum may lose its sign; the weights' never does.
    if slopes > 0.0 { slopes / weights } else { 1.0 }
}

fn contributions(problem: &Problem, robust: &Robust, count: usize, cluster_of: &[usize]) -> Vec<Cluster> {
    let unknowns = problem.columns.len;
    let empty = Cluster { gram: vec![0.0; unknowns * unknowns], score: vec![0.0; unknowns] };
    let mut clusters = vec![empty; count];
    for group in problem.groups() {
        let mut members: Vec<usize> = group.filter(|&index| robust.weights[index] > 0.0).collect();
        members.sort_by_key(|&index| cluster_of[index]);
        let shares: Vec<(usize, Share)> = members
            .chunk_by(|a, b| cluster_of[*a] == cluster_of[*b])
            .map(|members| {
                let cluster = cluster_of[members[0]];
                (cluster, take(problem, robust, members, &mut clusters[cluster]))
            })
            .collect();
        let total: f64 = shares.iter().map(|(_, share)| share.weight).sum();
        let mean: Vec<f64> = (0..unknowns)
            .map(|i| shares.iter().map(|(_, share)| share.row[i]).sum::<f64>() / total)
            .collect();
        for (cluster, share) in shares {
            clusters[cluster].level(&share, &mean, total);
        }
    }
    clusters
}

/// Adds the rows of one surface in one cluster to its sums, the surface's level aside.
fn take(problem: &Problem, robust: &Robust, members: &[usize], cluster: &mut Cluster) -> Share {
    let unknowns = problem.columns.len;
    let mut share = Share { weight: 0.0, row: vec![0.0; unknowns], residual: 0.0 };
    for &index in members {
        let (row, weight) = (problem.columns.row(&problem.observations[index]), robust.weights[index]);
        let (columns, values) = row.parts();
        for (i, (&column, value)) in columns.iter().zip(values).enumerate() {
            let scaled = weight * value;
            share.row[column] += scaled;
            cluster.score[column] += scaled * robust.residuals[index];
            let line = &mut cluster.gram[column * unknowns..][..unknowns];
            for (&other, value) in columns[..=i].iter().zip(values) {
                line[other] += scaled * value;
            }
        }
        share.weight += weight;
        share.residual += weight * robust.residuals[index];
    }
    share
}

impl Cluster {
    /// Takes account of the surface's level, whose mean changes when the cluster is left out: with W and x̄ of the
    /// surface, W_c and x̄_c of its share, `G_c −= W_c x̄_c x̄_cᵀ − W_c W/(W − W_c) (x̄_c − x̄)(x̄_c − x̄)ᵀ`.
    fn level(&mut self, share: &Share, mean: &[f64], total: f64) {
        let unknowns = mean.len();
        let left = total - share.weight;
        let goes = left <= NOTHING_LEFT * total;
        let factor = if goes { 0.0 } else { share.weight * total / left };
        let of_share: Vec<f64> = share.row.iter().map(|sum| sum / share.weight).collect();
        let apart: Vec<f64> = of_share.iter().zip(mean).map(|(share, mean)| share - mean).collect();
        let residual = if goes { 0.0 } else { share.residual * share.weight / left };
        // A surface is seen in some frames only: most levels of frames have no part in it.
        let seen: Vec<usize> = (0..unknowns).filter(|&i| of_share[i] != 0.0 || mean[i] != 0.0).collect();
        for (count, &i) in seen.iter().enumerate() {
            self.score[i] += residual * apart[i] - share.residual * mean[i];
            let line = &mut self.gram[i * unknowns..][..=i];
            let (own, away) = (share.weight * of_share[i], factor * apart[i]);
            seen[..=count].iter().for_each(|&j| line[j] += away * apart[j] - own * of_share[j]);
        }
    }
}
