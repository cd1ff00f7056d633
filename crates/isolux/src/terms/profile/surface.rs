//! The basis functions of the logarithm of the illumination profile.

use nalgebra::DMatrix;

use super::Places;
use crate::numerics::bspline::Basis;

/// B-splines along a row and along a column (methods, section 4).
pub(crate) const TENSOR: [usize; 2] = [8, 6];
/// `r²` and `r⁴`.
pub(crate) const RADIAL: usize = 2;

/// `ln v = c₁ r² + c₂ r⁴ + Σ c_kl B_k(x) B_l(y)`: the radial fall-off of lobe and lens, and the deviation from it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Surface {
    bases: [Basis; 2],
}

/// The functions at one place that are not 0 there: r², r⁴, then blocks of four neighbouring columns of the tensor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SurfaceRow {
    pub(crate) radial: [f64; RADIAL],
    /// First coefficient of each block of four, and its values.
    pub(crate) blocks: [(usize, [f64; 4]); 4],
}

impl Surface {
    /// Number of coefficients of the tensor.
    pub(crate) const TENSOR_LEN: usize = TENSOR[0] * TENSOR[1];

    pub(crate) fn new(places: &Places) -> Self {
        let [[x0, x1], [y0, y1]] = places.extent();
        let [along, down] = TENSOR.map(|count| count - 3);
        Self { bases: [Basis::new(x0, x1, along), Basis::new(y0, y1, down)] }
    }

    pub(crate) fn row(&self, [x, y]: [f64; 2]) -> SurfaceRow {
        let squared = x * x + y * y;
        let ((first_x, along), (first_y, down)) = (self.bases[0].at(x), self.bases[1].at(y));
        let block = |k: usize| {
            let start = (first_y + k) * TENSOR[0] + first_x;
            (start, along.map(|value| value * down[k]))
        };
        SurfaceRow { radial: [squared, squared * squared], blocks: [block(0), block(1), block(2), block(3)] }
    }

    /// ln v, but for a constant.
    pub(crate) fn sum(&self, radial: &[f64; RADIAL], tensor: &[f64], place: [f64; 2]) -> f64 {
        let row = self.row(place);
        let round: f64 = row.radial.iter().zip(radial).map(|(value, c)| value * c).sum();
        let block = |(start, values): (usize, [f64; 4])| {
            let used = tensor.get(start..start + 4).unwrap_or(&[f64::NAN; 4]);
            used.iter().zip(values).map(|(c, value)| c * value).sum::<f64>()
        };
        round + row.blocks.into_iter().map(block).sum::<f64>()
    }

    /// The matrix P of `cᵀ P c = ∫∫ s_xx² + 2 s_xy² + s_yy²` of the tensor.
    pub(crate) fn curvature(&self) -> DMatrix<f64> {
        let [x, y] = self.bases;
        y.mass().kronecker(&x.curvature())
            + y.steepness().kronecker(&x.steepness()) * 2.0
            + y.curvature().kronecker(&x.mass())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::Shape;
    use nalgebra::DVector;

    #[test]
    fn a_tilted_plane_has_no_curvature_and_a_saddle_has_that_of_its_twist() {
        let surface = Surface::new(&Places::new(Shape::new(30, 40), None));
        let [x, y] = surface.bases.map(Basis::line);
        let ones = |n: usize| DVector::from_element(n, 1.0);
        let of = |c: &DVector<f64>| (c.transpose() * surface.curvature() * c)[(0, 0)];
        let tilted = ones(TENSOR[1]).kronecker(&x) * 3.0 + y.kronecker(&ones(TENSOR[0]));
        let place = [0.3, -0.2];
        assert!((surface.sum(&[0.0; 2], tilted.as_slice(), place) - (3.0 * 0.3 - 0.2)).abs() < 1e-14);
        assert!(of(&tilted).abs() < 1e-9, "{}", of(&tilted));
        // s = x y: s_xy = 1, over an area of 1.6 × 1.2.
        assert!((of(&y.kronecker(&x)) - 2.0 * 1.6 * 1.2).abs() < 1e-9);
        assert!((surface.sum(&[1.0, 2.0], &[0.0; 48], place) - (0.13 + 2.0 * 0.0169)).abs() < 1e-15);
    }
}
