//! Frames that were stretched one by one: each spans exactly the same values.

use std::fmt;

use serde::Serialize;

use crate::frame::Frame;

/// Frames that tell.
const LEAST_FRAMES: usize = 3;
/// Whole numbers up to this are coarse: several pixels round to the largest one.
const COARSE: f32 = 1023.0;
/// Pixels at the largest value of a frame that was stretched: in fine steps few, in coarse ones this share.
const FEW: usize = 4;
const COARSE_SHARE: f64 = 0.01;
/// Pixels that hold the largest value of a frame by themselves.
const ALONE: usize = 2;

/// Least and largest amplitude of one frame.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Span {
    least_dn: f32,
    largest_dn: f32,
    /// Pixels that have the largest, and the first of them.
    at_largest: usize,
    place: usize,
}

/// Frames that all span the same values.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct SpannedFrames {
    /// Least amplitude of every frame, DN; `None` where only the largest is the same.
    pub least_dn: Option<f32>,
    /// Largest amplitude of every frame, DN.
    pub largest_dn: f32,
    /// Frames that were looked at.
    pub frames: usize,
}

/// The spans of all frames.
#[derive(Clone, Debug, Default)]
pub(crate) struct Spans {
    spans: Vec<Span>,
    pixels: usize,
}

impl Spans {
    /// Takes the next frame, holes and codes included: they are what a stretched frame does not keep.
    pub(crate) fn push(&mut self, frame: &Frame) {
        let mut span =
            Span { least_dn: f32::INFINITY, largest_dn: f32::NEG_INFINITY, at_largest: 0, place: 0 };
        for (pixel, &value) in frame.amplitude.values().iter().enumerate() {
            span.least_dn = span.least_dn.min(value);
            if value > span.largest_dn {
                (span.largest_dn, span.at_largest, span.place) = (value, 1, pixel);
            } else if value == span.largest_dn {
                span.at_largest += 1;
            }
        }
        self.pixels = frame.amplitude.values().len();
        self.spans.push(span);
    }

    /// Frames that were stretched one by one. `common_factor_changes`: still pixels share a factor that no time
    /// explains. Without it, the largest value must be that of single pixels at changing places: a code or a clip
    /// would stay, or hold many pixels.
    pub(crate) fn stretched(&self, common_factor_changes: bool) -> Option<SpannedFrames> {
        let first = *self.spans.first().filter(|_| self.spans.len() >= LEAST_FRAMES)?;
        let largest_dn = Some(first.largest_dn).filter(|largest| largest.is_finite() && *largest > 0.0)?;
        let all = |same: &dyn Fn(&Span) -> bool| self.spans.iter().all(same);
        let same_least = all(&|span| span.least_dn == first.least_dn) && first.least_dn < largest_dn;
        let coarse = largest_dn <= COARSE && largest_dn > 1.0;
        let few = if coarse { FEW.max((COARSE_SHARE * self.pixels as f64) as usize) } else { FEW };
        let mostly =
            |most: usize| 2 * self.spans.iter().filter(|s| s.at_largest <= most).count() > self.spans.len();
        let wanders = self.spans.windows(2).filter(|pair| pair[0].place != pair[1].place).count();
        let wanders = 4 * wanders >= self.spans.len() && all(&|span| span.at_largest <= ALONE);
        let held = (same_least || !coarse) && common_factor_changes && mostly(few);
        let stretched = all(&|span| span.largest_dn == largest_dn) && (held || (same_least && wanders));
        stretched.then_some(SpannedFrames {
            least_dn: same_least.then_some(first.least_dn),
            largest_dn,
            frames: self.spans.len(),
        })
    }
}

impl fmt::Display for SpannedFrames {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.least_dn {
            Some(least_dn) => write!(f, "every frame spans exactly {least_dn} to {}", self.largest_dn),
            None => write!(f, "the largest value of every frame is exactly {}", self.largest_dn),
        }?;
        write!(f, " ({} frames): scaled frame by frame, so that frames are not comparable", self.frames)
    }
}
