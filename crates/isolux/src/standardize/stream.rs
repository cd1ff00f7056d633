//! Standardizing frames that come one after the other, from a recording or a live camera.

use super::error::StandardizeError;
use super::prepared::{MeanDistance, Prepared};
use super::standardized::Standardized;
use super::standardizer::Standardizer;
use super::workspace::Workspace;
use crate::denoise::TemporalMean;
use crate::frame::{Frame, Shape};

/// Standardizes a sequence of frames. It owns the chain, what must be remembered of earlier frames, working memory
/// and the last result.
///
/// ```
/// use isolux::{Channels, Choice, Frame, IntegrationTime, Shape, Standardizer};
///
/// let channels = Channels::AMPLITUDE | Channels::INTEGRATION_TIME;
/// let mut stream = Standardizer::plan(&Choice::default(), None, channels)?.stream();
/// for time_us in [1000.0, 2000.0] {
///     let mut frame = Frame::new(Shape::new(1, 1));
///     frame.amplitude.fill(0.1 * time_us as f32);
///     frame.integration_time_us = IntegrationTime::PerFrame(time_us);
///     let standardized = stream.push(&frame)?;
///     assert_eq!(standardized.amplitude.get(0, 0), Some(820.0));
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Stream {
    standardizer: Standardizer,
    history: Option<TemporalMean>,
    /// Number of the next frame.
    next: usize,
    prepared: Prepared,
    workspace: Workspace,
    out: Standardized,
}

impl Standardizer {
    /// Begins a stream of frames that share this chain.
    #[must_use]
    pub fn stream(&self) -> Stream {
        Stream {
            standardizer: self.clone(),
            history: (self.frames_before() > 0).then(TemporalMean::new),
            next: 0,
            prepared: Prepared::default(),
            workspace: Workspace::default(),
            out: Standardized::new(Shape::new(0, 0)),
        }
    }
}

impl Stream {
    /// The chain.
    #[must_use]
    pub fn standardizer(&self) -> &Standardizer {
        &self.standardizer
    }

    /// Standardizes the next frame. Allocates only when the shape differs from that of the last frame.
    ///
    /// # Errors
    /// [`StandardizeError`] when the frame lacks what the plan needs, or its planes differ in shape.
    pub fn push(&mut self, frame: &Frame) -> Result<&Standardized, StandardizeError> {
        let mut prepared = std::mem::take(&mut self.prepared);
        let outcome = self.prepare(frame, &mut prepared);
        self.prepared = prepared;
        outcome?;
        self.standardizer.apply(frame, &self.prepared, &mut self.workspace, &mut self.out)?;
        Ok(&self.out)
    }

    /// Takes the next frame, in order, and writes into `out` what earlier frames contribute to it. Afterwards,
    /// [`Standardizer::apply`] may work on the frame in any order and thread.
    ///
    /// # Errors
    /// [`StandardizeError`] when the chain averages over frames and this frame has no distance, or its planes
    /// differ in shape.
    pub fn prepare(&mut self, frame: &Frame, out: &mut Prepared) -> Result<(), StandardizeError> {
        out.ambient_dn_per_us = self.standardizer.ambient_dn_per_us(self.next);
        out.relative_gain = self.standardizer.relative_gain(self.next);
        self.next += 1;
        let Some(history) = &mut self.history else {
            out.mean = None;
            return Ok(());
        };
        let MeanDistance { distance_m, variance_left } = out.mean.get_or_insert_default();
        history.push(frame, distance_m)?;
        if self.standardizer.predicts_sigma() {
            history.variance_left(variance_left);
        }
        Ok(())
    }

    /// The result of the last push; it has no pixels before the first push.
    #[must_use]
    pub fn last(&self) -> &Standardized {
        &self.out
    }

    /// Forgets the frames so far. Call it when another scene begins.
    pub fn reset(&mut self) {
        if let Some(history) = &mut self.history {
            history.reset();
        }
    }

    /// Forgets the frames so far, and takes the next one as this frame of the recording, counted from 0: where the plan
    /// knows something of each frame, it is that of this one.
    pub fn continue_at(&mut self, frame: usize) {
        self.reset();
        self.next = frame;
    }

    /// Bytes that it has allocated.
    #[must_use]
    pub fn bytes(&self) -> usize {
        let history = self.history.as_ref().map_or(0, TemporalMean::bytes);
        history + self.prepared.bytes() + self.workspace.bytes() + self.out.bytes()
    }
}
