//! Motion of the camera and of objects while a run is recorded.

use serde::{Deserialize, Serialize};

use crate::error::{InvalidValue, ensure};
use crate::scene::pose::Pose;

/// Smooth paths of the camera and of objects. Everything moves from frame to frame: every pose is recorded once,
/// `frames_per_time` poses at the first integration time of the run, as many at the next, and after the last time
/// the first again.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Motion {
    /// Number of poses, evenly spread over the paths, both ends included.
    pub poses: u32,
    /// Paths of everything that moves.
    #[serde(rename = "path")]
    pub paths: Vec<Path>,
}

/// The path of one object, or of the camera.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Path {
    /// Name of the object, or `camera`.
    pub object: String,
    /// Places that it passes at equal intervals of time, the first and the last among them.
    pub waypoints: Vec<Waypoint>,
}

/// A place on a path.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Waypoint {
    /// Centre, metres.
    pub center_m: [f64; 3],
    /// Turn about the vertical, degrees; see [`Pose`].
    #[serde(default)]
    pub yaw_deg: f64,
    /// Turn about the horizontal, degrees.
    #[serde(default)]
    pub tilt_deg: f64,
    /// Turn about the line of sight, degrees.
    #[serde(default)]
    pub roll_deg: f64,
}

impl Waypoint {
    fn coordinates(&self) -> [f64; 6] {
        let [x, y, z] = self.center_m;
        [x, y, z, self.yaw_deg, self.tilt_deg, self.roll_deg]
    }

    fn pose(&self) -> Pose {
        let Self { center_m, yaw_deg, tilt_deg, roll_deg } = *self;
        Pose { center_m, yaw_deg, tilt_deg, roll_deg }
    }
}

impl Path {
    /// The pose at a `share` (0..=1) of the way: the cubic of Catmull and Rom (1974) through the waypoints, whose
    /// speed at each is half the step between its neighbours.
    fn at(&self, share: f64) -> Pose {
        let last = self.waypoints.len() - 1;
        let place = share * last as f64;
        let from = (place as usize).min(last.saturating_sub(1));
        let near = |offset: usize| {
            // The ends are their own neighbours.
            self.waypoints[(from + offset).saturating_sub(1).min(last)].coordinates()
        };
        let [before, start, end, after] = [0, 1, 2, 3].map(near);
        let u = place - from as f64;
        let [x, y, z, yaw_deg, tilt_deg, roll_deg] = [0, 1, 2, 3, 4, 5].map(|i| {
            let (m0, m1) = (0.5 * (end[i] - before[i]), 0.5 * (after[i] - start[i]));
            let rise = end[i] - start[i];
            start[i] + u * (m0 + u * (3.0 * rise - 2.0 * m0 - m1 + u * (m0 + m1 - 2.0 * rise)))
        });
        Pose { center_m: [x, y, z], yaw_deg, tilt_deg, roll_deg }
    }
}

impl Motion {
    /// Pose of every path's object, for each of the poses.
    pub(crate) fn poses(&self) -> impl Iterator<Item = Vec<(&str, Pose)>> {
        let steps = self.poses.saturating_sub(1).max(1);
        (0..self.poses).map(move |pose| {
            let share = f64::from(pose) / f64::from(steps);
            self.paths.iter().map(|path| (path.object.as_str(), path.at(share))).collect()
        })
    }

    pub(crate) fn validate(&self, path: &str, objects: &[&str]) -> Result<(), InvalidValue> {
        let field = |name: &str| format!("{path}.{name}");
        ensure((1..=100_000).contains(&self.poses), || field("poses"), self.poses, "1 to 100000")?;
        for (index, moving) in self.paths.iter().enumerate() {
            let path = field(&format!("path[{index}]"));
            let known = format!("`camera` or the name of an object: {}", objects.join(", "));
            let right = moving.object == "camera" || objects.contains(&moving.object.as_str());
            ensure(right, || format!("{path}.object"), &moving.object, &known)?;
            let twice = self.paths[..index].iter().any(|other| other.object == moving.object);
            ensure(!twice, || format!("{path}.object"), &moving.object, "one path for each object")?;
            let count = moving.waypoints.len();
            let expected = "1 to 100000 places";
            ensure((1..=100_000).contains(&count), || format!("{path}.waypoints"), count, expected)?;
            for (index, waypoint) in moving.waypoints.iter().enumerate() {
                waypoint.pose().validate(&format!("{path}.waypoints[{index}]"))?;
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn path(places: &[[f64; 3]]) -> Path {
        let waypoint = |center_m: &[f64; 3]| Waypoint {
            center_m: *center_m,
            yaw_deg: 10.0 * center_m[0],
            ..Waypoint::default()
        };
        Path { object: "camera".into(), waypoints: places.iter().map(waypoint).collect() }
    }

    #[test]
    fn a_path_passes_its_waypoints_smoothly() {
        let path = path(&[[0.0, 0.0, 0.0], [1.0, 0.5, 0.0], [1.5, -0.5, 0.2], [3.0, 0.0, 0.0]]);
        for (index, waypoint) in path.waypoints.iter().enumerate() {
            let pose = path.at(index as f64 / 3.0);
            for (found, expected) in pose.center_m.iter().zip(waypoint.center_m) {
                assert!((found - expected).abs() < 1e-14);
            }
            assert!((pose.yaw_deg - waypoint.yaw_deg).abs() < 1e-13);
        }
        // One speed on both sides of an inner waypoint: the difference of the slopes goes with the step.
        let step = 1e-6;
        let [before, at, after] = [-step, 0.0, step].map(|offset| path.at(1.0 / 3.0 + offset).center_m[1]);
        assert!((after - 2.0 * at + before).abs() < 100.0 * step * step);
    }

    #[test]
    fn a_single_waypoint_is_a_place() {
        let motion = Motion { poses: 3, paths: vec![path(&[[1.0, 2.0, 3.0]])] };
        let places: Vec<_> = motion.poses().map(|poses| poses[0].1.center_m).collect();
        assert_eq!(places, [[1.0, 2.0, 3.0]; 3]);
    }
}
