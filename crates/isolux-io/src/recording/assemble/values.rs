//! Integration times, labels, time stamps and poses, each checked.

use isolux::{Channels, IntegrationTime, Plane};

use super::loaded::Loaded;
use crate::error::RecordingError;
use crate::recording::channels;

impl Loaded<'_> {
    /// Reads the integration time into `time`, whose memory is reused.
    pub(super) fn read_time(
        &self,
        wanted: Channels,
        time: &mut IntegrationTime,
    ) -> Result<(), RecordingError> {
        let flag = Channels::INTEGRATION_TIME;
        if !wanted.contains(flag) {
            *time = IntegrationTime::Unknown;
            return Ok(());
        }
        if let Some(constant) = self.metadata.info.integration_time_us {
            *time = IntegrationTime::PerFrame(constant);
            return Ok(());
        }
        if self.places.get(flag).is_some_and(|place| !self.channels[place].frame_dims.is_empty()) {
            return self.read_time_map(time);
        }
        let value = self.numbers::<1>(flag)?.map_or(f64::NAN, |[value]| value);
        *time = match value {
            _ if value.is_nan() => IntegrationTime::Unknown,
            _ if value > 0.0 && value.is_finite() => IntegrationTime::PerFrame(value),
            _ => {
                let expected = "a positive number of microseconds, or NaN where it is unknown";
                return Err(self.value_error(flag, None, value, expected));
            }
        };
        Ok(())
    }

    fn read_time_map(&self, time: &mut IntegrationTime) -> Result<(), RecordingError> {
        let (flag, shape) = (Channels::INTEGRATION_TIME, self.metadata.shape);
        if !matches!(time, IntegrationTime::PerPixel(_)) {
            *time = IntegrationTime::PerPixel(Plane::filled(shape, f32::NAN));
        }
        let IntegrationTime::PerPixel(map) = time else { return Ok(()) };
        self.plane(flag, map)?;
        match map.values().iter().position(|&value| value < 0.0 || value == f32::INFINITY) {
            None => Ok(()),
            Some(at) => {
                let expected = "a positive number of microseconds, or NaN or 0 where it is unknown";
                Err(self.value_error(flag, Some(at), f64::from(map.values()[at]), expected))
            }
        }
    }

    /// Reads the labels. `numbers` is memory for them before they are known to fit a byte.
    pub(super) fn read_target(
        &self,
        wanted: Channels,
        numbers: &mut Vec<f32>,
        target: &mut Option<Plane<u8>>,
    ) -> Result<(), RecordingError> {
        let (flag, shape) = (Channels::TARGET, self.metadata.shape);
        if !wanted.contains(flag) {
            *target = None;
            return Ok(());
        }
        let Some(frame) = self.raw(flag)? else { return Ok(()) };
        let target = target.get_or_insert_with(|| Plane::filled(shape, 0));
        target.reshape(shape, 0);
        numbers.resize(shape.pixels(), 0.0);
        frame.read_f32(numbers);
        for (at, (label, &value)) in target.values_mut().iter_mut().zip(&*numbers).enumerate() {
            if !(0.0..=255.0).contains(&value) {
                let expected = "a label of 0 to 255";
                return Err(self.value_error(flag, Some(at), f64::from(value), expected));
            }
            *label = value as u8;
        }
        Ok(())
    }

    /// NaN is what recorders write where they know no time.
    pub(super) fn timestamp_us(&self, wanted: Channels) -> Result<Option<f64>, RecordingError> {
        let flag = Channels::TIMESTAMP;
        let number = if wanted.contains(flag) { self.numbers::<1>(flag)? } else { None };
        Ok(number.map(|[value]| value).filter(|value| value.is_finite()))
    }

    /// `None` also for a pose with a number that is not finite: unknown in this frame.
    pub(super) fn pose(&self, wanted: Channels) -> Result<Option<[[f64; 4]; 4]>, RecordingError> {
        let flag = Channels::POSE;
        let numbers = if wanted.contains(flag) { self.numbers::<16>(flag)? } else { None };
        let known = numbers.filter(|numbers| numbers.iter().all(|number| number.is_finite()));
        Ok(known.map(|numbers| {
            let mut pose = [[0.0; 4]; 4];
            pose.iter_mut().zip(numbers.as_chunks::<4>().0).for_each(|(row, numbers)| *row = *numbers);
            pose
        }))
    }

    fn value_error(
        &self,
        flag: Channels,
        at: Option<usize>,
        found: f64,
        expected: &'static str,
    ) -> RecordingError {
        let file = self.places.get(flag).map(|place| self.channels[place].path.clone());
        let width = self.metadata.shape.width;
        RecordingError::Value {
            file: file.unwrap_or_else(|| self.metadata.path.join(channels::name(flag))),
            frame: self.index,
            pixel: at.map(|at| (at / width, at % width)),
            found,
            expected,
        }
    }
}
