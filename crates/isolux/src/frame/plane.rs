//! A row-major image plane: height × width values of one kind.

use crate::memory;

use std::fmt;

/// Height and width of an image, in pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Shape {
    /// Number of rows.
    pub height: usize,
    /// Number of columns.
    pub width: usize,
}

impl Shape {
    /// A shape of `height` rows and `width` columns.
    #[must_use]
    pub const fn new(height: usize, width: usize) -> Self {
        Self { height, width }
    }

    /// Number of pixels.
    #[must_use]
    pub const fn pixels(self) -> usize {
        self.height * self.width
    }

    /// Row and column of the pixel at `index`, row by row. The image must not be empty.
    #[must_use]
    pub const fn place(self, index: usize) -> (usize, usize) {
        (index / self.width, index % self.width)
    }
}

impl fmt::Display for Shape {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}×{} (height×width)", self.height, self.width)
    }
}

/// Data of a wrong length or shape.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ShapeError {
    /// A buffer does not hold height × width values.
    #[error("{found} values found, {} expected for an image of {shape}", shape.pixels())]
    Length {
        /// Values in the buffer.
        found: usize,
        /// Shape that was asked for.
        shape: Shape,
    },
    /// Two planes that belong together differ in shape.
    #[error("`{plane}` is {found}, {expected} expected, the shape of the frame's amplitude")]
    Mismatch {
        /// Name of the plane that does not fit.
        plane: &'static str,
        /// Its shape.
        found: Shape,
        /// Shape of the frame.
        expected: Shape,
    },
}

/// A row-major image of `T`.
#[derive(Clone, Debug, PartialEq)]
pub struct Plane<T> {
    shape: Shape,
    values: Vec<T>,
}

impl<T: Copy> Plane<T> {
    /// A plane with every pixel set to `value`.
    #[must_use]
    pub fn filled(shape: Shape, value: T) -> Self {
        Self { shape, values: vec![value; shape.pixels()] }
    }

    /// A plane over `values`, row by row.
    ///
    /// # Errors
    /// [`ShapeError::Length`] when `values` does not hold one value per pixel.
    pub fn from_vec(shape: Shape, values: Vec<T>) -> Result<Self, ShapeError> {
        if values.len() != shape.pixels() {
            return Err(ShapeError::Length { found: values.len(), shape });
        }
        Ok(Self { shape, values })
    }

    /// A plane whose value at (row, column) is `value(row, column)`.
    #[must_use]
    pub fn from_fn(shape: Shape, mut value: impl FnMut(usize, usize) -> T) -> Self {
        let mut values = Vec::with_capacity(shape.pixels());
        for row in 0..shape.height {
            values.extend((0..shape.width).map(|column| value(row, column)));
        }
        Self { shape, values }
    }

    /// Bytes that its values take.
    #[must_use]
    pub fn bytes(&self) -> usize {
        memory::bytes(&self.values)
    }

    /// Height and width.
    #[must_use]
    pub fn shape(&self) -> Shape {
        self.shape
    }

    /// All values, row by row.
    #[must_use]
    pub fn values(&self) -> &[T] {
        &self.values
    }

    /// All values, row by row, to be written.
    #[must_use]
    pub fn values_mut(&mut self) -> &mut [T] {
        &mut self.values
    }

    /// The value at (row, column), or `None` outside the image.
    #[must_use]
    pub fn get(&self, row: usize, column: usize) -> Option<T> {
        let inside = row < self.shape.height && column < self.shape.width;
        inside.then(|| self.values[row * self.shape.width + column])
    }

    /// Sets every pixel to `value`.
    pub fn fill(&mut self, value: T) {
        self.values.fill(value);
    }

    /// Gives the plane the wanted shape, filled with `value`. When the shape is unchanged, memory and values are
    /// kept.
    pub fn reshape(&mut self, shape: Shape, value: T) {
        if self.shape != shape {
            self.shape = shape;
            self.values.clear();
            self.values.resize(shape.pixels(), value);
        }
    }

    /// Refuses a plane of another shape than `expected`, naming it `plane`.
    ///
    /// # Errors
    /// [`ShapeError::Mismatch`] when the shapes differ.
    pub fn expect_shape(&self, plane: &'static str, expected: Shape) -> Result<(), ShapeError> {
        if self.shape == expected {
            Ok(())
        } else {
            Err(ShapeError::Mismatch { plane, found: self.shape, expected })
        }
    }
}

/// The square measurement window of the paper, clipped to the image: rows and columns, end excluded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Window {
    /// First row.
    pub top: usize,
    /// First column.
    pub left: usize,
    /// Number of rows.
    pub height: usize,
    /// Number of columns.
    pub width: usize,
}

impl Window {
    /// The window of `side`×`side` pixels at the centre of the image; the whole image where that is smaller.
    #[must_use]
    pub fn centred(shape: Shape, side: usize) -> Self {
        let (height, width) = (side.min(shape.height), side.min(shape.width));
        Self { top: (shape.height - height) / 2, left: (shape.width - width) / 2, height, width }
    }

    /// The whole image.
    #[must_use]
    pub fn whole(shape: Shape) -> Self {
        Self { top: 0, left: 0, height: shape.height, width: shape.width }
    }

    /// Indices into a row-major plane of `shape`, row by row. The window must lie inside the image.
    pub fn indices(self, shape: Shape) -> impl Iterator<Item = usize> {
        (self.top..self.top + self.height).flat_map(move |row| {
            (self.left..self.left + self.width).map(move |column| row * shape.width + column)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wrong_length_is_refused_with_both_numbers() {
        let error = Plane::from_vec(Shape::new(2, 3), vec![0u8; 5]).unwrap_err();
        assert_eq!(error.to_string(), "5 values found, 6 expected for an image of 2×3 (height×width)");
    }

    #[test]
    fn window_is_centred_and_clipped_to_small_images() {
        let shape = Shape::new(144, 176);
        assert_eq!(Window::centred(shape, 20), Window { top: 62, left: 78, height: 20, width: 20 });
        let small = Shape::new(3, 3);
        assert_eq!(Window::centred(small, 20).indices(small).collect::<Vec<_>>(), (0..9).collect::<Vec<_>>());
    }

    #[test]
    fn pixels_outside_the_image_are_none() {
        let plane = Plane::from_fn(Shape::new(2, 2), |row, column| row * 10 + column);
        assert_eq!(plane.get(1, 1), Some(11));
        assert_eq!(plane.get(2, 0), None);
        assert_eq!(plane.get(0, 2), None);
    }
}
