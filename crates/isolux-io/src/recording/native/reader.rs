//! Single channels of one frame: images, numbers, integration times, labels, poses, each checked.

use isolux::{IntegrationTime, Plane, Shape};

use super::channel::Channel;
use crate::error::RecordingError;
use crate::recording::element::{decode_f32, decode_f64};
use crate::recording::metadata::Metadata;

/// One frame of the stored channels.
pub(super) struct FrameReader<'a> {
    pub(super) metadata: &'a Metadata,
    pub(super) channels: &'a mut [Channel],
    pub(super) index: usize,
}

impl FrameReader<'_> {
    pub(super) fn channel(&mut self, name: &str) -> Option<&mut Channel> {
        self.channels.iter_mut().find(|channel| channel.name == name)
    }

    pub(super) fn has(&self, name: &str) -> bool {
        self.channels.iter().any(|channel| channel.name == name)
    }

    /// Reads a channel as it is; false where there is none.
    pub(super) fn plane(&mut self, name: &str, plane: &mut Plane<f32>) -> Result<bool, RecordingError> {
        let (shape, index) = (self.metadata.shape, self.index);
        let Some(channel) = self.channel(name) else { return Ok(false) };
        plane.reshape(shape, f32::NAN);
        let (element, order) = (channel.element, channel.byte_order);
        decode_f32(element, order, channel.frame(index)?, plane.values_mut());
        Ok(true)
    }

    pub(super) fn read_optional_plane(
        &mut self,
        name: &str,
        wanted: bool,
        plane: &mut Option<Plane<f32>>,
    ) -> Result<(), RecordingError> {
        if wanted {
            self.plane(name, plane_of(plane, self.metadata.shape))?;
        } else {
            *plane = None;
        }
        Ok(())
    }

    fn numbers<const COUNT: usize>(&mut self, name: &str) -> Result<Option<[f64; COUNT]>, RecordingError> {
        let index = self.index;
        let Some(channel) = self.channel(name) else { return Ok(None) };
        let mut numbers = [f64::NAN; COUNT];
        let (element, order) = (channel.element, channel.byte_order);
        decode_f64(element, order, channel.frame(index)?, &mut numbers);
        Ok(Some(numbers))
    }

    pub(super) fn read_time(
        &mut self,
        wanted: bool,
        time: &mut IntegrationTime,
    ) -> Result<(), RecordingError> {
        if !wanted {
            *time = IntegrationTime::Unknown;
            return Ok(());
        }
        if let Some(constant) = self.metadata.info.integration_time_us {
            *time = IntegrationTime::PerFrame(constant);
            return Ok(());
        }
        let per_pixel = self.channel("integration_time_us").is_some_and(|c| !c.frame_dims.is_empty());
        if per_pixel {
            return self.read_time_map(time);
        }
        let value = self.numbers::<1>("integration_time_us")?.map_or(f64::NAN, |[value]| value);
        *time = match value {
            _ if value.is_nan() => IntegrationTime::Unknown,
            _ if value > 0.0 && value.is_finite() => IntegrationTime::PerFrame(value),
            _ => {
                let expected = "a positive number of microseconds, or NaN where it is unknown";
                return Err(self.value_error("integration_time_us", None, value, expected));
            }
        };
        Ok(())
    }

    fn read_time_map(&mut self, time: &mut IntegrationTime) -> Result<(), RecordingError> {
        let shape = self.metadata.shape;
        if !matches!(time, IntegrationTime::PerPixel(_)) {
            *time = IntegrationTime::PerPixel(Plane::filled(shape, f32::NAN));
        }
        let IntegrationTime::PerPixel(map) = time else { return Ok(()) };
        self.plane("integration_time_us", map)?;
        match map.values().iter().position(|&value| value < 0.0 || value == f32::INFINITY) {
            None => Ok(()),
            Some(at) => {
                let expected = "a positive number of microseconds, or NaN or 0 where it is unknown";
                Err(self.value_error("integration_time_us", Some(at), f64::from(map.values()[at]), expected))
            }
        }
    }

    pub(super) fn read_target(
        &mut self,
        wanted: bool,
        numbers: &mut Vec<f32>,
        target: &mut Option<Plane<u8>>,
    ) -> Result<(), RecordingError> {
        let (shape, index) = (self.metadata.shape, self.index);
        let Some(channel) = self.channel("target").filter(|_| wanted) else {
            *target = None;
            return Ok(());
        };
        let target = target.get_or_insert_with(|| Plane::filled(shape, 0));
        target.reshape(shape, 0);
        numbers.resize(shape.pixels(), 0.0);
        let (element, order) = (channel.element, channel.byte_order);
        decode_f32(element, order, channel.frame(index)?, numbers);
        for (at, (label, &value)) in target.values_mut().iter_mut().zip(&*numbers).enumerate() {
            if !(0.0..=255.0).contains(&value) {
                let expected = "a label of 0 to 255";
                return Err(self.value_error("target", Some(at), f64::from(value), expected));
            }
            *label = value as u8;
        }
        Ok(())
    }

    /// NaN is what recorders write where they know no time.
    pub(super) fn timestamp_us(&mut self, wanted: bool) -> Result<Option<f64>, RecordingError> {
        let number = if wanted { self.numbers::<1>("timestamp_us")? } else { None };
        Ok(number.map(|[value]| value).filter(|value| value.is_finite()))
    }

    /// `None` also for a pose with a number that is not finite: unknown in this frame.
    pub(super) fn pose(&mut self, wanted: bool) -> Result<Option<[[f64; 4]; 4]>, RecordingError> {
        let numbers = if wanted { self.numbers::<16>("world_from_camera")? } else { None };
        let known = numbers.filter(|numbers| numbers.iter().all(|number| number.is_finite()));
        Ok(known.map(|numbers| {
            let mut pose = [[0.0; 4]; 4];
            pose.iter_mut().zip(numbers.as_chunks::<4>().0).for_each(|(row, numbers)| *row = *numbers);
            pose
        }))
    }

    fn value_error(
        &self,
        name: &str,
        at: Option<usize>,
        found: f64,
        expected: &'static str,
    ) -> RecordingError {
        let file = self.channels.iter().find(|channel| channel.name == name).map(|c| c.path.clone());
        let width = self.metadata.shape.width;
        RecordingError::Value {
            file: file.unwrap_or_else(|| self.metadata.path.join(name)),
            frame: self.index,
            pixel: at.map(|at| (at / width, at % width)),
            found,
            expected,
        }
    }
}

/// The plane in `slot`; a new one only where there was none.
pub(super) fn plane_of(slot: &mut Option<Plane<f32>>, shape: Shape) -> &mut Plane<f32> {
    slot.get_or_insert_with(|| Plane::filled(shape, f32::NAN))
}
