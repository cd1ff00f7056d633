//! Figures 6 and 13: the printed numbers against straight f64 code on the same frames.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

mod frames;
mod sections;

use frames::{assert_close, assert_holds, f64s, frame, picture};
use isolux_camera::scene::object::Form;
use isolux_camera::scene::texture::Texture;
use isolux_camera::{Scene, SimulatedFrame};
use sections::{claim, lab, make, row, table};

const NAME: &str = "figures 6 and 13";
const RULES: [&str; 4] = ["0.9 of maximum", "upper 10 %", "mean + 4σ", "histogram"];
/// Limited values are f32: half a unit in the last place is 6e-8, and the moments square it.
const ROUNDING: f64 = 1e-6;

fn scene() -> Scene {
    Scene::builtin("highlights").unwrap()
}

/// The four cutoffs, rounded to the f32 that limits the image.
fn cutoffs(image: &[f64]) -> [f64; 4] {
    let mut valid: Vec<f64> = image.iter().copied().filter(|v| *v > 0.0).collect();
    valid.sort_by(f64::total_cmp);
    let count = valid.len() as f64;
    let at = |fraction: f64| valid[(fraction * (count - 1.0)) as usize];
    let maximum = valid[valid.len() - 1];
    let mean = valid.iter().sum::<f64>() / count;
    let deviation = (valid.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / count).sqrt();
    let end = maximum.min(4.0 * at(0.99));
    let mut bins = [0.0; 258];
    for value in valid.iter().filter(|v| **v <= end) {
        bins[1 + ((value / (end / 256.0)) as usize).min(255)] += 1.0;
    }
    let needed = f64::max(2.0, 5e-4 * count);
    let highest = (1..=256).rev().find(|&b| (bins[b - 1] + bins[b] + bins[b + 1]) / 3.0 >= needed).unwrap();
    let histogram = (highest as f64 * end / 256.0).max(at(0.98));
    [0.9 * maximum, at(0.9), mean + 4.0 * deviation, histogram].map(|cutoff| f64::from(cutoff as f32))
}

struct Masks {
    foreground: Vec<bool>,
    highlight: Vec<bool>,
    matt: Vec<bool>,
}

fn masks(simulated: &SimulatedFrame) -> Masks {
    let truth = &simulated.truth;
    let measured: Vec<bool> = simulated.frame.amplitude.values().iter().map(|a| *a > 0.0).collect();
    let mask =
        |belongs: &dyn Fn(usize) -> bool| (0..measured.len()).map(|i| measured[i] && belongs(i)).collect();
    let specular = truth.specular_fraction.values();
    let (reflectivity, distance_m) = (truth.reflectivity.values(), truth.true_distance_m.values());
    Masks {
        foreground: mask(&|i| reflectivity[i] >= 0.5 && distance_m[i] < 1.2 && specular[i] < 0.01),
        highlight: mask(&|i| specular[i] > 0.5),
        matt: mask(&|i| specular[i] < 0.01),
    }
}

fn selected(values: &[f64], mask: &[bool]) -> Vec<f64> {
    values.iter().zip(mask).filter(|(_, member)| **member).map(|(value, _)| *value).collect()
}

fn moments(x: &[f64], y: &[f64]) -> f64 {
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let (x_mean, y_mean) = (mean(x), mean(y));
    x.iter().zip(y).map(|(x, y)| (x - x_mean) * (y - y_mean)).sum::<f64>() / x.len() as f64
}

/// τ-b over all pairs, by its definition.
fn naive_tau(x: &[f64], y: &[f64]) -> f64 {
    let sign = |a: f64, b: f64| i64::from(a > b) - i64::from(a < b);
    let (mut score, mut x_untied, mut y_untied) = (0, 0, 0);
    for i in 0..x.len() {
        for j in 0..i {
            let (a, b) = (sign(x[i], x[j]), sign(y[i], y[j]));
            score += a * b;
            x_untied += a * a;
            y_untied += b * b;
        }
    }
    score as f64 / ((x_untied as f64) * (y_untied as f64)).sqrt()
}

/// What a row of the tables should say.
fn expected(image: &[f64], cutoff: f64, masks: &Masks) -> Vec<f64> {
    let after: Vec<f64> = image.iter().map(|v| v.min(cutoff)).collect();
    let percent = |mask: &[bool]| {
        let values = selected(image, mask);
        100.0 * values.iter().filter(|v| **v > cutoff).count() as f64 / values.len() as f64
    };
    let valid: Vec<bool> = image.iter().map(|v| *v > 0.0).collect();
    let (x, y) = (selected(image, &masks.foreground), selected(&after, &masks.foreground));
    let (mut x_steps, mut y_steps) = (Vec::new(), Vec::new());
    let width = 176;
    for i in (0..image.len()).filter(|i| masks.foreground[*i]) {
        let right = (i % width + 1 < width).then_some(i + 1);
        let below = (i + width < image.len()).then_some(i + width);
        for j in [right, below].into_iter().flatten().filter(|j| masks.foreground[*j]) {
            x_steps.push(image[j] - image[i]);
            y_steps.push(after[j] - after[i]);
        }
    }
    let maximum = after.iter().copied().filter(|v| *v > 0.0).fold(0.0, f64::max);
    let mut matt = selected(&after, &masks.matt);
    matt.sort_by(f64::total_cmp);
    let position = 0.999 * (matt.len() - 1) as f64;
    let (low, high) = (matt[position.floor() as usize], matt[position.ceil() as usize]);
    vec![
        percent(&masks.foreground),
        (moments(&y, &y) / moments(&x, &x)).sqrt(),
        moments(&x_steps, &y_steps) / (moments(&x_steps, &x_steps) * moments(&y_steps, &y_steps)).sqrt(),
        naive_tau(&x, &y),
        100.0 * (low + position.fract() * (high - low)) / maximum,
        percent(&valid),
        percent(&masks.highlight),
        maximum,
    ]
}

#[test]
fn the_tables_say_what_straight_code_finds_in_the_three_scenes() {
    let section = make(NAME);
    let mut small_board = scene();
    let board = small_board.objects.iter_mut().find(|object| object.name == "board").unwrap();
    board.form = Form::Rectangle { size_m: [0.23, 0.17] };
    let Texture::Bitmap { cell_m, .. } = &mut board.texture else { panic!("the board has letters") };
    *cell_m = 0.012;
    let mut matt = scene();
    matt.objects.iter_mut().for_each(|object| object.highlight = None);
    for (id, scene) in
        [("specular-raw", scene()), ("specular-small-board", small_board), ("specular-matt", matt)]
    {
        let simulated = frame(scene, 8200.0);
        let (image, masks) = (f64s(&simulated.frame.amplitude), masks(&simulated));
        for (rule, cutoff) in RULES.into_iter().zip(cutoffs(&image)) {
            let found = row(table(&section, id), rule);
            assert_close(&found, &expected(&image, cutoff, &masks), ROUNDING, &format!("{id} {rule}"));
        }
    }
}

#[test]
fn a_standardized_image_keeps_its_structure_too() {
    let section = make(NAME);
    let simulated = frame(scene(), 8200.0);
    let [c0, c1, c2, c3] = lab().calibration.terms.cubic.as_ref().unwrap().coefficients;
    let distance_m = f64s(simulated.frame.distance_m.as_ref().unwrap());
    // The table is 1 at 8.2 ms.
    let scaled =
        |(a, d): (f64, &f64)| if a > 0.0 { a * (c0 + d * (c1 + d * (c2 + d * c3))) } else { f64::NAN };
    let image: Vec<f64> = f64s(&simulated.frame.amplitude).into_iter().zip(&distance_m).map(scaled).collect();
    let masks = masks(&simulated);
    for (rule, cutoff) in RULES.into_iter().zip(cutoffs(&image)) {
        let found = row(table(&section, "specular-standardized"), rule);
        let expected = expected(&image, cutoff, &masks);
        // The chain computes in f32: a value next to the cutoff or to the edge of a bin may fall on its other side.
        // One bin is 4·P99/256, below 1.5 % of the cutoff; ten pixels of 25 344 are 0.04 %.
        assert_close(&found[7..], &expected[7..], 0.015, rule);
        for (found, expected) in found[..7].iter().zip(&expected) {
            assert!((found - expected).abs() < 0.04 + 0.01 * expected, "{rule}: {found} {expected}");
        }
    }
    let claim = claim(&section, "histogram-keeps-structure-standardized");
    let found = row(table(&section, "specular-standardized"), "histogram");
    assert_eq!(claim.value, found[1].min(found[2]).min(found[3]));
}

#[test]
fn the_claims_hold_and_stand_on_the_tables() {
    let section = make(NAME);
    assert_holds(
        &section,
        &[
            "histogram-keeps-structure",
            "histogram-keeps-structure-standardized",
            "percent-flattens-foreground",
            "percent-erases-small-foreground",
            "fraction-of-maximum-in-bright-images",
            "histogram-frees-the-grey-scale",
        ],
    );
    let value = |id: &str| claim(&section, id).value;
    let cell = |id: &str, rule: usize, column: usize| row(table(&section, id), RULES[rule])[column];
    let kept = |column| cell("specular-raw", 3, column);
    assert_eq!(value("histogram-keeps-structure"), kept(1).min(kept(2)).min(kept(3)));
    assert_close(
        &[100.0 * value("percent-flattens-foreground")],
        &[cell("specular-raw", 1, 0)],
        1e-12,
        "flat",
    );
    let erased = 100.0 * value("percent-erases-small-foreground");
    assert_close(&[erased], &[cell("specular-small-board", 1, 0)], 1e-12, "erased");
    let bright = 100.0 * value("fraction-of-maximum-in-bright-images");
    assert_close(&[bright], &[cell("specular-matt", 0, 0)], 1e-12, "bright");
    assert_close(&[100.0 * value("histogram-frees-the-grey-scale")], &[kept(4)], 1e-12, "grey scale");
}

#[test]
fn the_pictures_are_the_image_limited_at_the_cutoffs() {
    let section = make(NAME);
    let image = f64s(&frame(scene(), 8200.0).frame.amplitude);
    let [_, upper_tenth, sigma, histogram] = cutoffs(&image);
    let pictures = [
        ("fig-6-original", f64::INFINITY),
        ("fig-6-corrected", histogram),
        ("fig-13-upper-tenth", upper_tenth),
        ("fig-13-sigma", sigma),
        ("fig-13-histogram", histogram),
    ];
    for (id, cutoff) in pictures {
        let picture = picture(&section, id);
        let limited: Vec<f64> =
            image.iter().map(|v| if *v > 0.0 { v.min(cutoff) } else { f64::NAN }).collect();
        assert_close(&f64s(&picture.values), &limited, 1e-7, id);
        let white = limited.iter().copied().filter(|v| *v > 0.0).fold(0.0, f64::max);
        assert_eq!(picture.range, (0.0, white as f32), "{id}");
    }
}
