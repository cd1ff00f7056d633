//! The forms in which `phase_samples` come.

use super::element::ElementType;

/// What a frame of `phase_samples` holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum PhaseLayout {
    /// (4, H, W): A1..A4.
    Bins,
    /// (8, H, W): A1..A4 of a first frequency, then of a second.
    TwiceBins,
    /// (2, H, W): I and Q; or (H, W), complex: I + iQ.
    Iq,
    /// (2, H, W), complex: I + iQ of a first and of a second frequency.
    TwiceIq,
}

impl PhaseLayout {
    /// The layout of frames of these dimensions; `None` for what is none.
    pub(crate) fn of(element: ElementType, dims: &[usize]) -> Option<Self> {
        match (element.is_complex(), dims) {
            (false, [4, _, _]) => Some(Self::Bins),
            (false, [8, _, _]) => Some(Self::TwiceBins),
            (false, [2, _, _]) | (true, [_, _]) => Some(Self::Iq),
            (true, [2, _, _]) => Some(Self::TwiceIq),
            _ => None,
        }
    }

    /// True for phase samples of two frequencies.
    pub(crate) fn is_twice(self) -> bool {
        matches!(self, Self::TwiceBins | Self::TwiceIq)
    }

    /// True where the raw bins are not there: neither their order nor how full a pixel is can be known.
    pub(crate) fn is_iq(self) -> bool {
        matches!(self, Self::Iq | Self::TwiceIq)
    }
}
