//! Frames of one integration time, one after the other, form a run; runs are compared, not frames.

use crate::frame::IntegrationTime;
use crate::numerics::statistics::Moments;

use super::input::Times;
use super::outcome::Unavailable;

/// The runs of one quantity (a pixel, or a figure of the whole image): averaged within, moments between.
///
/// The mean within a run removes most of the frame noise, which is no dependence on exposure. Every run weighs
/// the same, whatever its length.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Runs {
    time_us: f32,
    first_time_us: f32,
    frames: u32,
    observations: u32,
    sum: f64,
    closed: Moments,
    varies: bool,
}

impl Runs {
    /// Takes in the next value, seen at `time_us` (known, i.e. > 0).
    pub(super) fn push(&mut self, value: f64, time_us: f32, same_time_ratio: f64) {
        if self.frames == 0 {
            (self.time_us, self.first_time_us) = (time_us, time_us);
        } else if !IntegrationTime::same(time_us, self.time_us, same_time_ratio) {
            self.closed.push(self.sum / f64::from(self.frames));
            (self.time_us, self.frames, self.sum) = (time_us, 0, 0.0);
            self.varies |= !IntegrationTime::same(time_us, self.first_time_us, same_time_ratio);
        }
        self.frames = self.frames.saturating_add(1);
        self.observations = self.observations.saturating_add(1);
        self.sum += value;
    }

    /// Number of values taken in.
    pub(super) fn observations(&self) -> u32 {
        self.observations
    }

    /// Moments of the means of all runs, the last one included.
    pub(super) fn moments(&self) -> Moments {
        let mut moments = self.closed;
        if self.frames > 0 {
            moments.push(self.sum / f64::from(self.frames));
        }
        moments
    }

    /// Coefficient of variation over runs (population); `None` unless two of them differ in time.
    pub(super) fn coefficient_of_variation(&self) -> Option<f64> {
        if self.varies { self.moments().coefficient_of_variation() } else { None }
    }
}

/// The integration times so far, and whether they allow a comparison over time.
#[derive(Clone, Copy, Debug)]
pub(super) struct TimesSeen {
    shortest_us: f32,
    longest_us: f32,
    per_frame: bool,
}

impl TimesSeen {
    pub(super) fn new() -> Self {
        Self { shortest_us: f32::INFINITY, longest_us: 0.0, per_frame: false }
    }

    /// Takes in the times of a frame's usable pixels (those that are not NaN).
    pub(super) fn push(&mut self, usable: &[f32], times: Times<'_>) {
        match times {
            Times::Uniform(time_us) => self.widen(time_us),
            Times::PerPixel(_) => {
                let used = usable.iter().enumerate().filter(|(_, value)| !value.is_nan());
                used.for_each(|(index, _)| self.widen(times.at(index)));
            }
        }
        self.per_frame |= times.of_frame().is_some();
    }

    fn widen(&mut self, time_us: f32) {
        if time_us > 0.0 {
            self.shortest_us = self.shortest_us.min(time_us);
            self.longest_us = self.longest_us.max(time_us);
        }
    }

    /// Refuses times that are unknown or all the same.
    pub(super) fn require_variation(&self, same_time_ratio: f64) -> Result<(), Unavailable> {
        if self.longest_us == 0.0 {
            return Err(Unavailable::TimeUnknown);
        }
        if IntegrationTime::same(self.shortest_us, self.longest_us, same_time_ratio) {
            return Err(Unavailable::TimeConstant);
        }
        Ok(())
    }

    /// As [`Self::require_variation`], and refuses times that belong to pixels, not to frames.
    pub(super) fn require_variation_of_frames(&self, same_time_ratio: f64) -> Result<(), Unavailable> {
        let varies = self.require_variation(same_time_ratio);
        if varies != Err(Unavailable::TimeUnknown) && !self.per_frame {
            return Err(Unavailable::TimePerPixel);
        }
        varies
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn runs(values: &[(f64, f32)]) -> Runs {
        let mut runs = Runs::default();
        values.iter().for_each(|&(value, time_us)| runs.push(value, time_us, 1.01));
        runs
    }

    #[test]
    fn frames_are_averaged_within_a_run_and_runs_weigh_the_same() {
        // Run means 2, 5 and 5: mean 4, population variance (4 + 1 + 1)/3 = 2.
        let runs = runs(&[(1.0, 10.0), (3.0, 10.0), (5.0, 20.0), (4.0, 40.0), (5.0, 40.0), (6.0, 40.0)]);
        assert_eq!(runs.moments().count(), 3);
        assert!((runs.coefficient_of_variation().unwrap() - 2f64.sqrt() / 4.0).abs() < 1e-15);
        assert_eq!(runs.observations(), 6);
    }

    #[test]
    fn one_time_has_no_coefficient_even_when_the_value_varies() {
        assert_eq!(runs(&[(1.0, 10.0), (3.0, 10.0)]).coefficient_of_variation(), None);
        assert_eq!(runs(&[]).coefficient_of_variation(), None);
    }

    #[test]
    fn slow_drift_of_the_time_opens_a_run_once_it_has_left_the_first_time() {
        let runs = runs(&[(1.0, 1000.0), (1.0, 1006.0), (2.0, 1012.0)]);
        assert_eq!(runs.moments().count(), 2);
    }
}
