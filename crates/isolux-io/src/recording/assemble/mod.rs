//! From the channels of any source to frames.
//!
//! [`Assembled`] checks, when it is opened, that the channels make one recording (`check`), reaches frames in the
//! order that the source allows (`cursor`), and fills a frame (`fill`) from the loaded channels (`loaded`): phase
//! samples (`phases`: four `bins`, or `iq`; `unwrap` of two frequencies), distances (`distance`), and single values, each checked (`values`).

mod assembled;
mod bins;
mod check;
mod codes;
mod cursor;
mod distance;
mod fill;
mod iq;
mod loaded;
mod phases;
mod unwrap;
mod values;

pub use assembled::Assembled;
