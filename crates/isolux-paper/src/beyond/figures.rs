//! Every figure in one list, for the table and the page.

use isolux::DenoiseRule;

use super::chains::{self, Chain};
use super::denoise::{self, Bars};
use super::figure::{Aim, Figure, Unit};
use super::held_out::{CAMERAS, HeldOut};
use super::{decay, still, targets};
use crate::error::PaperError;

/// Measures everything that needs no recording. `progress` is told what is being done.
///
/// # Errors
/// [`PaperError`], which nothing should bring about.
pub fn simulated(progress: &mut dyn FnMut(&str)) -> Result<Vec<Figure>, PaperError> {
    let mut figures = Vec::new();
    progress("held-out cameras");
    let cameras = CAMERAS.iter().map(|seed| HeldOut::new(*seed)).collect::<Result<Vec<_>, _>>()?;
    progress("reference decays");
    figures.extend(decays(&cameras)?);
    progress("still scenes");
    figures.extend(still_scenes(&cameras)?);
    progress("patches at all depths, tilts and places");
    figures.extend(patches()?);
    progress("denoising");
    figures.extend(denoising()?);
    Ok(figures)
}

/// The worst of the cameras for each chain.
fn decays(cameras: &[HeldOut]) -> Result<Vec<Figure>, PaperError> {
    let measured =
        cameras.iter().map(|camera| decay::measure(camera, &chains::ALL)).collect::<Result<Vec<_>, _>>()?;
    let figure = |(index, chain): (usize, &Chain)| {
        let cv = largest(measured.iter().map(|decays| decays[index].cv));
        let what = format!("reference decay over all integration times, CV, worst camera: {}", chain.name);
        let aim = if *chain == chains::BEST { Aim::AtMost(0.015) } else { Aim::None };
        Figure::new("distance", what, cv, Unit::Percent, aim)
    };
    Ok(chains::ALL.iter().enumerate().map(figure).collect())
}

fn still_scenes(cameras: &[HeldOut]) -> Result<Vec<Figure>, PaperError> {
    let measured =
        cameras.iter().map(|camera| still::measure(camera, &chains::ALL)).collect::<Result<Vec<_>, _>>()?;
    let mut figures = Vec::new();
    for (index, chain) in chains::ALL.iter().enumerate() {
        let ours = *chain == chains::BEST;
        let ratio =
            largest(measured.iter().map(|still| still.chains[index].median_cv / still.floor.median_cv));
        let what = format!(
            "per-pixel CV over integration times beside the noise floor, worst camera: {}",
            chain.name
        );
        let aim = if ours { Aim::AtMost(1.25) } else { Aim::None };
        figures.push(Figure::new("time", what, ratio, Unit::Ratio, aim));
        if ours {
            let valid = measured.iter().map(|still| still.chains[index].valid).fold(f64::INFINITY, f64::min);
            let what = "valid pixels of those measured, same scenes, worst camera";
            figures.push(Figure::new("time", what, valid, Unit::Percent, Aim::AtLeast(0.85)));
        }
    }
    Ok(figures)
}

/// Every tenth of the 135 frames of the patches, worst camera.
fn patches() -> Result<Vec<Figure>, PaperError> {
    let mut measured = Vec::new();
    for seed in CAMERAS {
        let (calibration, _) = targets::calibrate_random(seed)?;
        measured.push(targets::patches(seed, &calibration, 10)?);
    }
    let worst = |value: fn(&targets::PatchFigures) -> f64| largest(measured.iter().map(value));
    let spread =
        "spread of ln(value / reflectivity) over patches, depths, tilts and places beside the noise floor";
    let (ours, textbook) = (worst(|f| f.deviation / f.floor), worst(|f| f.textbook / f.floor));
    let valid = measured.iter().map(|figures| figures.valid).fold(f64::INFINITY, f64::min);
    let what = |name: &str| format!("{spread}, worst camera: {name}");
    let share = "valid pixels, same frames, worst camera";
    Ok(vec![
        Figure::new("profile", what("linear, square"), textbook, Unit::Ratio, Aim::None),
        Figure::new("profile", what("spline, profile, angle, wiener"), ours, Unit::Ratio, Aim::AtMost(1.5)),
        Figure::new("profile", share, valid, Unit::Percent, Aim::AtLeast(0.85)),
    ])
}

fn denoising() -> Result<Vec<Figure>, PaperError> {
    let rules = [DenoiseRule::Wiener, DenoiseRule::Plane];
    let some = rules.map(Some);
    let mut figures = Vec::new();
    let all = [None, some[0], some[1]];
    for (rule, ratio) in all.iter().zip(denoise::flat_noise(&all)?) {
        let name = rule.map_or("none", DenoiseRule::name);
        let what = format!("noise on flat areas beside that with the true distance, SNR 4.5: {name}");
        let aim = if rule.is_some() { Aim::AtMost(1.05) } else { Aim::None };
        figures.push(Figure::new("denoise", what, ratio, Unit::Ratio, aim));
    }
    for wall_m in [2.75, 3.25, 3.75, 4.45] {
        let bars = Bars { wall_m, equal_amplitude: true };
        for (rule, bias) in rules.iter().zip(bars.bias(&some)?) {
            let what = format!(
                "bias on bars of 3 px, {:.1} m before a wall, SNR 4.5: {}",
                bars.step_m(),
                rule.name()
            );
            figures.push(Figure::new("denoise", what, bias, Unit::Percent, Aim::AtMost(0.05)));
        }
    }
    for (rule, leak_m) in rules.iter().zip(denoise::texture_leak_m(&rules)?) {
        let what = format!("checkerboard at one distance, bright less dark squares: {}", rule.name());
        // Four standard errors of the two means.
        figures.push(Figure::new("denoise", what, leak_m, Unit::Metre, Aim::AtMost(0.005)));
    }
    Ok(figures)
}

fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(f64::NEG_INFINITY, |a, b| if b.is_nan() { b } else { a.max(b) })
}
