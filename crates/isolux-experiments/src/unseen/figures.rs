//! Every figure in one list, for the table and the page.

use isolux::DenoiseRule;

use super::bracket::{self, BracketCase};
use super::chains::{self, Chain};
use super::decay::{Ambient, Decay};
use super::denoise::{self, Bars};
use super::figure::{Aim, Figure, Unit, largest, smallest};
use super::held_out::{CAMERAS, HeldOut};
use super::response::{self, FittedOn, Light};
use super::self_calibration::{self, Deviation, Experiment, Poses, RunKind, SelfCalibration, Spoil};
use super::sigma::{self, SigmaCase};
use super::{decay, still, targets};
use crate::error::ExperimentError;

/// The most that is to be left of the reference decay: coefficient of variation.
pub(crate) const DECAY_CV: f64 = 0.015;
/// The most that the typical pixel of a still scene is to vary over integration times, beside the noise floor.
pub(crate) const OVER_FLOOR: f64 = 1.25;
/// The same for amplitude and distance alone, where `t_ref / t` reaches 1.108.
const OVER_FLOOR_BY_AMPLITUDE: f64 = 1.11;

/// Measures everything that needs no recording. `progress` is told what is being done.
///
/// # Errors
/// [`ExperimentError`], which nothing should bring about.
pub fn simulated(progress: &mut dyn FnMut(&str)) -> Result<Vec<Figure>, ExperimentError> {
    let mut figures = Vec::new();
    progress("held-out cameras");
    let cameras = CAMERAS.iter().map(|seed| HeldOut::new(*seed)).collect::<Result<Vec<_>, _>>()?;
    progress("reference decays");
    figures.extend(decays(&cameras)?);
    progress("still scenes");
    figures.extend(still_scenes(&cameras)?);
    progress("strong ambient light");
    figures.extend(ambient()?);
    progress("patches at all depths, tilts and places");
    figures.extend(patches()?);
    progress("denoising");
    figures.extend(denoising()?);
    progress("predicted standard deviations");
    figures.extend(sigma(&cameras)?);
    progress("brackets");
    figures.extend(brackets(&cameras)?);
    progress("self-calibration");
    figures.extend(self_calibration(&cameras)?);
    Ok(figures)
}

/// The worst of the cameras for each chain, and of amplitude alone in each light.
fn decays(cameras: &[HeldOut]) -> Result<Vec<Figure>, ExperimentError> {
    let measure = |ambient, chains: &[Chain]| {
        let of_camera = |camera| decay::measure(camera, ambient, chains);
        cameras.iter().map(of_camera).collect::<Result<Vec<_>, _>>()
    };
    let measured = measure(Ambient::Same, &chains::ALL)?;
    let figure = |(index, chain): (usize, &Chain)| {
        let cv = largest(measured.iter().map(|decays| decays[index].cv));
        let what = format!("reference decay over all integration times, CV, worst camera: {}", chain.name);
        let aim = if chain.is_ours() { Aim::AtMost(DECAY_CV) } else { Aim::None };
        Figure::new("distance", what, cv, Unit::Percent, aim)
    };
    let mut figures: Vec<Figure> = chains::ALL.iter().enumerate().map(figure).collect();
    let of_amplitude = chains::ALL.iter().position(|chain| *chain == chains::FROM_AMPLITUDE);
    let same = measured.iter().filter_map(|decays| decays.get(of_amplitude?).copied()).collect();
    let of_light =
        |ambient| Ok::<Vec<Decay>, ExperimentError>(measure(ambient, &[chains::FROM_AMPLITUDE])?.concat());
    for (ambient, measured, most, least) in [
        (Ambient::Same, same, 0.008, 0.8),
        (Ambient::Dark, of_light(Ambient::Dark)?, 0.01, 0.8),
        (Ambient::Threefold, of_light(Ambient::Threefold)?, 0.01, 0.65),
    ] {
        let worst = |value: fn(&Decay) -> f64| measured.iter().map(value);
        let (cv, share) = (largest(worst(|decay| decay.cv)), smallest(worst(Decay::share)));
        let what = format!("the same from amplitude and distance alone, {}", ambient.describe());
        let positions = format!("{what}: share of the positions, the rest is flagged, worst camera");
        figures.push(Figure::new("distance", what, cv, Unit::Percent, Aim::AtMost(most)));
        figures.push(Figure::new("distance", positions, share, Unit::Percent, Aim::AtLeast(least)));
    }
    Ok(figures)
}

fn still_scenes(cameras: &[HeldOut]) -> Result<Vec<Figure>, ExperimentError> {
    let measured =
        cameras.iter().map(|camera| still::measure(camera, &chains::ALL)).collect::<Result<Vec<_>, _>>()?;
    let mut figures = Vec::new();
    for (index, chain) in chains::ALL.iter().enumerate() {
        let ratio =
            largest(measured.iter().map(|still| still.chains[index].median_cv / still.floor.median_cv));
        let what = format!(
            "per-pixel CV over integration times beside the noise floor, worst camera: {}",
            chain.name
        );
        let most = if *chain == chains::FROM_AMPLITUDE { OVER_FLOOR_BY_AMPLITUDE } else { OVER_FLOOR };
        let aim = if chain.is_ours() { Aim::AtMost(most) } else { Aim::None };
        figures.push(Figure::new("time", what, ratio, Unit::Ratio, aim));
        if chain.is_ours() {
            let valid = measured.iter().map(|still| still.chains[index].valid).fold(f64::INFINITY, f64::min);
            let what = format!("valid pixels of those measured, same scenes, worst camera: {}", chain.name);
            figures.push(Figure::new("time", what, valid, Unit::Percent, Aim::AtLeast(0.85)));
        }
    }
    Ok(figures)
}

/// Every tenth of the 135 frames of the patches, worst camera.
fn patches() -> Result<Vec<Figure>, ExperimentError> {
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

/// The least gain over a table refitted on the same scene, pixels and exposures, of the cameras.
fn ambient() -> Result<Vec<Figure>, ExperimentError> {
    let measure = |seed: &u64| response::measure(*seed, Light::StrongAmbient, FittedOn::Scene);
    let found = CAMERAS.iter().map(measure).collect::<Result<Vec<_>, _>>()?.concat();
    let mut figures = Vec::new();
    for (tier, aim) in [
        ("linear", Aim::None),
        ("scalar", Aim::None),
        ("amplitude", Aim::None),
        ("ambient", Aim::AtLeast(1.0)),
        ("pixel", Aim::AtLeast(3.0)),
        ("intensity", Aim::AtLeast(3.0)),
        ("phase_samples", Aim::AtLeast(3.0)),
    ] {
        let of_tier = || found.iter().filter(|figure| figure.method == tier);
        let gain = smallest(of_tier().map(|figure| figure.lut_median_cv / figure.median_cv));
        let what = format!(
            "strong ambient light, per-pixel CV of a lut refitted on the same scene over that of {tier}, worst camera"
        );
        figures.push(Figure::new("response", what, gain, Unit::Ratio, aim));
        let valid = smallest(of_tier().map(|figure| figure.valid_fraction));
        let what = format!("valid of the unclipped pixels, same exposures, worst camera: {tier}");
        figures.push(Figure::new("response", what, valid, Unit::Percent, Aim::None));
    }
    let beside_linear = CAMERAS.iter().map(|camera| {
        let cv = |method: &str| {
            let figure = found.iter().find(|figure| figure.camera == *camera && figure.method == method);
            figure.map_or(f64::NAN, |figure| figure.median_cv)
        };
        cv("linear") / cv("ambient")
    });
    let what = "strong ambient light, per-pixel CV of linear over that of ambient, worst camera";
    let least = Aim::AtLeast(1.0 / 1.1);
    figures.push(Figure::new("response", what, smallest(beside_linear), Unit::Ratio, least));
    // Of the methods that give nearly all pixels a value.
    let unmasked = found.iter().filter(|figure| figure.method != "ambient");
    let noise = smallest(unmasked.map(|figure| figure.lut_median_cv / figure.floor_median_cv));
    let what = "the same for the true factors: what the noise alone allows";
    figures.push(Figure::new("response", what, noise, Unit::Ratio, Aim::None));
    Ok(figures)
}

fn denoising() -> Result<Vec<Figure>, ExperimentError> {
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

/// Largest expected normalized calibration error.
const ENCE: f64 = 0.05;
/// What a normal law has is 68.3 %.
const COVERAGE: Aim = Aim::Within(0.66, 0.70);

fn sigma(cameras: &[HeldOut]) -> Result<Vec<Figure>, ExperimentError> {
    let plain = SigmaCase::PLAIN;
    let cases = [
        ("", plain, COVERAGE),
        (", --denoise wiener", SigmaCase { denoise: Some(DenoiseRule::Wiener), ..plain }, COVERAGE),
        (", --denoise plane", SigmaCase { denoise: Some(DenoiseRule::Plane), ..plain }, Aim::None),
        (", modulation frequency unknown", SigmaCase { frequency: false, ..plain }, Aim::None),
        (", no intensity recorded", SigmaCase { intensity: false, ..plain }, Aim::None),
        (", noise estimated from the scene", SigmaCase { noise_from_scene: true, ..plain }, Aim::None),
    ];
    let mut figures = Vec::new();
    for (name, case, aim) in cases {
        let mut found = Vec::new();
        for scene in ["office-desk", "cups"] {
            for camera in cameras {
                found.push(sigma::measure(camera, &SigmaCase { scene, ..case })?);
            }
        }
        let what = format!("errors within 1σ at SNR ≥ 5, against the truth{name}");
        figures.extend(both_ends(&what, "sigma", found.iter().map(|f| f.within_one_sigma), aim));
        let ence = largest(found.iter().map(|f| f.ence));
        // Denoising and a lack of channels have errors of their own.
        let aim = if case == plain { Aim::AtMost(ENCE) } else { Aim::None };
        figures.push(Figure::new("sigma", format!("ENCE{name}, worst"), ence, Unit::Percent, aim));
        let beyond = largest(found.iter().map(|f| f.beyond_three_sigma.0));
        let what = format!("errors beyond 3σ, 0.27 % of normal ones{name}, highest");
        figures.push(Figure::new("sigma", what, beyond, Unit::Percent, Aim::None));
    }
    Ok(figures)
}

/// The lowest and the highest of the cameras and scenes.
fn both_ends(
    what: &str,
    subject: &'static str,
    values: impl Iterator<Item = f64> + Clone,
    aim: Aim,
) -> [Figure; 2] {
    let figure = |end, value| Figure::new(subject, format!("{what}, {end}"), value, Unit::Percent, aim);
    [figure("lowest", smallest(values.clone())), figure("highest", largest(values))]
}

fn brackets(cameras: &[HeldOut]) -> Result<Vec<Figure>, ExperimentError> {
    let mut found = Vec::new();
    for scene in ["office-desk", "cups"] {
        for camera in cameras {
            found.push(bracket::measure(camera, &BracketCase::of(scene))?);
        }
    }
    let noise = largest(found.iter().map(|bracket| bracket.noise_of_best));
    let what = "noise of a merged bracket of four times beside its best time, median pixel, worst";
    let mut figures = vec![Figure::new("bracket", what, noise, Unit::Ratio, Aim::AtMost(1.0))];
    let coverage = found.iter().map(|bracket| bracket.sigma.within_one_sigma);
    figures.extend(both_ends("errors of merged frames within 1σ", "bracket", coverage, COVERAGE));
    // Where there is something to fill: elsewhere what is not usable is dead in every frame.
    let saturated = found.iter().filter(|bracket| bracket.usable_share[0] < 0.995);
    let filled = smallest(saturated.map(|bracket| bracket.filled_share));
    let what = "pixels saturated at the longest time that the others fill, cups, lowest";
    figures.push(Figure::new("bracket", what, filled, Unit::Percent, Aim::None));
    Ok(figures)
}

/// The worst of the cameras, each carried through a room of unknown things.
fn self_calibration(cameras: &[HeldOut]) -> Result<Vec<Figure>, ExperimentError> {
    let mut figures = Vec::new();
    for (poses, words) in [(Poses::Recorded, "poses recorded"), (Poses::Missing, "motion estimated")] {
        let run = |camera: &HeldOut| {
            let scene = RunKind::HandHeld.scene(40)?;
            let (camera, spoil) = (camera.model.clone(), Some(Spoil::USUAL));
            self_calibration::measure(&Experiment { camera, scene, poses, spoil, seed: 1 })
        };
        let found = cameras.iter().map(run).collect::<Result<Vec<_>, _>>()?;
        let mut figure = |subject, bound, of: fn(&SelfCalibration) -> Option<Deviation>| {
            let worst = largest(found.iter().map(|found| of(found).map_or(f64::NAN, |d| d.largest)));
            let what = format!(
                "self-calibration, 40 hand-held frames, 2 % noise, 5 % outliers, {words}: largest deviation, worst camera"
            );
            // The bounds are those for known poses; without, the figure is what it is.
            let aim = if poses == Poses::Recorded { Aim::AtMost(bound) } else { Aim::None };
            figures.push(Figure::new(subject, what, worst, Unit::Percent, aim));
        };
        figure("spline", 0.01, |found| found.distance);
        figure("profile", 0.015, |found| found.profile);
        figure("lut", 0.01, |found| found.time);
    }
    Ok(figures)
}
