//! Measures the noise of a recording in groups of like amplitude, distance and place.

use super::solve::{AmbientUnknown, Group, Light, solve};
use crate::calibrate::grouped_noise::{Compared, GroupedNoise};
use crate::denoise::{DenoiseRule, Denoiser};
use crate::frame::{Frame, IntegrationTime, Plane, Shape};
use crate::numerics::differences;
use crate::numerics::statistics::median;
use crate::standardize::AmbientLight;
use crate::terms::DistanceTable;
use crate::terms::response::AmbientResponse;

/// Pixels of a frame that are looked at; more would add nothing.
const PIXELS: usize = 1 << 16;
/// Rings of equal area around the centre of the image.
const RINGS: f32 = 4.0;
/// Distances of two frames of a still scene differ by 0.95 σ in the median; by more than this many σ, it moves.
const STILL: f64 = 2.0;
/// Lights of parts of a recording differ when they scatter by this many of their standard errors, root mean square...
const SIGNIFICANT: f64 = 2.0;
/// ...and by this share of the light.
const RELEVANT: f64 = 0.1;
/// Relative error of a light that is taken to be even, with surfaces that face the camera: on simulated desks, whose
/// table tops do not, the light comes out 1.2 to 1.4 times too strong.
const UNEVEN: f64 = 0.2;
/// Fewer parts show no drift.
const LEAST_PARTS: usize = 3;

/// Collects the noise of some frames of a recording. Frames that follow each other tell more than single ones.
///
/// Call [`Self::part`] before frames from another place of the recording, [`Self::push`] for each frame, and
/// [`Self::finish`] for the light.
#[derive(Clone, Debug)]
pub struct AmbientSurvey {
    response: AmbientResponse,
    /// Amplitude per µs of the calibration's target, by the distance.
    target_dn_per_us: DistanceTable,
    denoiser: Denoiser,
    rings: Plane<f32>,
    current: GroupedNoise,
    /// Time (µs) and distances of the last frame.
    previous: Option<(f64, Vec<f32>)>,
    first: usize,
    next: usize,
    parts: Vec<Part>,
}

/// Frames that follow each other.
#[derive(Clone, Debug)]
struct Part {
    middle_frame: usize,
    groups: Vec<Group>,
    spatial: bool,
}

impl AmbientSurvey {
    /// A survey without frames, for a camera of this response.
    #[must_use]
    pub fn new(response: &AmbientResponse) -> Self {
        Self {
            target_dn_per_us: response.target_table(),
            response: response.clone(),
            denoiser: Denoiser::default(),
            rings: Plane::filled(Shape::new(0, 0), f32::NAN),
            current: GroupedNoise::new(1),
            previous: None,
            first: 0,
            next: 0,
            parts: Vec::new(),
        }
    }

    /// States that the next frame is this one of the recording, counted from 0, and does not follow the last one.
    pub fn part(&mut self, frame: usize) {
        self.end_part();
        (self.first, self.next) = (frame, frame);
    }

    /// Takes the next frame. One without distances or without one time for all pixels, or whose planes differ in shape,
    /// is ignored.
    pub fn push(&mut self, frame: &Frame) {
        self.next += 1;
        let IntegrationTime::PerFrame(time_us) = frame.integration_time_us else { return self.interrupt() };
        let Some(distance_m) = frame.distance_m.as_ref().filter(|_| frame.check_shapes().is_ok()) else {
            return self.interrupt();
        };
        if self.rings.shape() != frame.shape() {
            self.rings = rings(frame.shape());
            let stride = frame.shape().pixels().div_ceil(PIXELS).max(1);
            self.current = GroupedNoise::new(stride);
            self.previous = None;
        }
        let repeats = self
            .previous
            .as_ref()
            .is_some_and(|(before_us, before_m)| *before_us == time_us && stands_still(before_m, distance_m));
        if !repeats {
            self.current.interrupt();
        }
        let denoised = self.denoiser.denoise(DenoiseRule::Wiener, frame, distance_m, false).distance_m;
        let target = |&distance_m: &f32| {
            if distance_m > 0.0 { self.target_dn_per_us.at(distance_m) } else { f32::NAN }
        };
        let light = denoised.iter().map(target).collect();
        let class = self.rings.values().to_vec();
        let amplitude = frame.counted_amplitudes().collect();
        self.current.push(frame.shape(), Compared { amplitude, light: Some(light), class });
        self.previous = Some((time_us, distance_m.values().to_vec()));
    }

    fn interrupt(&mut self) {
        self.current.interrupt();
        self.previous = None;
    }

    fn end_part(&mut self) {
        self.previous = None;
        let (groups, spatial) = self.current.take();
        let groups: Vec<Group> = groups.iter().filter_map(|group| Group::of(group, RINGS)).collect();
        if !groups.is_empty() {
            let middle_frame = usize::midpoint(self.first, self.next.saturating_sub(1));
            self.parts.push(Part { middle_frame, groups, spatial });
        }
    }

    /// The light of the frames so far.
    ///
    /// # Errors
    /// [`AmbientUnknown`] where the noise does not tell it.
    pub fn finish(mut self) -> Result<AmbientLight, AmbientUnknown> {
        self.end_part();
        // Differences between frames are free of texture: those between pixels count only where there are no others.
        let spatial = self.parts.iter().all(|part| part.spatial);
        self.parts.retain(|part| part.spatial == spatial);
        let pooled: Vec<Group> = self.parts.iter().flat_map(|part| part.groups.iter().copied()).collect();
        let whole = solve(&self.response, &pooled, None);
        let parts = self.solved_parts(whole.as_ref().map_or(0.0, |light| light.growth));
        match whole {
            Ok(light) if !drifts(&parts, light.dn_per_us) => Ok(steady(light)),
            // One light does not explain the noise of all parts, but each part has one.
            Ok(_) | Err(AmbientUnknown::OtherNoise { .. }) if parts.len() >= LEAST_PARTS => {
                Ok(drifting(&parts))
            }
            Ok(light) => Ok(steady(light)),
            Err(unknown) => Err(unknown),
        }
    }

    /// The light of each part; none where not all parts tell one.
    fn solved_parts(&self, growth: f64) -> Vec<(usize, Light)> {
        let solved =
            |part: &Part| Some((part.middle_frame, solve(&self.response, &part.groups, Some(growth)).ok()?));
        let parts: Option<Vec<_>> = self.parts.iter().map(solved).collect();
        parts.unwrap_or_default()
    }
}

fn steady(Light { dn_per_us, error_dn_per_us, growth }: Light) -> AmbientLight {
    AmbientLight {
        dn_per_us,
        error_dn_per_us: whole_error(dn_per_us, error_dn_per_us),
        growth,
        course: Vec::new(),
    }
}

fn drifting(parts: &[(usize, Light)]) -> AmbientLight {
    let mean = |value: fn(&Light) -> f64| {
        parts.iter().map(|(_, light)| value(light)).sum::<f64>() / parts.len() as f64
    };
    let dn_per_us = mean(|light| light.dn_per_us);
    AmbientLight {
        dn_per_us,
        error_dn_per_us: whole_error(dn_per_us, mean(|light| light.error_dn_per_us)),
        growth: mean(|light| light.growth),
        course: parts.iter().map(|(frame, light)| (*frame, light.dn_per_us)).collect(),
    }
}

/// The error by noise and the model of the pixel, with that of the scene.
fn whole_error(dn_per_us: f64, error_dn_per_us: f64) -> f64 {
    error_dn_per_us.hypot(UNEVEN * dn_per_us)
}

/// Whether the lights of the parts differ from the light of the whole by more than chance, and by enough to matter.
fn drifts(parts: &[(usize, Light)], whole: f64) -> bool {
    if parts.len() < LEAST_PARTS {
        return false;
    }
    let count = parts.len() as f64;
    let deviation = |light: &Light| light.dn_per_us - whole;
    let squares = parts.iter().map(|(_, light)| (deviation(light) / light.error_dn_per_us).powi(2));
    let scatter = parts.iter().map(|(_, light)| deviation(light).powi(2)).sum::<f64>() / count;
    squares.sum::<f64>() > SIGNIFICANT * SIGNIFICANT * count && scatter.sqrt() > RELEVANT * whole
}

/// Number of the ring of each pixel, from 1 at the centre.
fn rings(shape: Shape) -> Plane<f32> {
    Plane::from_fn(shape, |row, column| {
        1.0 + (AmbientLight::radius_squared(shape, row, column) * RINGS).min(RINGS - 0.5).floor()
    })
}

/// Whether two frames have the same distances, but for their noise.
fn stands_still(before_m: &[f32], now: &Plane<f32>) -> bool {
    let valid = |value: f32| value > 0.0 && value.is_finite();
    let rows: Vec<f64> =
        now.values().iter().map(|&d| if valid(d) { f64::from(d) } else { f64::NAN }).collect();
    let Some(sigma_m) = differences::spatial(rows.chunks(now.shape().width.max(1))) else { return false };
    let pairs = before_m.iter().zip(now.values()).filter(|(before, now)| valid(**before) && valid(**now));
    let mut changes: Vec<f64> = pairs.map(|(before, now)| f64::from((now - before).abs())).collect();
    median(&mut changes).is_some_and(|change_m| change_m <= STILL * sigma_m)
}
