//! The images that the rules are tried on: the scene of both figures, and two changes of it.

use isolux::standardize::{DistanceStep, TimeStep};
use isolux_camera::scene::object::Form;
use isolux_camera::scene::texture::Texture;
use isolux_camera::{Scene, SimulatedFrame};

use super::cases::Case;
use crate::error::ExperimentError;
use crate::measure::{frame_at, simulation_of};
use crate::paper::lab::Lab;

/// The scene of both figures.
const SCENE: &str = "highlights";
/// The reference time: the highlights are at their brightest, and not yet saturated.
const TIME_US: f64 = 8200.0;

/// The images that the rules are tried on.
pub(super) struct Cases {
    pub(super) raw: Case,
    pub(super) standardized: Case,
    pub(super) small_board: Case,
    pub(super) without_highlights: Case,
}

impl Cases {
    pub(super) fn measure(lab: &Lab) -> Result<Self, ExperimentError> {
        let original = frame(lab, |_| {})?;
        let raw =
            |simulated: &SimulatedFrame| Case::measure(lab, simulated, TimeStep::None, DistanceStep::None);
        Ok(Self {
            raw: raw(&original)?,
            standardized: Case::measure(lab, &original, TimeStep::Lut, DistanceStep::Cubic)?,
            small_board: raw(&frame(lab, halve_the_board)?)?,
            without_highlights: raw(&frame(lab, remove_the_gloss)?)?,
        })
    }
}

fn frame(lab: &Lab, change: impl FnOnce(&mut Scene)) -> Result<SimulatedFrame, ExperimentError> {
    let mut scene = Scene::builtin(SCENE)?;
    change(&mut scene);
    frame_at(&simulation_of(scene, lab.seed)?, SCENE, TIME_US)
}

fn halve_the_board(scene: &mut Scene) {
    for object in scene.objects.iter_mut().filter(|object| object.name == "board") {
        if let Form::Rectangle { size_m } = &mut object.form {
            *size_m = size_m.map(|side_m| 0.5 * side_m);
        }
        if let Texture::Bitmap { cell_m, .. } = &mut object.texture {
            *cell_m *= 0.5;
        }
    }
}

fn remove_the_gloss(scene: &mut Scene) {
    scene.objects.iter_mut().for_each(|object| object.highlight = None);
}
