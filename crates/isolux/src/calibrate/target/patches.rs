//! Small windows inside the labels of a target.

use crate::frame::Plane;

/// Side of a window, pixels.
pub(super) const PATCH_PX: usize = 5;

/// Finds windows; working memory.
#[derive(Clone, Debug, Default)]
pub(super) struct Patches {
    /// Side of the largest square of one label above 0 whose last pixel is here.
    squares: Vec<u16>,
    taken: Vec<bool>,
    found: Vec<(usize, usize)>,
}

impl Patches {
    /// First pixels (row, column) of windows that lie in one label above 0 and do not overlap; taken
    /// row by row, the first that fits.
    pub(super) fn find(&mut self, target: &Plane<u8>) -> &[(usize, usize)] {
        let shape = target.shape();
        let (labels, width) = (target.values(), shape.width);
        self.squares.clear();
        self.squares.resize(labels.len(), 0);
        self.taken.clear();
        self.taken.resize(labels.len(), false);
        self.found.clear();
        for index in (0..labels.len()).filter(|&index| labels[index] > 0) {
            let (row, column) = shape.place(index);
            let same = |back: usize| labels[index - back] == labels[index];
            let grows = row > 0 && column > 0 && same(1) && same(width) && same(width + 1);
            self.squares[index] = if grows {
                let around = [1, width, width + 1].map(|back| self.squares[index - back]);
                around.into_iter().fold(u16::MAX - 1, u16::min) + 1
            } else {
                1
            };
            if usize::from(self.squares[index]) >= PATCH_PX {
                self.take((row + 1 - PATCH_PX, column + 1 - PATCH_PX), width);
            }
        }
        &self.found
    }

    fn take(&mut self, (row, column): (usize, usize), width: usize) {
        let inside = |start: usize| start..start + PATCH_PX;
        let mut pixels = inside(row).flat_map(|y| inside(column).map(move |x| y * width + x));
        if pixels.clone().any(|pixel| self.taken[pixel]) {
            return;
        }
        pixels.by_ref().for_each(|pixel| self.taken[pixel] = true);
        self.found.push((row, column));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::Shape;

    #[test]
    fn windows_lie_in_one_label_and_clear_of_each_other() {
        // Two labels side by side, 6 and 11 columns wide, with a hole that a window would reach.
        let target = Plane::from_fn(Shape::new(7, 17), |row, column| match (row, column) {
            (0, 16) => 0,
            (_, 0..6) => 1,
            _ => 2,
        });
        let mut patches = Patches::default();
        assert_eq!(patches.find(&target), [(0, 0), (0, 6), (0, 11)]);
        assert_eq!(patches.find(&Plane::filled(Shape::new(4, 40), 1)), []);
        assert_eq!(patches.find(&Plane::filled(Shape::new(7, 7), 0)), []);
    }
}
