//! Numbers that options take.

/// A positive finite number.
pub(crate) fn positive(text: &str) -> Result<f64, String> {
    let value: f64 = text.parse().map_err(|_| format!("{text} is no number"))?;
    if value > 0.0 && value.is_finite() { Ok(value) } else { Err("a positive number expected".to_owned()) }
}

/// A finite number that is 0 or more.
pub(crate) fn not_negative(text: &str) -> Result<f64, String> {
    let value: f64 = text.parse().map_err(|_| format!("{text} is no number"))?;
    if value >= 0.0 && value.is_finite() {
        Ok(value)
    } else {
        Err("a number of 0 or more expected".to_owned())
    }
}
