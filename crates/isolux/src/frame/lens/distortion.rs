//! The models of distortion, by their names.

use std::fmt;

use super::error::LensError;
use super::fisheye::Fisheye;
use super::polynomial::Polynomial;

/// A distortion of the image of a pinhole. Places are those at depth 1: pixels from the principal point over the focal
/// length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Distortion(Kind);

#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    /// Brown and Conrady's, with the number of its coefficients. ROS calls it `plumb_bob`.
    BrownConrady(Polynomial, usize),
    /// The same polynomial in the other direction, from the distorted to the undistorted image, as librealsense has it.
    InverseBrownConrady(Polynomial),
    /// A quotient of two polynomials.
    Rational(Polynomial),
    /// Kannala and Brandt's, for fisheye lenses.
    Fisheye(Fisheye),
}

/// What a name stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Model {
    None,
    BrownConrady,
    InverseBrownConrady,
    Rational,
    Fisheye,
}

impl Model {
    /// Upper and lower case, `-` and spaces make no difference.
    fn named(name: &str) -> Option<Self> {
        let plain: String = name.trim().to_lowercase().replace(['-', ' ', '–'], "_");
        let plain =
            plain.strip_prefix("distortion.").or(plain.strip_prefix("rs2_distortion_")).unwrap_or(&plain);
        Some(match plain {
            "" | "none" | "pinhole" | "perspective" | "ideal" => Self::None,
            "brown_conrady" | "brown" | "plumb_bob" | "radtan" | "radial_tangential" | "opencv" => {
                Self::BrownConrady
            }
            "inverse_brown_conrady" => Self::InverseBrownConrady,
            "rational" | "rational_polynomial" | "rational_6kt" => Self::Rational,
            "fisheye" | "equidistant" | "kannala_brandt" | "kannala_brandt4" | "kb4" | "opencv_fisheye" => {
                Self::Fisheye
            }
            _ => return None,
        })
    }

    /// Its own name, and the numbers of coefficients that it takes.
    fn describe(self) -> (&'static str, &'static str) {
        match self {
            Self::None => ("none", "no coefficients"),
            Self::BrownConrady => ("brown_conrady", "4 or 5 (k1, k2, p1, p2, k3)"),
            Self::InverseBrownConrady => ("inverse_brown_conrady", "5 (k1, k2, p1, p2, k3)"),
            Self::Rational => ("rational", "8 (k1, k2, p1, p2, k3, k4, k5, k6)"),
            Self::Fisheye => ("fisheye", "4 (k1, k2, k3, k4)"),
        }
    }

    fn most(self) -> usize {
        match self {
            Self::None => 0,
            Self::BrownConrady | Self::InverseBrownConrady => 5,
            Self::Rational => 8,
            Self::Fisheye => 4,
        }
    }

    fn takes(self, count: usize) -> bool {
        match self {
            Self::None => false,
            Self::BrownConrady => count == 4 || count == 5,
            Self::InverseBrownConrady => count == 5,
            // OpenCV has up to 14: those of thin prisms and of a tilted sensor, which are refused by their own name.
            Self::Rational => (8..=14).contains(&count),
            Self::Fisheye => count == 0 || count == 4,
        }
    }
}

/// Zeros behind the coefficients that a model takes: librealsense has five for every model, OpenCV up to 14.
fn without_padding(coefficients: &[f64], most: usize) -> &[f64] {
    let last = coefficients.iter().rposition(|value| *value != 0.0).map_or(0, |last| last + 1);
    &coefficients[..coefficients.len().min(last.max(most))]
}

impl Distortion {
    /// The model of this name with `coefficients` in OpenCV's order: k1, k2, p1, p2, k3, k4, k5, k6; for a fisheye k1,
    /// k2, k3, k4, all 0 where none are given. `None` where nothing is distorted.
    ///
    /// # Errors
    /// [`LensError`] for an unknown name, the wrong number of coefficients, and values that cannot be used.
    pub fn named(name: &str, coefficients: &[f64]) -> Result<Option<Self>, LensError> {
        let model = Model::named(name).ok_or_else(|| LensError::UnknownModel { name: name.to_owned() })?;
        let (own_name, expected) = model.describe();
        // Without distortion a polynomial is a pinhole; a fisheye is equidistant.
        if model != Model::Fisheye && coefficients.iter().all(|value| *value == 0.0) {
            return Ok(None);
        }
        let coefficients = without_padding(coefficients, model.most());
        if !model.takes(coefficients.len()) {
            return Err(LensError::CoefficientCount { model: own_name, found: coefficients.len(), expected });
        }
        if !coefficients.iter().all(|value| value.is_finite()) {
            return Err(LensError::NotFinite { model: own_name });
        }
        if let Some(&value) = coefficients.iter().skip(8).find(|value| **value != 0.0) {
            return Err(LensError::Prisms { value });
        }
        let polynomial = || Polynomial::new(coefficients);
        Ok(Some(Self(match model {
            Model::None => return Ok(None),
            Model::BrownConrady => Kind::BrownConrady(polynomial(), coefficients.len()),
            Model::InverseBrownConrady => Kind::InverseBrownConrady(polynomial()),
            Model::Rational => Kind::Rational(polynomial()),
            Model::Fisheye => Kind::Fisheye(Fisheye::new(coefficients)),
        })))
    }

    /// The direction, of any length, that is shown at a place; `None` outside the domain of the model.
    #[must_use]
    pub fn ray(&self, place: [f64; 2]) -> Option<[f64; 3]> {
        let flat = |[x, y]: [f64; 2]| [x, y, 1.0];
        match &self.0 {
            Kind::BrownConrady(polynomial, _) | Kind::Rational(polynomial) => {
                polynomial.undistort(place).map(flat)
            }
            Kind::InverseBrownConrady(polynomial) => {
                polynomial.is_within(place).then(|| flat(polynomial.distort(place)))
            }
            Kind::Fisheye(fisheye) => fisheye.ray(place),
        }
    }

    /// The place at which a direction is shown; `None` where it is not.
    #[must_use]
    pub fn image(&self, direction: [f64; 3]) -> Option<[f64; 2]> {
        let [x, y, z] = direction;
        let flat = (z > 0.0).then_some([x / z, y / z]);
        match &self.0 {
            Kind::BrownConrady(polynomial, _) | Kind::Rational(polynomial) => {
                flat.filter(|place| polynomial.is_within(*place)).map(|place| polynomial.distort(place))
            }
            Kind::InverseBrownConrady(polynomial) => polynomial.undistort(flat?),
            Kind::Fisheye(fisheye) => fisheye.image(direction),
        }
    }
}

impl fmt::Display for Distortion {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.0 {
            Kind::BrownConrady(_, count) => write!(f, "Brown–Conrady, {count} coefficients"),
            Kind::InverseBrownConrady(_) => f.write_str("inverse Brown–Conrady, 5 coefficients"),
            Kind::Rational(_) => f.write_str("rational polynomial, 8 coefficients"),
            Kind::Fisheye(_) => f.write_str("Kannala–Brandt fisheye, 4 coefficients"),
        }
    }
}
