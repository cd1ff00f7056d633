//! Measuring recordings of labelled targets in any pose: medians of small windows inside a label, frame by frame. A row
//! of pixels at the label's border that see two materials moves no median by much.

mod fit;
mod gloss;
mod patches;
mod report;
mod rows;
#[cfg(test)]
mod tests;

pub(super) use fit::fit;
pub use report::{SurfaceUse, TargetReport};

use super::{CalibrateError, CalibrateSettings};
use crate::frame::{Frame, IntegrationTime, Intrinsics, PixelFlags, Plane, Shape};
use crate::surface::Incidence;
use patches::{PATCH_PX, Patches};

/// A window's median amplitude must stand this many times above its pixels' scatter: fainter ones are biased.
const LEAST_SIGNAL_TO_NOISE: f64 = 5.0;
/// Standard deviation that no window's median is trusted beyond, in ln: the unevenness of targets.
const UNEVENNESS: f64 = 0.01;
/// Distances within a window may spread by this share of their median; more is an edge.
const LARGEST_SPREAD: f64 = 0.1;

/// A labelled target, measured frame by frame.
#[derive(Clone, Debug)]
pub struct TargetSweep {
    recording: String,
    settings: CalibrateSettings,
    intrinsics: Option<Intrinsics>,
    shape: Option<Shape>,
    frames: usize,
    frames_used: usize,
    patches: Patches,
    incidence: Incidence,
    windows: Vec<Window>,
    without_normal: usize,
    linear: bool,
}

/// One window of one frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Window {
    pub(super) frame: u32,
    pub(super) label: u8,
    /// µs; NaN where it is unknown.
    pub(super) time_us: f32,
    pub(super) ln_amplitude: f32,
    /// m; NaN where the recording has none.
    pub(super) distance_m: f32,
    /// Row and column of the middle.
    pub(super) pixel: [u16; 2],
    /// NaN where it is not known.
    pub(super) cosine: f32,
    pub(super) weight: f32,
}

/// What a recording of targets says.
#[derive(Clone, Debug)]
pub struct TargetWindows {
    pub(super) recording: String,
    pub(super) intrinsics: Option<Intrinsics>,
    pub(super) shape: Option<Shape>,
    pub(super) frames: usize,
    pub(super) frames_used: usize,
    pub(super) windows: Vec<Window>,
    pub(super) without_normal: usize,
    /// Made linear before they were measured.
    pub(super) linear: bool,
}

impl TargetWindows {
    /// Number of windows that were measured.
    #[must_use]
    pub fn len(&self) -> usize {
        self.windows.len()
    }

    /// True when no window could be measured.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.windows.is_empty()
    }
}

impl TargetSweep {
    /// Starts a recording; `recording` is the name that errors and the calibration give it. Without `intrinsics`, there
    /// are no angles.
    #[must_use]
    pub fn new(
        recording: impl Into<String>,
        settings: &CalibrateSettings,
        intrinsics: Option<Intrinsics>,
    ) -> Self {
        Self {
            recording: recording.into(),
            settings: settings.clone(),
            intrinsics: intrinsics.filter(Intrinsics::is_usable),
            shape: None,
            frames: 0,
            frames_used: 0,
            patches: Patches::default(),
            incidence: Incidence::default(),
            windows: Vec::new(),
            without_normal: 0,
            linear: false,
        }
    }

    /// Says that the frames are linear in the light, as [`FrameLineariser`](crate::standardize::FrameLineariser) makes
    /// them: their amplitudes grow with the integration time itself, not with the table.
    #[must_use]
    pub fn of_linear_frames(self) -> Self {
        Self { linear: true, ..self }
    }

    /// Measures the next frame. Its integration time may be unknown or a map, its distance missing.
    ///
    /// # Errors
    /// [`CalibrateError`] when the frame has no labels, planes that do not fit, or another shape than the first.
    pub fn push(&mut self, frame: &Frame) -> Result<(), CalibrateError> {
        let number = self.frames;
        frame.check_shapes().map_err(|source| CalibrateError::Shape { frame: number, source })?;
        let target = frame.target.as_ref().ok_or(CalibrateError::NoTarget { frame: number })?;
        let shape = *self.shape.get_or_insert(frame.shape());
        target
            .expect_shape("target", shape)
            .map_err(|source| CalibrateError::Shape { frame: number, source })?;
        self.frames += 1;
        if let IntegrationTime::PerFrame(time_us) = frame.integration_time_us
            && self.settings.excludes(time_us)
        {
            return Ok(());
        }
        if let (Some(distance_m), Some(intrinsics)) = (&frame.distance_m, &self.intrinsics) {
            self.incidence.take(frame, distance_m, intrinsics);
        }
        let before = self.windows.len();
        for &(row, column) in self.patches.find(target) {
            let Some(mut window) = measure(frame, target, (row, column)) else { continue };
            window.frame = u32::try_from(number).unwrap_or(u32::MAX);
            if let (Some(_), Some(intrinsics)) = (&frame.distance_m, &self.intrinsics) {
                let cosine = |index| self.incidence.cosine(index, intrinsics);
                window.cosine = middle_cosine(cosine, shape, (row, column));
                self.without_normal += usize::from(window.cosine.is_nan());
            }
            self.windows.push(window);
        }
        self.frames_used += usize::from(self.windows.len() > before);
        Ok(())
    }

    /// Ends the recording.
    #[must_use]
    pub fn finish(self) -> TargetWindows {
        TargetWindows {
            recording: self.recording,
            intrinsics: self.intrinsics,
            shape: self.shape,
            frames: self.frames,
            frames_used: self.frames_used,
            windows: self.windows,
            without_normal: self.without_normal,
            linear: self.linear,
        }
    }
}

/// The windows of 5×5 pixels that are measured in an image of labels: each lies inside one label above 0, and none
/// overlaps another.
#[must_use]
pub fn label_windows(target: &Plane<u8>) -> Vec<crate::frame::Window> {
    let mut patches = Patches::default();
    let window =
        |&(top, left): &(usize, usize)| crate::frame::Window { top, left, height: PATCH_PX, width: PATCH_PX };
    patches.find(target).iter().map(window).collect()
}

/// Indices of the window whose first pixel is at (row, column).
fn indices(shape: Shape, (row, column): (usize, usize)) -> impl Iterator<Item = usize> {
    let rows = row..row + PATCH_PX;
    rows.flat_map(move |row| (column..column + PATCH_PX).map(move |column| row * shape.width + column))
}

/// Medians over a window; `None` where it is saturated, faint, uneven in depth, or mostly without a measurement.
fn measure(frame: &Frame, target: &Plane<u8>, corner: (usize, usize)) -> Option<Window> {
    const PIXELS: usize = PATCH_PX * PATCH_PX;
    let shape = frame.shape();
    let (mut logs, mut distances) = ([0.0; PIXELS], [0.0; PIXELS]);
    let (mut count, mut time_us) = (0, None);
    for index in indices(shape, corner) {
        if frame.flags.values()[index].intersects(PixelFlags::SATURATED) {
            return None;
        }
        let here_us = match &frame.integration_time_us {
            IntegrationTime::Unknown => f32::NAN,
            IntegrationTime::PerFrame(time_us) => *time_us as f32,
            IntegrationTime::PerPixel(map) => map.values()[index],
        };
        if *time_us.get_or_insert(here_us) != here_us && !here_us.is_nan() {
            return None;
        }
        let distance_m = frame.distance_m.as_ref().map_or(f32::NAN, |plane| plane.values()[index]);
        let measured = frame.distance_m.is_none() || (distance_m > 0.0 && distance_m < f32::INFINITY);
        let amplitude = frame.amplitude.values()[index];
        if frame.is_valid(index) && amplitude > 0.0 && measured {
            logs[count] = f64::from(amplitude).ln();
            distances[count] = f64::from(distance_m);
            count += 1;
        }
    }
    if count * 5 < PIXELS * 4 {
        return None;
    }
    let (ln_amplitude, scatter) = centre_and_scatter(&mut logs[..count])?;
    let (distance_m, distance_scatter) = centre_and_scatter(&mut distances[..count])?;
    if scatter * LEAST_SIGNAL_TO_NOISE > 1.0 || distance_scatter > LARGEST_SPREAD * distance_m {
        return None;
    }
    // A median of n normal values has the standard error 1.25 σ / √n.
    let variance = (1.25 * scatter).powi(2) / count as f64;
    let middle = |start: usize| u16::try_from(start + PATCH_PX / 2).unwrap_or(u16::MAX);
    Some(Window {
        frame: 0,
        label: target.get(corner.0, corner.1)?,
        time_us: time_us.unwrap_or(f32::NAN),
        ln_amplitude: ln_amplitude as f32,
        distance_m: distance_m as f32,
        pixel: [middle(corner.0), middle(corner.1)],
        cosine: f32::NAN,
        weight: (UNEVENNESS.powi(2) / (UNEVENNESS.powi(2) + variance)) as f32,
    })
}

/// Median and 1.4826 MAD. NaN are kept out by the caller, but for distances that the recording lacks.
fn centre_and_scatter(values: &mut [f64]) -> Option<(f64, f64)> {
    let centre = crate::numerics::statistics::median(values)?;
    let scatter = crate::numerics::statistics::median_absolute_deviation(values)?;
    Some((centre, crate::numerics::statistics::SIGMA_PER_MAD * scatter))
}

/// Median of the window's cosines; NaN where fewer than half of its pixels have one.
fn middle_cosine(cosine: impl Fn(usize) -> f32, shape: Shape, corner: (usize, usize)) -> f32 {
    let mut known = [0.0; PATCH_PX * PATCH_PX];
    let mut count = 0;
    for cosine in indices(shape, corner).map(cosine).filter(|cosine| !cosine.is_nan()) {
        known[count] = f64::from(cosine);
        count += 1;
    }
    let enough = count * 2 >= PATCH_PX * PATCH_PX;
    let median = crate::numerics::statistics::median(&mut known[..count]).filter(|_| enough);
    median.map_or(f32::NAN, |median| median as f32)
}
