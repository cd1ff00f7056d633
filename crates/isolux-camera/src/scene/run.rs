//! Which frames are recorded of a scene.

use serde::{Deserialize, Serialize};

use crate::error::{InvalidValue, ensure};
use crate::scene::motion::Motion;
use crate::scene::pose::Pose;

/// Frames of every integration time in every pose: the poses one after the other, in each of them the
/// integration times one after the other.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Run {
    /// Integration times, µs. Either these or `registers`.
    pub integration_times_us: Vec<f64>,
    /// Integration times by the camera's register.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub registers: Option<RegisterRange>,
    /// Frames that are recorded after each change of pose or integration time.
    pub frames_per_time: u32,
    /// Frames that pass unrecorded before them, while the camera settles.
    pub skip_frames: u32,
    /// Poses that the run goes through: one object at several distances.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub approach: Option<Approach>,
    /// Poses that the run goes through, after those of `approach`; without either, everything stays in place.
    #[serde(rename = "pose")]
    pub moves: Vec<Move>,
    /// Camera and objects on the move, instead of poses in which everything stands still.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub motion: Option<Motion>,
    /// Leave out what is over-saturated: an integration time is recorded only in poses where no bin of the
    /// 20×20 pixels at the image's centre is expected to reach the hard clip.
    pub skip_over_saturated: bool,
}

impl Default for Run {
    /// One frame, without integration times.
    fn default() -> Self {
        Self {
            integration_times_us: Vec::new(),
            registers: None,
            frames_per_time: 1,
            skip_frames: 0,
            approach: None,
            moves: Vec::new(),
            motion: None,
            skip_over_saturated: false,
        }
    }
}

/// Registers `first`, `first + step`, … up to `last`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RegisterRange {
    /// First register.
    pub first: u32,
    /// Last register, included if the steps meet it.
    pub last: u32,
    /// From register to register, 1 when it is left out.
    #[serde(default = "one")]
    pub step: u32,
}

fn one() -> u32 {
    1
}

/// One object, moved along the optical axis.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Approach {
    /// Name of the object.
    pub object: String,
    /// Depth z of its centre in each pose, metres.
    pub distances_m: Vec<f64>,
}

/// One object, or the camera, put elsewhere. What is left out stays as the object has it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Move {
    /// Name of the object, or `camera`.
    pub object: String,
    /// Centre, metres.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub center_m: Option<[f64; 3]>,
    /// Turn about the vertical, degrees.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub yaw_deg: Option<f64>,
    /// Turn about the horizontal, degrees.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tilt_deg: Option<f64>,
    /// Turn about the line of sight, degrees.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub roll_deg: Option<f64>,
}

impl Move {
    /// `pose`, changed.
    #[must_use]
    pub fn apply(&self, pose: Pose) -> Pose {
        Pose {
            center_m: self.center_m.unwrap_or(pose.center_m),
            yaw_deg: self.yaw_deg.unwrap_or(pose.yaw_deg),
            tilt_deg: self.tilt_deg.unwrap_or(pose.tilt_deg),
            roll_deg: self.roll_deg.unwrap_or(pose.roll_deg),
        }
    }
}

impl Run {
    /// Most poses or integration times that one run may list.
    const LIMIT: usize = 100_000;

    pub(crate) fn validate(&self, path: &str, objects: &[&str]) -> Result<(), InvalidValue> {
        self.validate_times(path)?;
        let count = self.frames_per_time;
        ensure((1..=100_000).contains(&count), || format!("{path}.frames_per_time"), count, "1 to 100000")?;
        if let Some(Approach { object, distances_m }) = &self.approach {
            let known = format!("the name of an object: {}", objects.join(", "));
            let field = |name: &str| format!("{path}.approach.{name}");
            ensure(objects.contains(&object.as_str()), || field("object"), object, &known)?;
            let right = (1..=Self::LIMIT).contains(&distances_m.len())
                && distances_m.iter().all(|distance| (1e-3..=1e6).contains(distance));
            ensure(right, || field("distances_m"), distances_m, "a list of numbers from 0.001 to 1e6 m")?;
        }
        for (index, pose) in self.moves.iter().enumerate() {
            let path = format!("{path}.pose[{index}]");
            let known = format!("`camera` or the name of an object: {}", objects.join(", "));
            let right = pose.object == "camera" || objects.contains(&pose.object.as_str());
            ensure(right, || format!("{path}.object"), &pose.object, &known)?;
            pose.apply(Pose::default()).validate(&path)?;
        }
        let Some(motion) = &self.motion else { return Ok(()) };
        let alone = self.approach.is_none() && self.moves.is_empty();
        ensure(
            alone,
            || format!("{path}.motion"),
            "beside other poses",
            "`motion`, or `approach` and `pose`",
        )?;
        motion.validate(&format!("{path}.motion"), objects)
    }

    fn validate_times(&self, path: &str) -> Result<(), InvalidValue> {
        let times = &self.integration_times_us;
        let either = times.is_empty() == self.registers.is_some() && times.len() <= Self::LIMIT;
        let field = || format!("{path}.integration_times_us");
        ensure(either, field, times, "a list of times in µs, or else `registers`, not both")?;
        let right = times.iter().all(|time| (1e-3..=1e9).contains(time));
        ensure(right, field, times, "times from 0.001 to 1e9 µs")?;
        let Some(range) = self.registers else { return Ok(()) };
        let right = range.step > 0 && range.first <= range.last;
        ensure(right, || format!("{path}.registers"), range, "first ≤ last and step ≥ 1")
    }
}
