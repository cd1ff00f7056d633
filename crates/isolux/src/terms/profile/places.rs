//! Image coordinates that the illumination profile is a function of.

use crate::frame::{Lens, Shape};

/// Where pixels lie: x to the right and y down from the principal point, in units of the image's half diagonal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Places {
    /// Height and width of the image.
    pub shape: Shape,
    /// Row and column of the origin: the principal point where it is known, the image's centre otherwise.
    pub origin: [f64; 2],
}

impl Places {
    /// The coordinates of an image of `shape`.
    #[must_use]
    pub fn new(shape: Shape, lens: Option<&Lens>) -> Self {
        let centre = [shape.height, shape.width].map(|pixels| 0.5 * (pixels as f64 - 1.0));
        let usable = lens.filter(|lens| lens.is_usable());
        Self { shape, origin: usable.and_then(Lens::principal_point).unwrap_or(centre) }
    }

    /// Half the diagonal of the image, pixels.
    #[must_use]
    pub fn half_diagonal_px(&self) -> f64 {
        0.5 * (self.shape.height as f64).hypot(self.shape.width as f64)
    }

    /// `[x, y]` of a pixel; fractions of pixels count too.
    #[must_use]
    pub fn at(&self, row: f64, column: f64) -> [f64; 2] {
        let unit = self.half_diagonal_px();
        [(column - self.origin[1]) / unit, (row - self.origin[0]) / unit]
    }

    /// `[least, greatest]` x and y, from the outer edge of the first pixel to that of the last.
    #[must_use]
    pub fn extent(&self) -> [[f64; 2]; 2] {
        let [x0, y0] = self.at(-0.5, -0.5);
        let [x1, y1] = self.at(self.shape.height as f64 - 0.5, self.shape.width as f64 - 0.5);
        [[x0, x1], [y0, y1]]
    }

    /// Cells of the map that says where a profile is supported: along a row, along a column.
    pub const CELLS: [usize; 2] = [16, 12];

    /// Number of the cell that a place lies in, row by row; `None` outside the image.
    #[must_use]
    pub fn cell(&self, place: [f64; 2]) -> Option<usize> {
        let along = |axis: usize| {
            let [start, end] = self.extent()[axis];
            let position = (place[axis] - start) / (end - start);
            let count = Self::CELLS[axis];
            (0.0..=1.0).contains(&position).then(|| ((position * count as f64) as usize).min(count - 1))
        };
        Some(along(1)? * Self::CELLS[0] + along(0)?)
    }

    /// The place in the middle of a cell.
    #[must_use]
    pub fn cell_centre(&self, cell: usize) -> [f64; 2] {
        let middle = |axis: usize, number: usize| {
            let [start, end] = self.extent()[axis];
            start + (end - start) * (number as f64 + 0.5) / Self::CELLS[axis] as f64
        };
        [middle(0, cell % Self::CELLS[0]), middle(1, cell / Self::CELLS[0])]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::Intrinsics;

    #[test]
    fn corners_are_one_away_and_cells_hold_their_centres() {
        let places = Places::new(Shape::new(30, 40), None);
        let [x, y] = places.at(-0.5, -0.5);
        assert!((x.hypot(y) - 1.0).abs() < 1e-15 && (x + 0.8).abs() < 1e-15);
        for cell in 0..Places::CELLS[0] * Places::CELLS[1] {
            assert_eq!(places.cell(places.cell_centre(cell)), Some(cell));
        }
        assert_eq!(places.cell([0.81, 0.0]), None);
        let lens = Lens::from(Intrinsics { fx: 30.0, fy: 30.0, cx: 18.0, cy: 15.0 });
        assert_eq!(Places::new(Shape::new(30, 40), Some(&lens)).at(15.0, 43.0), [1.0, 0.0]);
    }
}
