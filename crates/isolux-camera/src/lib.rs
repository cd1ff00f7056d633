//! A simulated time-of-flight camera, and scenes for it.
//!
//! The camera follows the physics of a four-bin pixel from the light source to the converter: see
//! [`CameraModel`]. A [`Scene`] says what stands before it and which frames are recorded. A [`Simulation`]
//! renders any frame by its index, with the truth beside it; the same seed gives the same bits on every machine
//! and any number of threads.
//!
//! What a calibration finds can be compared with the camera's own laws:
//!
//! | fitted | truth |
//! |---|---|
//! | distance term | [`CameraModel::distance_response`], [`CameraModel::led_decay`], [`CameraModel::harmonic_factor`] |
//! | illumination profile | [`CameraModel::illumination_profile`] |
//! | time response | [`CameraModel::noise_free_amplitude_dn`], [`FullWell`] |
//! | noise | [`CameraModel::bin_noise_electrons`] |
//! | standardized amplitude | [`Truth::true_standardized`], [`Truth::true_standardized_material`] |
//!
//! ```
//! use isolux_camera::{CameraModel, Scene, SimulatedFrame, Simulation};
//!
//! let scene = Scene::builtin("wall-sweep-smoke")?;
//! let model = CameraModel::preset(&scene.camera)?;
//! let simulation = Simulation::new(model, scene, 1)?;
//! let mut out = SimulatedFrame::new(simulation.shape());
//! simulation.render_frame(0, &mut out)?;
//! assert_eq!(out.frame.amplitude.shape(), simulation.shape());
//! # Ok::<(), isolux_camera::CameraError>(())
//! ```
mod catalogue;
mod document;
mod error;
mod full_well;
mod model;
mod noise;
mod optics;
mod pixel;
mod plan;
mod presets;
mod random_camera;
mod readout;
pub mod scene;
mod simulated_frame;
mod simulation;
mod view;

pub use error::{CameraError, InvalidValue};
pub use full_well::FullWell;
pub use model::{CameraModel, IntegrationRegister};
pub use pixel::PixelLight;
pub use plan::PlannedFrame;
pub use scene::Scene;
pub use simulated_frame::{SimulatedFrame, Truth};
pub use simulation::Simulation;
