//! Which observations share an exposure: those of one integration time, and those of one frame whose time is unknown.

use super::joint::{JointFit, TimeModel};
use super::severity::POOR_SHARE;
use crate::numerics::statistics::median;

/// Levels of frames, at most. Of longer recordings, frames are taken at equal steps.
const MOST_FRAMES: usize = 256;
/// One exposure for all frames leaves residuals that are larger by no more than this factor.
const LARGEST_GROWTH: f64 = 1.5;
/// It is shown by a law that follows from single frames too: the exponents agree within this many standard errors, of
/// which each is no larger than this.
const STANDARD_ERRORS: f64 = 2.0;
const LARGEST_ERROR: f64 = 0.3;

/// The exposures of all observations.
#[derive(Clone, Debug, Default)]
pub(super) struct Levels {
    /// Integration times, µs, increasing.
    pub(super) times_us: Vec<f64>,
    /// Frames whose time is unknown, increasing, as far as they are taken.
    frames: Vec<u32>,
}

impl Levels {
    /// Of observations, each with its integration time (µs; NaN where it is unknown) and frame.
    pub(super) fn new(observations: impl Iterator<Item = (f64, u32)>) -> Self {
        let (mut times_us, mut frames) = (Vec::new(), Vec::new());
        for (time_us, frame) in observations {
            if time_us > 0.0 && time_us.is_finite() {
                if times_us.last() != Some(&time_us) {
                    times_us.push(time_us);
                }
            } else if frames.last() != Some(&frame) {
                frames.push(frame);
            }
        }
        times_us.sort_by(f64::total_cmp);
        times_us.dedup();
        frames.sort_unstable();
        frames.dedup();
        let step = frames.len().div_ceil(MOST_FRAMES).max(1);
        Self { times_us, frames: frames.into_iter().step_by(step).collect() }
    }

    /// All times as one, where a table takes them out beforehand.
    pub(super) fn of_one_time(self) -> Self {
        Self { times_us: self.times_us.into_iter().take(1).collect(), ..self }
    }

    /// True where some times are unknown.
    pub(super) fn of_frames(&self) -> bool {
        !self.frames.is_empty()
    }

    /// The level of an observation; `None` where its frame is not taken.
    pub(super) fn of(&self, time_us: f64, frame: u32) -> Option<u16> {
        let index = if time_us > 0.0 && time_us.is_finite() {
            self.times_us.iter().position(|time| *time == time_us).unwrap_or(0)
        } else {
            self.times_us.len() + self.frames.binary_search(&frame).ok()?
        };
        u16::try_from(index).ok()
    }

    /// The model; `None` where all share one level. `reference_us`: near to the time at which the factor is 1.
    pub(super) fn model(&self, reference_us: f64) -> Option<TimeModel> {
        let count = self.times_us.len() + self.frames.len();
        let away = |index: &usize| (self.times_us[*index] / reference_us).ln().abs();
        let nearest = (0..self.times_us.len()).min_by(|a, b| away(a).total_cmp(&away(b)));
        let (reference, of_frames) = (nearest.unwrap_or(0), self.of_frames());
        (count > 1).then_some(TimeModel { count, reference, of_frames })
    }
}

/// Whether frames whose times are unknown show by themselves that they share one exposure: `shared` was fitted with one
/// level for all of them, `free` with one for each.
///
/// An automatic exposure follows the scene, mostly its distance: the law over distance takes it up where each distance
/// has frames of its own. What single frames see at several distances contradicts that law then.
pub(super) fn show_one_exposure(shared: &JointFit, free: &JointFit) -> bool {
    let (Some(one), Some(other)) = (shared.fall, free.fall) else { return false };
    let error = other.standard_error;
    let agree = (one.exponent - other.exponent).abs() <= STANDARD_ERRORS * error;
    error <= LARGEST_ERROR && agree && shared.sigma <= LARGEST_GROWTH * free.sigma
}

/// Whether one exposure for all frames gives the law of light, about d⁻², and frames that agree. An automatic exposure
/// flattens the law, or scatters the frames.
pub(super) fn look_like_one_exposure(shared: &JointFit, residuals: impl Iterator<Item = (u32, f64)>) -> bool {
    /// An automatic exposure that takes less out of d⁻² bends the law by no more than what is refused elsewhere.
    const LARGEST_EXPONENT: f64 = 0.2;
    let lawful = shared.fall.is_some_and(|fall| fall.exponent.abs() <= LARGEST_EXPONENT);
    lawful && shared_by_frames(residuals).is_some_and(|found| found.spread <= POOR_SHARE)
}

/// What the residuals of a frame share.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct SharedByFrames {
    /// Factors of the least and the most bright frame.
    pub(super) range: [f64; 2],
    /// Robust relative standard deviation of the factors.
    pub(super) spread: f64,
}

/// The factors that the residuals of frames share; `None` with too few frames to tell.
pub(super) fn shared_by_frames(residuals: impl Iterator<Item = (u32, f64)>) -> Option<SharedByFrames> {
    /// Observations that tell the factor of a frame, and frames that tell their spread.
    const LEAST: [usize; 2] = [8, 5];
    let mut residuals: Vec<(u32, f64)> = residuals.filter(|(_, residual)| residual.is_finite()).collect();
    residuals.sort_by_key(|(frame, _)| *frame);
    let frames = residuals.chunk_by(|a, b| a.0 == b.0).filter(|frame| frame.len() >= LEAST[0]);
    let middle =
        |frame: &[(u32, f64)]| median(&mut frame.iter().map(|(_, residual)| *residual).collect::<Vec<_>>());
    let mut factors: Vec<f64> = frames.filter_map(middle).collect();
    if factors.len() < LEAST[1] {
        return None;
    }
    factors.sort_by(f64::total_cmp);
    let range = [factors[0], factors[factors.len() - 1]].map(f64::exp);
    let spread = (factors.iter().map(|factor| factor * factor).sum::<f64>() / factors.len() as f64).sqrt();
    Some(SharedByFrames { range, spread })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_frame_without_a_time_has_a_level_of_its_own() {
        let seen = [(1000.0, 0), (f64::NAN, 1), (500.0, 2), (f64::NAN, 4), (1000.0, 5)];
        let levels = Levels::new(seen.into_iter());
        let of: Vec<_> = seen.iter().map(|&(time_us, frame)| levels.of(time_us, frame)).collect();
        assert_eq!(of, [1, 2, 0, 3, 1].map(Some));
        assert_eq!(levels.of(f64::NAN, 3), None);
        assert_eq!(levels.model(900.0), Some(TimeModel { count: 4, reference: 1, of_frames: true }));
        assert_eq!(Levels::new([(7.0, 0), (7.0, 1)].into_iter()).model(7.0), None);
        let many = Levels::new((0..1000).map(|frame| (f64::NAN, frame)));
        assert_eq!((many.frames.len(), many.of(f64::NAN, 4), many.of(f64::NAN, 5)), (250, Some(1), None));
    }

    #[test]
    fn residuals_of_one_sign_are_found() {
        let of = |factor: fn(u32) -> f64| {
            shared_by_frames((0..10).flat_map(move |frame| (0..25).map(move |_| (frame, factor(frame)))))
        };
        let found = of(|frame| if frame % 2 == 0 { 0.1 } else { -0.1 }).unwrap();
        assert!((found.spread - 0.1).abs() < 1e-12 && (found.range[1] - 0.1f64.exp()).abs() < 1e-12);
        assert_eq!(of(|_| 0.0).map(|found| found.spread), Some(0.0));
        assert_eq!(shared_by_frames((0..100).map(|frame| (frame, 0.1))), None);
    }
}
