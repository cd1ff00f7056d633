//! Measures an ordinary recording, frame by frame: every amplitude of every surface that is seen more than once.

use nalgebra::Vector3;

use super::motion::{CameraMotion, MotionFinding, Path};
use super::rigid::Rigid;
use super::surfaces::{Sighting, Surfaces};
use super::view::{LEAST_COSINE, View};
use crate::calibrate::exposure::{ExposureCurve, ExposureSweep};
use crate::calibrate::sweep_frames::{SweepFrames, single_time};
use crate::calibrate::{CalibrateSettings, MeasureError};
use crate::frame::{Frame, Intrinsics, Lens, PixelRays, Shape};
use crate::terms::Source;

/// An ordinary recording, measured frame by frame.
#[derive(Clone, Debug)]
pub struct SceneSweep {
    frames: SweepFrames,
    lens: Option<Lens>,
    /// Of all pixels, as soon as the shape is known.
    rays: Option<PixelRays>,
    shape: Option<Shape>,
    pub(super) path: Path,
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

/// The result of an ordinary recording.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneObservations {
    /// The recording.
    pub source: Source,
    /// Height and width of its frames.
    pub shape: Shape,
    /// Its lens, where it is known.
    pub lens: Option<Lens>,
    /// How the camera moved, or why that could not be estimated.
    pub motion: MotionFinding,
    /// Every observation of a surface that was seen more than once; empty when the motion is unknown.
    pub observations: Vec<SceneObservation>,
    /// The same recording as an exposure sweep, where the camera stood still.
    pub exposure: Option<ExposureCurve>,
}

impl SceneSweep {
    /// Starts a recording; `recording` is its name in errors and in the calibration. A camera that stands still
    /// needs no lens. [`MotionScout`](super::MotionScout) finds out which `motion` to pass.
    #[must_use]
    pub fn new(
        recording: impl Into<String>,
        settings: &CalibrateSettings,
        lens: Option<Lens>,
        motion: CameraMotion,
    ) -> Self {
        let recording = recording.into();
        // Recorded poses may turn out to be one and the same.
        let may_be_still = motion != CameraMotion::Estimated;
        Self {
            exposure: may_be_still.then(|| ExposureSweep::new(&recording, settings)),
            frames: SweepFrames::new(recording, settings),
            lens: lens.filter(Lens::is_usable),
            rays: None,
            shape: None,
            path: Path::new(motion),
            surfaces: Surfaces::default(),
        }
    }

    /// Measures the next frame.
    ///
    /// # Errors
    /// [`MeasureError`] when the frame has no distances, planes of different shapes, or no rigid pose although
    /// poses were announced; or when a moving camera has no lens, one that does not fit its frames, or only a table of
    /// rays.
    pub fn push(&mut self, frame: &Frame) -> Result<(), MeasureError> {
        let number = self.frames.next(frame)?;
        let shape = *self.shape.get_or_insert(frame.shape());
        frame
            .amplitude
            .expect_shape("amplitude", shape)
            .map_err(|source| MeasureError::Shape { frame: number, source })?;
        if frame.distance_m.is_none() {
            return Err(MeasureError::NoDistance { frame: number });
        }
        let time_us = single_time(&frame.integration_time_us).unwrap_or(f64::NAN);
        match &mut self.exposure {
            Some(exposure) if time_us.is_finite() => exposure.push(frame)?,
            // Without known times, the saturation cannot be determined.
            _ => self.exposure = None,
        }
        if self.frames.place(time_us).is_none() {
            return Ok(());
        }
        let lens = self.lens_of(shape).ok_or(MeasureError::NoIntrinsics)?;
        if !lens.can_project() && !self.path.is_still() {
            return Err(MeasureError::OnlyRays);
        }
        let rays = match self.rays.take() {
            Some(rays) => rays,
            None => {
                lens.check_shape(shape).map_err(|source| MeasureError::Lens { frame: number, source })?;
                lens.pixel_rays(shape)
            }
        };
        let rays = self.rays.insert(rays);
        let Some(view) = View::new(frame, &lens, rays) else { return Ok(()) };
        if let Some(pose) = self.path.next(number, frame, &view, &mut self.surfaces)? {
            self.surfaces.observe(&view, &pose, number as u32);
        }
        Ok(())
    }

    /// Ends the recording.
    #[must_use]
    pub fn finish(self) -> SceneObservations {
        let shape = self.shape.unwrap_or(Shape::new(0, 0));
        let motion = self.path.finding();
        let told = !matches!(motion, MotionFinding::Refused(_));
        let observations = if told { self.observations(shape) } else { Vec::new() };
        let source = self.frames.source(if told { self.path.poses.len() } else { 0 });
        let stands = motion == MotionFinding::Still;
        let exposure = self.exposure.filter(|_| stands).map(ExposureSweep::finish);
        SceneObservations { source, shape, lens: self.lens, motion, observations, exposure }
    }

    /// Where the camera stands still, any pinhole will do: every surface stays in its pixel.
    fn lens_of(&self, shape: Shape) -> Option<Lens> {
        let [height, width] = [shape.height, shape.width].map(|pixels| pixels as f64);
        let any = Intrinsics { fx: width, fy: width, cx: 0.5 * (width - 1.0), cy: 0.5 * (height - 1.0) };
        let still = self.path.is_still();
        let own = self.lens.clone().filter(|lens| lens.can_project() || !still);
        own.or(still.then_some(Lens::Pinhole(any)))
    }

    /// The observations, with distances and angles from the mean surfaces of all frames.
    fn observations(&self, shape: Shape) -> Vec<SceneObservation> {
        let places: Vec<(Vector3<f64>, Vector3<f64>)> =
            self.surfaces.surfaces.iter().map(|surface| (surface.point_m(), surface.normal())).collect();
        let mut seen = vec![0u32; places.len()];
        self.surfaces.sightings.iter().for_each(|sighting| seen[sighting.surface as usize] += 1);
        let again = |sighting: &&Sighting| seen[sighting.surface as usize] > 1;
        let Some(rays) = &self.rays else { return Vec::new() };
        let observation = |sighting: &Sighting| {
            let pose = self.path.poses.get(&sighting.frame)?;
            let (point_m, normal) = places[sighting.surface as usize];
            observation(sighting, pose, shape, rays, &point_m, &normal)
        };
        self.surfaces.sightings.iter().filter(again).filter_map(observation).collect()
    }
}

/// The pixel's own ray meets the surface's plane; `None` where it grazes it.
fn observation(
    sighting: &Sighting,
    pose: &Rigid,
    shape: Shape,
    rays: &PixelRays,
    point_m: &Vector3<f64>,
    normal: &Vector3<f64>,
) -> Option<SceneObservation> {
    let [row, column] = [sighting.pixel as usize / shape.width, sighting.pixel as usize % shape.width];
    let ray = Vector3::from(rays.ray(row, column)).normalize();
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
