//! The steps of the chain that are no more than a name.

use crate::names::named;

named! {
    /// Which terms to use where no single step says otherwise.
    #[derive(Default)]
    pub enum Method: "method" {
        /// The steps of the paper: lut, cubic and histogram. The calibration must hold them.
        Paper = "paper",
        /// The best terms that the calibration holds; without a calibration, textbook physics.
        #[default]
        Best = "best",
    }
}

named! {
    /// The step that removes the effect of the integration time.
    #[non_exhaustive]
    pub enum TimeStep: "time step" {
        /// The calibration's lookup table.
        Lut = "lut",
        /// Saturation corrected by the fill of each pixel (the calibration's response), then `t_ref / t`.
        Response = "response",
        /// `t_ref / t`.
        Linear = "linear",
        /// The factor that all still pixels of a frame share: relative to the other frames, without integration times.
        Relative = "relative",
        /// No correction of the integration time.
        None = "none",
    }
}

named! {
    /// The step that removes the effect of the distance.
    #[non_exhaustive]
    pub enum DistanceStep: "distance step" {
        /// The calibration's polynomial.
        Cubic = "cubic",
        /// The calibration's smooth law (spline).
        Spline = "spline",
        /// `(d / d_ref)²`.
        Square = "square",
        /// Eq. 5 of the paper: `((2d)² + 1) / ((2 d_ref)² + 1)`, d in metres.
        Eq5 = "eq5",
        /// No correction of the distance.
        None = "none",
    }
}

named! {
    /// The step that removes the effect of the illumination profile.
    pub enum ProfileStep: "profile step" {
        /// Divide by the calibration's illumination profile.
        On = "on",
        /// No correction of the illumination profile.
        Off = "off",
    }
}

named! {
    /// The step that removes the effect of the angle of incidence.
    pub enum AngleStep: "angle step" {
        /// Divide by the cosine of the angle to the power that the calibration holds; without one, 1 (Lambert).
        On = "on",
        /// No correction of the angle of incidence.
        Off = "off",
    }
}

named! {
    /// Whether the standard deviation of each value is predicted. Where it is, the bias that the noise of the
    /// distance causes is subtracted from the values.
    #[derive(Default)]
    pub enum SigmaStep: "sigma step" {
        /// Predict it; an error when the noise is not known.
        Required = "on",
        /// Predict it where the choice or the calibration knows the noise.
        WhereKnown = "where-known",
        /// Predict nothing, take nothing off.
        #[default]
        None = "off",
    }
}
