//! The noise of the amplitude at the shortest integration time, from consecutive frames.

use std::collections::BTreeMap;

use crate::calibration::NoiseFloor;
use crate::frame::{Frame, Window};
use crate::numerics::differences;

/// Compares the central window of each frame with that of the frame before.
#[derive(Clone, Debug, Default)]
pub(super) struct FloorWatch {
    /// Values in the window of the previous frame.
    previous: Option<Vec<f64>>,
    /// Numbers of frames, and the standard deviations of their differences from the frames before, DN; keyed by the
    /// bits of the (positive) time.
    deviations_dn: BTreeMap<u64, Vec<(usize, f64)>>,
}

impl FloorWatch {
    /// States that the next frame does not follow the last one.
    pub(super) fn interrupt(&mut self) {
        self.previous = None;
    }

    /// Takes the next frame; the `first` of a run is not compared with the one before.
    pub(super) fn push(&mut self, number: usize, time_us: f64, frame: &Frame, first: bool) {
        let window = window_values(frame);
        let deviation = self
            .previous
            .as_ref()
            .filter(|_| !first)
            .and_then(|before| differences::temporal(before, &window));
        self.previous = Some(window);
        let deviation = deviation.map(|deviation| (number, deviation));
        self.deviations_dn.entry(time_us.to_bits()).or_default().extend(deviation);
    }

    /// The floor at the shortest time; `None` where that has no two consecutive frames, or quantization hides the
    /// noise. Differences from the `left_out` frames do not count.
    pub(super) fn floor(&self, left_out: &[usize]) -> Option<NoiseFloor> {
        let (&bits, deviations) = self.deviations_dn.iter().next()?;
        let counts = |number: usize| !left_out.contains(&number) && !left_out.contains(&(number - 1));
        let deviations: Vec<f64> = deviations
            .iter()
            .filter(|(number, _)| counts(*number))
            .map(|(_, deviation)| *deviation)
            .collect();
        let mean = deviations.iter().sum::<f64>() / deviations.len() as f64;
        (mean > 0.0 && mean.is_finite()).then(|| NoiseFloor::new(mean, f64::from_bits(bits)))
    }
}

/// Amplitudes of the central 64×64 pixels, NaN where invalid: enough for a noise figure of 1 %.
fn window_values(frame: &Frame) -> Vec<f64> {
    let shape = frame.shape();
    let value = |i: usize| if frame.is_valid(i) { f64::from(frame.amplitude.values()[i]) } else { f64::NAN };
    Window::centred(shape, 64).indices(shape).map(value).collect()
}
