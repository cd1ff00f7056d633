//! Groups measured frames into positions of the target, and positions into the decay of one integration time.

use super::DistanceWarning;
use super::centre::Measurement;
use crate::terms::cubic::{Decay, DecayPoint};
use crate::terms::response::{NoiseOfSample, TargetSample};

/// Decays whose median signal-to-noise ratio is lower are left out: their distances are not reliable.
const LEAST_SIGNAL_TO_NOISE: f64 = 10.0;
/// Consecutive frames within this distance of the first belong to one position, or within
/// [`POSITION_STANDARD_ERRORS`] where the distance is noisy.
const POSITION_TOLERANCE_M: f64 = 0.005;
/// Two means of one position differ by more than this many standard errors once in 15 000 times.
const POSITION_STANDARD_ERRORS: f64 = 4.0;
/// The window's mean distance may scatter by this many standard errors before the target counts as moving.
const STANDARD_ERRORS: f64 = 8.0;
/// A decay is left out as a whole, like the paper's 0.2 ms, if a smaller share of its frames has a reliable
/// distance: the remaining distances are then selected by noise.
const LEAST_RELIABLE_SHARE: f64 = 1.0 / 3.0;

/// What was measured at one integration time.
#[derive(Clone, Debug, Default)]
pub(super) struct Positions {
    pub(super) reliable: Vec<Position>,
    /// Frames without a reliable distance.
    pub(super) unreliable: usize,
}

/// Frames of one position of the target.
#[derive(Clone, Debug)]
pub(super) struct Position {
    /// Number of each frame.
    pub(super) frames: Vec<usize>,
    pub(super) measurements: Vec<Measurement>,
    /// Noise of the amplitude, of all pairs of repeated frames.
    pub(super) noise: Option<NoiseOfSample>,
}

impl Positions {
    /// Adds a frame of this number; where it `follows` the last one without a change of time, it may belong to the same
    /// position. True where it does.
    pub(super) fn add(&mut self, frame: usize, measurement: Measurement, follows: bool) -> bool {
        match self.reliable.last_mut() {
            Some(last) if follows && last.holds(&measurement) => {
                last.frames.push(frame);
                last.measurements.push(measurement);
                true
            }
            _ => {
                let (frames, measurements) = (vec![frame], vec![measurement]);
                self.reliable.push(Position { frames, measurements, noise: None });
                false
            }
        }
    }

    /// Adds the noise of one more pair of frames to the last position.
    pub(super) fn add_noise(&mut self, found: NoiseOfSample) {
        let Some(position) = self.reliable.last_mut() else { return };
        let NoiseOfSample { variance_dn2, differences } = found;
        position.noise = Some(match position.noise {
            None => found,
            Some(before) => {
                let total = before.differences + differences;
                let sum = before.variance_dn2 * before.differences + variance_dn2 * differences;
                NoiseOfSample { variance_dn2: sum / total, differences: total }
            }
        });
    }

    /// What the response by amplitude and distance is fitted to: the positions from the brightest one on whose signal is
    /// strong enough, also those of decays that are left out as a whole.
    pub(super) fn samples(&self, integration_time_us: f64) -> Vec<TargetSample> {
        let sorted = self.by_distance();
        let strong = |position: &&&Position| position.mean(|m| m.signal_to_noise) >= LEAST_SIGNAL_TO_NOISE;
        let sample = |position: &&Position| TargetSample { integration_time_us, ..position.sample() };
        sorted[brightest(&sorted)..].iter().filter(strong).map(sample).collect()
    }

    fn by_distance(&self) -> Vec<&Position> {
        let mut sorted: Vec<&Position> = self.reliable.iter().collect();
        sorted.sort_by(|a, b| a.mean(|m| m.distance_m).total_cmp(&b.mean(|m| m.distance_m)));
        sorted
    }

    /// A warning for each position within which the target moved.
    pub(super) fn moved<'a>(&'a self, recording: &'a str) -> impl Iterator<Item = DistanceWarning> + 'a {
        self.reliable.iter().filter_map(|position| position.moved(recording))
    }

    /// The decay and the frames in it, starting where over-saturation ends; `None` when the signal is too weak.
    pub(super) fn decay(
        &self,
        recording: &str,
        integration_time_us: Option<f64>,
        warnings: &mut Vec<DistanceWarning>,
    ) -> Option<(Decay, usize)> {
        let recording = || recording.to_owned();
        let reliable: usize = self.reliable.iter().map(|p| p.measurements.len()).sum();
        let frames = reliable + self.unreliable;
        if (reliable as f64) < LEAST_RELIABLE_SHARE * frames as f64 {
            let recording = recording();
            warnings.push(DistanceWarning::FewReliable { recording, integration_time_us, reliable, frames });
            return None;
        }
        let sorted = self.by_distance();
        let peak = brightest(&sorted);
        if peak > 0 {
            let (recording, from_m) = (recording(), sorted[peak].mean(|m| m.distance_m));
            let positions = peak;
            warnings.push(DistanceWarning::OverSaturated {
                recording,
                integration_time_us,
                positions,
                from_m,
            });
        }
        let usable = &sorted[peak..];
        let mut ratios: Vec<f64> = usable.iter().map(|p| p.mean(|m| m.signal_to_noise)).collect();
        ratios.sort_by(f64::total_cmp);
        let signal_to_noise = *ratios.get(ratios.len() / 2)?;
        if signal_to_noise < LEAST_SIGNAL_TO_NOISE {
            let recording = recording();
            warnings.push(DistanceWarning::LowSignal { recording, integration_time_us, signal_to_noise });
            return None;
        }
        let points = usable.iter().map(|p| p.point()).collect();
        let frames = usable.iter().map(|p| p.measurements.len()).sum();
        Some((Decay { integration_time_us, points }, frames))
    }
}

/// Index of the position with the largest amplitude; 0 without positions.
fn brightest(positions: &[&Position]) -> usize {
    let brightness = |index: usize| positions[index].mean(|m| m.amplitude_dn);
    (0..positions.len()).max_by(|&a, &b| brightness(a).total_cmp(&brightness(b))).unwrap_or(0)
}

impl Position {
    fn sample(&self) -> TargetSample {
        let pixels: f64 = self.measurements.iter().map(|m| m.pixels).sum();
        let point = self.point();
        TargetSample {
            integration_time_us: f64::NAN,
            distance_m: point.distance_m,
            amplitude_dn: point.amplitude_dn,
            relative_error: 1.0 / (self.mean(|m| m.signal_to_noise) * pixels.sqrt()),
            noise: self.noise,
        }
    }

    fn holds(&self, next: &Measurement) -> bool {
        self.measurements.first().is_some_and(|first| {
            let noise_m = POSITION_STANDARD_ERRORS * first.distance_error_m.hypot(next.distance_error_m);
            (first.distance_m - next.distance_m).abs() <= noise_m.max(POSITION_TOLERANCE_M)
        })
    }

    pub(super) fn mean(&self, value: impl Fn(&Measurement) -> f64) -> f64 {
        self.measurements.iter().map(value).sum::<f64>() / self.measurements.len() as f64
    }

    fn point(&self) -> DecayPoint {
        DecayPoint { distance_m: self.mean(|m| m.distance_m), amplitude_dn: self.mean(|m| m.amplitude_dn) }
    }

    /// A warning if the means differ by more than noise explains.
    fn moved(&self, recording: &str) -> Option<DistanceWarning> {
        let distances = || self.measurements.iter().map(|m| m.distance_m);
        let range_m =
            distances().fold(f64::NEG_INFINITY, f64::max) - distances().fold(f64::INFINITY, f64::min);
        let noise_m = self.mean(|m| m.distance_error_m);
        // Half the tolerance that defines a position: no position can range over more than twice of it.
        let moved = range_m > (STANDARD_ERRORS * noise_m).max(0.5 * POSITION_TOLERANCE_M);
        let (recording, frame) = (recording.to_owned(), self.frames.first().copied().unwrap_or(0));
        moved.then_some(DistanceWarning::TargetMoved { recording, frame, range_m })
    }
}
