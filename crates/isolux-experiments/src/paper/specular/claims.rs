//! What the paper states about the rules, and whether it holds.

use isolux_report::page::{Claim, Verdict};

use super::cases::{Case, HISTOGRAM, OF_MAXIMUM, SIGMA, UPPER_TENTH};
use super::images::Cases;
use crate::paper::parts::verdict;

/// Structure counts as kept when each of its measures is at least this.
const KEPT: f64 = 0.99;
/// Share of the foreground that has to become one value to count as a significant loss, and as all of it.
const SIGNIFICANT: f64 = 0.1;
const ALL: f64 = 0.95;

/// The claims of figures 6 and 13.
pub(super) fn claims(cases: &Cases) -> Vec<Claim> {
    let of = |case: &Case, place: usize| -> String {
        let outcome = &case.outcomes[place];
        format!(
            "{:.1} % of the foreground set to one value, standard deviation {:.3}, gradient correlation {:.3}, τ {:.3}",
            100.0 * outcome.foreground_limited,
            outcome.structure.deviation_ratio,
            outcome.structure.gradient_correlation,
            outcome.structure.kendall_tau
        )
    };
    let keeps = |id: &str, statement: &str, case: &Case| {
        let least = case.outcomes[HISTOGRAM].least_kept();
        claim(
            id,
            statement,
            format!("Histogram: {}.", of(case, HISTOGRAM)),
            least,
            verdict(least >= KEPT, "structure is lost"),
        )
    };
    vec![
        keeps(
            "histogram-keeps-structure",
            "The histogram rule preserves the structure within the bright intensities.",
            &cases.raw,
        ),
        keeps(
            "histogram-keeps-structure-standardized",
            "The same on a standardized image (open in the paper, which shows raw amplitudes).",
            &cases.standardized,
        ),
        percent_flattens(cases, &of),
        percent_erases(cases, &of),
        fraction_of_maximum(cases, &of),
        grey_scale(&cases.raw),
    ]
}

fn percent_flattens(cases: &Cases, of: &dyn Fn(&Case, usize) -> String) -> Claim {
    let [percent, histogram] = [UPPER_TENTH, HISTOGRAM].map(|place| &cases.raw.outcomes[place]);
    claim(
        "percent-flattens-foreground",
        "Setting the upper 10 % to one value loses structure in the foreground that the histogram keeps.",
        format!("Upper 10 %: {}. Histogram: {}.", of(&cases.raw, UPPER_TENTH), of(&cases.raw, HISTOGRAM)),
        percent.foreground_limited,
        verdict(
            percent.foreground_limited > SIGNIFICANT
                && percent.least_kept() < KEPT
                && histogram.least_kept() >= KEPT,
            "percent leaves the foreground as it is",
        ),
    )
}

fn percent_erases(cases: &Cases, of: &dyn Fn(&Case, usize) -> String) -> Claim {
    let case = &cases.small_board;
    let flattened = case.outcomes[UPPER_TENTH].foreground_limited;
    claim(
        "percent-erases-small-foreground",
        "All information within the foreground is lost when the upper 10 % become one value.",
        format!(
            "True where the foreground is less than a tenth of the image: with the small board ({:.0} %), {}; what is \
             left are the dim edges of the tin. Histogram: {}. In the picture above the foreground is {:.0} % of the \
             image, so the percent rule reaches only its brightest third.",
            100.0 * case.foreground_share,
            of(case, UPPER_TENTH),
            of(case, HISTOGRAM),
            100.0 * cases.raw.foreground_share
        ),
        flattened,
        verdict(flattened >= ALL, "part of the foreground keeps its values"),
    )
}

fn fraction_of_maximum(cases: &Cases, of: &dyn Fn(&Case, usize) -> String) -> Claim {
    let matt = &cases.without_highlights.outcomes[OF_MAXIMUM];
    claim(
        "fraction-of-maximum-in-bright-images",
        "In images with generally high values, cutting at 90 % of the maximum is a significant loss.",
        format!(
            "Without highlights: {}. With highlights the maximum is theirs: {:.2} % of the pixels are limited, nothing is \
             lost and next to nothing gained.",
            of(&cases.without_highlights, OF_MAXIMUM),
            100.0 * cases.raw.outcomes[OF_MAXIMUM].limited
        ),
        matt.foreground_limited,
        verdict(
            matt.foreground_limited > SIGNIFICANT && matt.least_kept() < KEPT,
            "little of the foreground lies above 90 % of the maximum",
        ),
    )
}

fn grey_scale(raw: &Case) -> Claim {
    let used = raw.outcomes[HISTOGRAM].range_used;
    claim(
        "histogram-frees-the-grey-scale",
        "Without the outliers the picture shows the scene with its full contrast.",
        format!(
            "The matt scene uses {:.0} % of the grey scale before, {:.0} % with 0.9 of the maximum, {:.0} % with mean + 4σ, \
             {:.0} % with the histogram.",
            100.0 * raw.range_used,
            100.0 * raw.outcomes[OF_MAXIMUM].range_used,
            100.0 * raw.outcomes[SIGMA].range_used,
            100.0 * used
        ),
        used,
        verdict(used > 0.9 && used > raw.outcomes[SIGMA].range_used, "outliers still take part of the scale"),
    )
}

fn claim(id: &str, statement: &str, measured: String, value: f64, verdict: Verdict) -> Claim {
    Claim { id: id.to_owned(), statement: statement.to_owned(), measured, value, verdict }
}
