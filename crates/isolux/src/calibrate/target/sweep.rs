//! Measures a recording of labelled targets, frame by frame.

use std::collections::BTreeMap;

use super::flat::FlatLabel;
use super::measure::{WindowMedians, measure, middle_cosine};
use super::patches::{PATCH_PX, Patches};
use crate::calibrate::sweep_frames::SweepFrames;
use crate::calibrate::{CalibrateSettings, MeasureError};
use crate::frame::{Frame, IntegrationTime, Lens, PixelRays, Plane, Shape, Window};
use crate::surface::Incidence;
use crate::terms::Source;

/// A labelled target, measured frame by frame.
#[derive(Clone, Debug)]
pub struct TargetSweep {
    frames: SweepFrames,
    frames_used: usize,
    lens: Option<Lens>,
    /// Those of the lens, as soon as the shape is known.
    rays: Option<PixelRays>,
    shape: Option<Shape>,
    patches: Patches,
    incidence: Incidence,
    windows: Vec<WindowMedians>,
    without_normal: usize,
    linear: bool,
}

/// The result of a recording of targets: medians over windows of 5×5 pixels.
#[derive(Clone, Debug)]
pub struct TargetWindows {
    /// The recording.
    pub(super) source: Source,
    pub(super) lens: Option<Lens>,
    /// `None` without a frame.
    pub(super) shape: Option<Shape>,
    pub(super) windows: Vec<WindowMedians>,
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
    /// Starts a recording; `recording` is its name in errors and in the calibration. Without a `lens`, there are
    /// no angles.
    #[must_use]
    pub fn new(recording: impl Into<String>, settings: &CalibrateSettings, lens: Option<Lens>) -> Self {
        Self {
            frames: SweepFrames::new(recording, settings),
            frames_used: 0,
            lens: lens.filter(Lens::is_usable),
            rays: None,
            shape: None,
            patches: Patches::default(),
            incidence: Incidence::default(),
            windows: Vec::new(),
            without_normal: 0,
            linear: false,
        }
    }

    /// States that the frames are linear in the light, as [`FrameLineariser`](crate::standardize::FrameLineariser)
    /// makes them: their amplitudes are then corrected by `1/t`, not by the table.
    #[must_use]
    pub fn of_linear_frames(self) -> Self {
        Self { linear: true, ..self }
    }

    /// Measures the next frame. Its integration time may be unknown or a map, its distance missing.
    ///
    /// # Errors
    /// [`MeasureError`] when the frame has no labels, planes of different shapes, or another shape than the first
    /// frame.
    pub fn push(&mut self, frame: &Frame) -> Result<(), MeasureError> {
        let number = self.frames.next(frame)?;
        let target = frame.target.as_ref().ok_or(MeasureError::NoTarget { frame: number })?;
        let shape = self.shape(frame.shape(), number)?;
        target
            .expect_shape("target", shape)
            .map_err(|source| MeasureError::Shape { frame: number, source })?;
        if let IntegrationTime::PerFrame(time_us) = frame.integration_time_us
            && self.frames.settings.excludes(time_us)
        {
            return Ok(());
        }
        let before = self.windows.len();
        self.measure(frame, target, u32::try_from(number).unwrap_or(u32::MAX));
        self.frames_used += usize::from(self.windows.len() > before);
        Ok(())
    }

    /// The shape of the first frame; it is for that one that the rays are computed.
    fn shape(&mut self, found: Shape, frame: usize) -> Result<Shape, MeasureError> {
        if let (None, Some(lens)) = (self.shape, &self.lens) {
            lens.check_shape(found).map_err(|source| MeasureError::Lens { frame, source })?;
            self.rays = Some(lens.pixel_rays(found));
        }
        Ok(*self.shape.get_or_insert(found))
    }

    /// The windows of all labels. Distance and angle are those of the label's plane, where it is flat, else those of
    /// the window.
    fn measure(&mut self, frame: &Frame, target: &Plane<u8>, number: u32) {
        let corners = self.patches.find(target);
        let mut planes: BTreeMap<u8, Option<FlatLabel>> = BTreeMap::new();
        let mut has_normals = false;
        for &(row, column) in corners {
            let Some(mut window) = measure(frame, target, (row, column)) else { continue };
            window.frame = number;
            if let (Some(distance_m), Some(rays)) = (&frame.distance_m, &self.rays) {
                let plane = planes
                    .entry(window.label)
                    .or_insert_with(|| FlatLabel::fit(frame, target, window.label, corners, rays));
                if !plane.as_ref().is_some_and(|plane| plane.place(&mut window)) {
                    if !has_normals {
                        self.incidence.take(frame, distance_m, rays);
                        has_normals = true;
                    }
                    let cosine = |index| self.incidence.cosine(index, rays);
                    window.cosine = middle_cosine(cosine, frame.shape(), (row, column));
                }
                self.without_normal += usize::from(window.cosine.is_nan());
            }
            self.windows.push(window);
        }
    }

    /// Ends the recording.
    #[must_use]
    pub fn finish(self) -> TargetWindows {
        TargetWindows {
            source: self.frames.source(self.frames_used),
            lens: self.lens,
            shape: self.shape,
            windows: self.windows,
            without_normal: self.without_normal,
            linear: self.linear,
        }
    }
}

/// The windows of 5×5 pixels that are measured in an image of labels: each lies inside one label above 0, and none
/// overlaps another.
#[must_use]
pub fn label_windows(target: &Plane<u8>) -> Vec<Window> {
    let mut patches = Patches::default();
    let window = |&(top, left): &(usize, usize)| Window { top, left, height: PATCH_PX, width: PATCH_PX };
    patches.find(target).iter().map(window).collect()
}
