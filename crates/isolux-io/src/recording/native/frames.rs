//! From stored channels to a [`Frame`]: units, radial distance, amplitude from bins, flags.

use isolux::phase;
use isolux::{Channels, Frame, IntegrationTime, PixelFlags, Plane, Shape};

use super::channel::Channel;
use crate::error::{RecordingError, listing};
use crate::recording::element::{decode_f32, decode_f64};
use crate::recording::info::{DistanceKind, DistanceUnit, RecordingInfo};
use crate::recording::metadata::Metadata;

/// A phase sample from this fraction of the clip level on is taken for clipped: read noise spreads the clip.
const CLIPPED_FRACTION: f32 = 0.985;

/// Memory that lives from frame to frame.
#[derive(Default)]
pub(crate) struct Scratch {
    bins: Option<[Plane<f32>; 4]>,
    radial_per_depth: Option<Plane<f32>>,
    numbers: Vec<f32>,
}

/// Fills `frame` with frame `index`; see [`Recording::read_frame`](crate::recording::Recording::read_frame).
pub(crate) fn read(
    metadata: &Metadata,
    channels: &mut [Channel],
    scratch: &mut Scratch,
    index: usize,
    wanted: Channels,
    frame: &mut Frame,
) -> Result<(), RecordingError> {
    let mut reader = FrameReader { metadata, channels, index };
    let wants = |channel| wanted.contains(channel) && metadata.available.contains(channel);
    if wanted.contains(Channels::AMPLITUDE) && !wants(Channels::AMPLITUDE) {
        let found = listing(metadata.channels.iter().map(|channel| channel.name.as_str()));
        return Err(RecordingError::MissingAmplitude { path: metadata.path.clone(), found });
    }
    let (shape, info) = (metadata.shape, &metadata.info);
    frame.flags.reshape(shape, PixelFlags::empty());
    frame.flags.fill(PixelFlags::empty());
    frame.amplitude.reshape(shape, f32::NAN);

    let has_bins = reader.read_bins(wanted, scratch)?;
    let bins = scratch.bins.as_ref().filter(|_| has_bins);
    if wants(Channels::AMPLITUDE) {
        reader.read_amplitude(bins, frame)?;
    } else {
        frame.amplitude.fill(f32::NAN);
    }
    if let (Some(bins), Some(clip)) = (bins, info.saturated_phase_sample) {
        flag_clipped(bins, clip * CLIPPED_FRACTION, &mut frame.flags);
    }
    if wants(Channels::DISTANCE) {
        let distance_m = plane_of(&mut frame.distance_m, shape);
        if reader.plane("distance", distance_m)? {
            let unit = reader.distance_unit();
            make_metric_radial(info, unit, &mut scratch.radial_per_depth, distance_m);
        } else if let (Some(bins), Some(frequency_hz)) = (bins, info.modulation_frequency_hz) {
            // The bins are in the paper's sign already.
            phase::distance_into(bins, frequency_hz, false, distance_m).map_err(|e| reader.unequal(&e))?;
        }
    } else {
        frame.distance_m = None;
    }
    reader.read_optional_plane("intensity", wants(Channels::INTENSITY), &mut frame.intensity)?;
    reader.read_optional_plane(
        "vendor_amplitude",
        wants(Channels::VENDOR_AMPLITUDE),
        &mut frame.vendor_amplitude,
    )?;
    let confidence = &mut frame.vendor_confidence;
    reader.read_optional_plane("vendor_confidence", wants(Channels::VENDOR_CONFIDENCE), confidence)?;
    reader.read_time(wants(Channels::INTEGRATION_TIME), &mut frame.integration_time_us)?;
    reader.read_target(wants(Channels::TARGET), &mut scratch.numbers, &mut frame.target)?;
    frame.timestamp_us = reader.timestamp_us(wants(Channels::TIMESTAMP))?;
    frame.world_from_camera = reader.pose(wants(Channels::POSE))?;
    if wants(Channels::PHASE_SAMPLES) {
        // Swapped, not copied: the frame's old planes are the next frame's scratch.
        std::mem::swap(&mut frame.phase_samples, &mut scratch.bins);
    } else {
        frame.phase_samples = None;
    }
    Ok(())
}

struct FrameReader<'a> {
    metadata: &'a Metadata,
    channels: &'a mut [Channel],
    index: usize,
}

impl FrameReader<'_> {
    fn channel(&mut self, name: &str) -> Option<&mut Channel> {
        self.channels.iter_mut().find(|channel| channel.name == name)
    }

    fn has(&self, name: &str) -> bool {
        self.channels.iter().any(|channel| channel.name == name)
    }

    /// Reads a channel as it is; false where there is none.
    fn plane(&mut self, name: &str, plane: &mut Plane<f32>) -> Result<bool, RecordingError> {
        let (shape, index) = (self.metadata.shape, self.index);
        let Some(channel) = self.channel(name) else { return Ok(false) };
        plane.reshape(shape, f32::NAN);
        let (element, order) = (channel.element, channel.byte_order);
        decode_f32(element, order, channel.frame(index)?, plane.values_mut());
        Ok(true)
    }

    fn read_optional_plane(
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

    fn read_amplitude(
        &mut self,
        bins: Option<&[Plane<f32>; 4]>,
        frame: &mut Frame,
    ) -> Result<(), RecordingError> {
        if !self.plane("amplitude", &mut frame.amplitude)?
            && let Some(bins) = bins
        {
            phase::amplitude_into(bins, &mut frame.amplitude).map_err(|e| self.unequal(&e))?;
        }
        frame.flag_amplitude(self.metadata.info.saturated_amplitude);
        Ok(())
    }

    /// Reads the phase samples, in the paper's order and sign, when anything wanted depends on them; false where
    /// they are not needed or not there.
    fn read_bins(&mut self, wanted: Channels, scratch: &mut Scratch) -> Result<bool, RecordingError> {
        let info = &self.metadata.info;
        let amplitude = !self.has("amplitude") || info.saturated_phase_sample.is_some();
        let needed = wanted.contains(Channels::PHASE_SAMPLES)
            || (wanted.contains(Channels::AMPLITUDE) && amplitude)
            || (wanted.contains(Channels::DISTANCE) && !self.has("distance"));
        let (shape, index) = (self.metadata.shape, self.index);
        let convention = info.phase_convention.unwrap_or_default();
        let Some(channel) = self.channel("phase_samples").filter(|_| needed) else { return Ok(false) };
        let bins = scratch.bins.get_or_insert_with(|| [(); 4].map(|()| Plane::filled(shape, f32::NAN)));
        let (element, order) = (channel.element, channel.byte_order);
        let bytes = channel.frame(index)?;
        let bin_bytes = bytes.len() / 4;
        let [a1, a2, a3, a4] = convention.order;
        // The phase that runs the other way changes the sign of A2 − A4 and of nothing else.
        let positions = if convention.reversed { [a1, a4, a3, a2] } else { [a1, a2, a3, a4] };
        for (bin, position) in bins.iter_mut().zip(positions) {
            bin.reshape(shape, f32::NAN);
            let bytes = &bytes[position * bin_bytes..(position + 1) * bin_bytes];
            decode_f32(element, order, bytes, bin.values_mut());
        }
        Ok(true)
    }

    /// Integers are millimetres and floats metres, as in REP 118, unless `recording.json` says otherwise.
    fn distance_unit(&self) -> DistanceUnit {
        let integer = self.channels.iter().any(|c| c.name == "distance" && c.element.is_integer());
        let default = if integer { DistanceUnit::Millimetre } else { DistanceUnit::Metre };
        self.metadata.info.distance_unit.unwrap_or(default)
    }

    fn read_time(&mut self, wanted: bool, time: &mut IntegrationTime) -> Result<(), RecordingError> {
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

    fn read_target(
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
    fn timestamp_us(&mut self, wanted: bool) -> Result<Option<f64>, RecordingError> {
        let number = if wanted { self.numbers::<1>("timestamp_us")? } else { None };
        Ok(number.map(|[value]| value).filter(|value| value.is_finite()))
    }

    /// `None` also for a pose with a number that is not finite: unknown in this frame.
    fn pose(&mut self, wanted: bool) -> Result<Option<[[f64; 4]; 4]>, RecordingError> {
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

    fn unequal(&self, error: &isolux::ShapeError) -> RecordingError {
        RecordingError::content(&self.metadata.path, error.to_string(), "bins of one shape")
    }
}

/// The plane in `slot`; a new one only where there was none.
fn plane_of(slot: &mut Option<Plane<f32>>, shape: Shape) -> &mut Plane<f32> {
    slot.get_or_insert_with(|| Plane::filled(shape, f32::NAN))
}

/// Invalid distances (0, negative, NaN) stay invalid: both steps keep the sign.
fn make_metric_radial(
    info: &RecordingInfo,
    unit: DistanceUnit,
    radial_per_depth: &mut Option<Plane<f32>>,
    distance: &mut Plane<f32>,
) {
    if unit == DistanceUnit::Millimetre {
        // A division, not a product with 0.001: it rounds once.
        distance.values_mut().iter_mut().for_each(|value| *value /= 1000.0);
    }
    if let (Some(DistanceKind::Z), Some(intrinsics)) = (info.distance_kind, &info.intrinsics) {
        let shape = distance.shape();
        let ratio = radial_per_depth.get_or_insert_with(|| intrinsics.pinhole.radial_per_depth(shape));
        distance.values_mut().iter_mut().zip(ratio.values()).for_each(|(value, &ratio)| *value *= ratio);
    }
}

fn flag_clipped(bins: &[Plane<f32>; 4], level: f32, flags: &mut Plane<PixelFlags>) {
    for bin in bins {
        for (flags, &value) in flags.values_mut().iter_mut().zip(bin.values()) {
            flags.set(PixelFlags::SATURATED, value >= level || flags.contains(PixelFlags::SATURATED));
        }
    }
}
