//! The paper's steps against the textbook's, one by one, and what to say of the outcome.

use isolux_report::page::{Claim, Verdict};

use super::contest::{Contest, Contests};
use super::field::Selection;
use super::methods::{CUBIC, Competitor, EQ5, LINEAR, LUT, PAPER, SQUARE, TEXTBOOK};
use super::scores::{IMAGE_CV, MEAN_IOU, MEDIAN_CV, NOISE, P95_CV, SLOPE, Score};

/// Figures that differ by less than this share are a draw; for the slope, by this much.
const DRAW: f64 = 0.02;

/// One of the paper's steps against a rival, on one figure.
#[derive(Clone, Copy)]
struct Duel {
    id: &'static str,
    paper: Competitor,
    rival: Competitor,
    score: Score,
}

const fn duel(id: &'static str, paper: Competitor, rival: Competitor, score: Score) -> Duel {
    Duel { id, paper, rival, score }
}

const DUELS: [Duel; 8] = [
    duel("lut-against-linear-typical", LUT, LINEAR, MEDIAN_CV),
    duel("lut-against-linear-worst", LUT, LINEAR, P95_CV),
    duel("lut-against-linear-image", LUT, LINEAR, IMAGE_CV),
    duel("cubic-against-square-slope", CUBIC, SQUARE, SLOPE),
    duel("cubic-against-eq5-slope", CUBIC, EQ5, SLOPE),
    duel("cubic-against-eq5-noise", CUBIC, EQ5, NOISE),
    duel("paper-against-textbook-typical", PAPER, TEXTBOOK, MEDIAN_CV),
    duel("paper-against-textbook-threshold", PAPER, TEXTBOOK, MEAN_IOU),
];

/// Who won, over the scenes of a duel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Winner {
    Paper,
    Rival,
    Nobody,
}

/// A duel that was fought.
struct Outcome {
    duel: Duel,
    winner: Winner,
    /// Scene, the paper's figure, the rival's.
    figures: Vec<(&'static str, f64, f64)>,
}

/// Every duel as a claim, and one paragraph on those that the paper does not win.
pub(super) fn fight(contests: &Contests) -> (Vec<Claim>, String) {
    let outcomes: Vec<Outcome> = DUELS.into_iter().map(|duel| Outcome::of(duel, contests)).collect();
    (outcomes.iter().map(Outcome::claim).collect(), summary(&outcomes))
}

impl Outcome {
    /// Fought on the pixels that are above the noise: below it, everybody measures the floor.
    fn of(duel: Duel, contests: &Contests) -> Self {
        let figures_in = |contest: &Contest| {
            let figure = |who| contest.of(who).map_or(f64::NAN, duel.score.of);
            (contest.scene, figure(duel.paper), figure(duel.rival))
        };
        let figures: Vec<_> = if duel.score.heading == SLOPE.heading {
            contests.distances(Selection::Bright).map(figures_in).collect()
        } else {
            contests.still(Selection::Bright).map(figures_in).collect()
        };
        let winners: Vec<Winner> =
            figures.iter().map(|(_, paper, rival)| winner(&duel.score, *paper, *rival)).collect();
        let unanimous = winners.iter().all(|winner| *winner == winners[0]);
        Self { duel, winner: if unanimous { winners[0] } else { Winner::Nobody }, figures }
    }

    fn claim(&self) -> Claim {
        let Duel { id, paper, rival, score } = &self.duel;
        Claim {
            id: (*id).to_owned(),
            statement: format!("{} beats {} in {}.", paper.name, rival.name, score.name),
            measured: format!("{}; from 1 ms, LOW_SIGNAL pixels left out.", self.figures_in_words()),
            value: self.lead(),
            verdict: match self.winner {
                Winner::Paper => Verdict::Holds,
                Winner::Rival => Verdict::Fails(format!("{} wins", rival.name)),
                Winner::Nobody => {
                    Verdict::Open("a draw: no winner in both scenes by more than 2 %".to_owned())
                }
            },
        }
    }

    /// How much better the paper is, mean over the scenes, in the unit of the figure; negative when it is worse.
    fn lead(&self) -> f64 {
        let badness = self.duel.score.badness;
        let leads = self.figures.iter().map(|(_, paper, rival)| badness(*rival) - badness(*paper));
        leads.sum::<f64>() / self.figures.len() as f64
    }

    fn figures_in_words(&self) -> String {
        let Score { decimals, unit, .. } = self.duel.score;
        let words = self.figures.iter().map(|(scene, paper, rival)| {
            format!("{scene} {paper:.decimals$}{unit} against {rival:.decimals$}{unit}")
        });
        words.collect::<Vec<_>>().join(", ")
    }
}

fn winner(score: &Score, paper: f64, rival: f64) -> Winner {
    let (paper_badness, rival_badness) = ((score.badness)(paper), (score.badness)(rival));
    // A slope of 0 is no yardstick for relative differences.
    let scale = if score.heading == SLOPE.heading { 1.0 } else { paper.abs().max(rival.abs()) };
    match rival_badness - paper_badness {
        lead if lead > DRAW * scale => Winner::Paper,
        lead if lead < -DRAW * scale => Winner::Rival,
        _ => Winner::Nobody,
    }
}

fn summary(outcomes: &[Outcome]) -> String {
    let say = |outcome: &Outcome| {
        let Duel { paper, rival, score, .. } = &outcome.duel;
        format!(
            "{} against {} in {} ({})",
            rival.name,
            paper.name,
            score.name,
            outcome.figures_in_words_of_rival()
        )
    };
    let list = |wanted: Winner| {
        let said = outcomes.iter().filter(|outcome| outcome.winner == wanted).map(say);
        said.collect::<Vec<_>>().join("; ")
    };
    let (won, drawn) = (list(Winner::Rival), list(Winner::Nobody));
    let or_none = |list: String| if list.is_empty() { "nowhere".to_owned() } else { list };
    format!("Where a rival wins: {}. Where nobody does: {}.", or_none(won), or_none(drawn))
}

impl Outcome {
    /// The rival's figure first, as the sentence names it first.
    fn figures_in_words_of_rival(&self) -> String {
        let turned = Self {
            figures: self.figures.iter().map(|(scene, paper, rival)| (*scene, *rival, *paper)).collect(),
            ..*self
        };
        turned.figures_in_words()
    }
}
