//! Cameras that nothing was fitted or tuned on: the paper's method, the textbook's and ours.

use isolux::evaluate::SnrStratum;
use isolux_report::page::{Block, Cell, Claim, Section, Table};

use super::parts::{number, text, verdict};
use crate::error::ExperimentError;
use crate::paper::lab::Lab;
use crate::unseen::chains;
use crate::unseen::decay::{self, Decay};
use crate::unseen::figure::largest;
use crate::unseen::figures::{DECAY_CV, OVER_FLOOR};
use crate::unseen::held_out::{CAMERAS, HeldOut};
use crate::unseen::still::{self, Still, StillScene};

const METHOD: &str = "Cameras with another sensor, lens, light and frequency than the presets, each calibrated from a wall \
                      over its register and a board over distances, then measured on frames with other noise, at other \
                      distances and integration times. The floor is the same frames scaled with the true factors: no \
                      method can do better than the camera's noise. `isolux figures` prints the figures of every step.";

/// One camera with what every chain reaches.
struct Measured {
    name: String,
    decays: Vec<Decay>,
    still: StillScene,
}

/// The section.
///
/// # Errors
/// [`ExperimentError`], which no seed should bring about.
pub(super) fn section(_lab: &Lab) -> Result<Section, ExperimentError> {
    let measure = |seed: &u64| {
        let camera = HeldOut::new(*seed)?;
        let decays = decay::measure(&camera, decay::Ambient::Same, &chains::ALL)?;
        let still = still::measure(&camera, &chains::ALL)?;
        Ok(Measured { name: camera.model.name, decays, still })
    };
    let measured = CAMERAS.iter().map(measure).collect::<Result<Vec<_>, ExperimentError>>()?;
    let mut blocks = vec![
        Block::Text(METHOD.to_owned()),
        Block::Claims(vec![decay_claim(&measured), still_claim(&measured)]),
    ];
    blocks.push(Block::Table(decay_table(&measured)));
    blocks.push(Block::Table(still_table(&measured)));
    blocks.extend(measured.iter().map(|camera| Block::Table(strata_table(camera))));
    Ok(Section { id: "beyond".to_owned(), title: "Beyond the paper".to_owned(), blocks })
}

/// Position of our best among the chains.
fn ours() -> usize {
    chains::ALL.iter().position(|chain| *chain == chains::FROM_BINS).unwrap_or(0)
}

fn decay_claim(measured: &[Measured]) -> Claim {
    let worst = |index: usize| 100.0 * largest(measured.iter().map(|camera| camera.decays[index].cv));
    let value = worst(ours());
    let all =
        chains::ALL.iter().enumerate().map(|(index, chain)| format!("{} {:.2} %", chain.name, worst(index)));
    Claim {
        id: "beyond-decay".to_owned(),
        statement: format!(
            "With the raw bins, at most {:.1} % of the reference decay are left over all distances and integration times.",
            100.0 * DECAY_CV
        ),
        measured: format!("Coefficient of variation, worst camera: {}.", all.collect::<Vec<_>>().join(", ")),
        value,
        verdict: verdict(value <= 100.0 * DECAY_CV, "positions near over-saturation are compressed"),
    }
}

fn still_claim(measured: &[Measured]) -> Claim {
    let over = |index: usize| {
        largest(
            measured.iter().map(|camera| camera.still.chains[index].median_cv / camera.still.floor.median_cv),
        )
    };
    let value = over(ours());
    let all =
        chains::ALL.iter().enumerate().map(|(index, chain)| format!("{} {:.2}", chain.name, over(index)));
    Claim {
        id: "beyond-floor".to_owned(),
        statement: format!(
            "The typical pixel of a still scene varies over integration times at most {OVER_FLOOR} times as much as the \
             camera's noise alone."
        ),
        measured: format!("Beside the noise floor, worst camera: {}.", all.collect::<Vec<_>>().join(", ")),
        value,
        verdict: verdict(value <= OVER_FLOOR, "the integration time leaves more than the noise"),
    }
}

fn decay_table(measured: &[Measured]) -> Table {
    let mut columns = vec!["method".to_owned()];
    columns.extend(measured.iter().map(|camera| format!("{}, %", camera.name)));
    let row = |(index, chain): (usize, &chains::Chain)| {
        let mut row = vec![text(chain.name)];
        row.extend(measured.iter().map(|camera| number(100.0 * camera.decays[index].cv, 2)));
        row
    };
    let positions: Vec<String> =
        measured.iter().map(|camera| camera.decays[ours()].positions.to_string()).collect();
    Table {
        id: "beyond-decays".to_owned(),
        caption: format!(
            "What is left of the reference decay: coefficient of variation of the window's mean over {} positions and \
             six integration times together, those with a signal-to-noise ratio of 10.",
            positions.join(", ")
        ),
        columns,
        rows: chains::ALL.iter().enumerate().map(row).collect(),
    }
}

fn still_table(measured: &[Measured]) -> Table {
    let mut columns = vec!["method".to_owned()];
    for camera in measured {
        columns.extend(["median, %", "95 %, %", "valid, %"].map(|what| format!("{}: {what}", camera.name)));
    }
    let row = |name: &str, still: &dyn Fn(&Measured) -> Still| {
        let mut row = vec![text(name)];
        for camera in measured {
            let still = still(camera);
            row.extend([still.median_cv, still.p95_cv, still.valid].map(|share| number(100.0 * share, 2)));
        }
        row
    };
    let mut rows = vec![row("noise floor", &|camera| camera.still.floor.clone())];
    rows.extend(
        (chains::ALL.iter().enumerate())
            .map(|(index, chain)| row(chain.name, &|camera| camera.still.chains[index].clone())),
    );
    Table {
        id: "beyond-still".to_owned(),
        caption: "A still desk from 1 to 16 ms: coefficient of variation over the integration times of the typical pixel \
                  and of the worst twentieth, and the share of the measured pixels with a value."
            .to_owned(),
        columns,
        rows,
    }
}

/// The same by signal-to-noise ratio.
fn strata_table(camera: &Measured) -> Table {
    let strata = &camera.still.floor.by_snr;
    let mut columns = vec!["method".to_owned()];
    columns.extend(strata.iter().map(|stratum| match stratum.snr_to {
        Some(to) => format!("{} to {to} ({} pixels)", stratum.snr_from, stratum.pixels),
        None => format!("from {} ({} pixels)", stratum.snr_from, stratum.pixels),
    }));
    let cell = |stratum: &SnrStratum| match stratum.median_cv {
        Some(cv) => number(100.0 * cv, 2),
        None => Cell::Missing("no pixels".to_owned()),
    };
    let row = |name: &str, still: &Still| {
        std::iter::once(text(name)).chain(still.by_snr.iter().map(cell)).collect::<Vec<_>>()
    };
    let mut rows = vec![row("noise floor", &camera.still.floor)];
    rows.extend(chains::ALL.iter().zip(&camera.still.chains).map(|(chain, still)| row(chain.name, still)));
    Table {
        id: format!("beyond-strata-{}", camera.name),
        caption: format!(
            "{}: coefficient of variation of the typical pixel, %, by signal-to-noise ratio of the raw amplitude.",
            camera.name
        ),
        columns,
        rows,
    }
}
