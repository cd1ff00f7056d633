//! The common factor of the still pixels, from frame to frame.

use std::fmt;

use serde::Serialize;

use super::look::{Grid, Look, LookTime};
use super::pair::{Pair, between};
use crate::frame::IntegrationTime;
use crate::numerics::statistics::{Moments, median};

/// Frames that others are compared with, at most: views between which nothing stands still.
const MOST_REFERENCES: usize = 4;
/// Factors that range over less are no finding: cameras warm up.
const LEAST_RANGE: f64 = 1.05;
/// Where integration times vary, frames after a change of them may settle.
const LEAST_RANGE_OF_TIMES: f64 = 1.1;
/// Nor is a range that the parts of the image do not agree on, in standard deviations among them.
const LEAST_SCATTERS: f64 = 4.0;
/// Amplitudes grow with the time or by less, where they saturate or are corrected already. More than this beyond it
/// contradicts the recorded times, and so many frames at least.
const LEAST_EXCESS: f64 = 1.15;
const LEAST_EXCESSES: usize = 2;

/// Whether the recorded integration times decide which frames are compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Times {
    /// Frames of one time share one exposure; those of other times are compared with it by their times.
    Explain,
    /// All frames should share one level.
    Ignored,
}

/// What a recording says of its exposures.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ExposureClaim {
    /// The integration times are not recorded.
    NotRecorded,
    /// One integration time for all frames.
    Constant,
    /// Times that vary, and do not explain the factor.
    Recorded,
}

/// A factor that all still pixels share, and that the recorded integration times do not explain.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ExposureCourse {
    /// Least factor of a frame, relative to the median frame.
    pub least: f64,
    /// Largest factor of a frame.
    pub largest: f64,
    /// Frames that could be compared.
    pub frames: usize,
    /// What the recording says.
    pub claim: ExposureClaim,
}

/// Follows the common factor.
#[derive(Clone, Debug)]
pub(crate) struct Course {
    grid: Grid,
    times: Times,
    references: Vec<Look>,
    /// Reference and ln factor of each frame; `None` where nothing stands still.
    placed: Vec<Option<(usize, f64)>>,
    scatters: Vec<f64>,
    /// ln of what a frame has beyond its time.
    beyond: Vec<f64>,
    unknown: bool,
    /// The first recorded time, µs, and whether others differ.
    first_us: Option<f64>,
    varies: bool,
}

impl Course {
    pub(crate) fn new(grid: Grid, times: Times) -> Self {
        Self {
            grid,
            times,
            references: Vec::new(),
            placed: Vec::new(),
            scatters: Vec::new(),
            beyond: Vec::new(),
            unknown: false,
            first_us: None,
            varies: false,
        }
    }

    /// Takes the next frame.
    pub(crate) fn push(&mut self, look: Look) {
        self.note_time(&look);
        let same_times = self.times == Times::Explain;
        let compared = self.references.iter().enumerate().find_map(|(number, reference)| {
            Some((number, between(self.grid, reference, &look, same_times)?))
        });
        let place = compared.map(|(number, Pair { ln_factor, scatter })| {
            self.scatters.push(scatter);
            (number, ln_factor)
        });
        if place.is_none() && same_times {
            self.beyond.extend(self.beyond_time(&look));
        }
        let opens = place.is_none() && self.references.len() < MOST_REFERENCES && !look.ln_middle.is_nan();
        self.placed.push(place.or(opens.then_some((self.references.len(), 0.0))));
        if opens {
            self.references.push(look);
        }
    }

    /// Counts a frame that cannot be compared.
    pub(crate) fn skip(&mut self) {
        self.placed.push(None);
    }

    fn note_time(&mut self, look: &Look) {
        match &look.time {
            LookTime::Unknown => self.unknown = true,
            LookTime::Frame(time_us) => {
                let first_us = *self.first_us.get_or_insert(*time_us);
                self.varies |= !IntegrationTime::same(first_us, *time_us, IntegrationTime::SAME_RATIO);
            }
            LookTime::Samples(_) => self.varies = true,
        }
    }

    /// ln of what the frame's factor has beyond the ratio of the times, in its direction; `None` where the first
    /// frame cannot be compared.
    fn beyond_time(&self, look: &Look) -> Option<f64> {
        let reference = self.references.first()?;
        let (LookTime::Frame(before_us), LookTime::Frame(after_us)) = (&reference.time, &look.time) else {
            return None;
        };
        let ln_times = (after_us / before_us).ln();
        let pair = between(self.grid, reference, look, false)?;
        Some(ln_times.signum() * (pair.ln_factor - ln_times))
    }

    /// ln factors of the frames, 0 for their median frame; `None` for frames that cannot be compared with most others.
    pub(crate) fn ln_factors(&self) -> Vec<Option<f64>> {
        let count =
            |number: usize| self.placed.iter().flatten().filter(|(other, _)| *other == number).count();
        let main = (0..self.references.len()).max_by_key(|&number| (count(number), usize::MAX - number));
        let of_main = |place: &Option<(usize, f64)>| place.filter(|(number, _)| Some(*number) == main);
        let mut all: Vec<f64> =
            self.placed.iter().filter_map(of_main).map(|(_, ln_factor)| ln_factor).collect();
        let middle = median(&mut all).unwrap_or(0.0);
        self.placed.iter().map(|place| of_main(place).map(|(_, ln_factor)| ln_factor - middle)).collect()
    }

    /// Coefficient of variation of the factor over the frames that can be compared, and their number; `None` with
    /// fewer than two.
    pub(crate) fn variation(&self) -> Option<(f64, u32)> {
        let mut moments = Moments::default();
        self.ln_factors().into_iter().flatten().for_each(|ln_factor| moments.push(ln_factor.exp()));
        let cv = moments.coefficient_of_variation().filter(|_| moments.count() > 1)?;
        Some((cv, moments.count()))
    }

    /// A factor that the recorded times do not explain; `None` where there is none.
    pub(crate) fn unexplained(&self) -> Option<ExposureCourse> {
        let claim = match (self.varies, self.unknown) {
            (true, _) => ExposureClaim::Recorded,
            (false, true) => ExposureClaim::NotRecorded,
            (false, false) => ExposureClaim::Constant,
        };
        let least_range = if self.varies { LEAST_RANGE_OF_TIMES } else { LEAST_RANGE };
        let scatter = median(&mut self.scatters.clone()).unwrap_or(0.0);
        let (low, high, frames) = self.range()?;
        if high - low >= least_range.ln().max(LEAST_SCATTERS * scatter) {
            return Some(ExposureCourse { least: low.exp(), largest: high.exp(), frames, claim });
        }
        let excess = |beyond: &&f64| **beyond > LEAST_EXCESS.ln();
        if self.beyond.iter().filter(excess).count() < LEAST_EXCESSES {
            return None;
        }
        let (low, high) = ends(&self.beyond);
        let frames = self.beyond.len() + 1;
        Some(ExposureCourse { least: low.min(0.0).exp(), largest: high.exp(), frames, claim })
    }

    /// Ends of the ln factors about the median of those with one reference, and how many frames have one.
    fn range(&self) -> Option<(f64, f64, usize)> {
        let mut deviations = Vec::new();
        for number in 0..self.references.len() {
            let mine = self.placed.iter().flatten().filter(|(other, _)| *other == number);
            let mut mine: Vec<f64> = mine.map(|(_, ln_factor)| *ln_factor).collect();
            if mine.len() > 1 {
                let middle = median(&mut mine)?;
                deviations.extend(mine.iter().map(|ln_factor| ln_factor - middle));
            }
        }
        let (low, high) = ends(&deviations);
        Some((low, high, deviations.len()))
    }
}

/// Least and largest; 0 where there are none.
fn ends(values: &[f64]) -> (f64, f64) {
    let by = |choose: fn(f64, f64) -> f64| values.iter().copied().reduce(choose).unwrap_or(0.0);
    (by(f64::min), by(f64::max))
}

impl fmt::Display for ExposureCourse {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let recorded = match self.claim {
            ExposureClaim::NotRecorded => "the integration times are not recorded",
            ExposureClaim::Constant => "the recording states one integration time",
            ExposureClaim::Recorded => "the recorded integration times do not explain it",
        };
        write!(
            f,
            "all still pixels share a factor from frame to frame, {:.2} to {:.2} over {} frames, and {recorded}: the exposure \
             changed unrecorded, or frames were scaled one by one",
            self.least, self.largest, self.frames
        )
    }
}
