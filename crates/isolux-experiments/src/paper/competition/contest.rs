//! The contests: two still scenes for what changes with the integration time, a board and a chart of patches for
//! what changes with the distance.

use super::field::{Field, Selection, Standing};
use super::methods::{ALL, Competitor, OVER_DISTANCE};
use crate::error::ExperimentError;
use crate::paper::lab::Lab;

/// One scene, one selection, everybody.
pub(super) struct Contest {
    /// The scene, as the page names it.
    pub(super) scene: &'static str,
    /// Which frames and pixels entered.
    pub(super) selection: Selection,
    /// Results in the order of the competitors.
    pub(super) standings: Vec<Standing>,
}

impl Contest {
    /// What a competitor reached; every contest has all of its competitors.
    pub(super) fn of(&self, competitor: Competitor) -> Option<&Standing> {
        self.standings.iter().find(|standing| standing.competitor == competitor)
    }
}

/// All contests.
pub(super) struct Contests {
    /// Desk and shelf, each in every selection.
    pub(super) still: Vec<Contest>,
    /// Board and patches, each with all frames and with the bright pixels.
    pub(super) distances: Vec<Contest>,
    /// Share of its linear amplitude that a pixel of the desk keeps at the longest time, 5 % quantile.
    pub(super) desk_kept: f64,
}

impl Contests {
    /// Runs them.
    ///
    /// # Errors
    /// [`ExperimentError`], which no seed should bring about.
    pub(super) fn run(lab: &Lab) -> Result<Self, ExperimentError> {
        let every = |scene, field: &Field, selections: &[Selection], reference_us| {
            let contest = |selection: &Selection| {
                Ok(Contest {
                    scene,
                    selection: *selection,
                    standings: field.contest(*selection, reference_us)?,
                })
            };
            selections.iter().map(contest).collect::<Result<Vec<_>, ExperimentError>>()
        };
        let reference_us = lab.calibration.reference.integration_time_us;
        let desk_field = Field::new(lab, "office-desk", &ALL)?;
        let desk = every("desk", &desk_field, &Selection::ALL, reference_us)?;
        let shelf = every("shelf", &Field::new(lab, "office-shelf", &ALL)?, &Selection::ALL, reference_us)?;
        // The slope pairs pixels of one integration time, so short times do not mix with the others.
        let selections = [Selection::All, Selection::Bright];
        let mut board = Field::new(lab, "board-distances", &OVER_DISTANCE)?;
        board.label_centre();
        let board = every("board", &board, &selections, None)?;
        let patches = Field::new(lab, "patches", &OVER_DISTANCE)?;
        let patches = every("patches", &patches, &selections, None)?;
        Ok(Self {
            still: desk.into_iter().chain(shelf).collect(),
            distances: board.into_iter().chain(patches).collect(),
            desk_kept: desk_field.kept_at_longest,
        })
    }

    /// Desk and shelf in one selection.
    pub(super) fn still(&self, selection: Selection) -> impl Iterator<Item = &Contest> {
        self.still.iter().filter(move |contest| contest.selection == selection)
    }

    /// Board and patches in one selection.
    pub(super) fn distances(&self, selection: Selection) -> impl Iterator<Item = &Contest> {
        self.distances.iter().filter(move |contest| contest.selection == selection)
    }
}
