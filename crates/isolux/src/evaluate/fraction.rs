//! A share of a whole.

/// `part / whole`, 0..=1; 0 of nothing.
pub(super) fn fraction(part: u64, whole: u64) -> f64 {
    if whole > 0 { part as f64 / whole as f64 } else { 0.0 }
}
