//! The competition: the paper's table and cubic against linear time (Ritt), d² (Oprisescu), eq. 5 and A·d²/t, on the
//! same frames and the same pixels.

mod contest;
mod duels;
mod field;
mod methods;
mod scores;
mod tables;

use isolux_report::page::{Block, Section};

use crate::error::ExperimentError;
use crate::measure::coefficient_of_variation;
use crate::paper::lab::Lab;
use contest::Contests;
use field::{SHORTEST_US, Selection};
use isolux::terms::lut::LutAnswer;
use methods::{EQ5, LINEAR, LUT};
use scores::SLOPE;

/// The section of the competition.
///
/// # Errors
/// [`ExperimentError`], which no seed should bring about.
pub(super) fn section(lab: &Lab) -> Result<Section, ExperimentError> {
    let contests = Contests::run(lab)?;
    let (claims, outcome) = duels::fight(&contests);
    let mut blocks = vec![Block::Quote {
        text: "Ritt assumes a linear gain over the integration time; Oprisescu et al. weight with the square of the \
               distance. The paper measures both relations instead."
            .to_owned(),
        source: "sections 1 and 2".to_owned(),
    }];
    blocks.extend([METHOD.to_owned(), outcome, why(lab, &contests)].map(Block::Text));
    blocks.push(Block::Claims(claims));
    blocks.push(Block::Table(tables::slopes(&contests)));
    blocks.extend(tables::still(&contests).into_iter().map(Block::Table));
    Ok(Section {
        id: "competition".to_owned(),
        title: "The competition, on the same frames".to_owned(),
        blocks,
    })
}

const METHOD: &str = "Ten chains, none of which limits highlights, on identical frames; a pixel enters only where all of \
                      them have a value. Two still scenes show what the integration time leaves, the board (central \
                      window of 20×20) and the patches what the distance leaves. The table and the cubic are fitted on \
                      the wall and on this very board; the patches and the still scenes are new to them. At 0.2 and \
                      0.6 ms most of a scene is noise floor, which no scaling turns into signal, so the figures are \
                      given three times: for all times, from 1 ms, and from 1 ms without the pixels that are flagged \
                      LOW_SIGNAL. The duels are fought on the last.";

/// Why the table loses where it does: the wall it was measured on saturates, an office does not.
fn why(lab: &Lab, contests: &Contests) -> String {
    let lut = lab.calibration.terms.lut.as_ref();
    let end = lut.and_then(|lut| lut.integration_time_us.last().copied().zip(lut.multiplier.last().copied()));
    let (end_us, multiplier) = end.unwrap_or((f64::NAN, f64::NAN));
    let reference_us = lab.calibration.reference.integration_time_us.unwrap_or(f64::NAN);
    let shelf = contests.still(Selection::Bright).find(|contest| contest.scene == "shelf");
    let at_snr = |who, snr_from: f64| {
        let strata = shelf.and_then(|shelf| shelf.of(who)?.comparison.after.pixel_cv_by_snr.as_ref().ok());
        let stratum = strata.and_then(|strata| strata.iter().find(|stratum| stratum.snr_from == snr_from));
        100.0 * stratum.and_then(|stratum| stratum.median_cv).unwrap_or(f64::NAN)
    };
    let [linear, table] = wall_cv(lab);
    let board = contests.distances(Selection::Bright).find(|contest| contest.scene == "board");
    let eq5_slope = board.and_then(|board| board.of(EQ5)).map_or(f64::NAN, SLOPE.of);
    format!(
        "Why linear time wins: at its end, {:.1} ms, the table multiplies by {:.0} % more than linear time does, because \
         that much of the white wall's mean was lost to saturation. Even the brightest twentieth of the desk has lost \
         only {:.1} % there, so the table overcorrects the whole desk at long times. On the worst twentieth the table \
         wins because two errors cancel: the noise floor raises the short exposures of dim pixels, the overcorrection \
         their long ones (shelf, signal-to-noise 5 to 10: {:.1} % with the table, {:.1} % linear; from 20 on: {:.1} % and \
         {:.1} %). In a scene as bright as the wall it is the other way round: in the wall's centre, from 1 ms to the \
         table's end, linear time leaves a CV of {:.1} %, the table {:.1} %. One scalar for all pixels is a compromise, as \
         the paper says; it is a good one for scenes that saturate like the wall. Eq. 5 amplifies less noise because it \
         corrects less: it leaves a slope of {eq5_slope:.2} on the board.",
        end_us / 1000.0,
        100.0 * (multiplier * end_us / reference_us - 1.0),
        100.0 * (1.0 - contests.desk_kept),
        at_snr(LUT, 5.0),
        at_snr(LINEAR, 5.0),
        at_snr(LUT, 20.0),
        at_snr(LINEAR, 20.0),
        100.0 * linear,
        100.0 * table,
    )
}

/// CV of the wall's central window from 1 ms to the table's end, after linear time and after the table.
fn wall_cv(lab: &Lab) -> [f64; 2] {
    let (Some(lut), Some(centre)) = (&lab.calibration.terms.lut, lab.wall.regions.get(1)) else {
        return [f64::NAN; 2];
    };
    let inside = lab.wall.times_us.iter().zip(&centre.means_dn).filter_map(|(time_us, mean_dn)| {
        match lut.at(*time_us) {
            LutAnswer::Inside(gain) if *time_us >= SHORTEST_US => Some((mean_dn / time_us, mean_dn * gain)),
            _ => None,
        }
    });
    let (linear, table): (Vec<f64>, Vec<f64>) = inside.unzip();
    [linear, table].map(|values| coefficient_of_variation(&values))
}
