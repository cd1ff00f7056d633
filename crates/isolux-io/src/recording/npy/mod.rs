//! `.npy` files: what their headers say, and how headers are written.

mod descr;
mod header;
mod header_error;
mod literal;

pub(crate) use header::{NpyHeader, header_bytes};
pub(crate) use header_error::HeaderError;
