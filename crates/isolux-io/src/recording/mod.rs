//! Recordings: what they hold, how they are read and written, and the formats.
//!
//! From the ground up, each module using only those above it in this list:
//!
//! | module | what it holds |
//! |---|---|
//! | `element`, `codes`, `distance_unit` | number types; values that are no measurements; metres per unit |
//! | `frequency`, `lens` | one modulation frequency or two; the lens in `recording.json` |
//! | `info`, `metadata` | `recording.json`; what is known of a recording |
//! | `phase_layout`, `channels` | the forms of phase samples; the channels with a meaning: name, dimensions, flag |
//! | `source` | [`ChannelSource`]: what a format has to deliver |
//! | `reading` | [`Recording`]: what readers see |
//! | `assemble` | [`Assembled`]: from the one to the other; units, radial distances, flags, checks |
//! | `npy`, `native` | headers of `.npy` files; the native format |
//! | `writer` | [`RecordingWriter`] |
//! | `open` | the list of formats |
//!
//! The native form is a folder with one `.npy` file per channel and `recording.json`, or the same in one `.npz`
//! with a `.json` of the same stem beside it. A folder that holds `recording.npz` and `recording.json` is opened
//! like that archive.

mod assemble;
mod channels;
mod codes;
mod distance_unit;
mod element;
mod frequency;
mod info;
mod lens;
mod metadata;
mod native;
mod npy;
mod open;
mod phase_layout;
mod reading;
mod source;
mod writer;

pub use assemble::Assembled;
pub use codes::{ChannelCodes, Code, Codes, CodesFrom, OneOrMore};
pub use distance_unit::DistanceUnit;
pub use element::{ByteOrder, Element, ElementType, Number};
pub use frequency::ModulationFrequency;
pub use info::{DistanceKind, RecordedIntrinsics, RecordingInfo};
pub use lens::{LensDescription, UnusedLens, UnusedReason};
pub use metadata::{Access, ChannelInfo, Metadata, Storage, lens_of};
pub use open::open;
pub use reading::{Recording, for_each_frame};
pub use source::{ChannelSource, RawFrame, SourceDescription, StoredChannel};
pub use writer::{ChannelSpec, RecordingWriter};
