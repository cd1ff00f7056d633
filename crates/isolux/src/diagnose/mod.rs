//! Is a stream of amplitudes still what the sensor measured, or has something upstream already corrected, bent or
//! clipped it? And what does the vendor's own scaling do?
//!
//! What the sensor measures grows with the integration time t as t¹, falls with the distance d of one material as
//! d⁻², and towards the corners with the illumination profile. A [`Diagnoser`] looks at frames one by one, keeps
//! a sample of bounded size, and [`Diagnoser::finish`] regresses ln A on ln t, ln d and r² (methods, section 8).
//! r is the distance from the principal point in units of the image's half diagonal.
//!
//! Each exponent comes from data that determine it, and from no other:
//!
//! | exponent | from |
//! |---|---|
//! | t | the same pixels of a still scene at several times; else one target label at several times |
//! | d | one target label at several distances; else pixels of one vendor amplitude, if that is a reflectivity |
//! | all, of the vendor's scaling | ln(vendor/raw): the material cancels |
//! | all, of the amplitude against its own phase samples | ln(amplitude / eq. 1) |
//!
//! What a recording does not determine is [`Untold`], with the reason.
//!
//! Intervals are 95 %, from sandwich errors clustered by image block (8×8 blocks) and, where there are at least
//! eight of them, by frame or integration time: neighbouring pixels and pixels of one frame are no independent
//! witnesses. They hold what repeats of such a recording would give, not errors of the model.
//!
//! ```
//! use isolux::diagnose::{Diagnoser, DiagnoseSettings, State};
//! use isolux::{Frame, IntegrationTime, Plane, Shape};
//!
//! let shape = Shape::new(32, 32);
//! let mut diagnoser = Diagnoser::new(shape, DiagnoseSettings::default());
//! for time_us in [500.0, 1000.0, 2000.0, 4000.0] {
//!     let mut frame = Frame::new(shape);
//!     let scene = |row: usize, column: usize| (100 + 7 * row + 3 * column) as f32;
//!     frame.amplitude = Plane::from_fn(shape, |row, column| time_us as f32 / 1000.0 * scene(row, column));
//!     frame.integration_time_us = IntegrationTime::PerFrame(time_us);
//!     frame.flag_amplitude(None);
//!     diagnoser.push(&frame)?;
//! }
//! let diagnosis = diagnoser.finish();
//! assert!(diagnosis.time.is_ok_and(|time| time.state == State::Present));
//! assert!(diagnosis.distance.is_err()); // There is no distance channel.
//! # Ok::<(), isolux::ShapeError>(())
//! ```

mod columns;
mod diagnosis;
mod effect;
mod finding;
mod material;
mod panel;
mod rules;
mod sample;
mod scaling;
mod still;
#[cfg(test)]
mod tests;
mod untold;
mod values;
mod vendor;

use crate::frame::{Frame, IntegrationTime, PixelFlags, Shape, ShapeError};

pub use diagnosis::Diagnosis;
pub use effect::{Effect, Estimate, Evidence, State};
pub use finding::Finding;
pub use material::{Material, MaterialFit, RangeExponent};
pub use scaling::{RadialTerm, Scaling, TimeGroup};
pub use still::{Band, StillPixels};
pub use untold::{Outcome, Untold};
pub use values::{PileUp, Values};
pub use vendor::VendorFinding;

use panel::{Look, Panel};
use sample::{Observed, Sample};
use values::ValueMeter;

/// Integration times less than this factor apart count as one: cameras report them with jitter.
const SAME_TIME_RATIO: f64 = IntegrationTime::SAME_RATIO;
/// Factor that distances (5 to 95 % quantile) must span for an exponent: 1.2 makes d² differ by 44 %.
const MINIMUM_DISTANCE_RATIO: f64 = 1.2;
/// Rows below which a regression is no statement.
const MINIMUM_ROWS: usize = 200;
/// Clusters of frames or times are used from this number on: fewer are no estimate of a variance.
const MINIMUM_FRAME_CLUSTERS: usize = 8;
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

/// Takes frames one by one and comes to a [`Diagnosis`]. Memory does not grow with the number of frames: at most
/// about 45 MB, and as much again while it concludes.
#[derive(Clone, Debug)]
pub struct Diagnoser {
    shape: Shape,
    settings: DiagnoseSettings,
    frames: u32,
    radius2: Vec<f32>,
    values: ValueMeter,
    all: Sample,
    labelled: Sample,
    panel: Panel,
    seen: Seen,
}

/// Which channels were there.
#[derive(Clone, Copy, Debug, Default)]
struct Seen {
    time_per_pixel: bool,
    distance: bool,
    vendor: bool,
    phase_samples: bool,
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
            usable(index).then(|| Look {
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

    /// What the frames tell.
    #[must_use]
    pub fn finish(&self) -> Diagnosis {
        diagnosis::conclude(self)
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
    bins.map_or(f32::NAN, |bins| positive(crate::frame::phase::amplitude(bins)))
}

/// The value where it is a measurement, else NaN.
fn positive(value: f32) -> f32 {
    if value > 0.0 && value.is_finite() { value } else { f32::NAN }
}
