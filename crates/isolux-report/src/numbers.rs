//! Numbers as people write them.

/// With a power of ten: `1.50×10⁷`.
pub(crate) fn scientific(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$e}");
    match text.split_once('e').map(|(mantissa, power)| (mantissa, power.parse())) {
        Some((mantissa, Ok(power))) => format!("{mantissa}×10{}", superscript(power)),
        _ => text,
    }
}

/// An exponent in raised digits.
pub(crate) fn superscript(power: i32) -> String {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let digit = |character: char| character.to_digit(10).map_or('⁻', |digit| DIGITS[digit as usize]);
    power.to_string().chars().map(digit).collect()
}
