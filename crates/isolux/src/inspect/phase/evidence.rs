//! What shows that phases are read the wrong way.

use std::fmt;

use serde::Serialize;

use crate::frame::PhaseConvention;

/// What contradicts the order or the sign in which phase samples are read.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
#[non_exhaustive]
pub enum PhaseEvidence {
    /// A1 + A3 is not A2 + A4, as it must be where A1 and A3, A2 and A4 are half a period apart.
    Sums {
        /// Typical difference of the sums as they are read, relative to the amplitude.
        stated: f64,
        /// The same where other bins are opposite.
        found: f64,
        /// True where amplitude and distance, or a recorded distance, tell start and sign of the phase too.
        sign_known: bool,
    },
    /// The amplitude does not fall with the distance as light does.
    Law {
        /// Exponent of the distance as the phases are read.
        stated: f64,
        /// The same, read the other way; about −2.
        found: f64,
    },
    /// The distances are not the recorded ones.
    RecordedDistance {
        /// Typical difference from the recorded distances as the phases are read, m.
        stated_m: f64,
        /// The same, read the other way.
        found_m: f64,
    },
}

/// Phases that are read the wrong way: what shows it, and the way that fits.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PhaseFault {
    /// Order and sign by which the phases were read.
    pub stated: PhaseConvention,
    /// Order and sign that fit.
    pub fitting: PhaseConvention,
    /// What shows it.
    pub evidence: PhaseEvidence,
}

impl fmt::Display for PhaseFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let other = Changed(self);
        match self.evidence {
            PhaseEvidence::Sums { stated, found, sign_known } => {
                write!(
                    f,
                    "the phase samples are not in the order in which they are read: A1 + A3 and A2 + A4 differ by {:.0} % \
                     of the amplitude, {other} by {:.0} %",
                    100.0 * stated,
                    100.0 * found
                )?;
                let doubt =
                    "; start and sign of the phase, and so the distance, cannot be told from these frames";
                f.write_str(if sign_known { "" } else { doubt })
            }
            PhaseEvidence::Law { stated, found } => {
                let grows = match stated {
                    1.0.. => "grows",
                    ..-1.0 => "falls",
                    _ => "goes",
                };
                write!(
                    f,
                    "order or sign of the phases does not fit: as they are read, the amplitude {grows} with d^{stated:.1}, \
                     which no light does; {other}, it falls with d^{found:.1}"
                )
            }
            PhaseEvidence::RecordedDistance { stated_m, found_m } => write!(
                f,
                "order or sign of the phases does not fit: as they are read, their distances differ from the recorded ones \
                 by {stated_m:.2} m, {other} by {found_m:.2} m"
            ),
        }
    }
}

/// What is changed, in a few words.
struct Changed<'a>(&'a PhaseFault);

impl fmt::Display for Changed<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let PhaseFault { stated, fitting, .. } = self.0;
        let [a, b, c, d] = fitting.order;
        match (fitting.order == stated.order, fitting.reversed) {
            (true, _) => f.write_str("with the sign reversed"),
            (false, false) => write!(f, "in the order {a}, {b}, {c}, {d}"),
            (false, true) => write!(f, "in the order {a}, {b}, {c}, {d} with the sign reversed"),
        }
    }
}
