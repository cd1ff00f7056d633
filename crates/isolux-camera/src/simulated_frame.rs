//! A simulated frame and the truth behind it.

use isolux::{Frame, Plane, Shape};

use crate::model::CameraModel;

/// One frame of a simulated recording: what the camera delivers, and what is true. Reuse one for a whole
/// recording: its memory is kept.
#[derive(Clone, Debug, PartialEq)]
pub struct SimulatedFrame {
    /// Raw bins A1..A4, DN, in the paper's order.
    pub phase_samples: [Plane<u16>; 4],
    /// The frame as a reader of the recording would give it: amplitude by eq. 1 from the bins, wrapped radial
    /// distance, intensity (mean of the bins above the black level), integration time, flags, the same bins as
    /// f32, labels, pose.
    pub frame: Frame,
    /// What tests compare with.
    pub truth: Truth,
}

/// What a simulated camera saw, without noise. NaN where a pixel sees nothing.
#[derive(Clone, Debug, PartialEq)]
pub struct Truth {
    /// Radial distance, metres, not wrapped.
    pub true_distance_m: Plane<f32>,
    /// Diffuse reflectivity ρ, 0..1.
    pub reflectivity: Plane<f32>,
    /// Cosine of the angle of incidence, 0..1.
    pub cos_incidence: Plane<f32>,
    /// `(ρ cosθ + highlight) v`: the return relative to a surface of reflectivity 1 that faces the camera on
    /// the axis at the same distance.
    pub return_factor: Plane<f32>,
    /// Share of the highlight in the return, 0..1.
    pub specular_fraction: Plane<f32>,
    /// Amplitude without noise, saturation or quantization, DN; 0 where nothing is seen. Warm-up included.
    pub linear_amplitude: Plane<f32>,
    /// Amplitude without noise and quantization, with saturation, DN. Warm-up included. Dead pixels get the value
    /// of working ones.
    pub noise_free_amplitude: Plane<f32>,
}

impl SimulatedFrame {
    /// A frame of the given shape, to be rendered into.
    #[must_use]
    pub fn new(shape: Shape) -> Self {
        let nan = || Plane::filled(shape, f32::NAN);
        Self {
            phase_samples: [(); 4].map(|()| Plane::filled(shape, 0)),
            frame: Frame::new(shape),
            truth: Truth {
                true_distance_m: nan(),
                reflectivity: nan(),
                cos_incidence: nan(),
                return_factor: nan(),
                specular_fraction: nan(),
                linear_amplitude: nan(),
                noise_free_amplitude: nan(),
            },
        }
    }

    /// Gives every plane the wanted shape.
    pub(crate) fn reshape(&mut self, shape: Shape) {
        self.phase_samples.iter_mut().for_each(|plane| plane.reshape(shape, 0));
        let truth = &mut self.truth;
        for plane in [
            &mut truth.true_distance_m,
            &mut truth.reflectivity,
            &mut truth.cos_incidence,
            &mut truth.return_factor,
            &mut truth.specular_fraction,
            &mut truth.linear_amplitude,
            &mut truth.noise_free_amplitude,
            &mut self.frame.amplitude,
        ] {
            plane.reshape(shape, f32::NAN);
        }
        self.frame.flags.reshape(shape, isolux::PixelFlags::empty());
    }
}

impl Truth {
    /// Amplitude that each pixel would have at the reference integration time and distance in a camera without
    /// saturation, DN: only time and distance are taken out, profile and angle stay. NaN where nothing is seen.
    #[must_use]
    pub fn true_standardized(
        &self,
        model: &CameraModel,
        reference_time_us: f64,
        reference_distance_m: f64,
    ) -> Plane<f32> {
        let unit = unit_amplitude_dn(model, reference_time_us, reference_distance_m);
        scaled(&self.return_factor, unit)
    }

    /// The same with illumination profile, angle and highlights taken out too: proportional to the material's
    /// reflectivity alone, DN.
    #[must_use]
    pub fn true_standardized_material(
        &self,
        model: &CameraModel,
        reference_time_us: f64,
        reference_distance_m: f64,
    ) -> Plane<f32> {
        let unit = unit_amplitude_dn(model, reference_time_us, reference_distance_m);
        scaled(&self.reflectivity, unit)
    }
}

/// Linear amplitude of a surface of reflectivity 1 that faces the camera on the axis, DN.
fn unit_amplitude_dn(model: &CameraModel, time_us: f64, distance_m: f64) -> f64 {
    model.linear_amplitude_dn(model.light(1.0, 0.0, distance_m), time_us)
}

fn scaled(plane: &Plane<f32>, factor: f64) -> Plane<f32> {
    let mut out = plane.clone();
    out.values_mut().iter_mut().for_each(|value| *value = (f64::from(*value) * factor) as f32);
    out
}
