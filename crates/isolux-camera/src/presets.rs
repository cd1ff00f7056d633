//! Cameras that are built in.

use crate::error::CameraError;
use crate::model::CameraModel;

/// Name and TOML text of every preset camera.
const PRESETS: [(&str, &str); 3] = [
    ("sr3100", include_str!("../cameras/sr3100.toml")),
    ("kinect2-like", include_str!("../cameras/kinect2-like.toml")),
    ("o3d-like", include_str!("../cameras/o3d-like.toml")),
];

impl CameraModel {
    /// The preset of that name.
    ///
    /// # Errors
    /// [`CameraError::UnknownName`] with the list of the names.
    pub fn preset(name: &str) -> Result<Self, CameraError> {
        let text = Self::preset_toml(name)?;
        Self::from_toml(&format!("{name}.toml"), text)
    }

    /// TOML text of the preset of that name, a pattern for one's own.
    ///
    /// # Errors
    /// [`CameraError::UnknownName`] with the list of the names.
    pub fn preset_toml(name: &str) -> Result<&'static str, CameraError> {
        let found = PRESETS.iter().find(|(preset, _)| *preset == name);
        found.map(|(_, text)| *text).ok_or_else(|| CameraError::UnknownName {
            kind: "camera",
            found: name.to_owned(),
            known: Self::preset_names().collect::<Vec<_>>().join(", "),
        })
    }

    /// Names of all presets.
    pub fn preset_names() -> impl Iterator<Item = &'static str> {
        PRESETS.iter().map(|(name, _)| *name)
    }
}
