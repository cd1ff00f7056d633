//! From loaded channels to a [`Frame`].

use isolux::{Channels, Frame, Lens, PixelFlags, Plane, phase};

use super::bins;
use super::distance::DistanceScale;
use super::loaded::Loaded;
use crate::error::RecordingError;
use crate::recording::channels::Places;
use crate::recording::info::RecordingInfo;
use crate::recording::source::SourceDescription;

/// What lives from frame to frame.
#[derive(Debug)]
pub(super) struct Scratch {
    distance_scale: DistanceScale,
    bins: Option<[Plane<f32>; 4]>,
    numbers: Vec<f32>,
}

impl Scratch {
    pub(super) fn new(description: &SourceDescription, places: &Places, lens: Option<Lens>) -> Self {
        let distance = places.get(Channels::DISTANCE).map(|place| description.channels[place].element);
        let distance_scale = DistanceScale::new(&description.info, distance, lens);
        Self { distance_scale, bins: None, numbers: Vec::new() }
    }
}

/// The channels that must be loaded for those that are wanted: phase samples also where something else is computed
/// from them or flagged by them.
pub(super) fn needed(wanted: Channels, places: &Places, info: &RecordingInfo) -> Channels {
    let amplitude = !places.has(Channels::AMPLITUDE) || info.saturated_phase_sample.is_some();
    let bins = wanted.contains(Channels::PHASE_SAMPLES)
        || (wanted.contains(Channels::AMPLITUDE) && amplitude)
        || (wanted.contains(Channels::DISTANCE) && !places.has(Channels::DISTANCE));
    let mut needed = wanted;
    needed.set(Channels::PHASE_SAMPLES, bins);
    needed
}

/// Fills `frame` with the `wanted` channels, all of them available; `needed` has been loaded. See
/// [`Recording::read_frame_if_there`](crate::recording::Recording::read_frame_if_there).
pub(super) fn fill(
    loaded: &Loaded<'_>,
    wanted: Channels,
    needed: Channels,
    scratch: &mut Scratch,
    frame: &mut Frame,
) -> Result<(), RecordingError> {
    let (shape, info) = (loaded.metadata.shape, &loaded.metadata.info);
    frame.flags.reshape(shape, PixelFlags::empty());
    frame.flags.fill(PixelFlags::empty());
    frame.amplitude.reshape(shape, f32::NAN);

    let has_bins = needed.contains(Channels::PHASE_SAMPLES) && bins::read(loaded, &mut scratch.bins)?;
    let bins = scratch.bins.as_ref().filter(|_| has_bins);
    if wanted.contains(Channels::AMPLITUDE) {
        fill_amplitude(loaded, bins, frame)?;
    } else {
        frame.amplitude.fill(f32::NAN);
    }
    if let (Some(bins), Some(clip)) = (bins, info.saturated_phase_sample) {
        bins::flag_clipped(bins, clip, &mut frame.flags);
    }
    if wanted.contains(Channels::DISTANCE) {
        let distance_m = frame.distance_m.get_or_insert_with(|| Plane::filled(shape, f32::NAN));
        fill_distance(loaded, bins, &mut scratch.distance_scale, distance_m)?;
    } else {
        frame.distance_m = None;
    }
    loaded.optional_plane(Channels::INTENSITY, wanted, &mut frame.intensity)?;
    loaded.optional_plane(Channels::VENDOR_AMPLITUDE, wanted, &mut frame.vendor_amplitude)?;
    loaded.optional_plane(Channels::VENDOR_CONFIDENCE, wanted, &mut frame.vendor_confidence)?;
    loaded.read_time(wanted, &mut frame.integration_time_us)?;
    loaded.read_target(wanted, &mut scratch.numbers, &mut frame.target)?;
    frame.timestamp_us = loaded.timestamp_us(wanted)?;
    frame.world_from_camera = loaded.pose(wanted)?;
    if wanted.contains(Channels::PHASE_SAMPLES) {
        // Swapped, not copied: the frame's old planes are the next frame's scratch.
        std::mem::swap(&mut frame.phase_samples, &mut scratch.bins);
    } else {
        frame.phase_samples = None;
    }
    Ok(())
}

fn fill_amplitude(
    loaded: &Loaded<'_>,
    bins: Option<&[Plane<f32>; 4]>,
    frame: &mut Frame,
) -> Result<(), RecordingError> {
    if !loaded.plane(Channels::AMPLITUDE, &mut frame.amplitude)?
        && let Some(bins) = bins
    {
        phase::amplitude_into(bins, &mut frame.amplitude).map_err(|error| unequal(loaded, &error))?;
    }
    frame.flag_amplitude(loaded.metadata.info.saturated_amplitude);
    Ok(())
}

fn fill_distance(
    loaded: &Loaded<'_>,
    bins: Option<&[Plane<f32>; 4]>,
    scale: &mut DistanceScale,
    distance_m: &mut Plane<f32>,
) -> Result<(), RecordingError> {
    if loaded.plane(Channels::DISTANCE, distance_m)? {
        scale.apply(distance_m);
    } else if let (Some(bins), Some(frequency_hz)) = (bins, loaded.metadata.info.modulation_frequency_hz) {
        // The bins are in the paper's sign already.
        phase::distance_into(bins, frequency_hz, false, distance_m)
            .map_err(|error| unequal(loaded, &error))?;
    }
    Ok(())
}

fn unequal(loaded: &Loaded<'_>, error: &isolux::ShapeError) -> RecordingError {
    RecordingError::content(&loaded.metadata.path, error.to_string(), "bins of one shape")
}
