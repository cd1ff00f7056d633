//! What a figure of the diagnosis needs at least.

use crate::frame::IntegrationTime;

/// Integration times less than this factor apart count as one: cameras report them with jitter.
pub(super) const SAME_TIME_RATIO: f64 = IntegrationTime::SAME_RATIO;
/// Factor that distances (5 to 95 % quantile) must span for an exponent: 1.2 makes d² differ by 44 %.
pub(super) const MINIMUM_DISTANCE_RATIO: f64 = 1.2;
/// Rows below which a regression is no statement.
pub(super) const MINIMUM_ROWS: usize = 200;
/// Clusters of frames or times are used from this number on: fewer are no estimate of a variance.
pub(super) const MINIMUM_FRAME_CLUSTERS: usize = 8;
