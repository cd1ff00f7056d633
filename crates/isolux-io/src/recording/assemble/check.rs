//! Checks that the channels make one recording, and finds out what can be read from it.

use std::path::Path;
use std::sync::Arc;

use isolux::{Channels, Lens, PhaseConvention, RayTable, Shape};

use crate::error::{RecordingError, dims_text};
use crate::recording::channels::{self, FrameDims, Places};
use crate::recording::element::ElementType;
use crate::recording::frequency::ModulationFrequency;
use crate::recording::info::{DistanceKind, RecordingInfo};
use crate::recording::lens::LensDescription;
use crate::recording::metadata::{self, ChannelInfo, Metadata, Storage};
use crate::recording::phase_layout::PhaseLayout;
use crate::recording::source::{SourceDescription, StoredChannel};

/// What reading needs to know of a recording.
#[derive(Clone, Debug)]
pub(super) struct Layout {
    pub(super) metadata: Metadata,
    pub(super) places: Places,
}

/// Checks that the channels make one recording, and that `rays` are those of its pixels.
pub(super) fn check(
    description: &SourceDescription,
    rays: Option<Arc<RayTable>>,
) -> Result<Layout, RecordingError> {
    let names = description.channels.iter().map(|channel| channel.name.as_str());
    let shape = shape(description, channels::leading(&description.path, names.clone())?)?;
    let mut stored = Channels::empty();
    for (place, channel) in description.channels.iter().enumerate() {
        check_channel(channel, shape)?;
        if names.clone().take(place).any(|earlier| earlier == channel.name) {
            let found = format!("two channels named `{}`", channel.name);
            return Err(RecordingError::content(&channel.path, found, "each name once"));
        }
        stored |= channels::flag(&channel.name);
    }
    check_info(&description.info, &description.info_path, stored)?;
    check_lens(description, rays.as_ref(), shape, stored)?;
    let phases = description.channels.iter().find(|channel| channel.name == "phase_samples");
    let layout = phases.and_then(|channel| PhaseLayout::of(channel.element, &channel.frame_dims));
    if let Some(layout) = layout {
        check_phases(&description.info, &description.info_path, layout)?;
    }
    let mut available = available(stored, &description.info);
    // Frames carry raw bins or none.
    available.set(Channels::PHASE_SAMPLES, layout.is_some_and(|layout| !layout.is_iq()));
    let metadata = Metadata {
        path: description.path.clone(),
        frame_count: description.frame_count,
        access: description.access,
        shape,
        channels: list_channels(description, shape, available & !stored),
        available,
        info: description.info.clone(),
        rays,
    };
    Ok(Layout { metadata, places: Places::of(names) })
}

/// The shape of the frames, from the most important channel that has one.
fn shape(description: &SourceDescription, leading: usize) -> Result<Shape, RecordingError> {
    let channel = &description.channels[leading];
    let kind = FrameDims::of(&channel.name, channel.element);
    let shape = kind.shape(&channel.frame_dims).filter(|shape| shape.height > 0 && shape.width > 0);
    let Some(shape) = shape.filter(|_| description.frame_count != Some(0)) else {
        let frames = description.frame_count.map_or(String::new(), |count| format!("{count} "));
        let found = format!("{frames}frames of {}", dims_text(&channel.frame_dims));
        let expected = format!("{} with at least one frame and one pixel", kind.written(""));
        return Err(RecordingError::content(&channel.path, found, expected));
    };
    Ok(shape)
}

fn check_channel(channel: &StoredChannel, shape: Shape) -> Result<(), RecordingError> {
    channels::frame_values(&channel.path, &channel.frame_dims)?;
    let kind = FrameDims::of(&channel.name, channel.element);
    if channel.element.is_complex() && !matches!(kind, FrameDims::Iq | FrameDims::Anything) {
        let found = format!("values of type {}", channel.element);
        return Err(RecordingError::content(
            &channel.path,
            found,
            "real numbers; only `phase_samples` may be complex",
        ));
    }
    if !kind.allows(&channel.frame_dims, shape) {
        let allowed: Vec<_> = kind.allowed(shape).iter().map(|dims| dims_text(dims)).collect();
        let expected = if allowed.is_empty() { "no dimension of 0".to_owned() } else { allowed.join(" or ") };
        let found = format!("frames of {}", dims_text(&channel.frame_dims));
        return Err(RecordingError::content(&channel.path, found, expected));
    }
    if channels::flag(&channel.name) == Channels::TARGET && !channel.element.is_integer() {
        let found = format!("labels of type {}", channel.element);
        return Err(RecordingError::content(&channel.path, found, "uint8"));
    }
    Ok(())
}

/// Checks the description of the recording against the stored channels.
fn check_info(info: &RecordingInfo, path: &Path, stored: Channels) -> Result<(), RecordingError> {
    let error = |field: &str, found: &str, expected: &str| {
        Err(RecordingError::Info {
            path: path.to_owned(),
            field: field.to_owned(),
            found: found.to_owned(),
            expected: expected.to_owned(),
        })
    };
    if info.integration_time_us.is_some() && stored.contains(Channels::INTEGRATION_TIME) {
        let expected = "either the constant or the channel `integration_time_us`; remove one";
        return error("integration_time_us", "both", expected);
    }
    Ok(())
}

/// Checks what the description says of the phase samples.
fn check_phases(info: &RecordingInfo, path: &Path, layout: PhaseLayout) -> Result<(), RecordingError> {
    let error = |field: &str, found: &str, expected: &str| {
        let (field, found, expected) = (field.to_owned(), found.to_owned(), expected.to_owned());
        Err(RecordingError::Info { path: path.to_owned(), field, found, expected })
    };
    let (field, frequency) = ("modulation_frequency_hz", info.modulation_frequency_hz);
    let pair = matches!(frequency, Some(ModulationFrequency::Pair(_)));
    if layout.is_twice() && !pair {
        let found = if frequency.is_some() { "one frequency" } else { "nothing" };
        return error(field, found, "[first, second]: `phase_samples` are of two frequencies");
    }
    if pair && !layout.is_twice() {
        return error(field, "two frequencies", "one: `phase_samples` are of a single frequency");
    }
    let order = info.phase_convention.unwrap_or_default().order;
    if layout.is_iq() && order != PhaseConvention::default().order {
        let expected = "no order, only `reversed`: `phase_samples` are I and Q, not four bins";
        return error("phase_convention", &format!("the order {order:?}"), expected);
    }
    Ok(())
}

/// Checks that the lens is one of these images, and that depths can be made distances with it.
fn check_lens(
    description: &SourceDescription,
    rays: Option<&Arc<RayTable>>,
    shape: Shape,
    stored: Channels,
) -> Result<(), RecordingError> {
    let error = |field: &str, found: String, expected: &str| {
        Err(RecordingError::Info {
            path: description.info_path.clone(),
            field: field.to_owned(),
            found,
            expected: expected.to_owned(),
        })
    };
    let info = &description.info;
    let LensDescription { lens, unused } = metadata::lens_of(rays, info, shape);
    if let Some(wrong) = lens.as_ref().and_then(|lens| lens.check_shape(shape).err()) {
        return match lens {
            Some(Lens::Rays(_)) => {
                Err(RecordingError::content(&description.path.join("rays"), wrong.found(), wrong.expected()))
            }
            _ => error("intrinsics", wrong.found(), &wrong.expected()),
        };
    }
    let depth = info.distance_kind == Some(DistanceKind::Z) && stored.contains(Channels::DISTANCE);
    match lens {
        Some(lens) if depth && !lens.has_axis() => {
            let expected = "\"radial\": a lidar that spins has no axis along which depth is measured";
            error("distance_kind", "\"z\"".to_owned(), expected)
        }
        None if depth => {
            let found = unused.map_or("nothing".to_owned(), |unused| unused.to_string());
            let expected =
                "{fx, fy, cx, cy} or a table of rays: without them the z distance cannot be made radial";
            error("intrinsics", found, expected)
        }
        _ => Ok(()),
    }
}

/// What frames can carry: what is stored, constant, or computed from the phase samples.
fn available(stored: Channels, info: &RecordingInfo) -> Channels {
    let mut available = stored;
    if info.integration_time_us.is_some() {
        available |= Channels::INTEGRATION_TIME;
    }
    if stored.contains(Channels::PHASE_SAMPLES) {
        available |= Channels::AMPLITUDE;
        if info.modulation_frequency_hz.is_some() {
            available |= Channels::DISTANCE;
        }
    }
    available
}

fn list_channels(description: &SourceDescription, shape: Shape, computed: Channels) -> Vec<ChannelInfo> {
    let stored = description.channels.iter().map(|channel| ChannelInfo {
        name: channel.name.clone(),
        element: channel.element,
        frame_dims: channel.frame_dims.clone(),
        storage: Storage::Stored { note: channel.note.clone() },
    });
    let computed = computed.iter().map(|flag| {
        let constant = flag == Channels::INTEGRATION_TIME;
        ChannelInfo {
            name: channels::name(flag).to_owned(),
            element: if constant { ElementType::F64 } else { ElementType::F32 },
            frame_dims: if constant { Vec::new() } else { vec![shape.height, shape.width] },
            storage: if constant { Storage::Constant } else { Storage::FromPhaseSamples },
        }
    });
    stored.chain(computed).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::metadata::Access;

    fn channel(name: &str, frame_dims: &[usize]) -> StoredChannel {
        StoredChannel {
            name: name.to_owned(),
            path: name.into(),
            element: ElementType::U16,
            frame_dims: frame_dims.to_vec(),
            note: String::new(),
        }
    }

    fn layout(channels: &[StoredChannel], json: &str) -> Result<Metadata, RecordingError> {
        let info_path = Path::new("recording.json");
        let description = SourceDescription {
            path: "rec".into(),
            frame_count: None,
            access: Access::Once,
            channels: channels.to_vec(),
            info: RecordingInfo::from_json(json.as_bytes(), info_path).unwrap(),
            info_path: info_path.to_owned(),
        };
        check(&description, None).map(|layout| layout.metadata)
    }

    #[test]
    fn phase_samples_stand_in_for_amplitude_and_with_a_frequency_for_distance() {
        let bins = [channel("phase_samples", &[4, 2, 3])];
        let layout_without = layout(&bins, "{}").unwrap();
        assert_eq!(layout_without.shape, Shape::new(2, 3));
        assert_eq!(layout_without.available, Channels::PHASE_SAMPLES | Channels::AMPLITUDE);
        let layout_with =
            layout(&bins, r#"{"modulation_frequency_hz": 2e7, "integration_time_us": 3}"#).unwrap();
        let more = Channels::DISTANCE | Channels::INTEGRATION_TIME;
        assert_eq!(layout_with.available, layout_without.available | more);
        let names: Vec<_> = layout_with.channels.iter().map(|channel| channel.name.as_str()).collect();
        assert_eq!(names, ["phase_samples", "amplitude", "distance", "integration_time_us"]);
    }

    #[test]
    fn frames_that_do_not_fit_are_named_with_what_would() {
        let amplitude = channel("amplitude", &[2, 3]);
        let cases = [
            (channel("distance", &[3, 3]), "`distance`: found frames of (3, 3), expected (2, 3)"),
            (channel("integration_time_us", &[2]), "found frames of (2,), expected () or (2, 3)"),
            (channel("phase_samples", &[3, 2, 3]), "expected (4, 2, 3)"),
            (channel("world_from_camera", &[3, 4]), "expected (4, 4)"),
            (channel("notes", &[1, 0]), "no dimension of 0"),
            (channel("notes", &[1 << 20, 1 << 20]), "at most 67108864 values in a frame"),
            (channel("amplitude", &[2, 3]), "two channels named `amplitude`"),
        ];
        for (other, expected) in cases {
            let message = layout(&[amplitude.clone(), other], "{}").unwrap_err().to_string();
            assert!(message.contains(expected), "{message}");
        }
    }

    #[test]
    fn nothing_is_no_recording() {
        for dims in [&[0, 3][..], &[2, 0], &[2], &[1, 2, 3]] {
            let message = layout(&[channel("amplitude", dims)], "{}").unwrap_err().to_string();
            assert!(message.contains("expected (H, W) with at least one frame and one pixel"), "{message}");
        }
        let message = layout(&[channel("distance", &[2, 3])], "{}").unwrap_err().to_string();
        assert!(
            message.contains("found no `amplitude` and no `phase_samples`, only `distance`"),
            "{message}"
        );
    }

    #[test]
    fn labels_are_whole_numbers() {
        let target = StoredChannel { element: ElementType::F32, ..channel("target", &[2, 3]) };
        let message = layout(&[channel("amplitude", &[2, 3]), target], "{}").unwrap_err().to_string();
        assert!(message.contains("found labels of type float32, expected uint8"), "{message}");
    }

    #[test]
    fn z_needs_intrinsics_and_times_come_from_one_place() {
        let channels = [
            channel("amplitude", &[2, 3]),
            channel("distance", &[2, 3]),
            channel("integration_time_us", &[]),
        ];
        let message = layout(&channels, r#"{"distance_kind": "z"}"#).unwrap_err().to_string();
        assert!(message.contains("field `intrinsics`: found nothing"), "{message}");
        assert!(layout(&channels[..1], r#"{"distance_kind": "z"}"#).is_ok());
        let message = layout(&channels, r#"{"integration_time_us": 5}"#).unwrap_err().to_string();
        assert!(message.contains("field `integration_time_us`: found both"), "{message}");
    }
}
