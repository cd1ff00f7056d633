//! The metrics that compare each frame with the frame of the reference exposure.

use super::histogram::{HistogramDistance, HistogramMeter};
use super::image_cv::{ImageCv, ImageCvMeter};
use super::otsu::{OtsuMeter, OtsuShift, threshold_ln};
use super::outcome::{Outcome, Unavailable};
use super::threshold::{IouMeter, ThresholdIou};
use crate::frame::IntegrationTime;

/// The reference frame and what its comparison with the others has given so far.
#[derive(Clone, Debug)]
pub(super) struct ReferenceComparison {
    values: Vec<f32>,
    time_us: f32,
    threshold: Option<f64>,
    image_cv: ImageCvMeter,
    iou: IouMeter,
    otsu: OtsuMeter,
    histogram: HistogramMeter,
    sorted_reference: Vec<f32>,
    sorted_frame: Vec<f32>,
}

impl ReferenceComparison {
    /// Keeps the usable values (others NaN) of the frame taken with `time_us`.
    pub(super) fn new(usable: &[f32], time_us: f32) -> Self {
        let mut sorted_reference: Vec<f32> = usable.iter().copied().filter(|value| !value.is_nan()).collect();
        sorted_reference.sort_unstable_by(f32::total_cmp);
        Self {
            values: usable.to_vec(),
            time_us,
            threshold: threshold_ln(&sorted_reference).map(f64::exp),
            image_cv: ImageCvMeter::default(),
            iou: IouMeter::default(),
            otsu: OtsuMeter::default(),
            histogram: HistogramMeter::default(),
            sorted_frame: Vec::with_capacity(sorted_reference.len()),
            sorted_reference,
        }
    }

    pub(super) fn time_us(&self) -> f32 {
        self.time_us
    }

    /// Compares a frame; NaN = unusable.
    pub(super) fn push(&mut self, usable: &[f32], time_us: f32, same_time_ratio: f64) {
        self.image_cv.push(&self.values, usable, time_us, same_time_ratio);
        if IntegrationTime::same(time_us, self.time_us, same_time_ratio) {
            return;
        }
        if let Some(threshold) = self.threshold {
            self.iou.push(&self.values, usable, threshold);
        }
        self.sort_jointly_valid(usable);
        self.otsu.push(&self.sorted_reference, &self.sorted_frame, usable.len());
        self.histogram.push(&self.sorted_reference, &self.sorted_frame, usable.len());
    }

    fn sort_jointly_valid(&mut self, usable: &[f32]) {
        self.sorted_reference.clear();
        self.sorted_frame.clear();
        for (&reference, &frame) in self.values.iter().zip(usable) {
            if !reference.is_nan() && !frame.is_nan() {
                self.sorted_reference.push(reference);
                self.sorted_frame.push(frame);
            }
        }
        self.sorted_reference.sort_unstable_by(f32::total_cmp);
        self.sorted_frame.sort_unstable_by(f32::total_cmp);
    }

    pub(super) fn image_cv(&self) -> Outcome<ImageCv> {
        self.image_cv.finish()
    }

    pub(super) fn threshold_iou(&self) -> Outcome<ThresholdIou> {
        self.iou.finish(self.threshold.ok_or(Unavailable::NoThreshold)?)
    }

    pub(super) fn otsu_shift(&self) -> Outcome<OtsuShift> {
        self.otsu.finish()
    }

    pub(super) fn histogram_distance(&self) -> Outcome<HistogramDistance> {
        self.histogram.finish()
    }
}
