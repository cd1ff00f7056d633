//! From loaded channels to a [`Frame`].

use isolux::{Channels, Frame, Lens, PixelFlags, Plane};

use super::codes;
use super::distance::DistanceScale;
use super::loaded::Loaded;
use super::phases::Phases;
use crate::error::RecordingError;
use crate::recording::channels::Places;
use crate::recording::info::RecordingInfo;
use crate::recording::phase_layout::PhaseLayout;
use crate::recording::source::SourceDescription;

/// What lives from frame to frame.
#[derive(Debug)]
pub(super) struct Scratch {
    distance_scale: DistanceScale,
    phases: Option<Phases>,
    numbers: Vec<f32>,
}

impl Scratch {
    pub(super) fn new(description: &SourceDescription, places: &Places, lens: Option<Lens>) -> Self {
        let distance = places.get(Channels::DISTANCE).map(|place| description.channels[place].element);
        let distance_scale = DistanceScale::new(&description.info, distance, lens);
        let frequency = description.info.modulation_frequency_hz;
        let layout = places.get(Channels::PHASE_SAMPLES).and_then(|place| {
            let channel = &description.channels[place];
            PhaseLayout::of(channel.element, &channel.frame_dims)
        });
        let phases = layout.map(|layout| Phases::new(layout, frequency));
        Self { distance_scale, phases, numbers: Vec::new() }
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

    let mut phases = scratch.phases.as_mut().filter(|_| needed.contains(Channels::PHASE_SAMPLES));
    if let Some(phases) = &mut phases {
        phases.read(loaded)?;
    }
    if wanted.contains(Channels::AMPLITUDE) {
        fill_amplitude(loaded, phases.as_deref(), frame)?;
    } else {
        frame.amplitude.fill(f32::NAN);
    }
    if let (Some(phases), Some(clip)) = (&phases, info.saturated_phase_sample) {
        phases.flag_clipped(clip, &mut frame.flags);
    }
    if wanted.contains(Channels::DISTANCE) {
        let distance_m = frame.distance_m.get_or_insert_with(|| Plane::filled(shape, f32::NAN));
        let phases = phases.as_deref_mut();
        fill_distance(loaded, phases, &mut scratch.distance_scale, distance_m, &mut frame.flags)?;
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
    match phases.filter(|_| wanted.contains(Channels::PHASE_SAMPLES)) {
        // Swapped, not copied: the frame's old planes are the next frame's scratch.
        Some(phases) => std::mem::swap(&mut frame.phase_samples, &mut phases.bins),
        None => frame.phase_samples = None,
    }
    Ok(())
}

fn fill_amplitude(
    loaded: &Loaded<'_>,
    phases: Option<&Phases>,
    frame: &mut Frame,
) -> Result<(), RecordingError> {
    if !loaded.plane(Channels::AMPLITUDE, &mut frame.amplitude)?
        && let Some(phases) = phases
    {
        phases.amplitude_into(loaded, &mut frame.amplitude)?;
    }
    frame.flag_amplitude(loaded.metadata.info.saturated_amplitude);
    if let Some(codes) = &loaded.metadata.info.codes {
        codes::amplitude(&codes.amplitude, frame);
    }
    Ok(())
}

fn fill_distance(
    loaded: &Loaded<'_>,
    phases: Option<&mut Phases>,
    scale: &mut DistanceScale,
    distance_m: &mut Plane<f32>,
    flags: &mut Plane<PixelFlags>,
) -> Result<(), RecordingError> {
    if loaded.plane(Channels::DISTANCE, distance_m)? {
        if let Some(codes) = &loaded.metadata.info.codes {
            codes::distance(&codes.distance, distance_m, flags);
        }
        scale.apply(distance_m);
    } else if let Some(phases) = phases {
        phases.distance_into(loaded, distance_m)?;
    }
    Ok(())
}
