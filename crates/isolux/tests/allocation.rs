//! Applying a chain allocates nothing after the first frame, whatever the frames hold.

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

use isolux::specular::{KneeRule, PercentRule, SigmaRule};
use isolux::standardize::{
    AngleStep, DenoiseStep, DistanceStep, Prepared, SigmaStep, SpecularStep, TimeStep, Workspace,
};
use isolux::terms::noise::AmplitudeNoise;
use isolux::terms::profile::{Map, Places};
use isolux::terms::response::ResponseTier;
use isolux::terms::{FitQuality, NoiseModel, Profile};
use isolux::{
    Calibration, Channels, Choice, DenoiseRule, Frame, IntegrationTime, Intrinsics, Plane, RecordingTraits,
    Reference, Shape, SpecularRule, Standardized, Standardizer,
};

/// Counts the allocations of each thread, and the bytes that are in use.
struct Counting;

thread_local! {
    static ALLOCATIONS: Cell<usize> = const { Cell::new(0) };
    static BYTES: Cell<isize> = const { Cell::new(0) };
}

// SAFETY: every call is handed on to the system's allocator unchanged; counting allocates nothing.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.with(|count| count.set(count.get() + 1));
        BYTES.with(|bytes| bytes.set(bytes.get() + layout.size() as isize));
        // SAFETY: the caller's promises are those that `System` asks for.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        BYTES.with(|bytes| bytes.set(bytes.get() - layout.size() as isize));
        // SAFETY: as above.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// A frame whose values spread the more the larger `spread` is; at 0 they are all the same.
fn frame(shape: Shape, spread: usize, per_pixel: bool) -> Frame {
    let mut frame = Frame::new(shape);
    frame.amplitude =
        Plane::from_fn(shape, |row, column| 100.0 + ((row * 31 + column * 17) % (1 + spread)) as f32);
    frame.distance_m = Some(Plane::filled(shape, 1.5));
    frame.integration_time_us = match per_pixel {
        true => IntegrationTime::PerPixel(Plane::from_fn(shape, |row, column| (1 + row + column) as f32)),
        false => IntegrationTime::PerFrame(4000.0),
    };
    frame.flag_amplitude(None);
    frame
}

#[test]
fn nothing_is_allocated_per_frame() {
    let channels = Channels::AMPLITUDE | Channels::DISTANCE | Channels::INTEGRATION_TIME;
    let percent = SpecularStep::Limit(SpecularRule::Percent(PercentRule::Quantile(0.9)));
    let sigma = SpecularStep::Limit(SpecularRule::Sigma(SigmaRule::default()));
    let knee = SpecularStep::Limit(SpecularRule::Knee(KneeRule::default()));
    for specular in [None, Some(SpecularStep::None), Some(percent), Some(sigma), Some(knee)] {
        let choice = Choice { specular, ..Choice::default() };
        let standardizer = Standardizer::plan(&choice, None, channels).unwrap();
        let shape = Shape::new(48, 64);
        let frames: Vec<Frame> = [(900, false), (0, false), (3, true), (5000, false), (0, true)]
            .map(|(spread, per_pixel)| frame(shape, spread, per_pixel))
            .into();
        let mut stream = standardizer.stream();
        stream.push(&frames[0]).unwrap();
        let before = ALLOCATIONS.get();
        for frame in &frames {
            stream.push(frame).unwrap();
        }
        assert_eq!(ALLOCATIONS.get() - before, 0, "{specular:?}");
    }
}

#[test]
fn nothing_is_allocated_per_predicted_frame() {
    let channels = Channels::AMPLITUDE | Channels::DISTANCE | Channels::INTEGRATION_TIME;
    let by_amplitude = AmplitudeNoise {
        read_variance_dn2: 4.0,
        shot_variance_dn2_per_dn: 0.5,
        ambient_variance_dn2_per_us: 1e-3,
    };
    let noise = Some(NoiseModel { by_amplitude, by_intensity: None });
    let shape = Shape::new(48, 64);
    let frames =
        [(900, false), (0, false), (3, true)].map(|(spread, per_pixel)| frame(shape, spread, per_pixel));
    for modulation_frequency_hz in [Some(20e6), None] {
        for denoise in [None, Some(DenoiseStep::Smooth(DenoiseRule::Wiener))] {
            let sigma = SigmaStep::Required;
            let choice = Choice { denoise, sigma, noise, ..Choice::default() };
            let traits = RecordingTraits { modulation_frequency_hz, ..channels.into() };
            let standardizer = Standardizer::plan(&choice, None, traits.clone()).unwrap();
            let (single, mut merge) = standardizer.bracket().unwrap();
            let (mut stream, mut merged) = (single.stream(), Standardized::new(shape));
            let mut before = 0;
            for round in 0..3 {
                // The first bracket makes the memory of all.
                if round == 1 {
                    before = ALLOCATIONS.get();
                }
                for frame in &frames {
                    merge.push(stream.push(frame).unwrap()).unwrap();
                }
                merge.finish(&mut merged);
            }
            assert_eq!(ALLOCATIONS.get() - before, 0, "{modulation_frequency_hz:?} {denoise:?}");
        }
    }
}

#[test]
fn nothing_is_allocated_per_denoised_frame() {
    let channels = Channels::AMPLITUDE | Channels::DISTANCE | Channels::INTEGRATION_TIME;
    let shape = Shape::new(48, 64);
    let mut frame = frame(shape, 900, false);
    frame.distance_m =
        Some(Plane::from_fn(shape, |row, column| 1.5 + ((row * 13 + column * 7) % 401) as f32 / 1000.0));
    for rule in [DenoiseRule::Median, DenoiseRule::Wiener, DenoiseRule::Plane, DenoiseRule::Temporal] {
        let choice = Choice { denoise: Some(DenoiseStep::Smooth(rule)), ..Choice::default() };
        let standardizer = Standardizer::plan(&choice, None, channels).unwrap();
        // Both forms: in one go, and in two steps for threads.
        let (mut stream, mut in_order) = (standardizer.stream(), standardizer.stream());
        let (mut prepared, mut workspace) = (Prepared::default(), Workspace::default());
        let mut out = Standardized::new(shape);
        let mut before = 0;
        for index in 0..20 {
            // The history fills for eight frames.
            if index == 8 {
                before = ALLOCATIONS.get();
            }
            in_order.prepare(&frame, &mut prepared).unwrap();
            standardizer.apply(&frame, &prepared, &mut workspace, &mut out).unwrap();
            assert!(stream.push(&frame).unwrap().amplitude.get(0, 0) == out.amplitude.get(0, 0));
        }
        assert_eq!(ALLOCATIONS.get() - before, 0, "{rule:?}");
    }
}

#[test]
fn a_stream_tells_the_bytes_that_it_holds() {
    let noise = Some(NoiseModel {
        by_amplitude: AmplitudeNoise { read_variance_dn2: 4.0, ..AmplitudeNoise::default() },
        by_intensity: None,
    });
    let shape = Shape::new(48, 64);
    let frame = frame(shape, 900, true);
    let traits = RecordingTraits {
        channels: Channels::AMPLITUDE | Channels::DISTANCE | Channels::INTEGRATION_TIME,
        shape: Some(shape),
        intrinsics: Some(Intrinsics { fx: 60.0, fy: 60.0, cx: 31.5, cy: 23.5 }),
        modulation_frequency_hz: None,
        ambient_light: None,
        relative_exposure: None,
    };
    for rule in DenoiseRule::ALL {
        let choice = Choice {
            denoise: Some(DenoiseStep::Smooth(*rule)),
            angle: Some(AngleStep::On),
            sigma: SigmaStep::Required,
            noise,
            ..Choice::default()
        };
        let standardizer = Standardizer::plan(&choice, None, traits.clone()).unwrap();
        let before = BYTES.get();
        let mut stream = standardizer.stream();
        for _ in 0..2 * isolux::denoise::TemporalMean::FRAMES {
            stream.push(&frame).unwrap();
        }
        // Lists of vectors and the like are not counted.
        let uncounted = usize::try_from(BYTES.get() - before).unwrap().checked_sub(stream.bytes());
        assert!(uncounted.is_some_and(|bytes| bytes < 1024), "{rule}: {uncounted:?} of {}", stream.bytes());
    }
}

#[test]
fn nothing_is_allocated_per_frame_with_profile_and_angle() {
    let shape = Shape::new(48, 64);
    let intrinsics = Intrinsics { fx: 60.0, fy: 60.0, cx: 31.5, cy: 23.5 };
    let traits = RecordingTraits {
        channels: Channels::AMPLITUDE | Channels::DISTANCE | Channels::INTEGRATION_TIME,
        shape: Some(shape),
        intrinsics: Some(intrinsics),
        modulation_frequency_hz: None,
        ambient_light: None,
        relative_exposure: None,
    };
    let profile = Profile {
        version: 1,
        map: Map {
            places: Places { shape, origin: [23.5, 31.5] },
            radial: [-0.5, 0.0],
            tensor: vec![0.0; 48],
        },
        support: vec!["#".repeat(16); 12],
        fitted_on: Vec::new(),
        fit: FitQuality { points: 1, residual: 0.0, held_out_residual: None },
        warnings: Vec::new(),
    };
    let mut calibration = Calibration::new(None, Reference::default());
    calibration.terms.profile = Some(profile);
    let choice = Choice { angle: Some(AngleStep::On), ..Choice::default() };
    let standardizer = Standardizer::plan(&choice, Some(&calibration), traits).unwrap();
    let frames: Vec<Frame> = [(900, false), (0, true)].map(|(spread, map)| frame(shape, spread, map)).into();
    let mut stream = standardizer.stream();
    stream.push(&frames[0]).unwrap();
    let before = ALLOCATIONS.get();
    for frame in &frames {
        stream.push(frame).unwrap();
    }
    assert_eq!(ALLOCATIONS.get() - before, 0);
}

#[test]
fn nothing_is_allocated_per_linearised_frame() {
    let shape = Shape::new(48, 64);
    let calibration: isolux::Calibration = serde_json::from_str(RESPONSE).unwrap();
    let channels = Channels::AMPLITUDE
        | Channels::DISTANCE
        | Channels::INTEGRATION_TIME
        | Channels::INTENSITY
        | Channels::PHASE_SAMPLES;
    let mut frame = frame(shape, 900, false);
    let bins = [1.5, 1.0, 0.5, 1.0].map(|share| {
        Plane::from_fn(shape, |row, column| share * (200.0 + ((row * 29 + column * 7) % 611) as f32))
    });
    frame.intensity = Some(bins[1].clone());
    frame.phase_samples = Some(bins);
    for tier in [ResponseTier::PhaseSamples, ResponseTier::Intensity, ResponseTier::Amplitude] {
        let time = Some(TimeStep::Response);
        let choice = Choice { time, response_tier: Some(tier), ..Choice::default() };
        let choice = Choice { distance: Some(DistanceStep::Square), ..choice };
        let standardizer = Standardizer::plan(&choice, Some(&calibration), channels).unwrap();
        let mut stream = standardizer.stream();
        stream.push(&frame).unwrap();
        let before = ALLOCATIONS.get();
        let summary = stream.push(&frame).unwrap().summary;
        assert_eq!(ALLOCATIONS.get() - before, 0, "{tier:?}");
        assert!(0 < summary.valid && summary.valid <= summary.pixels, "{tier:?} {summary:?}");
    }
}

/// A calibration that holds a response and nothing else.
const RESPONSE: &str = r#"{
    "format": "isolux-calibration", "version": 1, "created_by": "a test",
    "reference": {"integration_time_us": 8200, "distance_m": 0.75},
    "terms": {"response": {
        "version": 1,
        "amplitude": {"hinge_dn": [300], "increment": [0.1], "largest_dn": 900, "fitted_on": [],
            "fit": {"points": 9, "residual": 0}},
        "intensity": {"well": {"full_well_dn": 2000, "softness": 6, "black_level_dn": 0}, "largest_dn": 1700,
            "fitted_on": [], "fit": {"points": 9, "residual": 0}},
        "phase_samples": {"well": {"full_well_dn": 1500, "softness": 6, "black_level_dn": 10}, "largest_dn": 1200,
            "modulation_frequency_hz": 2e7, "fitted_on": [], "fit": {"points": 9, "residual": 0}},
        "warnings": []
    }},
    "warnings": []
}"#;
