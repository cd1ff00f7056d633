//! Every detector, tuned once at the reference, on every frame of a sweep.

use imageproc::image::GrayImage;
use isolux::Plane;
use rayon::prelude::*;

use super::edges::{FixedCanny, true_outlines};
use super::eight_bit::Scale;
use super::features::FixedFeatures;
use super::otsu::OtsuRule;
use super::sweep::{Conditions, Sweep, Variant};
use super::threshold::FixedThreshold;
use crate::error::ExperimentError;

/// What the detectors find in an image, compared with what they find at the reference.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Figures {
    /// Overlap of the fixed threshold's masks, 0..=1.
    pub(super) threshold_iou: f64,
    /// F1 of Canny's edges, 0..=1.
    pub(super) edge_f1: f64,
    /// Overlap of the masks of Otsu's rule, 0..=1.
    pub(super) otsu_iou: f64,
    /// Otsu's level relative to the reference's.
    pub(super) otsu_ratio: f64,
    /// Share of FAST corners that repeat, 0..=1.
    pub(super) repeatability: f64,
    /// Share of BRIEF descriptors that find their own keypoint, 0..=1.
    pub(super) matched: f64,
}

/// Everything that was tuned at the reference, for one variant.
#[derive(Clone)]
pub(super) struct Tuned {
    /// Grey levels.
    pub(super) scale: Scale,
    /// Threshold.
    pub(super) threshold: FixedThreshold,
    /// Canny.
    pub(super) canny: FixedCanny,
    /// FAST and BRIEF.
    pub(super) features: FixedFeatures,
    otsu: OtsuRule,
}

/// Mean figures under one set of conditions, one entry a [`Variant`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Point {
    /// How the frames were taken.
    pub(super) conditions: Conditions,
    /// Means over the frames, the reference shot left out.
    pub(super) figures: [Figures; 3],
}

/// A sweep, measured.
#[derive(Clone)]
pub(super) struct Stability {
    /// Points in the order of recording.
    pub(super) points: Vec<Point>,
    /// Index of the point under the reference conditions.
    pub(super) reference: usize,
    /// What was tuned, one entry a [`Variant`].
    pub(super) tuned: Vec<Tuned>,
}

impl Stability {
    /// Tunes every detector at the reference shot (FAST also at the one after it) and applies it to all others.
    ///
    /// # Errors
    /// [`ExperimentError::Detector`].
    pub(super) fn measure(sweep: &Sweep) -> Result<Self, ExperimentError> {
        let outlines = true_outlines(&sweep.truth);
        let [reference, again] = [sweep.reference, sweep.reference + 1].map(|shot| &sweep.shots[shot].images);
        let tuned = (reference.par_iter().zip(again))
            .map(|(reference, again)| Tuned::at(reference, again, &outlines))
            .collect::<Result<Vec<_>, _>>()?;
        // One task a frame; collecting keeps their order, so the means are the same on any number of threads.
        let figures = sweep.shots.par_iter().map(|shot| {
            let mut all = [Figures::default(); Variant::ALL.len()];
            for ((figures, tuned), image) in all.iter_mut().zip(&tuned).zip(&shot.images) {
                *figures = tuned.compare(&tuned.scale.grey(image))?;
            }
            Ok((shot.conditions, all))
        });
        let mut figures = figures.collect::<Result<Vec<_>, ExperimentError>>()?;
        // A frame agrees with itself.
        figures.remove(sweep.reference);
        let points: Vec<Point> = figures.chunk_by(|a, b| a.0 == b.0).map(Point::mean).collect();
        let conditions = sweep.shots[sweep.reference].conditions;
        // The shot after the reference shares its conditions, so there is such a point.
        let reference = points.iter().position(|point| point.conditions == conditions).unwrap_or(0);
        Ok(Self { points, reference, tuned })
    }
}

impl Point {
    fn mean(frames: &[(Conditions, [Figures; 3])]) -> Self {
        let variant = |index: usize| {
            let mean = |figure: fn(&Figures) -> f64| {
                frames.iter().map(|(_, figures)| figure(&figures[index])).sum::<f64>() / frames.len() as f64
            };
            Figures {
                threshold_iou: mean(|figures| figures.threshold_iou),
                edge_f1: mean(|figures| figures.edge_f1),
                otsu_iou: mean(|figures| figures.otsu_iou),
                otsu_ratio: mean(|figures| figures.otsu_ratio),
                repeatability: mean(|figures| figures.repeatability),
                matched: mean(|figures| figures.matched),
            }
        };
        Self { conditions: frames[0].0, figures: [0, 1, 2].map(variant) }
    }
}

impl Tuned {
    fn at(reference: &Plane<f32>, again: &Plane<f32>, outlines: &GrayImage) -> Result<Self, ExperimentError> {
        let scale = Scale::chosen_at(reference);
        let (grey, again) = (scale.grey(reference), scale.grey(again));
        Ok(Self {
            scale,
            threshold: FixedThreshold::tuned_at(&grey),
            canny: FixedCanny::tuned_at(&grey, outlines),
            features: FixedFeatures::tuned_at(&grey, &again)?,
            otsu: OtsuRule::at(&grey),
        })
    }

    fn compare(&self, image: &GrayImage) -> Result<Figures, ExperimentError> {
        let (otsu_ratio, otsu_iou) = self.otsu.compare(image);
        let (repeatability, matched) = self.features.compare(image)?;
        Ok(Figures {
            threshold_iou: self.threshold.overlap(image),
            edge_f1: self.canny.agreement(image),
            otsu_iou,
            otsu_ratio,
            repeatability,
            matched,
        })
    }
}
