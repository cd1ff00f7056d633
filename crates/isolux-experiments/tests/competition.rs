//! The numbers that the section of the competition prints, against the same numbers computed here pixel by pixel,
//! without the core's evaluation.
#![allow(clippy::unwrap_used, clippy::panic, reason = "helpers of tests")]

mod sections;

use std::sync::OnceLock;

use isolux::terms::lut::LutAnswer;
use isolux::{Frame, IntegrationTime};
use isolux_camera::{CameraModel, Scene, SimulatedFrame, Simulation};
use isolux_report::page::{Block, Cell, Section, Verdict};
use sections::{claim, lab, row, table};

/// The page's values are products of f32 (half an ulp each, 6e-8), these are f64; a CV is a difference of such
/// values, so its relative error is larger by 1 / CV, and percent by 100 again.
const CV_TOLERANCE_PERCENT: f64 = 1e-3;

fn section() -> &'static Section {
    static SECTION: OnceLock<Section> = OnceLock::new();
    SECTION.get_or_init(|| sections::make("rivals on the same frames"))
}

fn desk() -> Vec<(f64, Frame)> {
    let scene = Scene::builtin("office-desk").unwrap();
    let simulation = Simulation::new(CameraModel::preset(&scene.camera).unwrap(), scene, lab().seed).unwrap();
    let mut simulated = SimulatedFrame::new(simulation.shape());
    let mut frame = |index| {
        simulation.render_frame(index, &mut simulated).unwrap();
        let frame = simulated.frame.clone();
        let IntegrationTime::PerFrame(time_us) = frame.integration_time_us else { panic!("no time") };
        (time_us, frame)
    };
    (0..simulation.len()).map(&mut frame).collect()
}

/// Every competitor has a value where amplitude and distance are positive and nothing is flagged.
fn usable(frame: &Frame, index: usize) -> bool {
    frame.is_valid(index) && frame.distance_m.as_ref().unwrap().values()[index] > 0.0
}

fn quantile(sorted: &[f64], fraction: f64) -> f64 {
    let rank = fraction * (sorted.len() - 1) as f64;
    let (low, high) = (sorted[rank.floor() as usize], sorted[rank.ceil() as usize]);
    low + rank.fract() * (high - low)
}

/// Median and 95 % quantile over pixels of the CV over the means at each time, percent.
fn pixel_cv(frames: &[(f64, Frame)], gain: impl Fn(f64) -> f64) -> [f64; 2] {
    let mut found = Vec::new();
    for index in 0..frames[0].1.amplitude.values().len() {
        let mut means = Vec::new();
        for run in frames.chunk_by(|a, b| a.0 == b.0) {
            let values: Vec<f64> = run
                .iter()
                .filter(|(_, frame)| usable(frame, index))
                .map(|(time_us, frame)| f64::from(frame.amplitude.values()[index]) * gain(*time_us))
                .collect();
            if !values.is_empty() {
                means.push(values.iter().sum::<f64>() / values.len() as f64);
            }
        }
        if means.len() > 1 {
            let mean = means.iter().sum::<f64>() / means.len() as f64;
            let variance = means.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / means.len() as f64;
            found.push(100.0 * variance.sqrt() / mean);
        }
    }
    found.sort_by(f64::total_cmp);
    [quantile(&found, 0.5), quantile(&found, 0.95)]
}

#[test]
fn the_cv_of_raw_linear_and_table_are_those_of_the_pixels() {
    let mut frames = desk();
    let lut = lab().calibration.terms.lut.as_ref().unwrap();
    let table_gain = |time_us: f64| match lut.at(time_us) {
        LutAnswer::Inside(gain) => gain,
        other => panic!("{time_us}: {other:?}"),
    };
    let gains: [(&str, &dyn Fn(f64) -> f64); 3] = [
        ("raw", &|_| 1.0),
        ("linear time (Ritt)", &|time_us| 8200.0 / time_us),
        ("LUT (paper)", &table_gain),
    ];
    for (selection, from_us) in [("all", 0.0), ("from-1-ms", 1000.0)] {
        frames.retain(|(time_us, _)| *time_us >= from_us);
        let printed = table(section(), &format!("competition-desk-{selection}"));
        for (name, gain) in &gains {
            let row = row(printed, name);
            let [median, p95] = pixel_cv(&frames, gain);
            assert!(
                (row[0] - median).abs() < CV_TOLERANCE_PERCENT,
                "{selection} {name}: {} {median}",
                row[0]
            );
            assert!((row[1] - p95).abs() < CV_TOLERANCE_PERCENT, "{selection} {name}: {} {p95}", row[1]);
        }
    }
}

#[test]
fn slopes_agree_with_the_window_means_of_the_board() {
    let slopes = table(section(), "competition-slopes");
    // From the laboratory's means, which no evaluator has seen: the median slope of pairs at one integration time.
    let mut pairs = Vec::new();
    let mut by_time = lab().board.clone();
    by_time.sort_by(|a, b| {
        a.integration_time_us
            .total_cmp(&b.integration_time_us)
            .then(a.true_distance_m.total_cmp(&b.true_distance_m))
    });
    for group in by_time.chunk_by(|a, b| a.integration_time_us == b.integration_time_us) {
        for (index, first) in group.iter().enumerate() {
            for second in &group[index + 1..] {
                let ln_distance = (second.distance_m / first.distance_m).ln();
                pairs.push((second.amplitude_dn / first.amplitude_dn).ln() / ln_distance);
            }
        }
    }
    pairs.sort_by(f64::total_cmp);
    let expected = quantile(&pairs, 0.5);
    let raw = row(slopes, "raw")[0];
    // Means count every position once, the sample every pixel; both see LED ring, harmonic and saturation, which
    // bend the curve by a few percent.
    assert!((raw - expected).abs() < 0.03, "{raw} {expected}");
    // d² adds exactly 2 to a slope, but for the distance noise that it multiplies into the values.
    let square = row(slopes, "d² (Oprisescu)")[0];
    assert!((square - raw - 2.0).abs() < 0.01, "{square} {raw}");
}

#[test]
fn time_steps_neither_add_noise_nor_lose_pixels() {
    for scene in ["desk", "shelf"] {
        for selection in ["all", "from-1-ms", "bright"] {
            let printed = table(section(), &format!("competition-{scene}-{selection}"));
            for name in ["linear time (Ritt)", "LUT (paper)"] {
                let row = row(printed, name);
                // One factor for all pixels of a frame drops out of the noise but for f32 rounding.
                assert!((row[5] - 1.0).abs() < 1e-5, "{}", row[5]);
                assert_eq!(row[6], sections::row(printed, "raw")[6]);
            }
            assert!(row(printed, "LUT + cubic (paper)")[5] > 1.2, "distance noise must show");
        }
    }
}

#[test]
fn the_best_cell_is_the_best_and_raw_never_is() {
    let tables = section().blocks.iter().filter_map(|block| match block {
        Block::Table(table) => Some(table),
        _ => None,
    });
    for table in tables {
        for column in 1..table.columns.len() {
            let larger_is_better = table.columns[column].starts_with("threshold IoU");
            let cells = || table.rows.iter().map(|row| &row[column]);
            let key = |value: f64| if larger_is_better { -value } else { value.abs() };
            let best = cells().find_map(|cell| match cell {
                Cell::Best { value, decimals } => Some((key(*value), *decimals)),
                _ => None,
            });
            assert!(!matches!(table.rows[0][column], Cell::Best { .. }), "{}", table.id);
            let Some((best, decimals)) = best else { continue };
            // Steps that leave the effect in do not compete; rows that have both steps always do.
            for row in
                table.rows.iter().filter(|row| matches!(&row[0], Cell::Text(name) if name.contains(" + ")))
            {
                if let Cell::Number { value, .. } = row[column] {
                    assert!(
                        key(value) > best - 0.5 * 0.1f64.powi(decimals as i32),
                        "{} column {column}",
                        table.id
                    );
                }
            }
        }
    }
}

#[test]
fn claims_say_what_the_tables_say() {
    let bright =
        |scene: &str, name: &str| row(table(section(), &format!("competition-{scene}-bright")), name);
    for (id, column) in [("lut-against-linear-typical", 0), ("lut-against-linear-worst", 1)] {
        let lead =
            |scene: &str| bright(scene, "linear time (Ritt)")[column] - bright(scene, "LUT (paper)")[column];
        let claim = claim(section(), id);
        assert!((claim.value - 0.5 * (lead("desk") + lead("shelf"))).abs() < 1e-12, "{id}");
        assert_eq!(claim.verdict == Verdict::Holds, lead("desk") > 0.0 && lead("shelf") > 0.0, "{id}");
    }
    // The cubic is why one measures: it must be flatter than the analytic laws on board and patches.
    for id in ["cubic-against-square-slope", "cubic-against-eq5-slope"] {
        assert_eq!(claim(section(), id).verdict, Verdict::Holds, "{id}");
    }
    let loses = claim(section(), "lut-against-linear-typical").verdict != Verdict::Holds;
    let said = section().blocks.iter().any(
        |block| matches!(block, Block::Text(text) if text.contains("Where a rival wins: linear time (Ritt)")),
    );
    assert_eq!(loses, said, "a rival's win must be said in words");
}
