//! Recordings that determine everything, and such that do not.

use isolux_camera::scene::motion::{Motion, Path, Waypoint};
use isolux_camera::scene::object::{Form, Object};
use isolux_camera::scene::run::Run;
use isolux_camera::scene::texture::Texture;
use isolux_camera::{CameraError, Scene};

/// How the camera is used in the room of the scene `hand-held`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RunKind {
    /// Carried through it, integration times in turn: everything can be told.
    HandHeld,
    /// Standing still, one integration time: nothing can be told.
    StillOneTime,
    /// Standing still, several integration times: s alone.
    StillManyTimes,
    /// Turned about its centre: v alone.
    Turning,
    /// Towards a wall that it faces: h; v cannot be told from k.
    TowardsWall,
}

impl RunKind {
    /// All of them.
    pub const ALL: [Self; 5] =
        [Self::HandHeld, Self::StillOneTime, Self::StillManyTimes, Self::Turning, Self::TowardsWall];

    /// In words.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::HandHeld => "carried through a room",
            Self::StillOneTime => "still, one integration time",
            Self::StillManyTimes => "still, several integration times",
            Self::Turning => "turned about its centre",
            Self::TowardsWall => "towards a wall that it faces",
        }
    }

    /// The scene, with so many poses where the camera moves.
    ///
    /// # Errors
    /// [`CameraError`] when the built-in scene is missing, which would be a defect.
    pub fn scene(self, poses: u32) -> Result<Scene, CameraError> {
        let mut scene = Scene::builtin("hand-held")?;
        let times_us = match self {
            Self::HandHeld => {
                scene
                    .runs
                    .iter_mut()
                    .filter_map(|run| run.motion.as_mut())
                    .for_each(|motion| motion.poses = poses);
                return Ok(scene);
            }
            Self::StillManyTimes => vec![2000.0, 4000.0, 8000.0, 10_000.0, 16_000.0],
            Self::StillOneTime | Self::Turning | Self::TowardsWall => vec![10_000.0],
        };
        let motion = |waypoints| {
            let paths = vec![Path { object: "camera".to_owned(), waypoints }];
            Some(Motion { poses, paths })
        };
        let still =
            Run { integration_times_us: times_us, skip_frames: 50, frames_per_time: 3, ..Run::default() };
        scene.runs = vec![match self {
            Self::Turning => Run { motion: motion(turns()), ..still },
            Self::TowardsWall => {
                scene.objects = vec![wall()];
                Run { motion: motion(steps()), ..still }
            }
            Self::HandHeld | Self::StillOneTime | Self::StillManyTimes => still,
        }];
        Ok(scene)
    }
}

fn turns() -> Vec<Waypoint> {
    let turn = |[yaw_deg, tilt_deg, roll_deg]: [f64; 3]| Waypoint {
        yaw_deg,
        tilt_deg,
        roll_deg,
        ..Waypoint::default()
    };
    [
        [0.0, 0.0, 0.0],
        [16.0, 8.0, 10.0],
        [-4.0, 14.0, -20.0],
        [-18.0, -6.0, 15.0],
        [6.0, -14.0, 40.0],
        [0.0, 4.0, 75.0],
    ]
    .map(turn)
    .into()
}

fn steps() -> Vec<Waypoint> {
    [-0.4, 0.3, 1.1, 1.7].map(|z| Waypoint { center_m: [0.0, 0.0, z], ..Waypoint::default() }).into()
}

fn wall() -> Object {
    let texture = Texture::Mosaic { cell_m: 0.24, reflectivities: [0.25, 0.85], seed: 1 };
    Object::new("wall", Form::Rectangle { size_m: [12.0, 12.0] }, [0.0, 0.0, 2.4], texture)
}
