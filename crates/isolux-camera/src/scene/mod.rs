//! Scenes: objects, light, and the recording that is made of them.

pub mod builtin;
pub mod motion;
pub mod object;
pub mod pose;
pub mod run;
pub(crate) mod solid;
pub mod texture;

use serde::{Deserialize, Serialize};

use crate::document;
use crate::error::{CameraError, InvalidValue, ensure};
use object::Object;
use run::Run;

/// Objects, ambient light, and the recording that is made of them. The TOML form is what `scenes/*.toml` of
/// this crate show; unknown fields are refused.
///
/// World coordinates are those of the camera in its first pose: x to the right, y down, z forward, metres.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Scene {
    /// Version of the file format: 1.
    pub version: i64,
    /// Name of the scene.
    pub name: String,
    /// One sentence about the scene.
    #[serde(default)]
    pub description: String,
    /// Name of the preset camera that the scene is made for.
    #[serde(default = "default_camera")]
    pub camera: String,
    /// Ambient light on a surface of reflectivity 1, relative to the active light at 1 m on the axis. It is
    /// reflected by the objects and falls off with the lens; where nothing stands, the surroundings send as
    /// much as a surface of reflectivity 1.
    #[serde(default)]
    pub ambient: f64,
    /// Objects; of several in a line the nearest is seen.
    #[serde(default, rename = "object")]
    pub objects: Vec<Object>,
    /// What is recorded, one run after the other.
    #[serde(rename = "run")]
    pub runs: Vec<Run>,
}

fn default_camera() -> String {
    "sr3100".to_owned()
}

impl Scene {
    /// Reads a scene from the TOML `text` of the file called `document` (the name is used in errors only).
    ///
    /// # Errors
    /// [`CameraError::Document`] for bad syntax, missing or unknown fields, [`CameraError::Value`] for values
    /// that make no sense, both with the line; [`CameraError::Version`] for a newer format.
    pub fn from_toml(document: &str, text: &str) -> Result<Self, CameraError> {
        let scene: Self = document::parse(document, text)?;
        scene.validate().map_err(|invalid| document::locate(document, text, invalid))?;
        Ok(scene)
    }

    /// Refuses values that make no sense by themselves. What depends on the camera (registers) is checked when
    /// a simulation is made.
    ///
    /// # Errors
    /// [`InvalidValue`] names the first field, its value and what is expected.
    pub fn validate(&self) -> Result<(), InvalidValue> {
        ensure(self.version == document::VERSION, || "version".into(), self.version, "1")?;
        ensure(!self.name.trim().is_empty(), || "name".into(), &self.name, "a name")?;
        ensure((0.0..=1e6).contains(&self.ambient), || "ambient".into(), self.ambient, "0 to 1e6")?;
        ensure(!self.runs.is_empty(), || "run".into(), self.runs.len(), "at least one [[run]]")?;
        for (index, object) in self.objects.iter().enumerate() {
            object.validate(&format!("object[{index}]"))?;
            let twice = self.objects[..index].iter().any(|other| other.name == object.name);
            let field = || format!("object[{index}].name");
            ensure(!twice, field, &object.name, "a name that no other object has")?;
        }
        let names: Vec<&str> = self.objects.iter().map(|object| object.name.as_str()).collect();
        self.runs
            .iter()
            .enumerate()
            .try_for_each(|(index, run)| run.validate(&format!("run[{index}]"), &names))
    }
}
