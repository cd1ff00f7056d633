//! Checks that a scene stood still while the integration time varied. It compares distances, which hardly depend on
//! the integration time: the image is cut into blocks, and a block has moved when its mean distance differs from
//! the median over all frames by more than noise and the camera's own shift explain.

use crate::frame::{Frame, Shape, Window};
use crate::numerics::differences;
use crate::numerics::statistics::upper_median;

/// The image is compared in this many blocks along each side.
const BLOCKS: usize = 8;
/// Cameras shift their distances by a few centimetres when the integration time changes; a larger difference is
/// movement.
const SHIFT_M: f64 = 0.05;
/// Block means are compared beyond this many standard errors.
const STANDARD_ERRORS: f64 = 5.0;
/// A block is compressed where its amplitude per time is below this share of the largest; its distance is then not
/// used.
const LINEAR_SHARE: f64 = 0.7;
/// Largest number of frames that are compared: a recording whose time changes with every frame would fill the
/// memory.
const MOST_FRAMES: usize = 4096;
/// The scene moved when more than this share of the comparable blocks did.
const MOVED_SHARE: f64 = 0.1;

/// Means of one block of one frame.
#[derive(Clone, Copy, Debug)]
struct Block {
    amplitude_per_us: f64,
    distance_m: f64,
    distance_error_m: f64,
}

/// Collects the block distances of frames of different integration times and finds movement.
#[derive(Clone, Debug, Default)]
pub struct MotionWatch {
    shape: Option<Shape>,
    runs: Vec<(f64, Vec<Block>)>,
}

/// A scene that did not stand still.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Movement {
    /// Integration time of the first frame in which the scene differs from the median of all frames, µs.
    pub integration_time_us: f64,
    /// Share of the comparable blocks that moved, 0..=1.
    pub share: f64,
}

impl MotionWatch {
    /// Takes the first frame of a run of equal integration times (µs). Frames without distance are ignored.
    pub fn push(&mut self, time_us: f64, frame: &Frame) {
        let Some(distance_m) = frame.distance_m.as_ref().filter(|_| self.runs.len() < MOST_FRAMES) else {
            return;
        };
        let shape = frame.shape();
        if *self.shape.get_or_insert(shape) != shape {
            return;
        }
        let block = |window: Window| {
            let valid = |i: &usize| frame.is_valid(*i) && distance_m.values()[*i] > 0.0;
            let value = |i: usize| if valid(&i) { f64::from(distance_m.values()[i]) } else { f64::NAN };
            let rows: Vec<f64> = window.indices(shape).map(value).collect();
            let indices: Vec<usize> = window.indices(shape).filter(valid).collect();
            let count = indices.len() as f64;
            let amplitude =
                indices.iter().map(|&i| f64::from(frame.amplitude.values()[i])).sum::<f64>() / count;
            let distance = indices.iter().map(|&i| f64::from(distance_m.values()[i])).sum::<f64>() / count;
            let noise = differences::spatial(rows.chunks(window.width)).unwrap_or(f64::NAN);
            let reliable = noise <= differences::DISTANCE_NOISE_SHARE * distance;
            Block {
                amplitude_per_us: amplitude / time_us,
                distance_m: if reliable { distance } else { f64::NAN },
                distance_error_m: noise / count.sqrt(),
            }
        };
        self.runs.push((time_us, blocks(shape).map(block).collect()));
    }

    /// The first frame in which too many blocks differ in distance from the median of all frames; `None` when the
    /// scene stood still or there is nothing to compare.
    #[must_use]
    pub fn verdict(&self) -> Option<Movement> {
        let count = self.runs.first()?.1.len();
        let brightest: Vec<f64> = (0..count)
            .map(|b| self.column(b).map(|block| block.amplitude_per_us).fold(0.0, f64::max))
            .collect();
        let usual: Vec<f64> =
            (0..count).map(|b| median(self.column(b).map(|block| block.distance_m))).collect();
        for (time_us, blocks) in &self.runs {
            let (mut comparable, mut moved) = (0, 0);
            for ((block, brightest), usual) in blocks.iter().zip(&brightest).zip(&usual) {
                let tolerance = STANDARD_ERRORS * block.distance_error_m + SHIFT_M;
                let shift = (block.distance_m - usual).abs();
                if block.amplitude_per_us >= LINEAR_SHARE * brightest
                    && shift.is_finite()
                    && tolerance.is_finite()
                {
                    comparable += 1;
                    moved += usize::from(shift > tolerance);
                }
            }
            if moved as f64 > MOVED_SHARE * f64::from(comparable) {
                let share = moved as f64 / f64::from(comparable);
                return Some(Movement { integration_time_us: *time_us, share });
            }
        }
        None
    }

    fn column(&self, block: usize) -> impl Iterator<Item = &Block> {
        self.runs.iter().map(move |(_, blocks)| &blocks[block])
    }
}

/// The image cut into blocks; none of them empty.
fn blocks(shape: Shape) -> impl Iterator<Item = Window> {
    let (rows, columns) = (BLOCKS.min(shape.height), BLOCKS.min(shape.width));
    (0..rows * columns).map(move |index| {
        let (row, column) = (index / columns, index % columns);
        let (top, left) = (row * shape.height / rows, column * shape.width / columns);
        let (bottom, right) = ((row + 1) * shape.height / rows, (column + 1) * shape.width / columns);
        Window { top, left, height: bottom - top, width: right - left }
    })
}

/// Median of the finite values; NaN when there are none.
fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.filter(|v| v.is_finite()).collect();
    upper_median(&mut values).unwrap_or(f64::NAN)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::Plane;

    fn frame(distance_m: f32) -> Frame {
        let shape = Shape::new(48, 64);
        let mut frame = Frame::new(shape);
        frame.amplitude.fill(100.0);
        frame.distance_m = Some(Plane::from_fn(shape, |row, _| distance_m + 0.001 * (row % 3) as f32));
        frame.flag_amplitude(None);
        frame
    }

    #[test]
    fn a_moved_scene_is_noticed_and_a_still_one_is_not() {
        let mut watch = MotionWatch::default();
        for distance in [1.0, 1.0, 1.001, 1.02] {
            watch.push(100.0, &frame(distance));
        }
        assert_eq!(watch.verdict(), None);
        watch.push(100.0, &frame(1.3));
        assert!(matches!(watch.verdict(), Some(Movement { share, .. }) if share == 1.0));
    }

    #[test]
    fn small_images_have_fewer_blocks() {
        assert_eq!(blocks(Shape::new(3, 3)).count(), 9);
        assert_eq!(blocks(Shape::new(144, 176)).count(), 64);
        assert!(blocks(Shape::new(3, 100)).all(|b| b.height > 0 && b.width > 0));
    }
}
