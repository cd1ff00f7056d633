//! Pixels whose phases are looked at.

use std::f64::consts::TAU;

use crate::frame::{Frame, IntegrationTime, PixelFlags};
use crate::inspect::claims::Claims;

/// Looked-at pixels of a frame, at most. The fits sort them, and need no more.
const SAMPLED_PIXELS: usize = 1 << 11;

/// One pixel of one frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pixel {
    /// A1..A4 as they are read, DN.
    pub(super) bins: [f32; 4],
    /// Phase as it is read, rad, where it is not that of the bins: of I/Q, and of two frequencies together.
    pub(super) phase: Option<f64>,
    /// Inverse of the integration time; 1 where it is not known.
    pub(super) per_time: f64,
    /// Recorded distance, m; NaN where there is none.
    pub(super) recorded_m: f64,
}

/// Pixels of some frames.
#[derive(Clone, Debug, Default)]
pub(in crate::inspect) struct Sample {
    pub(super) pixels: Vec<Pixel>,
    /// True once a frame of unknown time has been taken: amplitudes of another one need not be comparable.
    time_unknown: bool,
}

impl Sample {
    /// Takes some pixels of a frame that has phases.
    pub(in crate::inspect) fn push(&mut self, frame: &Frame, claims: &Claims) {
        let unknown = matches!(frame.integration_time_us, IntegrationTime::Unknown);
        if unknown && std::mem::replace(&mut self.time_unknown, true) {
            return;
        }
        // An odd number, so that cameras which alternate something by columns are seen whole.
        let stride = frame.flags.values().len().div_ceil(SAMPLED_PIXELS) | 1;
        for at in (0..frame.flags.values().len()).step_by(stride) {
            self.pixels.extend(pixel(frame, claims, at));
        }
    }
}

fn pixel(frame: &Frame, claims: &Claims, at: usize) -> Option<Pixel> {
    if frame.flags.values()[at].contains(PixelFlags::SATURATED) {
        return None;
    }
    let distance_m = frame.distance_m.as_ref().map_or(f64::NAN, |plane| f64::from(plane.values()[at]));
    let (recorded_m, computed_m) =
        if claims.distance_from_phases { (f64::NAN, distance_m) } else { (distance_m, f64::NAN) };
    let phase_of = |range_m| TAU * computed_m / range_m;
    let phase = claims.unwrapped_range_m.map(phase_of);
    let bins = match &frame.phase_samples {
        Some(bins) => [0, 1, 2, 3].map(|bin: usize| bins[bin].values()[at]),
        // The cosine and the sine of I/Q stand for the differences of the bins.
        None => {
            let (sine, cosine) = phase?.sin_cos();
            let amplitude = f64::from(frame.amplitude.values()[at]);
            [cosine, sine, -cosine, -sine].map(|share| (amplitude * share) as f32)
        }
    };
    let per_time = match &frame.integration_time_us {
        IntegrationTime::PerFrame(time_us) => 1.0 / time_us,
        IntegrationTime::PerPixel(times_us) => 1.0 / f64::from(times_us.values()[at]),
        IntegrationTime::Unknown => 1.0,
    };
    let finite = bins.iter().all(|bin| bin.is_finite()) && per_time > 0.0 && per_time.is_finite();
    let phase_known = phase.is_none_or(f64::is_finite);
    (finite && phase_known).then_some(Pixel { bins, phase, per_time, recorded_m })
}
