//! Before and after, side by side.

use serde::Serialize;

use super::fraction::fraction;
use super::{Evaluation, Evaluator, Outcome, SnrStratum, Unavailable};

/// The raw and the standardized amplitude of the same frames.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Comparison {
    /// Figures of the raw amplitude.
    pub before: Evaluation,
    /// Figures of the standardized amplitude.
    pub after: Evaluation,
    /// Relative noise after / before, dimensionless: 1 where the steps add no noise.
    #[serde(serialize_with = "crate::outcome_json::serialize")]
    pub noise_amplification: Outcome<f64>,
    /// Borders between the strata, where the signal-to-noise ratio is known.
    #[serde(skip)]
    snr_edges: Vec<f64>,
}

/// Where a figure should go.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Better {
    /// Smaller is better.
    Lower,
    /// Larger is better.
    Higher,
    /// Nearer to 0 is better.
    TowardsZero,
    /// Nearer to 0.683 is better, the share of normal errors within one standard deviation.
    TowardsNormal,
}

/// One line of a table of figures.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ComparisonRow {
    /// Name of the figure.
    pub metric: String,
    /// Its unit: `ratio` (1 = 100 %), `ln` (natural-log units) or `exponent`.
    pub unit: &'static str,
    /// Where it should go.
    pub better: Better,
    /// Before standardization.
    #[serde(serialize_with = "crate::outcome_json::serialize")]
    pub before: Outcome<f64>,
    /// After it.
    #[serde(serialize_with = "crate::outcome_json::serialize")]
    pub after: Outcome<f64>,
    /// Share of values behind the figure before, 0..=1.
    pub before_valid_fraction: Option<f64>,
    /// Share of values behind the figure after, 0..=1.
    pub after_valid_fraction: Option<f64>,
}

impl ComparisonRow {
    /// True where there is a figure to show: after, and before too, unless only predicted standard deviations have it.
    #[must_use]
    pub fn is_told(&self) -> bool {
        self.after.is_ok() && (self.before.is_ok() || self.before == Err(Unavailable::NoSigma))
    }
}

/// A figure and its valid fraction.
type Figure = Outcome<(f64, f64)>;

impl Comparison {
    /// Compares the evaluation of the raw amplitude with that of the standardized amplitude of the same frames.
    /// Both are stratified by the raw amplitude's signal-to-noise ratio.
    #[must_use]
    pub fn new(before: &Evaluator, after: &Evaluator) -> Self {
        let snr = before.signal_to_noise();
        let snr_edges = before.settings.snr_edges.iter().copied().filter(|_| snr.is_ok()).collect();
        let before = before.finish_stratified(&snr);
        let after = after.finish_stratified(&snr);
        let noise_amplification = noise_amplification(&before, &after);
        Self { before, after, noise_amplification, snr_edges }
    }

    /// All figures in a fixed order, for a table.
    #[must_use]
    pub fn rows(&self) -> Vec<ComparisonRow> {
        use Better::{Higher, Lower, TowardsZero};
        let cv = "CV over integration times";
        let mut rows = vec![
            self.row(&format!("pixel {cv}, median"), "ratio", Lower, |e| {
                e.pixel_cv.map(|cv| (cv.median, cv.valid_fraction))
            }),
            self.row(&format!("pixel {cv}, 95 % quantile"), "ratio", Lower, |e| {
                e.pixel_cv.map(|cv| (cv.p95, cv.valid_fraction))
            }),
        ];
        rows.extend(self.strata_rows());
        rows.extend([
            self.row(&format!("image {cv}"), "ratio", Lower, |e| {
                e.image_cv.map(|cv| (cv.cv, cv.valid_fraction))
            }),
            self.row("frame-to-frame variation of still pixels", "ratio", Lower, |e| {
                e.frame_to_frame.map(|found| (found.cv, found.valid_fraction))
            }),
            self.row(self.slope_name(), "exponent", TowardsZero, |e| {
                e.distance_slope.map(|slope| (slope.slope, slope.valid_fraction))
            }),
            self.row("fixed-threshold IoU, minimum", "ratio", Higher, |e| {
                e.threshold_iou.map(|iou| (iou.minimum, iou.valid_fraction))
            }),
            self.row("fixed-threshold IoU, mean", "ratio", Higher, |e| {
                e.threshold_iou.map(|iou| (iou.mean, iou.valid_fraction))
            }),
            self.row("shift of Otsu's threshold, mean", "ln", Lower, |e| {
                e.otsu_shift.map(|shift| (shift.mean_ln, shift.valid_fraction))
            }),
            self.row("W1 of log histograms, mean", "ln", Lower, |e| {
                e.histogram_distance.map(|w1| (w1.mean_ln, w1.valid_fraction))
            }),
            self.row("W1 of log histograms, maximum", "ln", Lower, |e| {
                e.histogram_distance.map(|w1| (w1.maximum_ln, w1.valid_fraction))
            }),
            self.row("relative noise of a frame", "ratio", Lower, |e| {
                e.noise.map(|noise| (noise.relative, noise.valid_fraction))
            }),
            self.noise_amplification_row(),
            self.row("errors within one predicted sigma", "ratio", Better::TowardsNormal, |e| {
                e.sigma_coverage.map(|coverage| (coverage.within_one_sigma, coverage.valid_fraction))
            }),
        ]);
        rows.extend(self.coverage_rows());
        rows.push(self.row("calibration error of sigma (ENCE)", "ratio", Lower, |e| {
            e.sigma_coverage.map(|coverage| (coverage.ence, coverage.valid_fraction))
        }));
        rows
    }

    /// Says so where pixels of all materials enter: their slope is not only that of the distance.
    fn slope_name(&self) -> &'static str {
        let slopes = [self.before.distance_slope, self.after.distance_slope];
        match slopes.iter().flatten().all(|slope| slope.labelled) {
            true => "slope of ln A on ln d",
            false => "slope of ln A on ln d, all pixels as one material",
        }
    }

    fn row(
        &self,
        metric: &str,
        unit: &'static str,
        better: Better,
        figure: impl Fn(&Evaluation) -> Figure,
    ) -> ComparisonRow {
        let (before, after) = (figure(&self.before), figure(&self.after));
        ComparisonRow {
            metric: metric.to_owned(),
            unit,
            better,
            before: before.map(|(value, _)| value),
            after: after.map(|(value, _)| value),
            before_valid_fraction: before.ok().map(|(_, valid)| valid),
            after_valid_fraction: after.ok().map(|(_, valid)| valid),
        }
    }

    /// One line a stratum; the valid fraction is that of pixels. No line where no pixel's ratio is known.
    fn strata_rows(&self) -> Vec<ComparisonRow> {
        let names = self.before.pixel_cv_by_snr.iter().flatten().map(stratum_name);
        let row = |(index, name): (usize, String)| {
            self.row(&name, "ratio", Better::Lower, |evaluation| {
                let strata = evaluation.pixel_cv_by_snr.as_ref().map_err(|reason| *reason)?;
                let stratum = strata.get(index).ok_or(Unavailable::NoValidPixels)?;
                let pixels = evaluation.pixels_per_frame as u64;
                let valid_fraction = fraction(stratum.pixels as u64, pixels);
                stratum.median_cv.map(|cv| (cv, valid_fraction)).ok_or(Unavailable::NoValidPixels)
            })
        };
        names.enumerate().map(row).collect()
    }

    /// One line a stratum, whether there is a σ or not: comparisons with one raw amplitude have the same lines. No line
    /// where no pixel's ratio is known.
    fn coverage_rows(&self) -> Vec<ComparisonRow> {
        let from = [0.0].into_iter().chain(self.snr_edges.iter().copied());
        let to = self.snr_edges.iter().copied().map(Some).chain([None]);
        let row = |(index, (from, to)): (usize, (f64, Option<f64>))| {
            let range = range_name(from, to);
            let name = format!("errors within one predicted sigma, SNR {range}");
            self.row(&name, "ratio", Better::TowardsNormal, |evaluation| {
                let strata = evaluation.sigma_coverage_by_snr.as_ref().map_err(|reason| *reason)?;
                let stratum = strata.get(index).ok_or(Unavailable::NoValidPixels)?;
                let values = evaluation.frames * evaluation.pixels_per_frame as u64;
                let share = stratum.within_one_sigma.ok_or(Unavailable::NoValidPixels)?;
                Ok((share, fraction(stratum.errors, values)))
            })
        };
        if self.snr_edges.is_empty() { Vec::new() } else { from.zip(to).enumerate().map(row).collect() }
    }

    fn noise_amplification_row(&self) -> ComparisonRow {
        let mut row = self.row("noise amplification", "ratio", Better::Lower, |evaluation| {
            evaluation.noise.map(|noise| (1.0, noise.valid_fraction))
        });
        row.after = self.noise_amplification;
        row
    }
}

fn stratum_name(stratum: &SnrStratum) -> String {
    format!("pixel CV over integration times, median, SNR {}", range_name(stratum.snr_from, stratum.snr_to))
}

fn range_name(from: f64, to: Option<f64>) -> String {
    match to {
        Some(to) if from == 0.0 => format!("below {to}"),
        Some(to) => format!("{from} to {to}"),
        None => format!("{from} and above"),
    }
}

fn noise_amplification(before: &Evaluation, after: &Evaluation) -> Outcome<f64> {
    let (before, after) = (before.noise?, after.noise?);
    if before.method != after.method {
        return Err(Unavailable::NoiseMethodsDiffer);
    }
    if before.relative > 0.0 { Ok(after.relative / before.relative) } else { Err(Unavailable::NoiseIsZero) }
}
