//! I/Q: the cosine and the sine of the phase, already computed by the camera's software.
//!
//! The amplitude is √(I² + Q²), in whatever unit they are delivered in. Bins give half of that (eq. 1), because a
//! difference of two opposite bins is twice the amplitude; software that delivers I/Q has halved it, or not, and a factor
//! that is the same for all pixels does no harm.

use isolux::{Plane, phase};

use crate::recording::source::RawFrame;

/// I and Q of one frequency.
pub(super) type Iq = [Plane<f32>; 2];

/// Reads I and Q, numbered `set` among those of a frame. `numbers` is memory for complex numbers.
pub(super) fn read(
    frame: &RawFrame<'_>,
    sets: usize,
    set: usize,
    reversed: bool,
    numbers: &mut Vec<f32>,
    [i, q]: &mut Iq,
) {
    let set_bytes = frame.bytes.len() / sets;
    let bytes = &frame.bytes[set * set_bytes..(set + 1) * set_bytes];
    if frame.element.is_complex() {
        numbers.resize(2 * i.values().len(), 0.0);
        RawFrame { bytes, ..*frame }.read_f32(numbers);
        let (pairs, _) = numbers.as_chunks::<2>();
        i.values_mut().iter_mut().zip(pairs).for_each(|(i, pair)| *i = pair[0]);
        q.values_mut().iter_mut().zip(pairs).for_each(|(q, pair)| *q = pair[1]);
    } else {
        let (first, second) = bytes.split_at(set_bytes / 2);
        RawFrame { bytes: first, ..*frame }.read_f32(i.values_mut());
        RawFrame { bytes: second, ..*frame }.read_f32(q.values_mut());
    }
    if reversed {
        q.values_mut().iter_mut().for_each(|q| *q = -*q);
    }
}

/// Amplitude of every pixel, in the unit of I and Q.
pub(super) fn amplitude_into([i, q]: &Iq, out: &mut Plane<f32>) {
    out.reshape(i.shape(), f32::NAN);
    let values = i.values().iter().zip(q.values());
    out.values_mut().iter_mut().zip(values).for_each(|(out, (&i, &q))| *out = (i * i + q * q).sqrt());
}

/// Distance of every pixel, m; NaN where nothing is modulated.
pub(super) fn distance_into([i, q]: &Iq, frequency_hz: f64, out: &mut Plane<f32>) {
    out.reshape(i.shape(), f32::NAN);
    let values = i.values().iter().zip(q.values());
    out.values_mut().iter_mut().zip(values).for_each(|(out, (&i, &q))| {
        let modulated = i != 0.0 || q != 0.0;
        *out = if modulated { phase::distance_m([i, q, 0.0, 0.0], frequency_hz, false) } else { f32::NAN };
    });
}
