//! Figures 6 and 13: an image with highlights under the paper's rules, and what each leaves of the structure
//! in the bright foreground.

mod cases;

use isolux::Plane;
use isolux::standardize::{DistanceStep, TimeStep};
use isolux_camera::scene::object::Form;
use isolux_camera::scene::texture::Texture;
use isolux_camera::{Scene, SimulatedFrame};
use isolux_report::page::{Block, Cell, Claim, Colours, Picture, Section, Table, Verdict};

use self::cases::{Case, HISTOGRAM, OF_MAXIMUM, Outcome, RULES, SIGMA, UPPER_TENTH};
use super::parts::{number, text, verdict};
use crate::error::PaperError;
use crate::lab::Lab;
use crate::measure::{frame_at, simulation_of};

/// The scene of both figures.
const SCENE: &str = "highlights";
/// The reference time: the highlights are at their brightest, and not yet saturated.
const TIME_US: f64 = 8200.0;
/// Structure counts as kept when each of its measures is at least this.
const KEPT: f64 = 0.99;
/// Share of the foreground that has to become one value to count as a significant loss, and as all of it.
const SIGNIFICANT: f64 = 0.1;
const ALL: f64 = 0.95;

/// The images that the rules are tried on.
struct Cases {
    raw: Case,
    standardized: Case,
    small_board: Case,
    without_highlights: Case,
}

/// The section of figures 6 and 13.
///
/// # Errors
/// Those of the camera and the chain.
pub(super) fn section(lab: &Lab) -> Result<Section, PaperError> {
    let cases = Cases::measure(lab)?;
    Ok(Section {
        id: "specular".to_owned(),
        title: "Figures 6 and 13: highlights".to_owned(),
        blocks: vec![
            Block::Quote {
                text: "A cut at 90 % of the maximum, or at the upper 10 % of the values, turns bright regions into one \
                       value; the mean plus four standard deviations is better; the highest intensity that occurs \
                       often enough in the histogram preserves the structure within the bright intensities."
                    .to_owned(),
                source: "sections 2.3 and 3, figures 6 and 13".to_owned(),
            },
            Block::Text(setup(&cases)),
            Block::Pictures(figure_6(&cases.raw)),
            Block::Pictures(figure_13(&cases.raw)),
            Block::Text(
                "Percent is shown in both readings: the text of the paper says 90 % of the maximum, the caption of \
                 its figure the upper 10 % of the pixels. What is left of the foreground is told by the ratio of the \
                 standard deviations, the correlation of the differences between neighbouring pixels, and the rank \
                 correlation of all pixels (Kendall's τ-b), each after against before: 1 is everything. A highlight \
                 pixel owes most of its light to a highlight; many of them are still darker than the board, and no \
                 single cut can reach those. The last column is the brightest matt value (99.9th percentile) as a \
                 share of the maximum: how much of the grey scale is left to the scene itself."
                    .to_owned(),
            ),
            Block::Table(table("specular-raw", "The raw amplitude at 8.2 ms", &cases.raw)),
            Block::Table(table(
                "specular-standardized",
                "The same frame after table and cubic, as in the chain",
                &cases.standardized,
            )),
            Block::Text(format!(
                "How much the two percent rules lose depends on the image, so here are two changes of the scene. With \
                 the board at half its size the foreground is {:.0} % of the image, less than a tenth. Without any \
                 gloss, the maximum belongs to the board.",
                100.0 * cases.small_board.foreground_share
            )),
            Block::Table(table("specular-small-board", "Raw, board at half its size", &cases.small_board)),
            Block::Table(table("specular-matt", "Raw, all objects matt", &cases.without_highlights)),
            Block::Claims(claims(&cases)),
        ],
    })
}

impl Cases {
    fn measure(lab: &Lab) -> Result<Self, PaperError> {
        let original = frame(lab, |_| {})?;
        let raw =
            |simulated: &SimulatedFrame| Case::measure(lab, simulated, TimeStep::None, DistanceStep::None);
        Ok(Self {
            raw: raw(&original)?,
            standardized: Case::measure(lab, &original, TimeStep::Lut, DistanceStep::Cubic)?,
            small_board: raw(&frame(lab, halve_the_board)?)?,
            without_highlights: raw(&frame(lab, remove_the_gloss)?)?,
        })
    }
}

fn frame(lab: &Lab, change: impl FnOnce(&mut Scene)) -> Result<SimulatedFrame, PaperError> {
    let mut scene = Scene::builtin(SCENE)?;
    change(&mut scene);
    frame_at(&simulation_of(scene, lab.seed)?, SCENE, TIME_US)
}

fn halve_the_board(scene: &mut Scene) {
    for object in scene.objects.iter_mut().filter(|object| object.name == "board") {
        if let Form::Rectangle { size_m } = &mut object.form {
            *size_m = size_m.map(|side_m| 0.5 * side_m);
        }
        if let Texture::Bitmap { cell_m, .. } = &mut object.texture {
            *cell_m *= 0.5;
        }
    }
}

fn remove_the_gloss(scene: &mut Scene) {
    scene.objects.iter_mut().for_each(|object| object.highlight = None);
}

fn setup(cases: &Cases) -> String {
    format!(
        "Glossy things before a bright lettered board, at 8.2 ms, raw amplitude as in the paper. The foreground is \
         what the simulation knows to be near (below 1.2 m), bright (reflectivity 0.5 or more) and matt (less than 1 % \
         of the light from a highlight): board and light stripes, {:.0} % of the image. {} pixels belong to highlights. \
         Every picture has black at 0 and white at its own maximum, as a viewer shows it.",
        100.0 * cases.raw.foreground_share,
        cases.raw.highlight_pixels
    )
}

fn figure_6(raw: &Case) -> Vec<Picture> {
    let corrected = &raw.outcomes[HISTOGRAM];
    vec![
        picture(
            "fig-6-original",
            "Figure 6, left. The original image: its highlights leave little for the rest.",
            &raw.before,
        ),
        picture("fig-6-corrected", "Figure 6, right. Corrected by the histogram rule.", &corrected.after),
    ]
}

fn figure_13(raw: &Case) -> Vec<Picture> {
    let outcome = |place: usize| &raw.outcomes[place].after;
    vec![
        picture("fig-13-original", "Figure 13, top left. Original.", &raw.before),
        picture(
            "fig-13-upper-tenth",
            "Figure 13, top right. Upper 10 % of the pixels set to their lowest value: the bright parts of the board \
             become flat.",
            outcome(UPPER_TENTH),
        ),
        picture(
            "fig-13-of-maximum",
            "Figure 13, the other reading of percent. Cut at 0.9 of the maximum.",
            outcome(OF_MAXIMUM),
        ),
        picture("fig-13-sigma", "Figure 13, bottom left. Cut at the mean plus 4σ.", outcome(SIGMA)),
        picture("fig-13-histogram", "Figure 13, bottom right. Cut by the histogram.", outcome(HISTOGRAM)),
    ]
}

fn picture(id: &str, caption: &str, image: &Plane<f32>) -> Picture {
    let white = image.values().iter().copied().filter(|value| value.is_finite()).fold(0.0, f32::max);
    Picture {
        id: id.to_owned(),
        caption: caption.to_owned(),
        alt: format!(
            "A lettered board on the left, two glossy balls, a bottle, a plate and a tin; white is {white:.0} DN."
        ),
        values: image.clone(),
        range: (0.0, white),
        label: "amplitude in DN".to_owned(),
        colours: Colours::Grey,
    }
}

fn table(id: &str, caption: &str, case: &Case) -> Table {
    let columns = [
        "rule",
        "largest value left in DN",
        "pixels limited in %",
        "highlight pixels limited in %",
        "foreground limited in %",
        "standard deviation kept",
        "gradient correlation",
        "Kendall τ",
        "grey scale used in %",
    ];
    let rows = RULES.iter().zip(&case.outcomes).map(|((name, _), outcome)| row(name, outcome));
    Table {
        id: id.to_owned(),
        caption: format!("{caption}. Grey scale used without any rule: {:.0} %.", 100.0 * case.range_used),
        columns: columns.map(str::to_owned).to_vec(),
        rows: rows.collect(),
    }
}

fn row(name: &str, outcome: &Outcome) -> Vec<Cell> {
    let highlights = if outcome.highlight_limited.is_nan() {
        Cell::Missing("no highlights".to_owned())
    } else {
        number(100.0 * outcome.highlight_limited, 1)
    };
    vec![
        text(name),
        number(outcome.maximum_dn, 0),
        number(100.0 * outcome.limited, 2),
        highlights,
        number(100.0 * outcome.foreground_limited, 2),
        number(outcome.structure.deviation_ratio, 3),
        number(outcome.structure.gradient_correlation, 3),
        number(outcome.structure.kendall_tau, 3),
        number(100.0 * outcome.range_used, 0),
    ]
}

fn claims(cases: &Cases) -> Vec<Claim> {
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
