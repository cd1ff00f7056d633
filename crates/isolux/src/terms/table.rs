//! A positive function of the distance as a table, so that the loop over pixels needs no logarithm or exponential.
//!
//! The cells are equal parts of the octaves of the distance, so that a cell's number and the place in it are bits of
//! the f32: the exponent and the upper bits of the mantissa are the cell, the lower bits the place. In a cell the
//! table is Hermite's cubic: with ends and slopes exact, its error is at most `Δ⁴/384 · max|q⁗|`, Δ the cell's
//! width. Cells are halved until the error measured where that bound is largest, in the middle, is below
//! [`DistanceTable::TOLERANCE`].

/// A tabulated function between two distances; outside, the value at the nearer end.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct DistanceTable {
    /// Hermite's cubic of each cell, coefficients of 1, u, u², u³, u from 0 to 1 through the cell.
    cells: Vec<[f32; 4]>,
    /// Cell number, counted from 0 m, of the first cell.
    first: u32,
    /// Mantissa bits within a cell.
    shift: u32,
    min_m: f32,
    max_m: f32,
}

impl DistanceTable {
    /// Relative error of interpolation that is aimed at; f32 arithmetic adds 4 ulp, 5e-7.
    pub(crate) const TOLERANCE: f64 = 1e-6;
    /// Binary logarithms of the fewest and the most cells in an octave. The most resolve an oscillation of
    /// 1000 rad/octave.
    const LOG2_CELLS: std::ops::RangeInclusive<u32> = 5..=12;

    /// Tabulates `function` between `min_m` and `max_m` (m, positive and increasing). It must be smooth for the
    /// 32nd part of an octave beyond either, where the outermost cells end.
    #[must_use]
    pub(crate) fn new(function: impl Fn(f64) -> f64, min_m: f64, max_m: f64) -> Self {
        let mut log2_cells = *Self::LOG2_CELLS.start();
        loop {
            let table = Self::with_cells(&function, min_m, max_m, log2_cells);
            if log2_cells == *Self::LOG2_CELLS.end()
                || table.error_in_the_middle(&function) <= Self::TOLERANCE
            {
                return table;
            }
            log2_cells += 1;
        }
    }

    /// The same with 128 cells in an octave, whatever the error: for functions with kinks, whose values need not be exact.
    #[must_use]
    pub(crate) fn coarse(function: impl Fn(f64) -> f64, min_m: f64, max_m: f64) -> Self {
        Self::with_cells(&function, min_m, max_m, 7)
    }

    fn with_cells(function: &impl Fn(f64) -> f64, min_m: f64, max_m: f64, log2_cells: u32) -> Self {
        let (min_m, max_m) = (min_m as f32, max_m as f32);
        let shift = f32::MANTISSA_DIGITS - 1 - log2_cells;
        let (first, last) = (min_m.to_bits() >> shift, max_m.to_bits() >> shift);
        let cells = (first..=last.max(first)).map(|cell| hermite(function, ends(cell, shift))).collect();
        Self { cells, first, shift, min_m, max_m }
    }

    /// Largest relative error in the middle of a cell.
    fn error_in_the_middle(&self, function: &impl Fn(f64) -> f64) -> f64 {
        let cells = self.cells.iter().zip(self.first..);
        let errors = cells.map(|(cell, number)| {
            let [start, end] = ends(number, self.shift);
            let exact = function(0.5 * (start + end));
            (f64::from(polynomial(*cell, 0.5)) / exact - 1.0).abs()
        });
        errors.fold(0.0, f64::max)
    }

    /// Number of cells.
    #[cfg(test)]
    #[must_use]
    pub(crate) fn cells(&self) -> usize {
        self.cells.len()
    }

    /// The value at one distance (m).
    #[inline(always)]
    #[must_use]
    pub(crate) fn at(&self, distance_m: f32) -> f32 {
        let bits = distance_m.max(self.min_m).min(self.max_m).to_bits();
        let cell = (bits >> self.shift).wrapping_sub(self.first) as usize;
        let place = bits & ((1 << self.shift) - 1);
        // Exact: fewer bits than a mantissa, divided by a power of two.
        let u = place as f32 * (1.0 / (1u32 << self.shift) as f32);
        self.cells.get(cell).map_or(f32::NAN, |cell| polynomial(*cell, u))
    }

    /// The value at one distance (m), its slope (per m) and its curvature (per m²); outside the ends the slope is 0.
    /// The slope is that of the interpolation, exact at the cells' ends; the curvature is good to about a percent.
    #[inline(always)]
    #[must_use]
    pub(crate) fn derivatives(&self, distance_m: f32) -> [f32; 3] {
        let bits = distance_m.max(self.min_m).min(self.max_m).to_bits();
        let number = bits >> self.shift;
        let place = bits & ((1 << self.shift) - 1);
        let u = place as f32 * (1.0 / (1u32 << self.shift) as f32);
        let inside = (distance_m >= self.min_m) & (distance_m <= self.max_m);
        let width_m = f32::from_bits((number + 1) << self.shift) - f32::from_bits(number << self.shift);
        let per_m = if inside { 1.0 / width_m } else { 0.0 };
        let Some(&cell) = self.cells.get(number.wrapping_sub(self.first) as usize) else {
            return [f32::NAN; 3];
        };
        let [_, c1, c2, c3] = cell;
        let slope = (3.0 * c3 * u + 2.0 * c2) * u + c1;
        let curvature = 6.0 * c3 * u + 2.0 * c2;
        [polynomial(cell, u), slope * per_m, curvature * per_m * per_m]
    }

    /// Multiplies each of `gains` by the value at its distance. The slices have the same length.
    pub(crate) fn scale(&self, distances_m: &[f32], gains: &mut [f32]) {
        look_up(self, distances_m, gains);
    }
}

#[multiversion::multiversion(targets("x86_64+avx512f+avx512bw+avx512vl+avx512dq", "x86_64+avx2"))]
fn look_up(table: &DistanceTable, distances_m: &[f32], gains: &mut [f32]) {
    for (gain, &distance_m) in gains.iter_mut().zip(distances_m) {
        *gain *= table.at(distance_m);
    }
}

#[inline(always)]
fn polynomial([c0, c1, c2, c3]: [f32; 4], u: f32) -> f32 {
    ((c3 * u + c2) * u + c1) * u + c0
}

/// Distances (m) at which a cell starts and ends.
fn ends(cell: u32, shift: u32) -> [f64; 2] {
    [cell, cell + 1].map(|cell| f64::from(f32::from_bits(cell << shift)))
}

/// Hermite's cubic between two distances. The slopes are central differences over a hundredth of the cell on either
/// side: their error, `(Δ/100)² q‴ / 6`, is below that of the interpolation.
fn hermite(function: &impl Fn(f64) -> f64, [start, end]: [f64; 2]) -> [f32; 4] {
    let step = 0.01 * (end - start);
    let slope = |x: f64| (function(x + step) - function(x - step)) / 0.02;
    let (from, to) = (function(start), function(end));
    let (m0, m1) = (slope(start), slope(end));
    let rise = to - from;
    [from, m0, 3.0 * rise - 2.0 * m0 - m1, m0 + m1 - 2.0 * rise].map(|c| c as f32)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Worst relative error against f64, over distances that are no multiples of anything.
    fn worst(function: impl Fn(f64) -> f64, min_m: f64, max_m: f64) -> f64 {
        let table = DistanceTable::new(&function, min_m, max_m);
        let steps = 200_003u32;
        (0..=steps)
            .map(|i| (min_m * (max_m / min_m).powf(f64::from(i) / f64::from(steps))) as f32)
            .map(|d| f64::from(d.clamp(min_m as f32, max_m as f32)))
            .map(|d| (f64::from(table.at(d as f32)) / function(d) - 1.0).abs())
            .fold(0.0, f64::max)
    }

    #[test]
    fn the_table_is_the_function_to_a_millionth() {
        // Twice the tolerance: f32 adds half an ulp for each of four coefficients and of six operations.
        let bound = 2.0 * DistanceTable::TOLERANCE;
        let harmonic = |k: f64| move |d: f64| (0.03 * (k * d).cos() + 0.1 * (d / 0.7).ln().powi(2)).exp();
        for (name, worst) in [
            ("one", worst(|_| 1.0, 0.3, 3.0)),
            ("power", worst(|d| d.powf(-1.7), 0.05, 120.0)),
            ("20 MHz", worst(harmonic(3.35), 0.3, 3.0)),
            ("100 MHz over two ambiguity ranges", worst(harmonic(16.8), 0.1, 3.0)),
        ] {
            assert!(worst <= bound, "{name}: {worst:e}");
        }
    }

    #[test]
    fn slope_and_curvature_are_those_of_the_function() {
        let (power, min_m, max_m) = (-1.7f64, 0.3, 3.0);
        let table = DistanceTable::new(|d| d.powf(power), min_m, max_m);
        for step in 0..500 {
            let distance_m = 0.301 + 0.0053 * f64::from(step);
            let [value, slope, curvature] = table.derivatives(distance_m as f32).map(f64::from);
            assert_eq!(value, f64::from(table.at(distance_m as f32)));
            // Interpolation errors in slope and curvature: those of the value times 1/Δ and 1/Δ², Δ 3 % of d at
            // most, and the rounding of f32 likewise.
            assert!((slope / (power / distance_m * value) - 1.0).abs() < 1e-3, "{distance_m}");
            let expected = power * (power - 1.0) / (distance_m * distance_m) * value;
            assert!((curvature / expected - 1.0).abs() < 3e-2, "{distance_m}: {curvature} {expected}");
        }
        assert_eq!(table.derivatives(5.0)[1..], [0.0, 0.0]);
    }

    #[test]
    fn outside_the_ends_the_value_stays() {
        let table = DistanceTable::new(|d| d, 0.4, 2.5);
        for (outside, end) in [(0.01, 0.4), (0.0, 0.4), (-3.0, 0.4), (f32::NAN, 0.4), (9.0, 2.5)] {
            assert_eq!(table.at(outside), table.at(end), "{outside}");
        }
        let mut gains = [2.0, 3.0];
        table.scale(&[1.0, f32::INFINITY], &mut gains);
        assert_eq!(gains, [2.0 * table.at(1.0), 3.0 * table.at(2.5)]);
    }
}
