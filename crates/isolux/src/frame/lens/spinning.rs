//! Lidars that spin: each row of the image is a beam at a fixed altitude, each column a direction of the turning head.
//!
//! Angles and axes are those of Ouster's metadata: x ahead, where the first column looks, y to the left, z up. The head
//! turns clockwise, seen from above. A beam's azimuth turns it further in that sense.

use super::error::LensError;
use crate::frame::Shape;

/// The beams of a lidar that spins by 360° from the first column to the last.
#[derive(Clone, Debug, PartialEq)]
pub struct SpinningLidar {
    altitudes_deg: Vec<f64>,
    /// One for each altitude.
    azimuths_deg: Vec<f64>,
}

impl SpinningLidar {
    /// Beams from the first row to the last. `azimuths_deg` are what each beam is ahead of the head, clockwise; empty
    /// where the rows of the image have been shifted so that a column looks in one direction.
    ///
    /// # Errors
    /// [`LensError`] for angles that are none, and another number of azimuths than of altitudes.
    pub fn new(altitudes_deg: &[f64], azimuths_deg: &[f64]) -> Result<Self, LensError> {
        let fine = altitudes_deg.iter().all(|altitude| altitude.abs() <= 90.0)
            && azimuths_deg.iter().all(|azimuth| azimuth.is_finite());
        if !fine {
            return Err(LensError::BeamAngles);
        }
        let (found, expected) = (azimuths_deg.len(), altitudes_deg.len());
        if found != 0 && found != expected {
            return Err(LensError::AzimuthCount { found, expected });
        }
        let azimuths_deg = if found == 0 { vec![0.0; expected] } else { azimuths_deg.to_vec() };
        Ok(Self { altitudes_deg: altitudes_deg.to_vec(), azimuths_deg })
    }

    /// Number of beams.
    #[must_use]
    pub fn beams(&self) -> usize {
        self.altitudes_deg.len()
    }

    pub(super) fn check_shape(&self, shape: Shape) -> Result<(), LensError> {
        let (found, expected) = (self.beams(), shape.height);
        if found == expected { Ok(()) } else { Err(LensError::BeamCount { found, expected }) }
    }

    pub(super) fn ray(&self, shape: Shape, row: usize, column: usize) -> Option<[f64; 3]> {
        let altitude = self.altitudes_deg.get(row)?.to_radians();
        let turned = 360.0 * column as f64 / shape.width as f64 + self.azimuths_deg.get(row)?;
        let (sine, cosine) = turned.to_radians().sin_cos();
        Some([cosine * altitude.cos(), -sine * altitude.cos(), altitude.sin()])
    }

    /// The row of the beam that is nearest in altitude, and the column.
    pub(super) fn project(&self, shape: Shape, [x, y, z]: [f64; 3]) -> Option<[f64; 2]> {
        let across = x.hypot(y);
        let altitude = z.atan2(across).to_degrees();
        let away = |row: usize| (self.altitudes_deg[row] - altitude).abs();
        let row = (0..self.beams()).min_by(|a, b| away(*a).total_cmp(&away(*b)))?;
        // Beyond the outermost beams nothing is seen; between two, the nearer one sees it.
        let seen = across > 0.0 && away(row) <= 0.5 * self.spacing_deg(row);
        let turned = (-y).atan2(x).to_degrees() - self.azimuths_deg[row];
        let column = turned.rem_euclid(360.0) / 360.0 * shape.width as f64;
        // Half a column before the first one is the last one's.
        let column = if column >= shape.width as f64 - 0.5 { column - shape.width as f64 } else { column };
        seen.then_some([row as f64, column])
    }

    /// The greater distance from a beam to those beside it.
    fn spacing_deg(&self, row: usize) -> f64 {
        let to = |other: Option<&f64>| other.map_or(0.0, |other| (other - self.altitudes_deg[row]).abs());
        let before = row.checked_sub(1).and_then(|before| self.altitudes_deg.get(before));
        to(before).max(to(self.altitudes_deg.get(row + 1)))
    }
}
