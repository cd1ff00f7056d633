//! Colours and shapes that distinguish series.

use std::f64::consts::TAU;

/// Colours in the style sheet; series beyond start again, with another shape.
const COLOURS: usize = 8;
/// Number of shapes; series beyond start again, with another colour.
const SHAPES: usize = 7;
/// Size of the shapes where there is room for them, pixels.
pub(super) const RADIUS: f64 = 3.6;

/// Class of the colour of a series.
pub(super) fn class(series: usize) -> String {
    format!("s{}", series % COLOURS)
}

/// Corners of the shape of a series around (0, 0), `radius` across to a side; none for the disc.
pub(super) fn corners(shape: usize, radius: f64) -> Vec<(f64, f64)> {
    match shape % SHAPES {
        0 => Vec::new(),
        1 => polygon(4, TAU / 8.0, radius * 1.25),
        2 => polygon(3, -TAU / 4.0, radius * 1.35),
        3 => polygon(4, 0.0, radius * 1.35),
        4 => polygon(3, TAU / 4.0, radius * 1.35),
        5 => cross(0.0, radius * 1.35),
        _ => cross(TAU / 8.0, radius * 1.35),
    }
}

fn polygon(sides: u32, turn: f64, radius: f64) -> Vec<(f64, f64)> {
    let corner = |index| turn + TAU * f64::from(index) / f64::from(sides);
    (0..sides).map(|index| (radius * corner(index).cos(), radius * corner(index).sin())).collect()
}

fn cross(turn: f64, radius: f64) -> Vec<(f64, f64)> {
    let half = radius * 0.3;
    let arm = [(half, -half), (radius, -half), (radius, half)];
    let (sin, cos) = turn.sin_cos();
    let quarter = |index: usize, (x, y): (f64, f64)| match index {
        0 => (x, y),
        1 => (-y, x),
        2 => (-x, -y),
        _ => (y, -x),
    };
    let upright = (0..4).flat_map(|index| arm.map(|corner| quarter(index, corner)));
    upright.map(|(x, y)| (x * cos - y * sin, x * sin + y * cos)).collect()
}
