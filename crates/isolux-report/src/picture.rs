//! Images with their colour bars.

use crate::colours;
use crate::error::ReportError;
use crate::markup::{Base64, Escaped, put};
use crate::numbers::scientific;
use crate::page::Picture;
use crate::png;

pub(crate) fn put_pictures(out: &mut String, pictures: &[Picture]) -> Result<(), ReportError> {
    if pictures.is_empty() {
        return Ok(());
    }
    // Rows that come out even: twos for two and four, threes for the rest.
    let row = if matches!(pictures.len(), 1 | 2 | 4) { "twos" } else { "threes" };
    put!(out, "<div class=\"pictures {row}\">\n");
    for picture in pictures {
        put_picture(out, picture)?;
    }
    out.push_str("</div>\n");
    Ok(())
}

fn put_picture(out: &mut String, picture: &Picture) -> Result<(), ReportError> {
    let shape = picture.values.shape();
    put!(
        out,
        "<figure class=\"picture\" id=\"{}\">\n<img src=\"data:image/png;base64,{}\" width=\"{}\" height=\"{}\" \
         alt=\"{}\"/>\n",
        picture.id,
        Base64(&png::encode(picture)?),
        shape.width,
        shape.height,
        Escaped(&picture.alt)
    );
    put_colour_bar(out, picture)?;
    put!(out, "<figcaption>{}</figcaption>\n</figure>\n", Escaped(&picture.caption));
    Ok(())
}

fn put_colour_bar(out: &mut String, picture: &Picture) -> Result<(), ReportError> {
    let (low, high) = png::usable_range(picture);
    let values = picture.values.values();
    let (bottom, top) = (low.min(high), low.max(high));
    let below = values.iter().any(|&value| value < bottom);
    let above = values.iter().any(|&value| value > top);
    let missing = values.iter().filter(|value| value.is_nan()).count();
    let end = |value: f32| {
        let mark = if value == bottom && below {
            "≤ "
        } else if value == top && above {
            "≥ "
        } else {
            ""
        };
        format!("{mark}{}", short(value, (high - low).abs()))
    };
    let middle = (f64::from(low) + f64::from(high)) / 2.0;
    put!(
        out,
        "<div class=\"colour-bar\">\n<img src=\"data:image/png;base64,{}\" width=\"255\" height=\"1\" alt=\"\"/>\n\
         <p class=\"ends\"><span>{}</span><span>{}</span><span>{}</span></p>\n<p class=\"quantity\">{}",
        Base64(&png::colour_bar(picture.colours)?),
        end(low),
        short(middle as f32, (high - low).abs()),
        end(high),
        Escaped(&picture.label)
    );
    if missing > 0 {
        let [red, green, blue] = colours::missing(picture.colours);
        put!(
            out,
            " <span class=\"no-value\"><svg viewBox=\"0 0 10 10\" aria-hidden=\"true\" \
             xmlns=\"http://www.w3.org/2000/svg\"><rect width=\"10\" height=\"10\" \
             fill=\"#{red:02x}{green:02x}{blue:02x}\"/></svg> {}: no value ({} of pixels)</span>",
            colours::missing_name(picture.colours),
            percent(missing, values.len())
        );
    }
    out.push_str("</p>\n</div>\n");
    Ok(())
}

/// Three digits of the span of the colour bar.
fn short(value: f32, span: f32) -> String {
    let span = if span.is_normal() { span } else { value.abs() };
    if value == 0.0 {
        return "0".to_owned();
    }
    if !(1e-3..1e6).contains(&value.abs().max(span)) {
        return scientific(f64::from(value), 2).replace(".00×", "×");
    }
    let decimals = (2.0 - span.log10().floor()).clamp(0.0, 6.0) as usize;
    let text = format!("{value:.decimals$}");
    match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
        false => text,
    }
}

/// A part that is neither none nor all is never written as 0 % or 100 %.
fn percent(part: usize, whole: usize) -> String {
    let percent = 100.0 * part as f64 / whole as f64;
    match percent {
        100.0 => "100 %".to_owned(),
        _ if percent < 0.1 => "< 0.1 %".to_owned(),
        _ => format!("{:.1} %", percent.min(99.9)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ends_of_the_colour_bar_are_short() {
        assert_eq!(short(255.0, 255.0), "255");
        assert_eq!(short(0.5, 1.0), "0.5");
        assert_eq!(short(3.25, 2.5), "3.25");
        assert_eq!(short(1e-9, 1e-9), "1×10⁻⁹");
        assert_eq!(short(-40.0, f32::INFINITY), "-40");
    }

    #[test]
    fn few_missing_pixels_are_not_called_none() {
        assert_eq!(percent(1, 100_000), "< 0.1 %");
        assert_eq!(percent(99_999, 100_000), "99.9 %");
        assert_eq!(percent(4, 4), "100 %");
    }
}
