//! Everybody's figures, the best marked.

use isolux_report::page::{Cell, Table};

use super::contest::{Contest, Contests};
use super::field::{Selection, Standing};
use super::methods::OVER_DISTANCE;
use super::scores::{SLOPE, STILL, Score};

/// One table a still scene and selection.
pub(super) fn still(contests: &Contests) -> Vec<Table> {
    contests.still.iter().map(still_scene).collect()
}

fn still_scene(contest: &Contest) -> Table {
    let mut columns = vec!["method".to_owned()];
    columns.extend(STILL.iter().map(|score| score.heading.to_owned()));
    columns.push("values by itself, %".to_owned());
    let row = |standing: &Standing| {
        let mut row = vec![Cell::Text(standing.competitor.name.to_owned())];
        row.extend(STILL.iter().map(|score| cell(score, standing, &contest.standings)));
        row.push(Cell::Number { value: 100.0 * standing.own_valid, decimals: 2 });
        row
    };
    let shared = contest.standings.first().and_then(|standing| standing.comparison.after.valid_fraction);
    Table {
        id: format!("competition-{}-{}", contest.scene, contest.selection.id()),
        caption: format!(
            "{}, {}. Everybody on the same {:.1} % of the pixels. The best is marked, of those that take the \
             integration time out; in noise amplification, of those that take the distance out.",
            if contest.scene == "desk" { "Desk" } else { "Shelf" },
            contest.selection.name(),
            100.0 * shared.unwrap_or(f64::NAN)
        ),
        columns,
        rows: contest.standings.iter().map(row).collect(),
    }
}

/// Slopes over the distance, every selection beside the others.
pub(super) fn slopes(contests: &Contests) -> Table {
    let columns = contests.distances.iter().map(|contest| {
        let selection = match contest.selection {
            Selection::All => "all",
            Selection::From1Ms => "from 1 ms",
            Selection::Bright => "from 1 ms, LOW_SIGNAL left out",
        };
        format!("{}, {selection}", contest.scene)
    });
    let row = |competitor| {
        let cells = contests.distances.iter().map(|contest| {
            let missing = || Cell::Missing("not evaluated".to_owned());
            contest.of(competitor).map_or_else(missing, |standing| cell(&SLOPE, standing, &contest.standings))
        });
        std::iter::once(Cell::Text(competitor.name.to_owned())).chain(cells).collect()
    };
    Table {
        id: "competition-slopes".to_owned(),
        caption: "Slope of ln A on ln d within one material and one integration time: −2 is the inverse-square law, 0 \
                  is the aim. The nearest to 0 is marked. The time step does not matter here."
            .to_owned(),
        columns: std::iter::once("method".to_owned()).chain(columns).collect(),
        rows: OVER_DISTANCE.map(row).to_vec(),
    }
}

/// A figure, marked when nobody else's is better as far as it is shown. Who leaves the effect in does not compete.
fn cell(score: &Score, standing: &Standing, all: &[Standing]) -> Cell {
    let competes = |standing: &&Standing| (score.competes)(standing.competitor);
    let badness = |standing: &Standing| (score.badness)((score.of)(standing));
    let best = all.iter().filter(competes).map(badness).fold(f64::INFINITY, f64::min);
    let (value, decimals) = ((score.of)(standing), score.decimals);
    let shown = |value: f64| (value * 10f64.powi(decimals as i32)).round();
    if !value.is_finite() {
        Cell::Missing("not determined".to_owned())
    } else if competes(&standing) && shown(badness(standing)) <= shown(best) {
        Cell::Best { value, decimals }
    } else {
        Cell::Number { value, decimals }
    }
}
