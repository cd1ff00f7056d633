//! Where an object or the camera is, and how it is turned.

use crate::error::{InvalidValue, ensure};

/// A vector or point: x to the right, y down, z forward.
pub(crate) type Vector = [f64; 3];

pub(crate) fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(crate) fn along(origin: Vector, direction: Vector, distance: f64) -> Vector {
    [0, 1, 2].map(|axis| origin[axis] + distance * direction[axis])
}

pub(crate) fn normalized(vector: Vector) -> Vector {
    let length = dot(vector, vector).sqrt();
    vector.map(|component| component / length)
}

/// Centre and turn: first roll about z, then tilt about x, then yaw about y (right-handed; y points down).
/// Unturned, a rectangle faces a camera at the origin and a cylinder stands upright. Positive yaw turns a
/// camera to its right, positive tilt upwards, positive roll clockwise.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pose {
    /// Centre, metres.
    pub center_m: [f64; 3],
    /// Turn about the vertical, degrees.
    pub yaw_deg: f64,
    /// Turn about the horizontal, degrees.
    pub tilt_deg: f64,
    /// Turn about the line of sight, degrees.
    pub roll_deg: f64,
}

impl Pose {
    pub(crate) fn validate(&self, path: &str) -> Result<(), InvalidValue> {
        let right = self.center_m.iter().all(|value| value.abs() <= 1e6);
        ensure(right, || format!("{path}.center_m"), self.center_m, "three numbers of metres, [x, y, z]")?;
        for (name, value) in
            [("yaw_deg", self.yaw_deg), ("tilt_deg", self.tilt_deg), ("roll_deg", self.roll_deg)]
        {
            ensure(value.abs() <= 3600.0, || format!("{path}.{name}"), value, "a number of degrees")?;
        }
        Ok(())
    }

    pub(crate) fn frame(&self) -> RigidFrame {
        let [(yaw_sin, yaw_cos), (tilt_sin, tilt_cos), (roll_sin, roll_cos)] =
            [self.yaw_deg, self.tilt_deg, self.roll_deg].map(|degrees| libm::sincos(degrees.to_radians()));
        let tilt_roll = [
            [roll_cos, -roll_sin, 0.0],
            [tilt_cos * roll_sin, tilt_cos * roll_cos, -tilt_sin],
            [tilt_sin * roll_sin, tilt_sin * roll_cos, tilt_cos],
        ];
        let [x, y, z] = tilt_roll;
        let mix = |a: f64, b: f64| [0, 1, 2].map(|column| a * x[column] + b * z[column]);
        RigidFrame { rotation: [mix(yaw_cos, yaw_sin), y, mix(-yaw_sin, yaw_cos)], center_m: self.center_m }
    }
}

/// A pose, ready to transform: world = rotation · local + centre.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RigidFrame {
    rotation: [Vector; 3],
    center_m: Vector,
}

impl RigidFrame {
    pub(crate) fn center_m(&self) -> Vector {
        self.center_m
    }

    pub(crate) fn direction_to_world(&self, local: Vector) -> Vector {
        self.rotation.map(|row| dot(row, local))
    }

    pub(crate) fn direction_to_local(&self, world: Vector) -> Vector {
        let [x, y, z] = self.rotation;
        [0, 1, 2].map(|axis| x[axis] * world[0] + y[axis] * world[1] + z[axis] * world[2])
    }

    pub(crate) fn point_to_local(&self, world: Vector) -> Vector {
        self.direction_to_local([0, 1, 2].map(|axis| world[axis] - self.center_m[axis]))
    }

    /// Row-major 4×4 transform from local to world coordinates.
    pub(crate) fn matrix(&self) -> [[f64; 4]; 4] {
        let row = |axis: usize| {
            [self.rotation[axis][0], self.rotation[axis][1], self.rotation[axis][2], self.center_m[axis]]
        };
        [row(0), row(1), row(2), [0.0, 0.0, 0.0, 1.0]]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(found: Vector, expected: Vector) -> bool {
        found.iter().zip(expected).all(|(found, expected)| (found - expected).abs() < 1e-15)
    }

    #[test]
    fn turns_go_the_documented_way() {
        let forward = [0.0, 0.0, 1.0];
        let turn =
            |yaw_deg, tilt_deg, roll_deg| Pose { yaw_deg, tilt_deg, roll_deg, ..Pose::default() }.frame();
        assert!(close(turn(90.0, 0.0, 0.0).direction_to_world(forward), [1.0, 0.0, 0.0]));
        assert!(close(turn(0.0, 90.0, 0.0).direction_to_world(forward), [0.0, -1.0, 0.0]));
        assert!(close(turn(0.0, 0.0, 90.0).direction_to_world([1.0, 0.0, 0.0]), [0.0, 1.0, 0.0]));
    }

    #[test]
    fn local_and_world_are_inverse() {
        let frame =
            Pose { center_m: [1.0, -2.0, 3.0], yaw_deg: 20.0, tilt_deg: -35.0, roll_deg: 50.0 }.frame();
        let local = [0.3, -0.4, 0.5];
        assert!(close(frame.direction_to_local(frame.direction_to_world(local)), local));
        let world = along(frame.center_m(), frame.direction_to_world(local), 1.0);
        assert!(frame.point_to_local(world).iter().zip(local).all(|(a, b)| (a - b).abs() < 1e-14));
    }
}
