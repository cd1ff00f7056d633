//! Reference decays, and how a fit over distance used them.

/// Amplitude and distance of the flat target at one position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DecayPoint {
    /// Mean distance in the window, m.
    pub distance_m: f64,
    /// Mean amplitude in the window, DN.
    pub amplitude_dn: f64,
}

/// The reference decay of one integration time.
#[derive(Clone, Debug, PartialEq)]
pub struct Decay {
    /// Integration time, µs; `None` where it is unknown.
    pub integration_time_us: Option<f64>,
    /// Positions, in any order.
    pub points: Vec<DecayPoint>,
}

/// How the fit used one reference decay.
#[derive(Clone, Debug, PartialEq)]
pub struct DecayUse {
    /// Integration time of the decay, µs.
    pub integration_time_us: Option<f64>,
    /// How it was scaled.
    pub scaling: Scaling,
    /// Root mean square of the relative error that the pooled cubic leaves on it.
    pub residual: Option<f64>,
}

/// How a decay was brought to the scale of the others.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scaling {
    /// Normalized by its own cubic at the reference distance.
    AtReference,
    /// It does not reach the reference distance: scaled onto the others where they overlap.
    OntoOthers,
    /// Neither reaches the reference nor overlaps the others: not used.
    LeftOut,
}

impl Scaling {
    /// In words, for reports.
    #[must_use]
    pub fn describe(self) -> &'static str {
        match self {
            Self::AtReference => "normalized at the reference distance",
            Self::OntoOthers => "scaled onto the others",
            Self::LeftOut => "left out",
        }
    }
}
