//! Intrinsics of another resolution.

use super::suspicion::Suspicion;
use crate::frame::Shape;

/// A principal point is nearer to the middle of the image than this share of its width or height.
const OFF_CENTRE_SHARE: f64 = 0.2;

/// The principal point, column and row in pixels, belongs to the middle of the image.
pub(super) fn suspicion(principal_point: Option<[f64; 2]>, shape: Shape) -> Option<Suspicion> {
    let [cx, cy] = principal_point?;
    let away = |at: f64, length: usize| (at + 0.5 - 0.5 * length as f64).abs() / length.max(1) as f64;
    let off = away(cx, shape.width) > OFF_CENTRE_SHARE || away(cy, shape.height) > OFF_CENTRE_SHARE;
    off.then_some(Suspicion::PrincipalPoint { cx, cy, height: shape.height, width: shape.width })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_principal_point_of_twice_or_half_the_size_is_told() {
        let shape = Shape::new(240, 320);
        let found = |cx, cy| suspicion(Some([cx, cy]), shape).is_some();
        assert!(found(320.0, 240.0) && found(79.5, 59.5));
        assert!(!found(159.5, 119.5) && !found(170.0, 140.0));
        assert_eq!(suspicion(None, shape), None);
    }
}
