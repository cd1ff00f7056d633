//! Integration times in another unit than microseconds.

use super::suspicion::Suspicion;
use crate::frame::{Frame, IntegrationTime};

/// The longest time of a recording is longer than this, µs, for all cameras that were met; in milliseconds, it is shorter.
const SHORTEST_US: f64 = 50.0;
/// In seconds, it is shorter than this.
const SHORTEST_MS: f64 = 0.1;
/// Longer than any frame, µs: nanoseconds.
const LONGEST_US: f64 = 2e6;

/// The range of the times that were seen.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Times {
    range: Option<[f64; 2]>,
}

impl Times {
    pub(super) fn push(&mut self, frame: &Frame, stride: usize) {
        match &frame.integration_time_us {
            IntegrationTime::Unknown => {}
            IntegrationTime::PerFrame(time) => self.add(*time),
            IntegrationTime::PerPixel(map) => {
                map.values().iter().step_by(stride).for_each(|&time| self.add(f64::from(time)));
            }
        }
    }

    fn add(&mut self, time: f64) {
        if time > 0.0 && time.is_finite() {
            let [least, most] = self.range.unwrap_or([time; 2]);
            self.range = Some([least.min(time), most.max(time)]);
        }
    }

    pub(super) fn suspicion(self) -> Option<Suspicion> {
        let [from, to] = self.range?;
        let (unit, us_per_unit) = match to {
            _ if to < SHORTEST_MS => ("seconds", 1e6),
            _ if to < SHORTEST_US => ("milliseconds", 1e3),
            _ if from > LONGEST_US => ("nanoseconds", 1e-3),
            _ => return None,
        };
        Some(Suspicion::TimeUnit { from_us: from, to_us: to, unit, us_per_unit })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::Shape;

    fn unit(times: &[f64]) -> Option<&'static str> {
        let mut seen = Times::default();
        for &time in times {
            let mut frame = Frame::new(Shape::new(1, 1));
            frame.integration_time_us = IntegrationTime::PerFrame(time);
            seen.push(&frame, 1);
        }
        match seen.suspicion() {
            Some(Suspicion::TimeUnit { unit, .. }) => Some(unit),
            _ => None,
        }
    }

    #[test]
    fn times_in_other_units_are_told() {
        assert_eq!(unit(&[0.0002, 0.0082, 0.0272]), Some("seconds"));
        assert_eq!(unit(&[0.2, 8.2, 27.2]), Some("milliseconds"));
        assert_eq!(unit(&[8.2e6, 27.2e6]), Some("nanoseconds"));
        for right in [&[200.0, 27200.0][..], &[1.0, 400.0, 5000.0], &[30.0, 125.0], &[f64::NAN], &[]] {
            assert_eq!(unit(right), None, "{right:?}");
        }
    }
}
