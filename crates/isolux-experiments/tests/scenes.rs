//! Figures 7 to 9: the printed numbers against straight f64 code on the same frames.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

mod frames;
mod sections;

use frames::{assert_close, assert_holds, frame, picture, simulation};
use isolux::Plane;
use isolux_camera::Scene;
use isolux_camera::scene::run::RegisterRange;
use isolux_report::page::Stroke;
use sections::{chart, claim, lab, make, row, table};

const NAME: &str = "figures 7 to 9";
const SCENES: [(&str, &str, &str); 2] =
    [("office-desk", "scene 1", "fig-8"), ("office-shelf", "scene 2", "fig-9")];
/// Name, first row, first column, height, width: (144 − 20)/4 = 31 and (176 − 20)/4 = 39.
const REGIONS: [(&str, [usize; 4]); 4] = [
    ("whole image", [0, 0, 144, 176]),
    ("centre", [62, 78, 20, 20]),
    ("half way out", [31, 39, 20, 20]),
    ("corner", [0, 0, 20, 20]),
];
/// Corrected pixels are f32: half a unit in the last place is 6e-8.
const ROUNDING: f64 = 1e-6;

/// Means over the integration times of one region.
#[derive(Default)]
struct Curves {
    times_ms: Vec<f64>,
    raw: Vec<f64>,
    corrected: Vec<f64>,
    noise_free: Vec<f64>,
}

fn mean(plane: &Plane<f32>, valid: &[bool], [top, left, height, width]: [usize; 4]) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for row in top..top + height {
        for column in left..left + width {
            if valid[row * 176 + column] {
                sum += f64::from(plane.get(row, column).unwrap());
                count += 1.0;
            }
        }
    }
    sum / count
}

/// Renders the scene and multiplies by the table's own entries.
fn curves(scene: &str) -> [Curves; 4] {
    let lut = lab().calibration.terms.lut.as_ref().unwrap();
    let mut scene = Scene::builtin(scene).unwrap();
    let last = lut.integration_time_us.len() as u32 - 1;
    scene.runs[0].integration_times_us.clear();
    scene.runs[0].registers = Some(RegisterRange { first: 0, last: last.min(135), step: 1 });
    scene.runs[0].frames_per_time = 1;
    let simulation = simulation(scene);
    let mut frames = Vec::new();
    simulation.render_frames(0..simulation.len(), &mut frames).unwrap();
    let mut curves: [Curves; 4] = Default::default();
    for (register, simulated) in frames.iter().enumerate() {
        let amplitude = &simulated.frame.amplitude;
        let valid: Vec<bool> = amplitude.values().iter().map(|a| *a > 0.0).collect();
        let multiplier = lut.multiplier[register];
        assert_eq!(lut.integration_time_us[register], 200.0 * (register + 1) as f64);
        for (curve, (_, window)) in curves.iter_mut().zip(REGIONS) {
            let raw = mean(amplitude, &valid, window);
            curve.times_ms.push(0.2 * (register + 1) as f64);
            curve.raw.push(raw);
            curve.corrected.push(multiplier * raw);
            curve.noise_free.push(multiplier * mean(&simulated.truth.noise_free_amplitude, &valid, window));
        }
    }
    curves
}

fn cv(values: &[f64]) -> f64 {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    (values.iter().map(|v| v * v).sum::<f64>() / count - mean * mean).sqrt() / mean
}

#[test]
fn table_charts_and_claims_say_what_straight_code_finds() {
    let section = make(NAME);
    let variation = table(&section, "scenes-variation");
    for (scene, short, figure) in SCENES {
        let curves = curves(scene);
        let chart = chart(&section, figure);
        let mut ratios = Vec::new();
        for (index, ((name, _), curve)) in REGIONS.iter().zip(&curves).enumerate() {
            let Curves { times_ms, raw, corrected, noise_free } = curve;
            let last = raw.len() - 1;
            ratios.push(cv(raw) / cv(corrected));
            // Register 4 is 1 ms, register 40 the reference of 8.2 ms.
            let expected = [
                cv(raw),
                cv(corrected),
                ratios[index],
                cv(&raw[4..]) / cv(&corrected[4..]),
                corrected[0] / corrected[40],
                corrected[last] / corrected[40],
                noise_free[0] / noise_free[40],
            ];
            let found = row(variation, &format!("{short}, {name}"));
            assert_close(&found, &expected, ROUNDING, &format!("{scene} {name}"));
            for (series, means, stroke) in
                [(index, corrected, Stroke::Solid), (index + 4, raw, Stroke::Dashed)]
            {
                let series = &chart.series[series];
                assert!(series.name.starts_with(name) && series.stroke == stroke, "{}", series.name);
                let (x, y): (Vec<f64>, Vec<f64>) = series.points.iter().copied().unzip();
                assert_close(&x, times_ms, 1e-12, figure);
                assert_close(&y, means, ROUNDING, figure);
            }
        }
        let value = |id: &str| claim(&section, &format!("{figure}-{id}")).value;
        let least = ratios[1..].iter().copied().fold(f64::INFINITY, f64::min);
        let noise_free = curves[0].noise_free[0] / curves[0].noise_free[40];
        let found =
            [value("image-varies-less"), value("windows-vary-less"), value("floor-at-the-shortest-time")];
        assert_close(&found, &[ratios[0], least, noise_free], ROUNDING, figure);
    }
}

#[test]
fn corrected_images_vary_several_times_less_and_noise_is_what_deviates_at_the_short_end() {
    let section = make(NAME);
    for figure in ["fig-8", "fig-9"] {
        let ids = [format!("{figure}-image-varies-less"), format!("{figure}-floor-at-the-shortest-time")];
        assert_holds(&section, &ids.each_ref().map(String::as_str));
        assert!(claim(&section, &ids[0]).value > 3.0);
    }
    for (_, short, _) in SCENES {
        for (name, _) in REGIONS {
            let found = row(table(&section, "scenes-variation"), &format!("{short}, {name}"));
            // From 1 ms on every region varies several times less, the dimmest included.
            assert!(found[3] > 3.0, "{short} {name}: {}", found[3]);
        }
    }
}

#[test]
fn the_pictures_are_raw_frames_of_the_reference_time() {
    let section = make(NAME);
    for (scene, ..) in SCENES {
        let picture = picture(&section, &format!("fig-7-{scene}"));
        let mut scene = Scene::builtin(scene).unwrap();
        scene.runs[0].integration_times_us.clear();
        scene.runs[0].registers = Some(RegisterRange { first: 0, last: 40, step: 1 });
        scene.runs[0].frames_per_time = 1;
        let expected = frame(scene, 8200.0).frame.amplitude;
        assert_eq!(picture.values, expected);
        assert!(picture.range.0 == 0.0 && picture.range.1 > 500.0);
    }
}
