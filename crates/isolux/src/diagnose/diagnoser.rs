//! Frames are looked at one by one, and a sample of bounded size is kept.

use super::panel::{self, Panel};
use super::sample::{Observed, Sample};
use super::values::ValueMeter;
use crate::common_factor::{Course, Grid, Look, Spans, Times};
use crate::frame::{Frame, IntegrationTime, PixelFlags, Shape, ShapeError, phase};

/// Blocks along each side of the image, the clusters of pixels.
const BLOCKS: usize = 8;
/// Pixels that enter no fit.
const UNUSABLE: PixelFlags = PixelFlags::INVALID.union(PixelFlags::SATURATED);

/// What the diagnosis is told about the recording.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DiagnoseSettings {
    /// Column and row of the principal point, pixels; the image's centre where it is unknown.
    pub principal_point: Option<[f64; 2]>,
    /// True when the amplitude was computed from the phase samples by eq. 1: comparing it with them says nothing.
    pub amplitude_from_phase_samples: bool,
}

/// Takes frames one by one and comes to a [`Diagnosis`](super::Diagnosis). Memory does not grow with the number of frames: at most
/// about 45 MB, and as much again while it concludes.
#[derive(Clone, Debug)]
pub struct Diagnoser {
    shape: Shape,
    pub(super) settings: DiagnoseSettings,
    pub(super) frames: u32,
    radius2: Vec<f32>,
    pub(super) values: ValueMeter,
    pub(super) all: Sample,
    pub(super) labelled: Sample,
    pub(super) panel: Panel,
    pub(super) seen: Seen,
    grid: Grid,
    pub(super) course: Course,
    pub(super) spans: Spans,
}

/// Which channels were there.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Seen {
    pub(super) time_per_pixel: bool,
    pub(super) distance: bool,
    pub(super) vendor: bool,
    pub(super) phase_samples: bool,
}

impl Diagnoser {
    /// A diagnoser of frames of `shape`.
    #[must_use]
    pub fn new(shape: Shape, settings: DiagnoseSettings) -> Self {
        Self {
            shape,
            frames: 0,
            radius2: radius2(shape, settings.principal_point),
            values: ValueMeter::default(),
            all: Sample::default(),
            labelled: Sample::default(),
            panel: Panel::new(shape.pixels(), |index| block(shape, index)),
            seen: Seen::default(),
            grid: Grid::new(shape),
            course: Course::new(Grid::new(shape), Times::Explain),
            spans: Spans::default(),
            settings,
        }
    }

    /// Takes in the next frame.
    ///
    /// # Errors
    /// [`ShapeError::Mismatch`] when a plane is not of the diagnoser's shape; the frame then does not count.
    pub fn push(&mut self, frame: &Frame) -> Result<(), ShapeError> {
        frame.amplitude.expect_shape("amplitude", self.shape)?;
        frame.check_shapes()?;
        self.see(frame);
        self.course.push(Look::of_frame(self.grid, frame));
        self.spans.push(frame);
        for index in 0..self.shape.pixels() {
            let (amplitude, flags) = (frame.amplitude.values()[index], frame.flags.values()[index]);
            self.values.push(amplitude, flags);
            if flags.intersects(UNUSABLE) {
                continue;
            }
            self.offer(frame, index);
        }
        let usable = |index: usize| !frame.flags.values()[index].intersects(UNUSABLE);
        self.panel.push(|index| {
            usable(index).then(|| panel::Look {
                time_us: time_us(frame, index),
                amplitude: frame.amplitude.values()[index],
                distance_m: distance_m(frame, index),
            })
        });
        self.all.next_frame(self.shape.pixels());
        self.labelled.next_frame(self.shape.pixels());
        self.frames = self.frames.saturating_add(1);
        Ok(())
    }

    fn see(&mut self, frame: &Frame) {
        self.seen.distance |= frame.distance_m.is_some();
        self.seen.vendor |= frame.vendor_amplitude.is_some();
        self.seen.phase_samples |= frame.phase_samples.is_some();
        self.seen.time_per_pixel |= matches!(frame.integration_time_us, IntegrationTime::PerPixel(_));
    }

    /// Offers a pixel to the samples; only what is kept is looked at closer.
    fn offer(&mut self, frame: &Frame, index: usize) {
        let label = frame.target.as_ref().map_or(0, |target| target.values()[index]);
        let (for_all, for_labelled) = (self.all.admits(index), label > 0 && self.labelled.admits(index));
        if !for_all && !for_labelled {
            return;
        }
        let observed = Observed {
            frame: self.frames,
            block: block(self.shape, index),
            label,
            time_us: time_us(frame, index),
            distance_m: distance_m(frame, index),
            radius2: self.radius2[index],
            amplitude: frame.amplitude.values()[index],
            vendor: frame.vendor_amplitude.as_ref().map_or(f32::NAN, |plane| plane.values()[index]),
            demodulated: demodulated(frame, index),
        };
        if for_all {
            self.all.keep(index, observed);
        }
        if for_labelled {
            self.labelled.keep(index, observed);
        }
    }
}

/// Squared distance of each pixel from the principal point in units of the half diagonal.
fn radius2(shape: Shape, principal_point: Option<[f64; 2]>) -> Vec<f32> {
    let (height, width) = (shape.height as f64, shape.width as f64);
    let [cx, cy] = principal_point.unwrap_or([(width - 1.0) / 2.0, (height - 1.0) / 2.0]);
    let half_diagonal2 = (height * height + width * width) / 4.0;
    let at = |index: usize| {
        let (row, column) = shape.place(index);
        let (row, column) = (row as f64, column as f64);
        (((row - cy).powi(2) + (column - cx).powi(2)) / half_diagonal2) as f32
    };
    (0..shape.pixels()).map(at).collect()
}

/// Number of the image block that a pixel lies in.
fn block(shape: Shape, index: usize) -> u16 {
    let (row, column) = shape.place(index);
    (row * BLOCKS / shape.height * BLOCKS + column * BLOCKS / shape.width) as u16
}

/// NaN where it is unknown.
fn time_us(frame: &Frame, index: usize) -> f32 {
    frame.integration_time_us.at(index).map_or(f32::NAN, |time_us| positive(time_us as f32))
}

fn distance_m(frame: &Frame, index: usize) -> f32 {
    frame.distance_m.as_ref().map_or(f32::NAN, |plane| positive(plane.values()[index]))
}

/// Eq. 1 of the pixel's phase samples; NaN without them.
fn demodulated(frame: &Frame, index: usize) -> f32 {
    let bins = frame.phase_samples.as_ref().map(|bins| bins.each_ref().map(|bin| bin.values()[index]));
    bins.map_or(f32::NAN, |bins| positive(phase::amplitude(bins)))
}

/// The value where it is a measurement, else NaN.
fn positive(value: f32) -> f32 {
    if value > 0.0 && value.is_finite() { value } else { f32::NAN }
}
