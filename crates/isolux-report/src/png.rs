//! Planes as PNG pictures: one alone, or several in a grid.

use ::png::{BitDepth, ColorType, Compression, Encoder};
use isolux::{Plane, Shape};

use crate::colours;
use crate::error::ReportError;
use crate::page::{Colours, Picture};

/// Palette index of pixels without a value; all below are levels of the colour table.
const MISSING: u8 = 255;
/// Highest level of the colour table: 255 levels, so that one index is left for [`MISSING`].
const TOP: f32 = 254.0;
/// Pixels between the pictures of a montage.
const GAP: usize = 4;
/// Grey between the pictures of a montage, RGB.
const GAP_COLOUR: colours::Rgb = [255; 3];
/// Palette index of the gap of a montage: the montage has 254 levels.
const GAP_INDEX: u8 = 254;

/// A row of a montage: its pictures, and the values of black and of white in all of them.
pub type MontageRow = (Vec<Plane<f32>>, (f32, f32));

/// The picture as PNG, one pixel per value: 255 levels of its colours over its range, values beyond the range in
/// the colour of its end, NaN in a colour that the table does not hold (red on grey, grey on viridis).
///
/// # Errors
/// [`ReportError::PictureShape`] when the picture has no pixels; [`ReportError::Png`] when it cannot be encoded.
pub fn encode(picture: &Picture) -> Result<Vec<u8>, ReportError> {
    let shape = picture.values.shape();
    if shape.pixels() == 0 {
        return Err(ReportError::PictureShape { id: picture.id.clone(), shape });
    }
    let (low, high) = usable_range(picture);
    let indices: Vec<u8> =
        picture.values.values().iter().map(|&value| level(value, low, high, TOP)).collect();
    write(shape, &indices, &palette(picture.colours, MISSING))
}

/// Pictures in a grid as PNG, one row of the grid per inner list; all pictures of one shape. A row's pair is the
/// value of black and of white. Pixels without a value are red, the gaps white.
///
/// # Errors
/// [`ReportError::Montage`] when there is no picture, one without pixels, or one of another shape.
pub fn montage(rows: &[MontageRow]) -> Result<Vec<u8>, ReportError> {
    let shape = common_shape(rows)?;
    let columns = rows.iter().map(|(planes, _)| planes.len()).max().unwrap_or(0);
    let canvas = Shape::new(rows.len() * (shape.height + GAP) - GAP, columns * (shape.width + GAP) - GAP);
    let mut indices = vec![GAP_INDEX; canvas.pixels()];
    for (row, (planes, (low, high))) in rows.iter().enumerate() {
        for (column, plane) in planes.iter().enumerate() {
            let corner = row * (shape.height + GAP) * canvas.width + column * (shape.width + GAP);
            for (line, values) in plane.values().chunks_exact(shape.width).enumerate() {
                let start = corner + line * canvas.width;
                let target = &mut indices[start..start + shape.width];
                for (index, &value) in target.iter_mut().zip(values) {
                    *index = level(value, *low, *high, f32::from(GAP_INDEX - 1));
                }
            }
        }
    }
    write(canvas, &indices, &palette(Colours::Grey, GAP_INDEX))
}

/// The colours of a table from its low end to its high one, 256×1 pixels, as PNG.
pub(crate) fn colour_bar(colours: Colours) -> Result<Vec<u8>, ReportError> {
    let indices: Vec<u8> = (0..MISSING).collect();
    write(Shape::new(1, indices.len()), &indices, &palette(colours, MISSING))
}

/// Ends of the colour bar: those of the picture, or those of its values where they are no numbers.
pub(crate) fn usable_range(picture: &Picture) -> (f32, f32) {
    let (low, high) = picture.range;
    if low.is_finite() && high.is_finite() {
        return (low, high);
    }
    let finite = || picture.values.values().iter().copied().filter(|value| value.is_finite());
    let (least, most) = (finite().fold(f32::INFINITY, f32::min), finite().fold(f32::NEG_INFINITY, f32::max));
    match least <= most {
        true => (if low.is_finite() { low } else { least }, if high.is_finite() { high } else { most }),
        false => (0.0, 1.0),
    }
}

/// Level 0 to `top` of a value, or [`MISSING`]. A range without width puts its own value into the middle.
fn level(value: f32, low: f32, high: f32, top: f32) -> u8 {
    if value.is_nan() {
        return MISSING;
    }
    // In f64, the difference of two f32 is finite.
    let (value, low, high) = (f64::from(value), f64::from(low), f64::from(high));
    let part = (value - low) / (high - low);
    let part = if part.is_nan() { 0.5 } else { part.clamp(0.0, 1.0) };
    (part * f64::from(top)).round() as u8
}

/// 256 colours: `levels` of the table, then the gap where there is one, then the colour of missing values.
fn palette(colours: Colours, levels: u8) -> Vec<u8> {
    let table = colours::table(colours);
    let top = usize::from(levels - 1);
    let mut palette: Vec<colours::Rgb> =
        (0..=top).map(|level| table[(level * 255 + top / 2) / top]).collect();
    palette.resize(usize::from(MISSING), GAP_COLOUR);
    palette.push(colours::missing(colours));
    palette.concat()
}

fn common_shape(rows: &[MontageRow]) -> Result<Shape, ReportError> {
    let mut planes = rows.iter().flat_map(|(planes, _)| planes);
    let refuse = |found: String| Err(ReportError::Montage { found });
    let Some(first) = planes.next().map(Plane::shape) else {
        return refuse("no picture".to_owned());
    };
    if first.pixels() == 0 {
        return refuse(format!("one of {first}"));
    }
    match planes.find(|plane| plane.shape() != first) {
        Some(other) => refuse(format!("one of {first} and one of {}", other.shape())),
        None => Ok(first),
    }
}

fn write(shape: Shape, indices: &[u8], palette: &[u8]) -> Result<Vec<u8>, ReportError> {
    // Beyond 32 bits, zero: refused by the encoder.
    let side = |length: usize| u32::try_from(length).unwrap_or(0);
    let mut bytes = Vec::new();
    let mut encoder = Encoder::new(&mut bytes, side(shape.width), side(shape.height));
    encoder.set_color(ColorType::Indexed);
    encoder.set_depth(BitDepth::Eight);
    encoder.set_palette(palette);
    encoder.set_compression(Compression::High);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(indices)?;
    writer.finish()?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn decode(bytes: &[u8]) -> (u32, u32, Vec<[u8; 3]>) {
        let mut decoder = ::png::Decoder::new(std::io::Cursor::new(bytes));
        decoder.set_transformations(::png::Transformations::EXPAND);
        let mut reader = decoder.read_info().unwrap();
        let mut buffer = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut buffer).unwrap();
        assert_eq!(info.color_type, ColorType::Rgb);
        let pixels =
            buffer[..info.buffer_size()].chunks_exact(3).map(|rgb| [rgb[0], rgb[1], rgb[2]]).collect();
        (info.width, info.height, pixels)
    }

    fn picture(values: Vec<f32>, range: (f32, f32), colours: Colours) -> Picture {
        let shape = Shape::new(1, values.len());
        Picture {
            id: "x".to_owned(),
            caption: String::new(),
            alt: String::new(),
            values: Plane::from_vec(shape, values).unwrap(),
            range,
            label: String::new(),
            colours,
        }
    }

    #[test]
    fn ends_beyond_and_nan_have_their_colours() {
        let values = vec![-1.0, 0.0, 100.0, f32::INFINITY, f32::NEG_INFINITY, f32::NAN];
        let (width, height, pixels) = decode(&encode(&picture(values, (0.0, 100.0), Colours::Grey)).unwrap());
        assert_eq!((width, height), (6, 1));
        let (black, white) = ([0; 3], [255; 3]);
        assert_eq!(pixels, [black, black, white, white, black, colours::missing(Colours::Grey)]);
        let (_, _, pixels) = decode(&encode(&picture(vec![0.0, 1.0], (0.0, 1.0), Colours::Viridis)).unwrap());
        assert_eq!(pixels, [[0x44, 0x01, 0x54], [0xfd, 0xe7, 0x25]]);
    }

    #[test]
    fn ranges_that_are_none_still_give_a_picture() {
        for range in
            [(1.0, 1.0), (f32::NAN, f32::NAN), (f32::MIN, f32::MAX), (2.0, -2.0), (0.0, f32::INFINITY)]
        {
            for values in [vec![f32::NAN; 4], vec![1.0; 4], vec![f32::MAX, f32::MIN, 1e-45, 0.0]] {
                encode(&picture(values, range, Colours::Grey)).unwrap();
            }
        }
        assert!(encode(&picture(vec![], (0.0, 1.0), Colours::Grey)).is_err());
    }

    #[test]
    fn a_montage_has_a_scale_per_row() {
        let plane = |value| Plane::filled(Shape::new(2, 3), value);
        let rows = [(vec![plane(5.0), plane(10.0)], (0.0, 10.0)), (vec![plane(5.0)], (0.0, 5.0))];
        let (width, height, pixels) = decode(&montage(&rows).unwrap());
        assert_eq!((width, height), (2 * 3 + 4, 2 * 2 + 4));
        let at = |row: usize, column: usize| pixels[row * 10 + column][0];
        assert!(at(0, 0).abs_diff(128) <= 1, "{}", at(0, 0));
        assert_eq!((at(0, 9), at(7, 0), at(3, 0), at(7, 9)), (255, 255, 255, 255));
    }

    #[test]
    fn a_montage_of_nothing_or_of_unlike_shapes_is_refused() {
        let error = montage(&[]).unwrap_err();
        assert_eq!(
            error.to_string(),
            "a montage needs pictures of one shape with at least one pixel; found no picture"
        );
        let unlike = vec![Plane::filled(Shape::new(1, 2), 0.0), Plane::filled(Shape::new(2, 1), 0.0)];
        assert!(matches!(montage(&[(unlike, (0.0, 1.0))]), Err(ReportError::Montage { .. })));
        assert!(montage(&[(vec![Plane::filled(Shape::new(0, 2), 0.0)], (0.0, 1.0))]).is_err());
    }
}
