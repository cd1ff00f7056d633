//! Scenes that are built in: the files of `scenes/`, embedded.

use crate::error::CameraError;
use crate::scene::Scene;

macro_rules! scenes {
    ($($name:literal),* $(,)?) => {
        /// Name and TOML text of every built-in scene.
        const SCENES: &[(&str, &str)] = &[$(($name, include_str!(concat!("../../scenes/", $name, ".toml")))),*];
    };
}

scenes![
    "example",
    "wall-sweep",
    "wall-sweep-smoke",
    "board-distances",
    "board-distances-smoke",
    "board-distances-unguarded",
    "patches",
    "patches-smoke",
    "highlights",
    "office-desk",
    "office-shelf",
    "cups",
    "two-boards",
];

impl Scene {
    /// The built-in scene of that name.
    ///
    /// # Errors
    /// [`CameraError::UnknownName`] with the list of the names.
    pub fn builtin(name: &str) -> Result<Self, CameraError> {
        let text = Self::builtin_toml(name)?;
        Self::from_toml(&format!("{name}.toml"), text)
    }

    /// TOML text of the built-in scene of that name, a pattern for one's own.
    ///
    /// # Errors
    /// [`CameraError::UnknownName`] with the list of the names.
    pub fn builtin_toml(name: &str) -> Result<&'static str, CameraError> {
        let found = SCENES.iter().find(|(scene, _)| *scene == name);
        found.map(|(_, text)| *text).ok_or_else(|| CameraError::UnknownName {
            kind: "scene",
            found: name.to_owned(),
            known: Self::builtin_names().collect::<Vec<_>>().join(", "),
        })
    }

    /// Names of all built-in scenes.
    pub fn builtin_names() -> impl Iterator<Item = &'static str> {
        SCENES.iter().map(|(name, _)| *name)
    }
}
