//! The numbers that the section of the purpose prints, against the same numbers computed here from the frames, without
//! the image library.
#![allow(clippy::unwrap_used, clippy::panic, reason = "helpers of tests")]

mod sections;

use std::sync::OnceLock;

use isolux::standardize::Choice;
use isolux::{Channels, IntegrationTime, Standardizer};
use isolux_camera::{CameraModel, Scene, SimulatedFrame, Simulation};
use isolux_report::page::{Section, Verdict};
use sections::{chart, claim, lab, row, series, table};

/// Both sides count pixels and divide: only the order of a mean's terms may differ.
const ROUNDING: f64 = 1e-12;

fn section() -> &'static Section {
    static SECTION: OnceLock<Section> = OnceLock::new();
    SECTION.get_or_init(|| sections::make("one set of parameters"))
}

/// Integration time in µs and values of every frame of the desk, raw or after the paper's chain.
fn desk(standardized: bool) -> Vec<(f64, Vec<f32>)> {
    let scene = Scene::builtin("office-desk").unwrap();
    let simulation = Simulation::new(CameraModel::preset(&scene.camera).unwrap(), scene, lab().seed).unwrap();
    let channels = Channels::AMPLITUDE | Channels::DISTANCE | Channels::INTEGRATION_TIME;
    let chain = Standardizer::plan(&Choice::paper(), Some(&lab().calibration), channels).unwrap();
    let mut simulated = SimulatedFrame::new(simulation.shape());
    let mut stream = chain.stream();
    let mut values = |index| {
        simulation.render_frame(index, &mut simulated).unwrap();
        let frame = &simulated.frame;
        let IntegrationTime::PerFrame(time_us) = frame.integration_time_us else { panic!("no time") };
        if !standardized {
            let values = frame.amplitude.values().iter().enumerate();
            let measured = values.map(|(index, value)| if frame.is_valid(index) { *value } else { f32::NAN });
            return (time_us, measured.collect());
        }
        (time_us, stream.push(frame).unwrap().amplitude.values().to_vec())
    };
    (0..simulation.len()).map(&mut values).collect()
}

/// Otsu's level of grey levels, from the definition: the level with the largest variance between the classes.
fn otsu(levels: &[u8]) -> u8 {
    let spread = |level: u8| {
        let (low, high): (Vec<f64>, Vec<f64>) =
            levels.iter().map(|value| f64::from(*value)).partition(|value| *value <= f64::from(level));
        if low.is_empty() || high.is_empty() {
            return 0.0;
        }
        let mean = |class: &[f64]| class.iter().sum::<f64>() / class.len() as f64;
        low.len() as f64 * high.len() as f64 * (mean(&low) - mean(&high)).powi(2)
    };
    // Of equals the first: an empty gap between the classes has many.
    (0..=254).rev().max_by(|a, b| spread(*a).total_cmp(&spread(*b))).unwrap()
}

fn grey(values: &[f32], levels_per_dn: f64) -> Vec<u8> {
    values.iter().map(|value| (f64::from(*value) * levels_per_dn).round() as u8).collect()
}

fn iou(first: &[u8], second: &[u8], level: u8) -> f64 {
    let masks = || first.iter().zip(second).map(|(a, b)| (*a > level, *b > level));
    masks().filter(|(a, b)| *a && *b).count() as f64 / masks().filter(|(a, b)| *a || *b).count() as f64
}

#[test]
fn the_threshold_curves_are_those_of_the_frames() {
    let chart = chart(section(), "purpose-time-threshold");
    for (standardized, name) in [(false, "desk, raw"), (true, "desk, standardized")] {
        let frames = desk(standardized);
        let reference = frames.iter().position(|(time_us, _)| *time_us == 8200.0).unwrap();
        let levels_per_dn = 200.0 / quantile_99(&frames[reference].1);
        let reference_grey = grey(&frames[reference].1, levels_per_dn);
        let level = otsu(&reference_grey);
        let points = &series(chart, name).points;
        assert_eq!(points.len(), 18);
        for (time_ms, printed) in points {
            let others = frames
                .iter()
                .enumerate()
                .filter(|(index, (time_us, _))| time_us / 1000.0 == *time_ms && *index != reference);
            let found: Vec<f64> = others
                .map(|(_, (_, values))| iou(&reference_grey, &grey(values, levels_per_dn), level))
                .collect();
            let mean = found.iter().sum::<f64>() / found.len() as f64;
            assert!((mean - printed).abs() < ROUNDING, "{name} {time_ms} ms: {mean} {printed}");
        }
    }
}

/// Linear between the two nearest ranks.
fn quantile_99(values: &[f32]) -> f64 {
    let mut valid: Vec<f64> =
        values.iter().filter(|value| value.is_finite()).map(|value| f64::from(*value)).collect();
    valid.sort_by(f64::total_cmp);
    let rank = 0.99 * (valid.len() - 1) as f64;
    let (low, high) = (valid[rank.floor() as usize], valid[rank.ceil() as usize]);
    low + rank.fract() * (high - low)
}

#[test]
fn the_summary_is_the_mean_and_the_worst_of_the_curves() {
    let curves = [
        ("purpose-time-threshold", "threshold IoU"),
        ("purpose-time-edges", "Canny F1"),
        ("purpose-time-otsu", "Otsu IoU"),
        ("purpose-time-corners", "FAST repeated"),
    ];
    for (id, metric) in curves {
        for scene in ["desk", "shelf"] {
            let row = row(table(section(), "purpose-summary"), &format!("{scene}: {metric}"));
            for (variant, column) in [("raw", 0), ("standardized", 4)] {
                let points = &series(chart(section(), id), &format!("{scene}, {variant}")).points;
                let values: Vec<f64> =
                    points.iter().filter(|(ms, _)| *ms >= 1.0).map(|(_, value)| *value).collect();
                let mean = values.iter().sum::<f64>() / values.len() as f64;
                let worst = values.iter().copied().fold(1.0, f64::min);
                assert!((row[column] - mean).abs() < ROUNDING, "{id} {scene} {variant}");
                assert!((row[column + 1] - worst).abs() < ROUNDING, "{id} {scene} {variant}");
            }
        }
    }
}

#[test]
fn what_the_conclusion_claims_holds_for_thresholds_and_over_distances() {
    for id in [
        "one-threshold-for-all-times",
        "one-threshold-for-all-distances",
        "one-canny-for-all-distances",
        "one-corners-for-all-distances",
        "otsu-level-over-distances",
    ] {
        assert_eq!(claim(section(), id).verdict, Verdict::Holds, "{id}");
    }
}

#[test]
fn the_shares_that_decide_are_those_of_the_curves() {
    let detectors = [("threshold", "threshold"), ("edges", "canny"), ("corners", "corners")];
    for (curve, id) in detectors {
        let served = |scene: &str| {
            let chart = chart(section(), &format!("purpose-time-{curve}"));
            let points = &series(chart, &format!("{scene}, standardized")).points;
            let at_reference = points.iter().find(|(ms, _)| *ms == 8.2).unwrap().1;
            points.iter().filter(|(_, value)| *value >= 0.8 * at_reference).count()
        };
        let share = (served("desk") + served("shelf")) as f64 / 36.0;
        let claim = claim(section(), &format!("one-{id}-for-all-times"));
        assert!((claim.value - share).abs() < ROUNDING, "{id}");
        // What the sentence says and what the verdict says.
        assert!(claim.measured.contains(&format!("{:.0} % of the conditions after", 100.0 * share)), "{id}");
        assert!(share >= 0.75 || claim.verdict != Verdict::Holds, "{id}");
    }
}

#[test]
fn the_noise_of_the_distance_is_named() {
    let section = section();
    let claim = claim(section, "distance-step-costs-edges-at-short-times");
    let points = &series(chart(section, "purpose-time-edges"), "desk, standardized").points;
    let at_2_ms = points.iter().find(|(ms, _)| *ms == 2.0).unwrap().1;
    assert!(claim.measured.contains(&format!("{at_2_ms:.2} after the whole chain")), "{}", claim.measured);
    assert!(claim.value < 0.0, "{}", claim.value);
}

#[test]
fn the_raw_level_of_otsu_follows_the_integration_time() {
    let points = &series(chart(section(), "purpose-time-otsu-level"), "desk, raw").points;
    for (time_ms, ratio) in points.iter().filter(|(ms, _)| (2.0..=8.2).contains(ms)) {
        // Nothing clips there, so the level is proportional to the time. Levels are whole numbers, the lowest near
        // 19: half a level more or less is 3 %; noise moves the split between the classes by as much.
        assert!((ratio / (time_ms / 8.2) - 1.0).abs() < 0.06, "{time_ms} ms: {ratio}");
    }
}
