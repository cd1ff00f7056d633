//! A direction for every pixel.

use super::error::LensError;
use crate::frame::Shape;

/// The directions of an image's pixels, each of unit length; NaN where a pixel sees nothing.
#[derive(Clone, Debug, PartialEq)]
pub struct RayTable {
    shape: Shape,
    /// Row by row.
    unit: Vec<[f64; 3]>,
}

impl RayTable {
    /// A table of (height, width, 3) values, row by row: x to the right, y down, z ahead, of any length. Three NaN say
    /// that a pixel sees nothing.
    ///
    /// # Errors
    /// [`LensError`] for another number of values, a ray that is 0 or not finite, and a table without a ray.
    pub fn new(shape: Shape, values: &[f64]) -> Result<Self, LensError> {
        let expected = 3 * shape.pixels();
        if values.len() != expected {
            return Err(LensError::TableValues { found: values.len(), expected });
        }
        let mut unit = Vec::with_capacity(shape.pixels());
        for (index, values) in values.chunks_exact(3).enumerate() {
            let ray = [values[0], values[1], values[2]];
            let usable = length(ray) > 0.0 && length(ray).is_finite();
            if !usable && !ray.iter().all(|value| value.is_nan()) {
                let (row, column) = shape.place(index);
                return Err(LensError::Ray { row, column, ray });
            }
            unit.push(normalized(ray));
        }
        if unit.iter().all(|ray| ray[0].is_nan()) {
            return Err(LensError::EmptyTable);
        }
        Ok(Self { shape, unit })
    }

    /// `ray` gives the direction of the pixel in a row and column.
    pub(super) fn from_fn(shape: Shape, ray: impl Fn(usize, usize) -> Option<[f64; 3]>) -> Self {
        let unit = |index: usize| {
            let (row, column) = shape.place(index);
            ray(row, column).map_or([f64::NAN; 3], normalized)
        };
        Self { shape, unit: (0..shape.pixels()).map(unit).collect() }
    }

    /// Height and width, pixels.
    #[must_use]
    pub fn shape(&self) -> Shape {
        self.shape
    }

    /// The direction of a pixel, of unit length; `None` outside the table and where the pixel sees nothing.
    #[must_use]
    pub fn get(&self, row: usize, column: usize) -> Option<[f64; 3]> {
        let inside = row < self.shape.height && column < self.shape.width;
        let ray = self.unit.get(row * self.shape.width + column).filter(|_| inside)?;
        (!ray[0].is_nan()).then_some(*ray)
    }

    /// The directions, row by row, of unit length; NaN where a pixel sees nothing.
    #[must_use]
    pub fn unit(&self) -> &[[f64; 3]] {
        &self.unit
    }
}

fn length([x, y, z]: [f64; 3]) -> f64 {
    x.hypot(y).hypot(z)
}

fn normalized(ray: [f64; 3]) -> [f64; 3] {
    let length = length(ray);
    ray.map(|value| value / length)
}
