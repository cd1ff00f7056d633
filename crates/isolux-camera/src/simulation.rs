//! A camera before a scene: any frame of the recording, by its index.

use std::f64::consts::TAU;
use std::ops::Range;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use isolux::phase::{SPEED_OF_LIGHT_M_PER_S, amplitude};
use isolux::{IntegrationTime, Plane, Shape};
use rayon::prelude::*;

use crate::error::CameraError;
use crate::model::CameraModel;
use crate::noise::{Noise, Purpose};
use crate::plan::{Plan, PlannedFrame, plan};
use crate::readout::{Readout, dead_pixels};
use crate::scene::Scene;
use crate::simulated_frame::SimulatedFrame;
use crate::view::{Tracer, View};

/// A recording that is made frame by frame, on demand.
///
/// Every frame depends on the model, the scene, the seed and its index alone, bit by bit: not on the machine,
/// the number of threads, or on what was rendered before.
#[derive(Debug)]
pub struct Simulation {
    model: CameraModel,
    scene: Scene,
    seed: u64,
    plan: Plan,
    readout: Readout,
    dead: Vec<bool>,
    views: Mutex<Vec<(usize, Arc<OnceLock<View>>)>>,
}

impl Simulation {
    /// Poses whose geometry is kept. Frames of one pose follow each other, so a few are enough, even with
    /// several threads at work.
    const KEPT_VIEWS: usize = 4;

    /// Prepares the recording of `scene` with the camera `model`. `seed` chooses the noise.
    ///
    /// # Errors
    /// [`CameraError::Value`] when a value of the model or the scene makes no sense or the camera lacks a
    /// register that the scene asks for; [`CameraError::NoFrames`], [`CameraError::TooManyFrames`].
    pub fn new(model: CameraModel, scene: Scene, seed: u64) -> Result<Self, CameraError> {
        model.validate()?;
        scene.validate()?;
        let plan = plan(&model, &scene)?;
        let (readout, dead) = (Readout::new(&model), dead_pixels(&model));
        Ok(Self { model, scene, seed, plan, readout, dead, views: Mutex::new(Vec::new()) })
    }

    /// Number of frames, at least one.
    #[must_use]
    #[expect(clippy::len_without_is_empty, reason = "a simulation without frames is refused by `new`")]
    pub fn len(&self) -> usize {
        self.plan.frames.len()
    }

    /// The camera.
    #[must_use]
    pub fn model(&self) -> &CameraModel {
        &self.model
    }

    /// The scene.
    #[must_use]
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Seed of the noise.
    #[must_use]
    pub fn seed(&self) -> u64 {
        self.seed
    }

    /// Height and width of the frames.
    #[must_use]
    pub fn shape(&self) -> Shape {
        self.model.shape()
    }

    /// What is recorded, frame by frame.
    #[must_use]
    pub fn frames(&self) -> &[PlannedFrame] {
        &self.plan.frames
    }

    /// True where the camera's pixels deliver nothing, row by row.
    #[must_use]
    pub fn dead_pixels(&self) -> &[bool] {
        &self.dead
    }

    /// Renders frame `index` into `out`. Nothing is allocated when `out` held a frame of this shape before and
    /// the pose is one of the last few.
    ///
    /// # Errors
    /// [`CameraError::FrameIndex`] when the recording has fewer frames.
    pub fn render_frame(&self, index: usize, out: &mut SimulatedFrame) -> Result<(), CameraError> {
        let Some(planned) = self.plan.frames.get(index) else {
            return Err(CameraError::FrameIndex { index, length: self.len() });
        };
        let cell = self.view(planned.pose);
        let view = cell.get_or_init(|| self.trace(planned.pose));
        out.reshape(self.shape());
        let exposure = Exposure {
            integration_time_us: planned.integration_time_us,
            drift: self.model.warm_up_factor(planned.frames_since_change),
        };
        self.expose(index as u64, &exposure, view, out);
        copy_truth(&exposure, view, self.model.gain_dn_per_electron, &self.readout, out);
        self.deliver(&exposure, view, out);
        Ok(())
    }

    /// Renders the frames of `indices` into the first ones of `out`, on rayon's threads; `out` grows as needed.
    ///
    /// # Errors
    /// [`CameraError::FrameIndex`] when the recording has fewer frames.
    pub fn render_frames(
        &self,
        indices: Range<usize>,
        out: &mut Vec<SimulatedFrame>,
    ) -> Result<(), CameraError> {
        if indices.end > self.len() {
            return Err(CameraError::FrameIndex { index: indices.end - 1, length: self.len() });
        }
        if out.len() < indices.len() {
            out.resize_with(indices.len(), || SimulatedFrame::new(self.shape()));
        }
        indices
            .into_par_iter()
            .zip(out.par_iter_mut())
            .try_for_each(|(index, out)| self.render_frame(index, out))
    }

    /// The place of a pose's geometry, which its first user fills while the lock is free again.
    fn view(&self, pose: usize) -> Arc<OnceLock<View>> {
        let mut views = self.views.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, view)) = views.iter().find(|(kept, _)| *kept == pose) {
            return Arc::clone(view);
        }
        if views.len() >= Self::KEPT_VIEWS {
            views.remove(0);
        }
        let view = Arc::new(OnceLock::new());
        views.push((pose, Arc::clone(&view)));
        view
    }

    fn trace(&self, pose: usize) -> View {
        Tracer::new(&self.model, &self.scene, &self.plan.settings[pose]).view()
    }

    /// Fills the bins.
    fn expose(&self, frame: u64, exposure: &Exposure, view: &View, out: &mut SimulatedFrame) {
        let width = self.shape().width;
        let [a1, a2, a3, a4] = &mut out.phase_samples;
        let bins = [a1.values_mut(), a2.values_mut(), a3.values_mut(), a4.values_mut()];
        for (row, pixels) in view.pixels.values().chunks(width).enumerate() {
            let mut noise = Noise::new(self.seed, Purpose::Row, frame << 32 | row as u64);
            for (column, pixel) in pixels.iter().enumerate() {
                let index = row * width + column;
                let levels = if self.dead[index] {
                    [0; 4]
                } else {
                    self.readout.bins(exposure.electrons(pixel.rates), exposure.drift, &mut noise)
                };
                for k in 0..4 {
                    bins[k][index] = levels[k];
                }
            }
        }
    }

    /// Fills the frame from the bins, as a camera's own software would.
    fn deliver(&self, exposure: &Exposure, view: &View, out: &mut SimulatedFrame) {
        let shape = self.shape();
        let frame = &mut out.frame;
        let distance_m = plane(&mut frame.distance_m, shape, f32::NAN);
        let intensity = plane(&mut frame.intensity, shape, f32::NAN);
        let target = plane(&mut frame.target, shape, 0);
        let [f1, f2, f3, f4] =
            frame.phase_samples.get_or_insert_with(|| [(); 4].map(|()| Plane::filled(shape, 0.0)));
        let floats = [f1, f2, f3, f4].map(|plane| {
            plane.reshape(shape, 0.0);
            plane.values_mut()
        });
        let [a1, a2, a3, a4] = out.phase_samples.each_ref().map(Plane::values);
        for (index, pixel) in view.pixels.values().iter().enumerate() {
            let levels = [a1[index], a2[index], a3[index], a4[index]];
            let bins = levels.map(f32::from);
            for k in 0..4 {
                floats[k][index] = bins[k];
            }
            let saturated = self.readout.is_saturated(levels);
            let code = self.model.saturated_amplitude.filter(|_| saturated);
            frame.amplitude.values_mut()[index] = code.unwrap_or_else(|| amplitude(bins));
            distance_m[index] = if code.is_some() {
                f32::NAN
            } else {
                distance_of(levels, self.model.modulation_frequency_hz)
            };
            let sum = bins[0] + bins[1] + bins[2] + bins[3];
            intensity[index] = 0.25 * sum - self.model.black_level_dn as f32;
            target[index] = pixel.target;
        }
        frame.integration_time_us = IntegrationTime::PerFrame(exposure.integration_time_us);
        frame.world_from_camera = Some(view.world_from_camera);
        frame.flags.fill(isolux::PixelFlags::empty());
        frame.flag_amplitude(self.model.saturated_amplitude);
    }
}

/// What makes one frame differ from another of the same view, besides the noise.
struct Exposure {
    integration_time_us: f64,
    /// Gain relative to the settled camera's.
    drift: f64,
}

impl Exposure {
    fn electrons(&self, rates: [f64; 4]) -> [f64; 4] {
        rates.map(|rate| self.integration_time_us * rate)
    }
}

/// Radial distance in metres as [`isolux::phase::distance_m`] has it, but with `libm`'s arc tangent, whose bits
/// are the same on every machine; NaN where the bins carry no modulation.
fn distance_of(levels: [u16; 4], modulation_frequency_hz: f64) -> f32 {
    let [a1, a2, a3, a4] = levels.map(f64::from);
    if a1 == a3 && a2 == a4 {
        return f32::NAN;
    }
    let phase = libm::atan2(a2 - a4, a1 - a3);
    let phase = if phase < 0.0 { phase + TAU } else { phase };
    (SPEED_OF_LIGHT_M_PER_S * phase / (2.0 * TAU * modulation_frequency_hz)) as f32
}

fn plane<T: Copy>(slot: &mut Option<Plane<T>>, shape: Shape, value: T) -> &mut [T] {
    let plane = slot.get_or_insert_with(|| Plane::filled(shape, value));
    plane.reshape(shape, value);
    plane.values_mut()
}

fn copy_truth(
    exposure: &Exposure,
    view: &View,
    gain_dn_per_electron: f64,
    readout: &Readout,
    out: &mut SimulatedFrame,
) {
    let truth = &mut out.truth;
    let to_dn = exposure.drift * gain_dn_per_electron * exposure.integration_time_us;
    for (index, pixel) in view.pixels.values().iter().enumerate() {
        truth.true_distance_m.values_mut()[index] = pixel.distance_m;
        truth.reflectivity.values_mut()[index] = pixel.reflectivity;
        truth.cos_incidence.values_mut()[index] = pixel.cos_incidence;
        truth.return_factor.values_mut()[index] = pixel.return_factor;
        truth.specular_fraction.values_mut()[index] = pixel.specular_fraction;
        truth.linear_amplitude.values_mut()[index] = (to_dn * pixel.amplitude_rate) as f32;
        truth.noise_free_amplitude.values_mut()[index] =
            readout.noise_free_amplitude_dn(exposure.electrons(pixel.rates), exposure.drift) as f32;
    }
}
