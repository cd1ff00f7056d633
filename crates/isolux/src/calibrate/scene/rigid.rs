//! Rigid motion: where the camera is.

use nalgebra::{Matrix3, Matrix4, Vector3, Vector6};

/// A turn and a shift: `p ↦ R p + t`, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Rigid {
    pub(super) rotation: Matrix3<f64>,
    pub(super) translation: Vector3<f64>,
}

/// Entries of a rotation may differ from orthonormal ones by this: poses of three decimals are good enough to use.
const ORTHONORMAL: f64 = 2e-3;

impl Rigid {
    pub(super) fn identity() -> Self {
        Self { rotation: Matrix3::identity(), translation: Vector3::zeros() }
    }

    /// The transform of a recording; `None` when it is not rigid.
    pub(super) fn from_rows(rows: &[[f64; 4]; 4]) -> Option<Self> {
        let matrix = Matrix4::from_fn(|row, column| rows[row][column]);
        let rotation: Matrix3<f64> = matrix.fixed_view::<3, 3>(0, 0).into_owned();
        let translation: Vector3<f64> = matrix.fixed_view::<3, 1>(0, 3).into_owned();
        let product = rotation.transpose() * rotation - Matrix3::identity();
        let rigid = product.amax() <= ORTHONORMAL
            && rotation.determinant() > 0.0
            && translation.iter().all(|value| value.is_finite())
            && (0..4).all(|column| rows[3][column] == if column == 3 { 1.0 } else { 0.0 });
        rigid.then_some(Self { rotation, translation })
    }

    pub(super) fn point(&self, point: &Vector3<f64>) -> Vector3<f64> {
        self.rotation * point + self.translation
    }

    pub(super) fn inverse(&self) -> Self {
        let rotation = self.rotation.transpose();
        Self { rotation, translation: -(rotation * self.translation) }
    }

    /// `self` after `first`.
    pub(super) fn after(&self, first: &Self) -> Self {
        Self { rotation: self.rotation * first.rotation, translation: self.point(&first.translation) }
    }

    /// The motion of a small turn (first three, rad) and shift (m); the turn by Rodrigues' formula.
    pub(super) fn small(step: &Vector6<f64>) -> Self {
        let turn = Vector3::new(step[0], step[1], step[2]);
        let angle = turn.norm();
        let cross = turn.cross_matrix();
        let (first, second) = if angle < 1e-6 {
            (1.0, 0.5)
        } else {
            (angle.sin() / angle, (1.0 - angle.cos()) / (angle * angle))
        };
        let rotation = Matrix3::identity() + cross * first + cross * cross * second;
        Self { rotation, translation: Vector3::new(step[3], step[4], step[5]) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turns_are_rotations_and_inverses_undo() {
        let step = Vector6::new(0.3, -0.2, 0.5, 0.1, 0.2, -0.4);
        let motion = Rigid::small(&step);
        assert!((motion.rotation.transpose() * motion.rotation - Matrix3::identity()).amax() < 1e-15);
        let point = Vector3::new(1.0, 2.0, 3.0);
        assert!((motion.inverse().point(&motion.point(&point)) - point).amax() < 1e-14);
        let twice = motion.after(&motion);
        assert!((twice.point(&point) - motion.point(&motion.point(&point))).amax() < 1e-14);
        // About z, by the right hand: x turns to y.
        let quarter = Rigid::small(&Vector6::new(0.0, 0.0, std::f64::consts::FRAC_PI_2, 0.0, 0.0, 0.0));
        assert!((quarter.point(&Vector3::x()) - Vector3::y()).amax() < 1e-15);
    }

    #[test]
    fn what_is_not_rigid_is_no_pose() {
        let mut rows =
            [[1.0, 0.0, 0.0, 0.5], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]];
        assert_eq!(Rigid::from_rows(&rows).map(|pose| pose.translation[0]), Some(0.5));
        rows[0][0] = -1.0;
        assert_eq!(Rigid::from_rows(&rows), None);
        rows[0][0] = f64::NAN;
        assert_eq!(Rigid::from_rows(&rows), None);
        rows[0][0] = 1.1;
        assert_eq!(Rigid::from_rows(&rows), None);
    }
}
