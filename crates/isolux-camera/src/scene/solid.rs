//! Where a ray meets a form, in the form's own coordinates.

use crate::scene::object::Form;
use crate::scene::pose::{Vector, along, dot};

/// A point where a ray meets a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Hit {
    /// From the ray's origin, in lengths of its direction.
    pub(crate) distance: f64,
    /// Unit normal; its side does not matter.
    pub(crate) normal: Vector,
    /// Place on the surface, metres.
    pub(crate) place_m: [f64; 2],
}

/// Nearer than this is no hit: the camera may stand on a surface, but it does not see it.
const NEAREST: f64 = 1e-6;

impl Form {
    /// The nearest point of the form along the ray.
    pub(crate) fn hit(&self, origin: Vector, direction: Vector) -> Option<Hit> {
        match *self {
            Self::Rectangle { size_m } => rectangle(size_m, origin, direction),
            Self::Cuboid { size_m } => cuboid(size_m, origin, direction),
            Self::Sphere { radius_m } => sphere(radius_m, origin, direction),
            Self::Cylinder { radius_m, height_m } => cylinder(radius_m, height_m, origin, direction),
        }
    }

    /// Radius of a ball about the centre that holds the form, metres.
    pub(crate) fn bounding_radius_m(&self) -> f64 {
        let half_diagonal = |sizes: &[f64]| 0.5 * sizes.iter().map(|size| size * size).sum::<f64>().sqrt();
        match *self {
            Self::Rectangle { size_m } => half_diagonal(&size_m),
            Self::Cuboid { size_m } => half_diagonal(&size_m),
            Self::Sphere { radius_m } => radius_m,
            Self::Cylinder { radius_m, height_m } => half_diagonal(&[2.0 * radius_m, height_m]),
        }
    }
}

fn rectangle(size_m: [f64; 2], origin: Vector, direction: Vector) -> Option<Hit> {
    let distance = -origin[2] / direction[2];
    let [x, y, _] = along(origin, direction, distance);
    let inside = x.abs() <= 0.5 * size_m[0] && y.abs() <= 0.5 * size_m[1] && distance > NEAREST;
    inside.then_some(Hit { distance, normal: [0.0, 0.0, -1.0], place_m: [x, y] })
}

/// The faces across each axis, and the coordinates that span them.
const FACES: [(usize, usize, usize); 3] = [(0, 2, 1), (1, 0, 2), (2, 0, 1)];

fn cuboid(size_m: [f64; 3], origin: Vector, direction: Vector) -> Option<Hit> {
    let mut nearest: Option<Hit> = None;
    for (axis, across, down) in FACES {
        for side in [-0.5, 0.5] {
            let distance = (side * size_m[axis] - origin[axis]) / direction[axis];
            let point = along(origin, direction, distance);
            let inside = |axis: usize| point[axis].abs() <= 0.5 * size_m[axis];
            let nearer = nearest.is_none_or(|hit| distance < hit.distance);
            if distance > NEAREST && nearer && inside(across) && inside(down) {
                let mut normal = [0.0; 3];
                normal[axis] = 2.0 * side;
                nearest = Some(Hit { distance, normal, place_m: [point[across], point[down]] });
            }
        }
    }
    nearest
}

fn sphere(radius_m: f64, origin: Vector, direction: Vector) -> Option<Hit> {
    let distance = first_root(
        dot(direction, direction),
        dot(origin, direction),
        dot(origin, origin) - radius_m * radius_m,
        |_| true,
    )?;
    let point = along(origin, direction, distance);
    let around = radius_m * libm::atan2(point[0], -point[2]);
    let down = radius_m * libm::asin((point[1] / radius_m).clamp(-1.0, 1.0));
    Some(Hit { distance, normal: point.map(|value| value / radius_m), place_m: [around, down] })
}

fn cylinder(radius_m: f64, height_m: f64, origin: Vector, direction: Vector) -> Option<Hit> {
    let caps = [-0.5, 0.5].into_iter().filter_map(|side| {
        let distance = (side * height_m - origin[1]) / direction[1];
        let [x, _, z] = along(origin, direction, distance);
        let inside = x * x + z * z <= radius_m * radius_m && distance > NEAREST;
        inside.then_some(Hit { distance, normal: [0.0, 2.0 * side, 0.0], place_m: [x, z] })
    });
    let flat = |a: Vector, b: Vector| a[0] * b[0] + a[2] * b[2];
    let side = first_root(
        flat(direction, direction),
        flat(origin, direction),
        flat(origin, origin) - radius_m * radius_m,
        |distance| (origin[1] + distance * direction[1]).abs() <= 0.5 * height_m,
    );
    let side = side.map(|distance| {
        let [x, y, z] = along(origin, direction, distance);
        let normal = [x / radius_m, 0.0, z / radius_m];
        Hit { distance, normal, place_m: [radius_m * libm::atan2(x, -z), y] }
    });
    caps.chain(side).min_by(|a, b| a.distance.total_cmp(&b.distance))
}

/// Smallest solution beyond [`NEAREST`] of `a t² + 2 b t + c = 0` that is `wanted`.
fn first_root(a: f64, b: f64, c: f64, wanted: impl Fn(f64) -> bool) -> Option<f64> {
    let root = (b * b - a * c).sqrt();
    [(-b - root) / a, (-b + root) / a].into_iter().find(|&t| t > NEAREST && wanted(t))
}

#[cfg(test)]
mod tests {
    use super::*;

    const EYE: Vector = [0.0, 0.0, -2.0];

    fn distance(form: Form, direction: Vector) -> Option<f64> {
        form.hit(EYE, direction).map(|hit| hit.distance)
    }

    #[test]
    fn forms_are_met_where_they_are() {
        let forward = [0.0, 0.0, 1.0];
        assert_eq!(distance(Form::Rectangle { size_m: [1.0, 1.0] }, forward), Some(2.0));
        assert_eq!(distance(Form::Cuboid { size_m: [1.0, 1.0, 1.0] }, forward), Some(1.5));
        assert_eq!(distance(Form::Sphere { radius_m: 0.5 }, forward), Some(1.5));
        assert_eq!(distance(Form::Cylinder { radius_m: 0.5, height_m: 1.0 }, forward), Some(1.5));
    }

    #[test]
    fn forms_end_where_they_end() {
        let past = [0.3, 0.0, 1.0];
        let over = [0.0, 0.3, 1.0];
        for form in [
            Form::Rectangle { size_m: [1.0, 1.0] },
            Form::Cuboid { size_m: [0.8, 0.8, 0.8] },
            Form::Sphere { radius_m: 0.5 },
            Form::Cylinder { radius_m: 0.5, height_m: 0.8 },
        ] {
            assert_eq!(distance(form, past), None, "{form:?}");
            assert_eq!(distance(form, over), None, "{form:?}");
            assert_eq!(distance(form, [0.0, 0.0, -1.0]), None, "{form:?}");
        }
    }

    #[test]
    fn a_cup_seen_from_above_shows_its_top() {
        let hit = Form::Cylinder { radius_m: 0.5, height_m: 1.0 }.hit([0.0, -2.0, -0.2], [0.0, 1.0, 0.1]);
        let hit = hit.unwrap();
        assert_eq!(hit.normal, [0.0, -1.0, 0.0]);
        assert_eq!(hit.distance, 1.5);
    }

    #[test]
    fn normals_have_unit_length() {
        let direction = [0.05, 0.1, 1.0];
        for form in [Form::Sphere { radius_m: 0.7 }, Form::Cylinder { radius_m: 0.7, height_m: 2.0 }] {
            let normal = form.hit(EYE, direction).unwrap().normal;
            assert!((dot(normal, normal) - 1.0).abs() < 1e-14);
        }
    }
}
