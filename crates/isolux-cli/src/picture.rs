//! Grey PNG pictures of planes.

use std::path::Path;

use isolux::{Plane, Shape};

use crate::failure::{Failure, Outcome};

/// Pixels between the pictures of a montage.
const GAP: usize = 4;
/// Grey between the pictures.
const GAP_GREY: u8 = 255;

/// Writes pictures in a grid: one row of the grid per inner list, all of one shape, black at 0 and white at the
/// row's `white`. Invalid pixels are black. The file is written whole or not at all.
pub(crate) fn write_montage(path: &Path, rows: &[(Vec<Plane<f32>>, f32)]) -> Outcome {
    let Some(shape) = rows.first().and_then(|(planes, _)| planes.first()).map(Plane::shape) else {
        return Err(Failure::data(format!("`{}`: no picture to write", path.display())));
    };
    let columns = rows.iter().map(|(planes, _)| planes.len()).max().unwrap_or(0);
    let canvas = Shape::new(rows.len() * (shape.height + GAP) - GAP, columns * (shape.width + GAP) - GAP);
    let mut pixels = Plane::filled(canvas, GAP_GREY);
    for (row, (planes, white)) in rows.iter().enumerate() {
        for (column, plane) in planes.iter().enumerate() {
            let (top, left) = (row * (shape.height + GAP), column * (shape.width + GAP));
            paste(plane, *white, &mut pixels, top, left);
        }
    }
    let failed =
        |error: &dyn std::fmt::Display| Failure::data(format!("cannot write `{}`: {error}", path.display()));
    let bytes = encode(&pixels).map_err(|error| failed(&error))?;
    isolux_io::write_whole(path, &bytes).map_err(|error| failed(&error))
}

fn paste(plane: &Plane<f32>, white: f32, canvas: &mut Plane<u8>, top: usize, left: usize) {
    let (width, canvas_width) = (plane.shape().width, canvas.shape().width);
    for (row, values) in plane.values().chunks(width).enumerate() {
        let start = (top + row) * canvas_width + left;
        let target = &mut canvas.values_mut()[start..start + width];
        for (grey, value) in target.iter_mut().zip(values) {
            // A float that is NaN becomes 0: black.
            *grey = (255.0 * (value / white).clamp(0.0, 1.0)).round() as u8;
        }
    }
}

fn encode(pixels: &Plane<u8>) -> Result<Vec<u8>, Box<dyn std::error::Error>> {
    let Shape { height, width } = pixels.shape();
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, u32::try_from(width)?, u32::try_from(height)?);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.set_depth(png::BitDepth::Eight);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(pixels.values())?;
    writer.finish()?;
    Ok(bytes)
}

/// The value below which `fraction` of the valid pixels of all planes lie; 1 where there are none.
pub(crate) fn white_level(planes: &[Plane<f32>], fraction: f64) -> f32 {
    let valid = planes.iter().flat_map(|plane| plane.values()).filter(|value| value.is_finite());
    let mut values: Vec<f64> = valid.map(|&value| f64::from(value)).collect();
    isolux::statistics::quantile(&mut values, fraction).filter(|level| *level > 0.0).unwrap_or(1.0) as f32
}
