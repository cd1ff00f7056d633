//! Reflectivity over a surface.

use serde::{Deserialize, Serialize};

use crate::error::{InvalidValue, ensure};

/// Reflectivity (0..1, diffuse) as a function of the place on the surface.
///
/// Places are (x, y) in metres from the centre of a rectangle or of the faces of a box; on spheres and
/// cylinders x runs along the circumference and y down.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Texture {
    /// One reflectivity.
    Uniform(f64),
    /// Squares of two reflectivities; the first is right and below of the centre.
    Checkerboard {
        /// Side of a square, metres.
        cell_m: f64,
        /// The two reflectivities.
        reflectivities: [f64; 2],
    },
    /// Vertical stripes of two reflectivities and equal width; turn the object for others.
    Stripes {
        /// Width of a pair of stripes, metres.
        period_m: f64,
        /// The two reflectivities.
        reflectivities: [f64; 2],
    },
    /// A grid of patches of known reflectivity, centred, row by row, on a border.
    Patches {
        /// Patches in a row.
        columns: usize,
        /// Distance from patch to patch, metres.
        pitch_m: f64,
        /// Side of a patch, metres, at most `pitch_m`.
        side_m: f64,
        /// Reflectivity of each patch.
        reflectivities: Vec<f64>,
        /// Reflectivity around the patches.
        border: f64,
    },
    /// Square tiles, each of a pseudo-random reflectivity of its own.
    Mosaic {
        /// Side of a tile, metres.
        cell_m: f64,
        /// Lowest and highest reflectivity.
        reflectivities: [f64; 2],
        /// Chooses the tiles: another seed, another mosaic.
        seed: u32,
    },
    /// Letters and drawings: `#` has the second reflectivity, everything else the first; centred.
    Bitmap {
        /// Side of a character's cell, metres.
        cell_m: f64,
        /// Lines of the drawing, of equal length.
        rows: Vec<String>,
        /// Reflectivity of ground and figure.
        reflectivities: [f64; 2],
    },
}

/// Reflectivity and label of a place on a texture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Surface {
    pub(crate) reflectivity: f64,
    /// Calibration label.
    pub(crate) target: u8,
}

impl Texture {
    pub(crate) fn at(&self, [x, y]: [f64; 2], target: u8) -> Surface {
        let of = |reflectivity| Surface { reflectivity, target };
        match self {
            Self::Uniform(reflectivity) => of(*reflectivity),
            Self::Checkerboard { cell_m, reflectivities } => {
                let odd = ((x / cell_m).floor() + (y / cell_m).floor()).rem_euclid(2.0) >= 1.0;
                of(reflectivities[usize::from(odd)])
            }
            Self::Stripes { period_m, reflectivities } => {
                of(reflectivities[usize::from((x / period_m).rem_euclid(1.0) >= 0.5)])
            }
            Self::Patches { columns, pitch_m, side_m, reflectivities, border } => {
                let rows = reflectivities.len().div_ceil(*columns);
                let patch = cell(x, *columns, *pitch_m, *side_m)
                    .zip(cell(y, rows, *pitch_m, *side_m))
                    .map(|(column, row)| row * columns + column);
                match patch.and_then(|patch| reflectivities.get(patch).map(|value| (patch, *value))) {
                    // `validate` made sure that the labels fit.
                    Some((patch, reflectivity)) if target > 0 => {
                        Surface { reflectivity, target: target.saturating_add(patch as u8) }
                    }
                    Some((_, reflectivity)) => Surface { reflectivity, target: 0 },
                    None => Surface { reflectivity: *border, target: 0 },
                }
            }
            Self::Mosaic { cell_m, reflectivities: [low, high], seed } => {
                let tile = [x, y].map(|coordinate| (coordinate / cell_m).floor() as i32);
                of(low + (high - low) * tile_share(*seed, tile))
            }
            Self::Bitmap { cell_m, rows, reflectivities } => {
                let columns = rows.first().map_or(0, String::len);
                let figure = cell(x, columns, *cell_m, *cell_m)
                    .zip(cell(y, rows.len(), *cell_m, *cell_m))
                    .and_then(|(column, row)| rows.get(row)?.as_bytes().get(column))
                    .is_some_and(|&character| character == b'#');
                of(reflectivities[usize::from(figure)])
            }
        }
    }

    pub(crate) fn validate(&self, path: &str, target: u8) -> Result<(), InvalidValue> {
        let length = |name: &str, value: f64| {
            ensure((1e-6..=1e6).contains(&value), || format!("{path}.{name}"), value, "1e-6 to 1e6 m")
        };
        let reflectivity = |name: &str, values: &[f64]| {
            let right = values.iter().all(|value| (0.0..=1.0).contains(value));
            let field = || format!("{path}.{name}");
            match values {
                [value] => ensure(right, field, value, "a reflectivity from 0 to 1"),
                _ => ensure(right, field, values, "reflectivities from 0 to 1"),
            }
        };
        match self {
            Self::Uniform(value) => reflectivity("uniform", &[*value]),
            Self::Checkerboard { cell_m, reflectivities } => {
                length("checkerboard.cell_m", *cell_m)?;
                reflectivity("checkerboard.reflectivities", reflectivities)
            }
            Self::Stripes { period_m, reflectivities } => {
                length("stripes.period_m", *period_m)?;
                reflectivity("stripes.reflectivities", reflectivities)
            }
            Self::Patches { columns, pitch_m, side_m, reflectivities, border } => {
                length("patches.pitch_m", *pitch_m)?;
                length("patches.side_m", *side_m)?;
                reflectivity("patches.reflectivities", reflectivities)?;
                reflectivity("patches.border", &[*border])?;
                let field = |name: &str| format!("{path}.patches.{name}");
                ensure(side_m <= pitch_m, || field("side_m"), side_m, "at most pitch_m")?;
                ensure((1..=255).contains(columns), || field("columns"), columns, "1 to 255")?;
                let room = if target == 0 { 1024 } else { 256 - usize::from(target) };
                let expected = format!("1 to {room} patches with first label {target}");
                let count = reflectivities.len();
                ensure((1..=room).contains(&count), || field("reflectivities"), count, &expected)
            }
            Self::Mosaic { cell_m, reflectivities, .. } => {
                length("mosaic.cell_m", *cell_m)?;
                reflectivity("mosaic.reflectivities", reflectivities)?;
                let field = || format!("{path}.mosaic.reflectivities");
                ensure(reflectivities[0] <= reflectivities[1], field, reflectivities, "the lower one first")
            }
            Self::Bitmap { cell_m, rows, reflectivities } => {
                length("bitmap.cell_m", *cell_m)?;
                reflectivity("bitmap.reflectivities", reflectivities)?;
                let width = rows.first().map_or(0, String::len);
                let right = width > 0 && rows.iter().all(|row| row.is_ascii() && row.len() == width);
                let field = || format!("{path}.bitmap.rows");
                ensure(right, field, rows, "at least one row, all of one length, of ASCII characters")
            }
        }
    }
}

/// A number from 0 to 1, below 1, that looks random: the mixer of MurmurHash3 (Appleby 2011) over seed and tile.
fn tile_share(seed: u32, [column, row]: [i32; 2]) -> f64 {
    let mixed = [column as u32, row as u32].iter().fold(seed, |bits, &part| {
        let mut bits = (bits ^ part).wrapping_add(0x9e37_79b9);
        bits = (bits ^ (bits >> 16)).wrapping_mul(0x85eb_ca6b);
        bits = (bits ^ (bits >> 13)).wrapping_mul(0xc2b2_ae35);
        bits ^ (bits >> 16)
    });
    f64::from(mixed) / 4_294_967_296.0
}

/// Which of `count` cells, centred about 0, the coordinate lies in; `None` outside or between them.
fn cell(coordinate_m: f64, count: usize, pitch_m: f64, side_m: f64) -> Option<usize> {
    let position = coordinate_m / pitch_m + 0.5 * count as f64;
    let index = position.floor();
    let inside = (position - index - 0.5).abs() * pitch_m <= 0.5 * side_m;
    (inside && index >= 0.0 && index < count as f64).then_some(index as usize)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn patches_carry_their_reflectivity_and_their_label() {
        let texture = Texture::Patches {
            columns: 2,
            pitch_m: 0.2,
            side_m: 0.1,
            reflectivities: vec![0.1, 0.2, 0.3],
            border: 0.5,
        };
        assert_eq!(texture.validate("t", 7), Ok(()));
        assert_eq!(texture.at([-0.1, -0.1], 7), Surface { reflectivity: 0.1, target: 7 });
        assert_eq!(texture.at([0.1, -0.1], 7), Surface { reflectivity: 0.2, target: 8 });
        assert_eq!(texture.at([-0.1, 0.1], 7), Surface { reflectivity: 0.3, target: 9 });
        for border in [[0.1, 0.1], [0.0, -0.1], [0.5, 0.0]] {
            assert_eq!(texture.at(border, 7), Surface { reflectivity: 0.5, target: 0 });
        }
        assert!(texture.validate("t", 254).unwrap_err().to_string().contains("1 to 2 patches"));
    }

    #[test]
    fn boards_stripes_and_letters_are_where_they_belong() {
        let board = Texture::Checkerboard { cell_m: 0.1, reflectivities: [0.1, 0.9] };
        let at = |x, y| board.at([x, y], 0).reflectivity;
        assert_eq!([at(0.05, 0.05), at(-0.05, 0.05), at(-0.05, -0.05)], [0.1, 0.9, 0.1]);
        let stripes = Texture::Stripes { period_m: 0.2, reflectivities: [0.1, 0.9] };
        assert_eq!(stripes.at([0.05, 3.0], 0).reflectivity, 0.1);
        assert_eq!(stripes.at([-0.05, 3.0], 0).reflectivity, 0.9);
        let mosaic = Texture::Mosaic { cell_m: 0.1, reflectivities: [0.2, 0.8], seed: 3 };
        let tiles = (0..900).map(|i| mosaic.at([0.1 * f64::from(i % 30) - 1.45, 0.1 * f64::from(i / 30)], 0));
        let tiles: Vec<f64> = tiles.map(|surface| surface.reflectivity).collect();
        assert!(tiles.iter().all(|tile| (0.2..0.8).contains(tile)));
        // Uniform: the mean of 900 has a standard error of 0.6/√(12·900) = 0.006.
        assert!((tiles.iter().sum::<f64>() / 900.0 - 0.5).abs() < 0.03);
        let rows = vec!["#.".to_owned(), "..".to_owned()];
        let letters = Texture::Bitmap { cell_m: 0.1, rows, reflectivities: [0.2, 0.8] };
        assert_eq!(letters.at([-0.05, -0.05], 0).reflectivity, 0.8);
        assert_eq!(letters.at([0.05, -0.05], 0).reflectivity, 0.2);
        assert_eq!(letters.at([-0.35, -0.05], 0).reflectivity, 0.2);
    }
}
