//! Scenes that are built in: the files of `scenes/`, embedded.

use crate::catalogue::Catalogue;
use crate::error::CameraError;
use crate::scene::Scene;

macro_rules! files {
    ($($name:literal),* $(,)?) => {
        &[$(($name, include_str!(concat!("../../scenes/", $name, ".toml")))),*]
    };
}

const SCENES: Catalogue = Catalogue {
    kind: "scene",
    entries: files![
        "wall-sweep",
        "wall-sweep-smoke",
        "board-distances",
        "board-distances-smoke",
        "board-distances-unguarded",
        "patches",
        "patches-smoke",
        "target-board",
        "highlights",
        "office-desk",
        "office-shelf",
        "cups",
        "two-boards",
        "hand-held",
        "hand-held-smoke",
        "example",
    ],
};

impl Scene {
    /// The built-in scene of that name.
    ///
    /// # Errors
    /// [`CameraError::UnknownName`] with the list of the names.
    pub fn builtin(name: &str) -> Result<Self, CameraError> {
        Self::from_toml(&format!("{name}.toml"), Self::builtin_toml(name)?)
    }

    /// TOML text of the built-in scene of that name, a pattern for one's own.
    ///
    /// # Errors
    /// [`CameraError::UnknownName`] with the list of the names.
    pub fn builtin_toml(name: &str) -> Result<&'static str, CameraError> {
        SCENES.text(name)
    }

    /// Names of all built-in scenes.
    pub fn builtin_names() -> impl Iterator<Item = &'static str> {
        SCENES.names()
    }
}
