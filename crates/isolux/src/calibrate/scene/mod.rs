//! Measuring an ordinary recording without a rig: the same surfaces at several distances, places in the image, angles
//! and integration times, each of a reflectivity that nobody knows (methods, section 4).
//!
//! Every frame is cut into facets (planes through neighbours). Facets that are plain, neither dim nor saturated nor
//! at an edge, become surfaces; later frames look for known surfaces where the camera's motion puts them and take
//! what they see there for the same, if distance and normal agree. Places and normals are means over all frames,
//! because the noise of a single distance would bend the law over distance. One pass; memory is bounded.

mod align;
mod facets;
mod fit;
mod lambert;
mod motion;
mod report;
mod rigid;
mod rows;
mod scatter;
mod scout;
mod surfaces;
#[cfg(test)]
mod tests;
mod view;

pub use motion::{CameraMotion, MotionFinding, MotionObstacle, MotionRefusal, Travel};
pub use report::{SceneReport, SceneUse};
pub use scout::MotionScout;

pub(super) use fit::fit;

use nalgebra::Vector3;

use super::runs::{Place, Runs};
use super::{CalibrateError, CalibrateSettings, ExposureCurve, ExposureSweep};
use crate::frame::{Frame, Intrinsics, Shape};
use crate::terms::Source;
use motion::Path;
use rigid::Rigid;
use surfaces::{Sighting, Surfaces};
use view::{LEAST_COSINE, View};

/// An ordinary recording, measured frame by frame.
#[derive(Clone, Debug)]
pub struct SceneSweep {
    recording: String,
    settings: CalibrateSettings,
    intrinsics: Option<Intrinsics>,
    shape: Option<Shape>,
    runs: Runs,
    frames: usize,
    path: Path,
    surfaces: Surfaces,
    /// A camera that stands still over several times shows each pixel's compression too.
    exposure: Option<ExposureSweep>,
}

/// One amplitude of one surface, with all that it may depend on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SceneObservation {
    /// Number of the surface, from 0: its reflectivity is the same in all its observations.
    pub surface: u32,
    /// Number of the frame, from 0.
    pub frame: u32,
    /// Row and column of the pixel.
    pub pixel: [u32; 2],
    /// Integration time, µs; NaN where it is unknown.
    pub integration_time_us: f64,
    /// ln of the amplitude, DN.
    pub ln_amplitude: f32,
    /// Standard deviation of `ln_amplitude`, from the scatter among neighbours.
    pub sigma: f32,
    /// Radial distance, m.
    pub distance_m: f32,
    /// Cosine of the angle of incidence, 0.2..=1.
    pub cosine: f32,
}

/// What a recording without a rig says.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneObservations {
    /// The recording.
    pub source: Source,
    /// Height and width of its frames.
    pub shape: Shape,
    /// Its pinhole, where it is known.
    pub intrinsics: Option<Intrinsics>,
    /// How the camera moved, or why that could not be told.
    pub motion: MotionFinding,
    /// Every observation of a surface that was seen more than once; none when the motion could not be told.
    pub observations: Vec<SceneObservation>,
    /// The same recording as an exposure sweep, where the camera stood still.
    pub exposure: Option<ExposureCurve>,
}

impl SceneSweep {
    /// Starts a recording; `recording` is the name that errors and the calibration give it. A camera that stands still
    /// needs no intrinsics. [`MotionScout`] tells which `motion` to expect.
    #[must_use]
    pub fn new(
        recording: impl Into<String>,
        settings: &CalibrateSettings,
        intrinsics: Option<Intrinsics>,
        motion: CameraMotion,
    ) -> Self {
        let recording = recording.into();
        // Recorded poses may turn out to be one and the same.
        let may_be_still = motion != CameraMotion::Estimated;
        Self {
            exposure: may_be_still.then(|| ExposureSweep::new(&recording, settings)),
            recording,
            settings: settings.clone(),
            intrinsics: intrinsics.filter(Intrinsics::is_usable),
            shape: None,
            runs: Runs::new(settings.skip_frames),
            frames: 0,
            path: Path::new(motion),
            surfaces: Surfaces::default(),
        }
    }

    /// Measures the next frame.
    ///
    /// # Errors
    /// [`CalibrateError`] when the frame has no distances, planes that do not fit, no rigid pose where poses are said to
    /// be recorded, or a moving camera no intrinsics.
    pub fn push(&mut self, frame: &Frame) -> Result<(), CalibrateError> {
        let number = self.frames;
        self.frames += 1;
        frame.check_shapes().map_err(|source| CalibrateError::Shape { frame: number, source })?;
        let shape = *self.shape.get_or_insert(frame.shape());
        frame
            .amplitude
            .expect_shape("amplitude", shape)
            .map_err(|source| CalibrateError::Shape { frame: number, source })?;
        if frame.distance_m.is_none() {
            return Err(CalibrateError::NoDistance { frame: number });
        }
        let time_us = super::single_time(&frame.integration_time_us).unwrap_or(f64::NAN);
        match &mut self.exposure {
            Some(exposure) if time_us.is_finite() => exposure.push(frame)?,
            // Times that nobody knows tell nothing of the compression.
            _ => self.exposure = None,
        }
        if self.runs.push(time_us) == Place::Settling || self.settings.excludes(time_us) {
            return Ok(());
        }
        let intrinsics = self.pinhole(shape).ok_or(CalibrateError::NoIntrinsics)?;
        let Some(view) = View::new(frame, &intrinsics) else { return Ok(()) };
        if let Some(pose) = self.path.next(number, frame, &view, &mut self.surfaces)? {
            self.surfaces.observe(&view, &pose, number as u32);
        }
        Ok(())
    }

    /// Ends the recording.
    #[must_use]
    pub fn finish(self) -> SceneObservations {
        let shape = self.shape.unwrap_or(Shape::new(0, 0));
        let used = self.path.poses.len();
        let motion = self.path.finding();
        let told = !matches!(motion, MotionFinding::Refused(_));
        let observations = if told { self.observations(shape) } else { Vec::new() };
        let source = Source {
            recording: self.recording,
            frames_used: if told { used } else { 0 },
            frames_left_out: self.frames - if told { used } else { 0 },
        };
        let stands = motion == MotionFinding::Still;
        let exposure = self.exposure.filter(|_| stands).map(ExposureSweep::finish);
        SceneObservations { source, shape, intrinsics: self.intrinsics, motion, observations, exposure }
    }

    /// Where the camera stands still, any pinhole will do: every surface stays in its pixel.
    fn pinhole(&self, shape: Shape) -> Option<Intrinsics> {
        let [height, width] = [shape.height, shape.width].map(|pixels| pixels as f64);
        let any = Intrinsics { fx: width, fy: width, cx: 0.5 * (width - 1.0), cy: 0.5 * (height - 1.0) };
        self.intrinsics.or(self.path.is_still().then_some(any))
    }

    /// Distances and angles from what all frames together say of the surfaces.
    fn observations(&self, shape: Shape) -> Vec<SceneObservation> {
        let places: Vec<(Vector3<f64>, Vector3<f64>)> =
            self.surfaces.surfaces.iter().map(|surface| (surface.point_m(), surface.normal())).collect();
        let mut seen = vec![0u32; places.len()];
        self.surfaces.sightings.iter().for_each(|sighting| seen[sighting.surface as usize] += 1);
        let again = |sighting: &&Sighting| seen[sighting.surface as usize] > 1;
        let Some(intrinsics) = self.pinhole(shape) else { return Vec::new() };
        let observation = |sighting: &Sighting| {
            let pose = self.path.poses.get(&sighting.frame)?;
            let (point_m, normal) = places[sighting.surface as usize];
            observation(sighting, pose, shape, &intrinsics, &point_m, &normal)
        };
        self.surfaces.sightings.iter().filter(again).filter_map(observation).collect()
    }
}

/// The pixel's own ray meets the surface's plane; `None` where it grazes it.
fn observation(
    sighting: &Sighting,
    pose: &Rigid,
    shape: Shape,
    intrinsics: &Intrinsics,
    point_m: &Vector3<f64>,
    normal: &Vector3<f64>,
) -> Option<SceneObservation> {
    let (row, column) = shape.place(sighting.pixel as usize);
    let ray = Vector3::from(intrinsics.ray(row as f64, column as f64)).normalize();
    let cosine = normal.dot(&(pose.rotation * ray));
    let distance_m = normal.dot(&(point_m - pose.translation)) / cosine;
    (cosine >= LEAST_COSINE && distance_m > 0.0).then_some(SceneObservation {
        surface: sighting.surface,
        frame: sighting.frame,
        pixel: [row as u32, column as u32],
        integration_time_us: sighting.integration_time_us,
        ln_amplitude: sighting.ln_amplitude,
        sigma: sighting.sigma,
        distance_m: distance_m as f32,
        cosine: cosine.min(1.0) as f32,
    })
}
