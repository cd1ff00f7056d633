//! One object: form, place, surface.

use serde::{Deserialize, Serialize};

use crate::error::{InvalidValue, ensure};
use crate::scene::pose::Pose;
use crate::scene::texture::Texture;

/// A body with a surface.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Object {
    /// Name, by which runs move it; no two objects share one. `camera` is the camera's.
    pub name: String,
    /// Form and size.
    pub form: Form,
    /// Centre, metres.
    pub center_m: [f64; 3],
    /// Turn about the vertical, degrees; see [`Pose`].
    #[serde(default)]
    pub yaw_deg: f64,
    /// Turn about the horizontal, degrees.
    #[serde(default)]
    pub tilt_deg: f64,
    /// Turn about the line of sight, degrees.
    #[serde(default)]
    pub roll_deg: f64,
    /// Reflectivity over the surface.
    pub texture: Texture,
    /// Gloss, if any.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub highlight: Option<Highlight>,
    /// Calibration label: pixels of one label > 0 are one material, 0 is unused. On a `patches` texture the
    /// label of the first patch; the others count on, and the border has none.
    #[serde(default)]
    pub target: u8,
}

/// Form of an object, about its centre, before it is turned.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Form {
    /// A flat board or wall in the x–y plane, seen from both sides.
    Rectangle {
        /// Width and height, metres.
        size_m: [f64; 2],
    },
    /// A box.
    Cuboid {
        /// Width, height and depth, metres.
        size_m: [f64; 3],
    },
    /// A ball.
    Sphere {
        /// Radius, metres.
        radius_m: f64,
    },
    /// A closed cylinder about the vertical.
    Cylinder {
        /// Radius, metres.
        radius_m: f64,
        /// Height, metres.
        height_m: f64,
    },
}

/// Specular lobe of a glossy surface. The light sits at the camera, so the highlight appears where the surface
/// faces it: `k_s cosθ^n` is added to `ρ cosθ`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Highlight {
    /// k_s: brightness of the highlight's peak; a white surface has 1.
    pub strength: f64,
    /// n: the larger, the smaller the spot.
    pub exponent: f64,
}

impl Object {
    /// A matt object without label, facing the camera, for scenes that are made in a program.
    #[must_use]
    pub fn new(name: &str, form: Form, center_m: [f64; 3], texture: Texture) -> Self {
        Self {
            name: name.to_owned(),
            form,
            center_m,
            yaw_deg: 0.0,
            tilt_deg: 0.0,
            roll_deg: 0.0,
            texture,
            highlight: None,
            target: 0,
        }
    }

    /// Where the object is.
    #[must_use]
    pub fn pose(&self) -> Pose {
        Pose {
            center_m: self.center_m,
            yaw_deg: self.yaw_deg,
            tilt_deg: self.tilt_deg,
            roll_deg: self.roll_deg,
        }
    }

    pub(crate) fn validate(&self, path: &str) -> Result<(), InvalidValue> {
        let named = !self.name.trim().is_empty() && self.name != "camera";
        ensure(named, || format!("{path}.name"), &self.name, "a name other than `camera`")?;
        self.pose().validate(path)?;
        self.form.validate(&format!("{path}.form"))?;
        self.texture.validate(&format!("{path}.texture"), self.target)?;
        let Some(Highlight { strength, exponent }) = self.highlight else { return Ok(()) };
        let field = |name: &str| format!("{path}.highlight.{name}");
        ensure((0.0..=1e6).contains(&strength), || field("strength"), strength, "0 to 1e6")?;
        ensure((0.0..=1e6).contains(&exponent), || field("exponent"), exponent, "0 to 1e6")
    }
}

impl Form {
    fn validate(&self, path: &str) -> Result<(), InvalidValue> {
        let right = |sizes: &[f64]| sizes.iter().all(|size| (1e-6..=1e6).contains(size));
        let expected = "1e-6 to 1e6 m";
        match self {
            Self::Rectangle { size_m } => {
                ensure(right(size_m), || format!("{path}.rectangle.size_m"), size_m, expected)
            }
            Self::Cuboid { size_m } => {
                ensure(right(size_m), || format!("{path}.cuboid.size_m"), size_m, expected)
            }
            Self::Sphere { radius_m } => {
                ensure(right(&[*radius_m]), || format!("{path}.sphere.radius_m"), radius_m, expected)
            }
            Self::Cylinder { radius_m, height_m } => {
                ensure(right(&[*radius_m]), || format!("{path}.cylinder.radius_m"), radius_m, expected)?;
                ensure(right(&[*height_m]), || format!("{path}.cylinder.height_m"), height_m, expected)
            }
        }
    }
}
