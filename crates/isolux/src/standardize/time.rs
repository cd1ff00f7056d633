//! The integration-time step: one multiplier per frame, or one per pixel.

use super::StandardizeError;
use super::plan::TimePlan;
use crate::frame::{Frame, IntegrationTime, PixelFlags};
use crate::terms::linear;
use crate::terms::lut::LutAnswer;

/// Where the multipliers are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum TimeGain {
    /// One for all pixels.
    Uniform(f32),
    /// In the output plane, one for each pixel.
    PerPixel,
}

/// The multipliers of a frame, and how many of its measured pixels the table does not cover.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct TimeOutcome {
    pub(super) gain: TimeGain,
    /// Above the range, or unknown.
    pub(super) refused: usize,
    /// Below the range.
    pub(super) extrapolated: usize,
}

/// A multiplier, and the flags of the pixels that get it. NaN where there is none.
type Answer = (f32, PixelFlags);

/// Computes the multipliers; where each pixel has its own time, they are written into `gains`. Completes `flags`.
///
/// # Errors
/// [`StandardizeError::TimeUnknown`] when the plan needs a time and the frame has none.
pub(super) fn gains(
    plan: &TimePlan,
    frame: &Frame,
    gains: &mut [f32],
    flags: &mut [PixelFlags],
) -> Result<TimeOutcome, StandardizeError> {
    let mut outcome = TimeOutcome { gain: TimeGain::Uniform(1.0), refused: 0, extrapolated: 0 };
    match (plan, &frame.integration_time_us) {
        (TimePlan::None, _) => {}
        (_, IntegrationTime::Unknown) => return Err(StandardizeError::TimeUnknown),
        (_, IntegrationTime::PerFrame(time_us)) => {
            let (gain, flag) = answer(plan, *time_us);
            if !flag.is_empty() {
                flags.iter_mut().for_each(|flags| outcome.flag(flags, flag));
            }
            outcome.gain = TimeGain::Uniform(gain);
        }
        (_, IntegrationTime::PerPixel(map)) => {
            let mut known = Memo::default();
            for ((&time_us, gain), flags) in map.values().iter().zip(gains).zip(flags) {
                let (value, flag) = known.get(time_us, |time_us| answer(plan, time_us));
                *gain = value;
                if !flag.is_empty() {
                    outcome.flag(flags, flag);
                }
            }
            outcome.gain = TimeGain::PerPixel;
        }
    }
    Ok(outcome)
}

impl TimeOutcome {
    /// Flags one pixel; counts it where it was a measurement so far.
    fn flag(&mut self, flags: &mut PixelFlags, flag: PixelFlags) {
        let measured = !flags.contains(PixelFlags::INVALID);
        let refused = flag.contains(PixelFlags::INVALID);
        self.refused += usize::from(measured && refused);
        self.extrapolated += usize::from(measured && !refused);
        *flags |= flag;
    }
}

fn answer(plan: &TimePlan, time_us: f64) -> Answer {
    if !(time_us > 0.0 && time_us.is_finite()) {
        return (f32::NAN, PixelFlags::INVALID | PixelFlags::TIME_OUT_OF_RANGE);
    }
    match plan {
        TimePlan::None => (1.0, PixelFlags::empty()),
        TimePlan::Linear { reference_us } => {
            (linear::multiplier(time_us, *reference_us) as f32, PixelFlags::empty())
        }
        TimePlan::Lut(lut) => flagged(lut.at(time_us)),
        TimePlan::Scalar { response, reference_us } => flagged(response.at(time_us, *reference_us)),
    }
}

fn flagged(answer: LutAnswer) -> Answer {
    match answer {
        LutAnswer::Inside(gain) => (gain as f32, PixelFlags::empty()),
        LutAnswer::Below(gain) => (gain as f32, PixelFlags::TIME_OUT_OF_RANGE),
        LutAnswer::Refused => (f32::NAN, PixelFlags::INVALID | PixelFlags::TIME_OUT_OF_RANGE),
    }
}

/// Remembers the last few times: cameras that mix exposures within a frame use two or three.
#[derive(Default)]
struct Memo {
    entries: [Option<(u32, Answer)>; 4],
    oldest: usize,
}

impl Memo {
    fn get(&mut self, time_us: f32, compute: impl Fn(f64) -> Answer) -> Answer {
        let bits = time_us.to_bits();
        if let Some((_, answer)) = self.entries.iter().flatten().find(|(known, _)| *known == bits) {
            return *answer;
        }
        let answer = compute(f64::from(time_us));
        self.entries[self.oldest] = Some((bits, answer));
        self.oldest = (self.oldest + 1) % self.entries.len();
        answer
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::{Plane, Shape};

    #[test]
    fn a_map_of_times_gives_each_pixel_its_multiplier() {
        let times = [125.0, 5000.0, f32::NAN, 125.0, 0.0, 60.0, 70.0, 80.0, 125.0];
        let mut frame = Frame::new(Shape::new(3, 3));
        frame.integration_time_us =
            IntegrationTime::PerPixel(Plane::from_vec(Shape::new(3, 3), times.to_vec()).unwrap());
        let (mut values, mut flags) = ([0.0; 9], [PixelFlags::empty(); 9]);
        let plan = TimePlan::Linear { reference_us: 1000.0 };
        flags[4] = PixelFlags::INVALID;
        let expected = TimeOutcome { gain: TimeGain::PerPixel, refused: 1, extrapolated: 0 };
        assert_eq!(gains(&plan, &frame, &mut values, &mut flags), Ok(expected));
        for (i, time) in times.into_iter().enumerate() {
            if time > 0.0 {
                assert_eq!((values[i], flags[i]), (1000.0 / time, PixelFlags::empty()));
            } else {
                assert!(values[i].is_nan() && flags[i].bits() == 0b1001, "{time}");
            }
        }
    }
}
