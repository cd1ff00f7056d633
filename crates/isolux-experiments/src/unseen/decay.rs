//! The paper's reference decay over distances and integration times that were not fitted on: how much of it a chain
//! leaves.

use std::collections::BTreeMap;

use isolux::{Frame, PixelFlags, Standardized, Stream, Window};
use isolux_camera::{Scene, Simulation};

use super::chains::Chain;
use super::held_out::{HeldOut, MEASURED, cropped};
use super::light;
use crate::error::ExperimentError;
use crate::measure::{WINDOW_PX, coefficient_of_variation, for_each};

/// Integration times, µs, and distances, m, between those of the calibration's sweep.
const TIMES_US: [f64; 6] = [700.0, 1500.0, 3000.0, 6000.0, 12_000.0, 20_000.0];
const DISTANCES_M: [f64; 12] = [0.33, 0.42, 0.53, 0.67, 0.77, 0.85, 0.95, 1.15, 1.45, 1.9, 2.3, 2.7];
/// A position counts where this share of the window has a value: less would be selected by its noise.
const LEAST_SHARE: f64 = 0.5;
/// Positions with less signal have no reliable distance: the rule by which the paper leaves out 0.2 ms.
const LEAST_SNR: f64 = 10.0;

/// Ambient light of the frames that are measured on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ambient {
    /// None.
    Dark,
    /// That of the calibration.
    Same,
    /// Three times that.
    Threefold,
}

impl Ambient {
    /// As a figure names it.
    pub(super) fn describe(self) -> &'static str {
        match self {
            Self::Dark => "in the dark",
            Self::Same => "in the light of the calibration",
            Self::Threefold => "in three times the light of the calibration",
        }
    }

    fn of_calibration(self) -> f64 {
        match self {
            Self::Dark => 0.0,
            Self::Same => 1.0,
            Self::Threefold => 3.0,
        }
    }
}

/// What a chain leaves of the decay.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Decay {
    /// Coefficient of variation of the window's means over all positions and times.
    pub cv: f64,
    /// Positions that entered: those that the chain gives a value.
    pub positions: usize,
    /// Positions with enough signal.
    pub of: usize,
}

impl Decay {
    /// Share of the positions that entered.
    #[must_use]
    pub fn share(&self) -> f64 {
        self.positions as f64 / self.of as f64
    }
}

/// A board before a held-out camera: every chain's decay, in their order.
///
/// # Errors
/// [`ExperimentError`], which no seed should bring about.
pub fn measure(
    held_out: &HeldOut,
    ambient: Ambient,
    chains: &[Chain],
) -> Result<Vec<Decay>, ExperimentError> {
    let mut scene = Scene::builtin("board-distances")?;
    scene.ambient *= ambient.of_calibration();
    for run in &mut scene.runs {
        run.integration_times_us = TIMES_US.to_vec();
        if let Some(approach) = &mut run.approach {
            approach.distances_m = DISTANCES_M.to_vec();
        }
    }
    let simulation = Simulation::new(cropped(&held_out.model), scene, MEASURED)?;
    let light = light::estimate(&held_out.from_amplitude, &simulation, light::poses(&simulation))?;
    let plan = |chain: &Chain| Ok::<Stream, ExperimentError>(chain.plan(held_out, light.as_ref())?.stream());
    let mut streams: Vec<Stream> = chains.iter().map(plan).collect::<Result<_, _>>()?;
    // Keyed by pose and time; for each chain the sum and number of the frames' means.
    let mut positions: BTreeMap<(usize, u64), Vec<[f64; 2]>> = BTreeMap::new();
    for_each(&simulation, |index, simulated| {
        let frame = &simulated.frame;
        let window = Window::centred(frame.shape(), WINDOW_PX);
        if snr(frame, window) < LEAST_SNR {
            return Ok(());
        }
        let planned = simulation.frames()[index];
        let key = (planned.pose, planned.integration_time_us.to_bits());
        let sums = positions.entry(key).or_insert_with(|| vec![[0.0; 2]; chains.len()]);
        for (stream, sum) in streams.iter_mut().zip(sums) {
            if let Some(mean) = mean(stream.push(frame)?, window) {
                (sum[0], sum[1]) = (sum[0] + mean, sum[1] + 1.0);
            }
        }
        Ok(())
    })?;
    let decay = |chain: usize| {
        let means: Vec<f64> = positions.values().map(|sums| sums[chain][0] / sums[chain][1]).collect();
        let positions = means.iter().filter(|mean| mean.is_finite()).count();
        let finite: Vec<f64> = means.iter().copied().filter(|mean| mean.is_finite()).collect();
        Decay { cv: coefficient_of_variation(&finite), positions, of: means.len() }
    };
    Ok((0..chains.len()).map(decay).collect())
}

fn mean(out: &Standardized, window: Window) -> Option<f64> {
    let pixels = window.indices(out.amplitude.shape()).count();
    let values = window.indices(out.amplitude.shape()).filter_map(|index| {
        let usable = !out.flags.values()[index].contains(PixelFlags::INVALID);
        usable.then(|| f64::from(out.amplitude.values()[index]))
    });
    let (sum, count) = values.fold((0.0, 0.0), |(sum, count), value| (sum + value, count + 1.0));
    (count >= LEAST_SHARE * pixels as f64).then_some(sum / count)
}

/// Mean over standard deviation in the window, where the board is uniform.
fn snr(frame: &Frame, window: Window) -> f64 {
    let values: Vec<f64> = window
        .indices(frame.shape())
        .filter(|&index| frame.is_valid(index))
        .map(|index| f64::from(frame.amplitude.values()[index]))
        .collect();
    1.0 / coefficient_of_variation(&values)
}
