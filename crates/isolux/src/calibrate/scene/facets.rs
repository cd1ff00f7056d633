//! The surface around every pixel: a plane through its neighbours.
//!
//! A plane is linear in the inverse depth: `1/z = (n/ρ) · (x, y, 1)` for the ray (x, y, 1), n the normal and ρ the plane's
//! distance from the camera. For rays r of unit length, the same holds of the distance: `1/d = (n/ρ) · r`. A pinhole has
//! the former, with two unknowns and a mean; all other lenses the latter, with three.

use nalgebra::{Matrix3, Vector3};

use crate::frame::{Intrinsics, PixelRays, RayTable, Shape};

/// Least share of the window's pixels that must be valid.
const LEAST_SHARE: f64 = 0.6;

/// A plane through the neighbours of a pixel, in camera coordinates.
#[derive(Clone, Copy, Debug)]
pub(super) struct Facet {
    /// Where the pixel's ray meets the plane, metres.
    pub(super) point_m: Vector3<f64>,
    /// Unit normal, away from the camera.
    pub(super) normal: Vector3<f64>,
    /// Scatter of single pixels around the plane, in their standard deviations.
    pub(super) scatter: f64,
    /// Standard error of `point_m` along the ray, metres.
    pub(super) error_m: f64,
    /// Standard error of `normal` about either axis, rad.
    pub(super) normal_error: f64,
}

/// What is known of a pixel before its surroundings are looked at.
#[derive(Clone, Copy, Debug)]
pub(super) struct Depth {
    /// 1/z of a pinhole, otherwise 1/d, 1/m.
    pub(super) inverse: f64,
    /// Its inverse variance, 0 where there is no distance.
    pub(super) weight: f64,
}

/// Sums over a window: of a pinhole weight, x, y, q, xx, xy, yy, xq, yq, qq, and the number of pixels; of rays r xx, xy,
/// xz, yy, yz, zz, xq, yq, zq, qq, and the number of pixels.
type Sums = [f64; 11];

/// Fits a plane to the window of `radius` pixels to each side of every pixel; `None` where the pixel or too many of
/// its neighbours have no distance. Weighted least squares by sums over boxes.
pub(super) fn fit(depths: &[Depth], shape: Shape, rays: &PixelRays, radius: usize) -> Vec<Option<Facet>> {
    match rays {
        PixelRays::Pinhole(pinhole) => {
            let ray = |index: usize| pinhole_ray(pinhole, shape, index);
            let terms = |index: usize, depth: &Depth| pinhole_terms(ray(index), depth);
            fit_all(depths, shape, radius, terms, |index, sums| solve(sums, ray(index)))
        }
        PixelRays::Table(table) => {
            let terms = |index: usize, depth: &Depth| table_terms(table, index, depth);
            fit_all(depths, shape, radius, terms, |index, sums| solve_along(sums, table.unit().get(index)?))
        }
    }
}

fn fit_all(
    depths: &[Depth],
    shape: Shape,
    radius: usize,
    terms: impl Fn(usize, &Depth) -> Sums,
    solve: impl Fn(usize, &Sums) -> Option<Facet>,
) -> Vec<Option<Facet>> {
    let terms = |(index, depth): (usize, &Depth)| {
        if depth.weight > 0.0 { terms(index, depth) } else { [0.0; 11] }
    };
    let sums = box_sums(&depths.iter().enumerate().map(terms).collect::<Vec<_>>(), shape, radius);
    let least = LEAST_SHARE * ((2 * radius + 1) * (2 * radius + 1)) as f64;
    let facet = |(index, sums): (usize, &Sums)| {
        (depths[index].weight > 0.0 && sums[10] >= least).then(|| solve(index, sums)).flatten()
    };
    sums.iter().enumerate().map(facet).collect()
}

fn pinhole_ray(pinhole: &Intrinsics, shape: Shape, index: usize) -> [f64; 3] {
    pinhole.ray((index / shape.width) as f64, (index % shape.width) as f64)
}

fn pinhole_terms([x, y, _]: [f64; 3], depth: &Depth) -> Sums {
    let (w, q) = (depth.weight, depth.inverse);
    [w, w * x, w * y, w * q, w * x * x, w * x * y, w * y * y, w * x * q, w * y * q, w * q * q, 1.0]
}

fn table_terms(table: &RayTable, index: usize, depth: &Depth) -> Sums {
    let (w, q, [x, y, z]) = (depth.weight, depth.inverse, table.unit()[index]);
    let [wx, wy, wz] = [w * x, w * y, w * z];
    [wx * x, wx * y, wx * z, wy * y, wy * z, wz * z, wx * q, wy * q, wz * q, w * q * q, 1.0]
}

/// The plane `1/d = inverse · r` of the sums of rays, where `ray` meets it.
fn solve_along(sums: &Sums, ray: &[f64; 3]) -> Option<Facet> {
    let [xx, xy, xz, yy, yz, zz, xq, yq, zq, qq, count] = *sums;
    let gram = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
    let (moment, ray) = (Vector3::new(xq, yq, zq), Vector3::from(*ray));
    let covariance = gram.cholesky()?.inverse();
    let inverse = covariance * moment;
    let (q, length) = (inverse.dot(&ray), inverse.norm());
    let variance = ((qq - inverse.dot(&moment)) / (count - 3.0)).max(0.0);
    let leverage = ray.dot(&(covariance * ray));
    if !(q > 0.0 && length > 0.0 && length.is_finite() && leverage.is_finite()) {
        return None;
    }
    let normal = inverse / length;
    // The error across the normal turns it; along it, it only moves the plane.
    let turning = (covariance.trace() - normal.dot(&(covariance * normal))).max(0.0);
    Some(Facet {
        point_m: ray / q,
        normal,
        scatter: variance.sqrt(),
        error_m: (variance * leverage).sqrt() / (q * q),
        normal_error: (0.5 * variance * turning).sqrt() / length,
    })
}

fn solve(sums: &Sums, [x, y, _]: [f64; 3]) -> Option<Facet> {
    let [w, sx, sy, sq, sxx, sxy, syy, sxq, syq, sqq, count] = *sums;
    let (mx, my, mq) = (sx / w, sy / w, sq / w);
    let (cxx, cxy, cyy) = (sxx - sx * mx, sxy - sx * my, syy - sy * my);
    let (cxq, cyq, cqq) = (sxq - sx * mq, syq - sy * mq, sqq - sq * mq);
    let determinant = cxx * cyy - cxy * cxy;
    let a = (cxq * cyy - cyq * cxy) / determinant;
    let b = (cyq * cxx - cxq * cxy) / determinant;
    let (dx, dy) = (x - mx, y - my);
    let q = mq + a * dx + b * dy;
    let normal = Vector3::new(a, b, mq - a * mx - b * my);
    let length = normal.norm();
    let variance = ((cqq - a * cxq - b * cyq) / (count - 3.0)).max(0.0);
    let leverage = 1.0 / w + (dx * dx * cyy - 2.0 * dx * dy * cxy + dy * dy * cxx) / determinant;
    if !(q > 0.0 && length > 0.0 && length.is_finite() && leverage.is_finite()) {
        return None;
    }
    let point_m = Vector3::new(x, y, 1.0) / q;
    let error_m = (variance * leverage).sqrt() / q * point_m.norm();
    let normal_error = (0.5 * variance * (cxx + cyy) / determinant).sqrt() / length;
    Some(Facet { point_m, normal: normal / length, scatter: variance.sqrt(), error_m, normal_error })
}

/// Sums over windows, cut off at the image's edge. Each is added up anew: a running sum would carry rounding along.
fn box_sums(terms: &[Sums], shape: Shape, radius: usize) -> Vec<Sums> {
    let width = shape.width.max(1);
    let add =
        |total: &mut Sums, term: &Sums| total.iter_mut().zip(term).for_each(|(total, term)| *total += term);
    let mut across = vec![[0.0; 11]; terms.len()];
    for (sums, line) in across.chunks_mut(width).zip(terms.chunks(width)) {
        for (at, sum) in sums.iter_mut().enumerate() {
            line[at.saturating_sub(radius)..(at + radius + 1).min(width)]
                .iter()
                .for_each(|term| add(sum, term));
        }
    }
    let mut sums = vec![[0.0; 11]; terms.len()];
    for (row, line) in sums.chunks_mut(width).enumerate() {
        for near in row.saturating_sub(radius)..(row + radius + 1).min(shape.height) {
            let near = &across[near * width..][..line.len()];
            line.iter_mut().zip(near).for_each(|(sum, term)| add(sum, term));
        }
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;

    const SHAPE: Shape = Shape { height: 20, width: 24 };
    const PINHOLE: Intrinsics = Intrinsics { fx: 30.0, fy: 29.0, cx: 11.0, cy: 9.0 };

    /// Depths on the plane `normal · p = rho_m`.
    fn plane(normal: Vector3<f64>, rho_m: f64) -> Vec<Depth> {
        let ray = |index: usize| PINHOLE.ray((index / SHAPE.width) as f64, (index % SHAPE.width) as f64);
        let inverse = |index: usize| normal.dot(&Vector3::from(ray(index))) / rho_m;
        (0..SHAPE.pixels()).map(|index| Depth { inverse: inverse(index), weight: 1.0 }).collect()
    }

    #[test]
    fn a_plane_is_found_everywhere_but_behind_holes() {
        let normal = Vector3::new(0.3, -0.2, 0.9).normalize();
        let mut depths = plane(normal, 1.4);
        depths[7 * SHAPE.width + 9] = Depth { inverse: f64::NAN, weight: 0.0 };
        let facets = fit(&depths, SHAPE, &PixelRays::Pinhole(PINHOLE), 4);
        assert!(facets[7 * SHAPE.width + 9].is_none() && facets[0].is_none(), "a hole, a corner");
        for index in (4..16).flat_map(|row| (4..20).map(move |column| row * SHAPE.width + column)) {
            let Some(facet) = facets[index] else { continue };
            // Sums of 81 terms around 1, centred: a thousand roundings.
            assert!(
                (facet.normal - normal).amax() < 1e-10 && (normal.dot(&facet.point_m) - 1.4).abs() < 1e-12
            );
            assert!(facet.scatter < 1e-6);
        }
    }

    #[test]
    fn scatter_and_error_are_those_of_the_noise() {
        let mut depths = plane(Vector3::z(), 2.0);
        // Uniform noise of a relative standard deviation of 1 % or, in every other row, of 2 %.
        for (number, depth) in (0u64..).zip(&mut depths) {
            let noise = 0.01 * (1 + number / SHAPE.width as u64 % 2) as f64;
            let share = (crate::numerics::hash::splitmix64(number) >> 11) as f64 / (1u64 << 53) as f64;
            depth.inverse *= 1.0 + noise * 12f64.sqrt() * (share - 0.5);
            depth.weight = (0.5 * noise).powi(-2);
        }
        let facets = fit(&depths, SHAPE, &PixelRays::Pinhole(PINHOLE), 4);
        let inner = (4..16).flat_map(|row| (4..20).map(move |column| row * SHAPE.width + column));
        let facets: Vec<Facet> = inner.filter_map(|index| facets[index]).collect();
        let mean = facets.iter().map(|facet| facet.scatter).sum::<f64>() / facets.len() as f64;
        // Some six independent windows of 81 pixels: 1/√(2·486) = 3 %.
        assert!((mean - 1.0).abs() < 0.1, "{mean}");
        let rms = |of: &dyn Fn(&Facet) -> f64| {
            (facets.iter().map(|facet| of(facet).powi(2)).sum::<f64>() / facets.len() as f64).sqrt()
        };
        let deviations = [
            rms(&|facet| (facet.point_m[2] - 2.0) / facet.error_m),
            rms(&|facet| facet.normal[0] / facet.normal_error),
            rms(&|facet| facet.normal[1] / facet.normal_error),
        ];
        assert!(deviations.iter().all(|deviation| (0.5..1.6).contains(deviation)), "{deviations:?}");
    }

    #[test]
    fn rays_in_a_table_give_the_facets_of_the_pinhole() {
        let depths = plane(Vector3::new(0.3, -0.2, 0.9).normalize(), 1.4);
        let ray = |index: usize| Vector3::from(pinhole_ray(&PINHOLE, SHAPE, index));
        let values: Vec<f64> = (0..SHAPE.pixels()).flat_map(|index| <[f64; 3]>::from(ray(index))).collect();
        let table = PixelRays::Table(std::sync::Arc::new(RayTable::new(SHAPE, &values).unwrap()));
        // Uniform noise of 1 %; the same depths as distances.
        let noisy = |(index, depth): (usize, &Depth)| {
            let share = (crate::numerics::hash::splitmix64(index as u64) >> 11) as f64 / (1u64 << 53) as f64;
            let inverse = depth.inverse * (1.0 + 0.01 * 12f64.sqrt() * (share - 0.5));
            Depth { inverse, weight: (0.01 * depth.inverse).powi(-2) }
        };
        let depths: Vec<Depth> = depths.iter().enumerate().map(noisy).collect();
        let along = |(index, depth): (usize, &Depth)| {
            let length = ray(index).norm();
            Depth { inverse: depth.inverse / length, weight: depth.weight * length * length }
        };
        let distances: Vec<Depth> = depths.iter().enumerate().map(along).collect();
        let (flat, any) =
            (fit(&depths, SHAPE, &PixelRays::Pinhole(PINHOLE), 4), fit(&distances, SHAPE, &table, 4));
        let both: Vec<(&Facet, &Facet)> =
            flat.iter().zip(&any).filter_map(|(a, b)| a.as_ref().zip(b.as_ref())).collect();
        assert_eq!(both.len(), flat.iter().flatten().count());
        for (flat, any) in both {
            // The same equations in other words: only rounding, of sums that are not centred, is between them.
            assert!((flat.normal - any.normal).amax() < 1e-9 && (flat.point_m - any.point_m).amax() < 1e-9);
            assert!((flat.scatter - any.scatter).abs() < 1e-7 * flat.scatter);
            assert!((flat.error_m - any.error_m).abs() < 1e-7 * flat.error_m);
            // Approximations of one another where the normal is not along the ray.
            assert!((flat.normal_error / any.normal_error - 1.0).abs() < 0.3);
        }
    }
}
