//! From stored channels to a [`Frame`]: units, radial distance, amplitude from bins, flags.

use isolux::phase;
use isolux::{Channels, Frame, PixelFlags, Plane};

use super::channel::Channel;
use super::reader::{FrameReader, plane_of};
use crate::error::{RecordingError, listing};
use crate::recording::element::decode_f32;
use crate::recording::info::{DistanceKind, DistanceUnit, RecordingInfo};
use crate::recording::metadata::Metadata;

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
        flag_clipped(bins, clip * phase::CLIPPED_SHARE as f32, &mut frame.flags);
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

impl FrameReader<'_> {
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

    fn unequal(&self, error: &isolux::ShapeError) -> RecordingError {
        RecordingError::content(&self.metadata.path, error.to_string(), "bins of one shape")
    }
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
