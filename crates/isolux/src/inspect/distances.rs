//! Distances in another unit than is said, and beyond the range of the modulation.

use super::claims::Claims;
use super::suspicion::Suspicion;
use crate::numerics::statistics::quantile;

/// Half of the image is nearer than this, m, even for lidars that see far: the road is near.
const FAR_M: f64 = 45.0;
/// ... for a recording that states its unit.
const FAR_AS_STATED_M: f64 = 250.0;
/// Half of the image is farther than this, m: time-of-flight cameras measure from some 0.2 m on.
const NEAR_M: f64 = 0.22;
/// ... for a recording that states its unit, in which close work is believed.
const NEAR_AS_STATED_M: f64 = 0.05;
/// Units that are tried, metres for one, the most frequent first.
const UNITS_M: [f64; 3] = [0.001, 0.01, 1.0];
/// Medians, m, that a tried unit must give.
const USUAL_M: [f64; 2] = [0.25, 30.0];
/// Noise may carry a distance beyond the range by this share.
const RANGE_MARGIN: f64 = 0.02;
/// Share of distances beyond the range that is no accident.
const LEAST_BEYOND: f64 = 2e-3;

/// What is wrong with distances, m, as they were read.
pub(super) fn suspicion(distances_m: &[f32], claims: &Claims) -> Option<Suspicion> {
    let mut values: Vec<f64> = distances_m.iter().map(|&d| f64::from(d)).collect();
    let median_m = quantile(&mut values, 0.5)?;
    let range_m = claims.range_m;
    let stated = claims.distance_unit_stated;
    let far_m = if stated { FAR_AS_STATED_M } else { range_m.map_or(FAR_M, |range_m| range_m.min(FAR_M)) };
    let near_m = if stated { NEAR_AS_STATED_M } else { NEAR_M };
    if (median_m > far_m || median_m < near_m)
        && let Some(unit_m) = likely_unit(median_m, range_m, claims)
    {
        let [from_m, to_m] = [0.05, 0.95].map(|at| quantile(&mut values, at).unwrap_or(median_m));
        return Some(Suspicion::DistanceUnit { from_m, to_m, unit_m });
    }
    let range_m = range_m?;
    let beyond = values.iter().filter(|d| **d > range_m * (1.0 + RANGE_MARGIN)).count();
    let share = beyond as f64 / values.len() as f64;
    (share > LEAST_BEYOND).then_some(Suspicion::BeyondRange { share, range_m })
}

/// The unit in which the stored distances would be usual ones.
fn likely_unit(median_m: f64, range_m: Option<f64>, claims: &Claims) -> Option<f64> {
    let assumed_m = claims.metres_per_unit?;
    let [least_m, most_m] = USUAL_M;
    let most_m = range_m.map_or(most_m, |range_m| range_m.min(most_m));
    let fits = |unit_m: &f64| {
        let median_m = median_m / assumed_m * unit_m;
        (unit_m / assumed_m - 1.0).abs() > 1e-9 && (least_m..=most_m).contains(&median_m)
    };
    UNITS_M.into_iter().find(fits)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::phase::SPEED_OF_LIGHT_M_PER_S;

    fn claims(metres_per_unit: f64, stated: bool, frequency_hz: Option<f64>) -> Claims {
        Claims {
            metres_per_unit: Some(metres_per_unit),
            distance_unit_stated: stated,
            range_m: frequency_hz.map(|f| SPEED_OF_LIGHT_M_PER_S / (2.0 * f)),
            ..Claims::default()
        }
    }

    /// What is found for a scene from 0.4 to 3 m whose distances are read as `scale` times as large.
    fn found(scale: f64, claims: &Claims) -> Option<Suspicion> {
        let distances: Vec<f32> = (0..1000).map(|i| ((0.4 + 0.0026 * f64::from(i)) * scale) as f32).collect();
        suspicion(&distances, claims)
    }

    fn unit(found: Option<Suspicion>) -> Option<f64> {
        match found {
            Some(Suspicion::DistanceUnit { unit_m, .. }) => Some(unit_m),
            _ => None,
        }
    }

    #[test]
    fn each_unit_that_is_taken_for_another_is_named() {
        let (float, integer) = (claims(1.0, false, None), claims(0.001, false, None));
        assert_eq!(unit(found(1000.0, &float)), Some(0.001));
        assert_eq!(unit(found(100.0, &float)), Some(0.01));
        assert_eq!(unit(found(0.1, &integer)), Some(0.01));
        assert_eq!(unit(found(0.001, &integer)), Some(1.0));
        // As stated, against all evidence.
        assert_eq!(unit(found(1000.0, &claims(1.0, true, None))), Some(0.001));
        for right in [float, integer, claims(0.001, true, None), claims(1.0, true, Some(20e6))] {
            assert_eq!(found(1.0, &right), None, "{right:?}");
        }
    }

    #[test]
    fn close_work_and_far_views_are_believed_where_the_unit_is_stated() {
        assert_eq!(found(0.08, &claims(0.001, true, None)), None);
        assert_eq!(found(60.0, &claims(1.0, true, None)), None);
        assert!(unit(found(0.08, &claims(0.001, false, None))).is_some());
    }

    #[test]
    fn distances_beyond_the_range_are_told() {
        let near = claims(1.0, true, Some(60e6));
        let Some(Suspicion::BeyondRange { share, range_m }) = found(1.0, &near) else { panic!() };
        assert!((range_m - 2.498).abs() < 1e-3 && (share - 0.17).abs() < 0.02, "{share} {range_m}");
    }
}
