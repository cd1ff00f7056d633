//! Cameras that are built in: the files of `cameras/`, embedded.

use crate::catalogue::Catalogue;
use crate::error::CameraError;
use crate::model::CameraModel;

const PRESETS: Catalogue = Catalogue {
    kind: "camera",
    entries: &[
        ("sr3100", include_str!("../cameras/sr3100.toml")),
        ("kinect2-like", include_str!("../cameras/kinect2-like.toml")),
        ("o3d-like", include_str!("../cameras/o3d-like.toml")),
    ],
};

impl CameraModel {
    /// The preset of that name.
    ///
    /// # Errors
    /// [`CameraError::UnknownName`] with the list of the names.
    pub fn preset(name: &str) -> Result<Self, CameraError> {
        Self::from_toml(&format!("{name}.toml"), Self::preset_toml(name)?)
    }

    /// TOML text of the preset of that name, a pattern for one's own.
    ///
    /// # Errors
    /// [`CameraError::UnknownName`] with the list of the names.
    pub fn preset_toml(name: &str) -> Result<&'static str, CameraError> {
        PRESETS.text(name)
    }

    /// Names of all presets.
    pub fn preset_names() -> impl Iterator<Item = &'static str> {
        PRESETS.names()
    }
}
